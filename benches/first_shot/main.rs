//! First shot against photons from the lights: speed against error.
#![allow(missing_docs, clippy::disallowed_methods, reason = "a program that prints, no library")]

mod reconstruct;
mod scenes;

use cpu_time::ProcessTime;
use etendue::core::backend::{NoControl, PhotonJob, PhotonStart, Session, illumination_film_settings};
use etendue::core::film::Film;
use etendue::core::illumination::{Clustering, Clusters, ElementSettings, Elements};
use etendue::core::scene::CompiledScene;
use etendue::core::transport::first_shot::{Subdivision, Weights};
use etendue::core::transport::photon::Sequence;
use etendue::cpu::{CpuBackend, CpuSession};
use std::path::PathBuf;
use std::sync::Arc;

fn session(scene: &CompiledScene) -> CpuSession {
    CpuBackend::new(Some(1)).expect("a backend").open_session(Arc::new(scene.clone())).expect("a session")
}

struct Run {
    maps: Vec<Vec<[f64; 3]>>,
    seconds: f64,
    rays: u64,
    hits: u64,
}

fn run(session: &CpuSession, elements: &Elements, job: &PhotonJob) -> Run {
    let (mut maps, mut seconds, mut rays, mut hits) = (Vec::new(), 0.0, 0, 0);
    for r in job.replicates.clone() {
        let one = PhotonJob { replicates: r..r + 1, ..job.clone() };
        let mut film = Film::new(illumination_film_settings(session.scene(), elements, &one).expect("light"));
        let start = ProcessTime::now();
        let stats = session.illumination(&one, &NoControl, &mut film).expect("a map");
        seconds += start.elapsed().as_secs_f64();
        rays += stats.rays;
        hits += stats.hits;
        maps.push((0..film.len()).map(|i| film.mean(i)).collect());
    }
    Run { maps, seconds, rays, hits }
}

fn error(maps: &[Vec<([f64; 3], f64)>]) -> f64 {
    let n = maps.len() as f64;
    let (mut var, mut square) = (0.0, 0.0);
    for i in 0..maps[0].len() {
        let area = maps[0][i].1;
        for c in 0..3 {
            let m = maps.iter().map(|m| m[i].0[c]).sum::<f64>() / n;
            let v = maps.iter().map(|x| (x[i].0[c] - m).powi(2)).sum::<f64>() / (n - 1.0);
            var += area * v;
            square += area * (m * m - v / n);
        }
    }
    (var / square).sqrt()
}

fn on(clusters: Option<&Clusters>, elements: &Elements, maps: &[Vec<[f64; 3]>]) -> Vec<Vec<([f64; 3], f64)>> {
    maps.iter()
        .map(|m| match clusters {
            Some(c) => c.means(|i| elements.weight(i), |i| m[i]),
            None => m.iter().enumerate().map(|(i, x)| (*x, elements.weight(i))).collect(),
        })
        .collect()
}

/// Distance of the means of two runs beyond their noise, over the size.
fn bias(a: &[Vec<([f64; 3], f64)>], b: &[Vec<([f64; 3], f64)>]) -> f64 {
    let stats = |maps: &[Vec<([f64; 3], f64)>], i: usize, c: usize| {
        let n = maps.len() as f64;
        let m = maps.iter().map(|m| m[i].0[c]).sum::<f64>() / n;
        (m, maps.iter().map(|x| (x[i].0[c] - m).powi(2)).sum::<f64>() / (n - 1.0) / n)
    };
    let (mut d2, mut s2) = (0.0, 0.0);
    for i in 0..a[0].len() {
        for c in 0..3 {
            let ((ma, va), (mb, vb)) = (stats(a, i, c), stats(b, i, c));
            d2 += a[0][i].1 * ((ma - mb).powi(2) - va - vb);
            s2 += a[0][i].1 * mb * mb;
        }
    }
    let d = d2 / s2;
    d.abs().sqrt() * d.signum()
}

