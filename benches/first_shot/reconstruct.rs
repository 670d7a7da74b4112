//! Maps after reconstruction against maps as they are, and against each element drawn to its cluster's mean.
//!
//! Errors are relative, weighted by area, with bias in them; the reference's noise is taken out.

use crate::scenes::Case;
use cpu_time::ProcessTime;
use etendue::core::backend::{NoControl, PhotonJob, PhotonStart, Session, illumination_film_settings};
use etendue::core::film::Film;
use etendue::core::illumination::{
    Basis, Clustering, ElementSettings, Elements, NO_CLUSTER, Sides, reconstruct,
};
use etendue::core::transport::first_shot::{Subdivision, Weights};
use etendue::core::transport::photon::Sequence;
use etendue::cpu::CpuSession;

const REPLICATES_LOG2: u32 = 4;
const CLUSTERS: usize = 2000;

struct Map {
    mean: Vec<[f64; 3]>,
    variance: Vec<[f64; 3]>,
}

impl Map {
    fn of(film: &Film) -> Self {
        Self {
            mean: (0..film.len()).map(|i| film.mean(i)).collect(),
            variance: (0..film.len()).map(|i| film.variance(i).expect("replicates")).collect(),
        }
    }
}

/// Sums over elements and channels: squared distance to the reference, the map's own estimate of it, the reference's square and mean squared z.
struct Compared {
    error: f64,
    stated: f64,
    z2: f64,
}

fn compare(elements: &Elements, map: &Map, reference: &Map) -> Compared {
    let (mut distance, mut stated, mut square, mut z2, mut weights) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for i in 0..map.mean.len() {
        let w = elements.weight(i);
        for c in 0..3 {
            let (truth, noise) = (reference.mean[i][c], reference.variance[i][c]);
            let d2 = (map.mean[i][c] - truth).powi(2);
            distance += w * (d2 - noise);
            stated += w * map.variance[i][c];
            square += w * (truth * truth - noise);
            if map.variance[i][c] > 0.0 {
                z2 += w * d2 / (map.variance[i][c] + noise);
                weights += w;
            }
        }
    }
    Compared {
        error: (distance.max(0.0) / square).sqrt(),
        stated: (stated / square).sqrt(),
        z2: z2 / weights.max(f64::MIN_POSITIVE),
    }
}

/// Each element drawn to the mean of its cluster by its noise; the spread beyond noise is the cluster's signal.
fn to_cluster_means(clustering: &Clustering, elements: &Elements, map: &Map) -> Map {
    let clusters = clustering.by_count(CLUSTERS);
    let (weight, n) = (|i: usize| elements.weight(i), map.mean.len());
    let means = clusters.means(weight, |i| map.mean[i]);
    let noise = clusters.means(weight, |i| map.variance[i].map(|v| v * f64::from(elements.area(i))));
    let rest = clusters.means(weight, |i| {
        let k = clusters.of[i] as usize;
        [0, 1, 2]
            .map(|c| (map.mean[i][c] - means[k].0[c]).powi(2) - noise[k].0[c] / f64::from(elements.area(i)))
    });
    let mut out = Map { mean: map.mean.clone(), variance: map.variance.clone() };
    for i in (0..n).filter(|i| clusters.of[*i] != NO_CLUSTER) {
        let k = clusters.of[i] as usize;
        for c in 0..3 {
            let (v, signal) = (noise[k].0[c] / f64::from(elements.area(i)), rest[k].0[c].max(0.0));
            let gain = if signal > 0.0 { signal / (signal + v) } else { 0.0 };
            out.mean[i][c] = means[k].0[c] + gain * (map.mean[i][c] - means[k].0[c]);
            out.variance[i][c] = gain * v;
        }
    }
    out
}

fn film(session: &CpuSession, elements: &Elements, job: &PhotonJob) -> Film {
    let mut film = Film::new(illumination_film_settings(session.scene(), elements, job).expect("light"));
    session.illumination(job, &NoControl, &mut film).expect("a map");
    film
}

/// Prints the table of one scene; `reference_bits` is the logarithm of the reference's photons.
pub(crate) fn run(case: &Case, reference_bits: u32) {
    let session = crate::session(&case.scene);
    let lights = |survives_first| PhotonStart::Lights { registers_direct: false, survives_first };
    let surfaces = PhotonStart::Surfaces { subdivision: Subdivision::robust(), weights: Weights::EXACT };
    println!(
        "\n{}: {}, {} triangles; reference 2^{reference_bits}",
        case.name,
        case.about,
        case.scene.triangles.len()
    );
    println!(
        "relative error in %: the map as it is | drawn to {CLUSTERS} clusters | reconstructed (stated, z^2, seconds, flux)"
    );
    for (basis, sides) in [
        (Basis::Constant, Sides::Together),
        (Basis::Constant, Sides::Apart),
        (Basis::Linear, Sides::Together),
        (Basis::Linear, Sides::Apart),
    ] {
        let settings = ElementSettings { basis, sides, largest: f32::INFINITY };
        let elements = Elements::new(&case.scene, settings);
        let clustering = Clustering::new(&case.scene, &elements);
        let job = |bits: u32, start, sequence, seed| PhotonJob {
            seed,
            photons: 1 << (bits - REPLICATES_LOG2),
            replicates: 0..1 << REPLICATES_LOG2,
            max_hits: u32::MAX,
            start,
            sequence,
            elements: settings,
        };
        let of = |job: &PhotonJob| film(&session, &elements, job);
        let reference = Map::of(&of(&job(reference_bits, lights(true), Sequence::Sorted, 77)));
        println!("  {basis:?} {sides:?}, {} elements", elements.count());
        for (name, start, sequence) in
            [("lights random", lights(false), Sequence::Random), ("exact sorted", surfaces, Sequence::Sorted)]
        {
            for bits in [16, 18, 20] {
                let film = of(&job(bits, start, sequence, 1));
                let raw = Map::of(&film);
                let drawn = to_cluster_means(&clustering, &elements, &raw);
                let clock = ProcessTime::now();
                let found = reconstruct(&clustering, &elements, &film).expect("replicates");
                let seconds = clock.elapsed().as_secs_f64();
                let found = Map {
                    mean: found.values,
                    variance: found.stderr.iter().map(|s| s.map(|s| s * s)).collect(),
                };
                let flux =
                    |map: &Map| (0..film.len()).map(|i| elements.weight(i) * map.mean[i][1]).sum::<f64>();
                let [a, b, c] = [&raw, &drawn, &found].map(|map| compare(&elements, map, &reference));
                println!(
                    "    {name:14} 2^{bits} | {:.2} | {:.2} ({:.2}, {:.2}) | {:.2} ({:.2}, {:.2}, {seconds:.2} s, {:.4})",
                    100.0 * a.error,
                    100.0 * b.error,
                    100.0 * b.stated,
                    b.z2,
                    100.0 * c.error,
                    100.0 * c.stated,
                    c.z2,
                    flux(&found) / flux(&raw),
                );
            }
        }
    }
}