fn main() {
    let mut args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    // `reconstruct` before the other arguments: of the maps after reconstruction.
    let reconstructs = args.first().is_some_and(|a| a == "reconstruct");
    if reconstructs {
        args.remove(0);
    }
    let only = args.first().map(String::as_str);
    let bits: u32 = args.get(1).and_then(|a| a.parse().ok()).unwrap_or(if reconstructs { 24 } else { 18 });
    let replicates: u32 = args.get(2).and_then(|a| a.parse().ok()).unwrap_or(8);
    let data = std::env::var_os("ETENDUE_SCENES").map(PathBuf::from);
    for case in scenes::cases(data.as_deref(), only) {
        if reconstructs {
            reconstruct::run(&case, bits);
            continue;
        }
        let session = session(&case.scene);
        let settings = ElementSettings::default();
        let elements = Elements::new(&case.scene, settings);
        println!("\n{}: {}, {} triangles", case.name, case.about, case.scene.triangles.len());
        let lights = |survives_first| PhotonStart::Lights { registers_direct: false, survives_first };
        let job = PhotonJob {
            seed: 1,
            photons: 1 << bits,
            replicates: 0..replicates,
            max_hits: u32::MAX,
            start: lights(false),
            sequence: Sequence::Random,
            elements: settings,
        };
        let reference = run(
            &session,
            &elements,
            &PhotonJob { seed: 77, start: lights(true), sequence: Sequence::Sorted, ..job.clone() },
        );
        let lit = |i: usize| reference.maps.iter().any(|m| m[i] != [0.0; 3]);
        let clustering = Clustering::new(&case.scene, &elements).retain(lit);
        let clusters = [None, Some(clustering.by_count(2000)), Some(clustering.by_count(200))];
        println!("clusters {:?}", clusters.iter().flatten().map(|c| c.count).collect::<Vec<_>>());
        let mut starts = vec![("lights", lights(false)), ("lights, weighted", lights(true))];
        for (s, subdivision) in [
            ("none", Subdivision::None),
            ("published", Subdivision::published()),
            ("robust", Subdivision::robust()),
        ] {
            for (w, weights) in [("density", Weights::Density), ("exact", Weights::EXACT)] {
                if s != "robust" && std::env::var_os("FULL").is_none() {
                    continue;
                }
                let start = ProcessTime::now();
                let shot = session.first_shot(&subdivision, weights).expect("a density");
                println!(
                    "  {s} {w}: precompute {:.3} s, {} pairs, {:.1} MB, s {:.4}",
                    start.elapsed().as_secs_f64(),
                    shot.pairs(),
                    shot.bytes() as f64 * 1e-6,
                    shot.survival()
                );
                starts.push((
                    Box::leak(format!("{s} {w}").into_boxed_str()),
                    PhotonStart::Surfaces { subdivision, weights },
                ));
            }
        }
        let mut base: Option<([f64; 3], f64)> = None;
        for (name, start) in starts {
            if let PhotonStart::Surfaces { subdivision, weights } = start {
                session.first_shot(&subdivision, weights).expect("a density");
            }
            for sequence in [Sequence::Random, Sequence::Sobol, Sequence::Sorted] {
                let r = run(&session, &elements, &PhotonJob { start, sequence, ..job.clone() });
                let errors = [0, 1, 2].map(|k| error(&on(clusters[k].as_ref(), &elements, &r.maps)));
                let bias = [1, 2].map(|k: usize| {
                    bias(
                        &on(clusters[k].as_ref(), &elements, &r.maps),
                        &on(clusters[k].as_ref(), &elements, &reference.maps),
                    )
                });
                let photons = f64::from(replicates) * f64::from(job.photons);
                let (e0, t0) = *base.get_or_insert((errors, r.seconds));
                let gain = [0, 1, 2].map(|k| (e0[k] / errors[k]).powi(2));
                println!(
                    "  {name:18} {sequence:?}\t{:.3} us {:.2} rays {:.2} hits  err {:.2} {:.2} {:.2} %  ph {:.2} {:.2} {:.2}  t {:.2} {:.2} {:.2}  bias {:.2} {:.2} %",
                    r.seconds / photons * 1e6,
                    r.rays as f64 / photons,
                    r.hits as f64 / photons,
                    100.0 * errors[0],
                    100.0 * errors[1],
                    100.0 * errors[2],
                    gain[0],
                    gain[1],
                    gain[2],
                    gain[0] * t0 / r.seconds,
                    gain[1] * t0 / r.seconds,
                    gain[2] * t0 / r.seconds,
                    100.0 * bias[0],
                    100.0 * bias[1],
                );
            }
        }
    }
}
