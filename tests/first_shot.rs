//! First shot on whole scenes: the law of its gain, its energy, and the answer of the path tracer.
//!
//! Short versions always; the long ones (`--ignored`) are those of TESTING.md.
#![cfg(all(feature = "io", feature = "cpu"))]
#![allow(clippy::disallowed_methods, reason = "statistics in f64")]

mod common;

use common::{root, shared_scenes};
use etendue::core::backend::{NoControl, PathJob, PhotonJob, PhotonStart, Probe, Session};
use etendue::core::backend::{illumination_film_settings, probe_film_settings};
use etendue::core::film::Film;
use etendue::core::illumination::{Basis, Clustering, Clusters, ElementSettings, Elements, Sides};
use etendue::core::scene::{LightDesc, SceneDesc, compile};
use etendue::core::transport::first_shot::{Subdivision, Weights};
use etendue::core::transport::photon::Sequence;
use etendue::cpu::{CpuBackend, CpuSession};
use etendue::io::load_scene;
use etendue::metrics::replicates::{Values, bias, moments, noise, on, total};
use etendue::metrics::statistics;
use std::path::Path;
use std::sync::Arc;

fn load(path: &Path) -> SceneDesc {
    load_scene(path).unwrap_or_else(|e| panic!("{e}")).desc
}

fn open(desc: &SceneDesc) -> CpuSession {
    let scene = compile(desc).unwrap_or_else(|e| panic!("{e}")).0;
    CpuBackend::new(None).unwrap().open_session(Arc::new(scene)).unwrap()
}

/// The plain baseline: absorbed by chance at every hit.
const LIGHTS: PhotonStart = PhotonStart::Lights { registers_direct: false, survives_first: false };

fn surfaces(weights: Weights) -> PhotonStart {
    PhotonStart::Surfaces { subdivision: Subdivision::robust(weights), weights }
}

/// Replicates of a map, one after the other.
fn maps(session: &CpuSession, elements: &Elements, job: &PhotonJob) -> Vec<Vec<[f64; 3]>> {
    job.replicates
        .clone()
        .map(|r| {
            let job = PhotonJob { replicates: r..r + 1, ..job.clone() };
            let mut film = Film::new(illumination_film_settings(session.scene(), elements, &job).unwrap());
            session.illumination(&job, &NoControl, &mut film).unwrap();
            assert_eq!((film.invalid(), film.saturated()), (0, 0));
            (0..film.len()).map(|i| film.mean(i)).collect()
        })
        .collect()
}

fn job(elements: &Elements, photons: u32, replicates: u32) -> PhotonJob {
    PhotonJob {
        seed: 11,
        photons,
        replicates: 0..replicates,
        max_hits: u32::MAX,
        start: LIGHTS,
        sequence: Sequence::Random,
        elements: *elements.settings(),
    }
}

/// Which elements some photon of a job found, by a run of its own: were they chosen by the values that are compared, small ones that few photons meet
/// would be in where they were met by chance, and too bright.
fn lit(session: &CpuSession, elements: &Elements, job: &PhotonJob) -> Vec<bool> {
    let job = PhotonJob { seed: 97, start: PhotonStart::LIGHTS, sequence: Sequence::Sorted, ..job.clone() };
    let mut found = vec![false; elements.count()];
    for map in maps(session, elements, &job) {
        for (lit, value) in found.iter_mut().zip(map) {
            *lit |= value != [0.0; 3];
        }
    }
    found
}

/// Share of the flux of lights without size that survives its first hit, counted with photons that end at their first hit.
fn counted_survival(session: &CpuSession, elements: &Elements, photons: u32) -> (f64, f64) {
    let scene = session.scene();
    let start = PhotonStart::Lights { registers_direct: true, survives_first: false };
    let job = PhotonJob { start, max_hits: 1, ..job(elements, photons, 16) };
    let found = maps(session, elements, &job);
    let emitted: f64 = scene
        .lights
        .iter()
        .map(|l| {
            let flux = etendue::core::light::emit::flux(l, scene.bounding_sphere().1);
            flux.to_array().iter().map(|x| f64::from(*x)).sum::<f64>()
        })
        .sum();
    let each: Vec<f64> = found
        .iter()
        .map(|map| {
            let flux: f64 = (0..scene.triangles.len())
                .map(|t| {
                    let albedo = scene.material_of(t as u32).albedo;
                    let e = map[t];
                    f64::from(scene.primitive_area(t as u32))
                        * (0..3).map(|c| e[c] * f64::from(albedo[c])).sum::<f64>()
                })
                .sum();
            flux / emitted
        })
        .collect();
    let (mean, variance) = statistics::mean_and_variance_of_mean(&each);
    (mean, variance.sqrt())
}

struct Law {
    gain: f64,
    survival: f64,
    bias: f64,
}

/// The gain in photons at about 2000 clusters with random numbers, and the bias that `density` has there.
fn law(name: &str, desc: &SceneDesc, largest: f32, photons: u32, replicates: u32) -> Law {
    let session = open(desc);
    let settings = ElementSettings { basis: Basis::Constant, sides: Sides::Together, largest };
    let elements = Elements::new(session.scene(), settings);
    let job = job(&elements, photons, replicates);
    let by_lights = maps(&session, &elements, &job);
    let by_density =
        maps(&session, &elements, &PhotonJob { start: surfaces(Weights::Density), seed: 12, ..job.clone() });
    let truth = PhotonJob {
        start: surfaces(Weights::EXACT),
        sequence: Sequence::Sorted,
        seed: 13,
        photons: 4 * photons,
        ..job.clone()
    };
    let truth = maps(&session, &elements, &truth);
    let lit = lit(&session, &elements, &job);
    let clusters = Clustering::new(session.scene(), &elements).retain(|i| lit[i]).by_count(2000);
    let [a, b, r] = [&by_lights, &by_density, &truth].map(|m| on(Some(&clusters), &elements, m));
    let shot = session.first_shot(&Subdivision::robust(Weights::Density), Weights::Density).unwrap();
    let found = Law { gain: (noise(&a) / noise(&b)).powi(2), survival: shot.survival(), bias: bias(&b, &r) };
    println!(
        "{name}: {} clusters, gain {:.3}, 1/s {:.3}, bias of density {:+.2} %",
        clusters.count,
        found.gain,
        1.0 / found.survival,
        100.0 * found.bias
    );
    found
}

/// 10 % and two standard errors of a ratio of two variances, each from `replicates` - 1 degrees of freedom at so many independent places.
fn allowed(replicates: u32, places: f64) -> f64 {
    0.1 + 2.0 * (4.0 / (f64::from(replicates - 1) * places)).sqrt()
}

fn check_law(law: &Law, replicates: u32) {
    // Photons of one walk meet several clusters, so that these count for fewer than they are.
    let off = law.gain * law.survival - 1.0;
    assert!(off.abs() <= allowed(replicates, 500.0), "gain {} where 1/s is {}", law.gain, 1.0 / law.survival);
}

fn room() -> SceneDesc {
    let mut desc = load(&root().join("scenes/cornell/closed.toml"));
    desc.shapes.clear();
    desc.lights = vec![LightDesc::Point { position: [2.78, 4.5, 2.795], intensity: [10.0; 3] }];
    desc
}

fn colonnade() -> SceneDesc {
    load(&root().join("scenes/colonnade/lamps.toml"))
}

#[test]
fn the_gain_is_one_over_the_share_that_survives() {
    let room = law("room", &room(), 0.3, 1 << 16, 16);
    assert!(room.bias.abs() < 0.005, "{}", room.bias);
    check_law(&room, 16);
    let colonnade = law("colonnade", &colonnade(), f32::INFINITY, 1 << 15, 16);
    if colonnade.bias < 0.005 {
        check_law(&colonnade, 16);
    }
}

#[test]
fn pairs_know_the_share_that_survives() {
    for (desc, photons) in [(room(), 1 << 18), (colonnade(), 1 << 19)] {
        let session = open(&desc);
        let elements = Elements::new(session.scene(), ElementSettings::default());
        let (counted, error) = counted_survival(&session, &elements, photons);
        for (weights, tolerance) in [(Weights::Density, 0.005), (Weights::EXACT, 0.01)] {
            let s = session.first_shot(&Subdivision::robust(weights), weights).unwrap().survival();
            println!("s {s:.5} by pairs, {counted:.5} +- {error:.5} by photons");
            assert!(
                (s - counted).abs() <= tolerance * counted + 3.0 * error,
                "{s} by pairs, {counted} by photons"
            );
        }
    }
}

/// Uniform numbers for places of probes.
fn unit(seed: u32, index: u32, dimension: u32) -> f32 {
    etendue::core::sampling::counter::Counter::new(u64::from(seed)).unit(7, index, dimension)
}

/// Indirect irradiance of clusters by the path tracer, less the direct light in closed form at each probe: each replicate has `each` probes of each cluster, on elements
/// drawn by area: many, since parts of some elements are hidden.
fn by_paths(
    session: &CpuSession,
    elements: &Elements,
    clusters: &Clusters,
    replicates: u32,
    each: u32,
) -> Vec<Values> {
    let scene = session.scene();
    let mut members: Vec<Vec<(u32, f64)>> = vec![Vec::new(); clusters.count];
    for (i, c) in clusters.of.iter().enumerate().filter(|(_, c)| (**c as usize) < clusters.count) {
        let list = &mut members[*c as usize];
        let before = list.last().map_or(0.0, |l| l.1);
        list.push((i as u32, before + elements.weight(i)));
    }
    let count = clusters.count as u32;
    (0..replicates)
        .map(|k| {
            let mut probes = Vec::new();
            for index in 0..each * count {
                let list = &members[(index % count) as usize];
                let numbers = [0, 1, 2].map(|d| unit(3 + k, index, d));
                let at = f64::from(numbers[0]) * list.last().map_or(0.0, |l| l.1);
                let element = list[list.partition_point(|l| l.1 <= at).min(list.len() - 1)].0 as usize;
                let (p, n) = elements.point_on(scene, element, [numbers[1], numbers[2]]).unwrap();
                probes.push(Probe { position: p.to_array(), normal: n.to_array() });
            }
            let job =
                PathJob { seed: 900 + u64::from(k), block_length: 16, blocks: 0..1, max_depth: u32::MAX };
            let mut film = Film::new(probe_film_settings(scene, &job, probes.len()));
            session.path_probes(&job, &probes, &NoControl, &mut film).unwrap();
            let mut values: Values =
                members.iter().map(|list| ([0.0; 3], list.last().map_or(0.0, |l| l.1))).collect();
            for (i, probe) in probes.iter().enumerate() {
                let (all, direct) = (film.mean(i), direct_at(session, probe));
                for c in 0..3 {
                    values[i % count as usize].0[c] += (all[c] - direct[c]) / f64::from(each);
                }
            }
            values
        })
        .collect()
}

/// Direct irradiance of lights without size at a probe, on the side of its normal.
fn direct_at(session: &CpuSession, probe: &Probe) -> [f64; 3] {
    use etendue::core::geometry::Intersector;
    use etendue::core::math::Vec3;
    let scene = session.scene();
    let n = Vec3::from_array(probe.normal);
    let point =
        etendue::core::transport::resolve_probe(scene, session.tree(), Vec3::from_array(probe.position), n);
    let mut sum = [0.0; 3];
    for light in &scene.lights {
        if etendue::core::light::emit::toward(light, point.position).dot(n) <= 0.0 {
            continue;
        }
        if let Some((e, ray)) = etendue::core::direct::irradiance::from_light(light, &point, n)
            && !session.tree().occluded(&ray)
        {
            for (s, x) in sum.iter_mut().zip(e.to_array()) {
                *s += f64::from(x);
            }
        }
    }
    sum
}

/// Compares two estimates on clusters: the largest Welch statistic by Sidak's correction at alpha = 0.001, the mean square of all, and the distance of all.
fn agree(name: &str, photons: &[Values], paths: &[Values], allowed_bias: f64) {
    let count = photons[0].len();
    let level = statistics::sidak(1e-3, 3 * count as u64);
    let [na, nb] = [photons, paths].map(|m| (m.len() - 1) as f64);
    let (mut squares, mut tests, mut worst) = (0.0, 0.0, (0.0_f64, 0));
    for i in 0..count {
        for c in 0..3 {
            let ((a, va), (b, vb)) = (moments(photons, i, c), moments(paths, i, c));
            if va + vb <= 0.0 {
                continue;
            }
            let z = (a - b) / (va + vb).sqrt();
            // Welch 1947.
            let degrees = (va + vb).powi(2) / (va * va / na + vb * vb / nb);
            let over = z.abs() / statistics::student_t_two_sided(level, degrees);
            if over > worst.0 {
                worst = (over, i);
            }
            // The variance of Student's t, taken out.
            squares += z * z * (1.0 - 2.0 / degrees.max(4.0));
            tests += 1.0;
        }
    }
    let mean_square = squares / tests;
    let [own, theirs] = [photons, paths].map(|m| noise(m) / (m.len() as f64).sqrt());
    let b = bias(photons, paths);
    println!(
        "{name}: {count} clusters, mean z^2 {mean_square:.3}, largest z over its limit {:.2}, distance {:+.2} %, noise {:.2} % of photons and {:.2} % of paths",
        worst.0,
        100.0 * b,
        100.0 * own,
        100.0 * theirs
    );
    assert!(worst.0 <= 1.0, "{name}: cluster {} is {} times its limit off", worst.1, worst.0);
    assert!(mean_square < 1.3, "{name}: {mean_square}");
    // The square of a distance is known to the square of the noise, of which a few places have most.
    assert!(b < allowed_bias.hypot(theirs), "{name}: {b}");
    let ((ta, va), (tb, vb)) = (total(photons), total(paths));
    let error = (va + vb).sqrt();
    assert!((ta - tb).abs() <= 3.0 * error, "{name}: {ta} by photons, {tb} by paths, {error} between them");
}

struct Effort {
    photons: u32,
    replicates: u32,
    /// Per cluster and replicate, of which there are 16; 16 paths each.
    probes: u32,
    clusters: &'static [usize],
}

fn compare(name: &str, desc: &SceneDesc, largest: f32, effort: &Effort) {
    let session = open(desc);
    let settings = ElementSettings { basis: Basis::Constant, sides: Sides::Apart, largest };
    let elements = Elements::new(session.scene(), settings);
    let job = PhotonJob {
        start: surfaces(Weights::EXACT),
        sequence: Sequence::Sorted,
        ..job(&elements, effort.photons, effort.replicates)
    };
    let found = maps(&session, &elements, &job);
    let lit = lit(&session, &elements, &job);
    for count in effort.clusters {
        let clusters = Clustering::new(session.scene(), &elements).retain(|i| lit[i]).by_count(*count);
        let paths = by_paths(&session, &elements, &clusters, 16, effort.probes);
        agree(name, &on(Some(&clusters), &elements, &found), &paths, 0.02);
    }
}

const SHORT: Effort = Effort { photons: 1 << 15, replicates: 16, probes: 8, clusters: &[200] };
const LONG: Effort = Effort { photons: 1 << 20, replicates: 16, probes: 64, clusters: &[200, 2000] };

#[test]
fn exact_weights_give_the_answer_of_paths() {
    compare("room", &room(), 0.5, &SHORT);
    compare("colonnade", &colonnade(), f32::INFINITY, &Effort { photons: 1 << 16, ..SHORT });
}

#[test]
#[ignore = "minutes"]
fn long_exact_weights_give_the_answer_of_paths() {
    compare("room", &room(), 0.2, &LONG);
    compare("colonnade", &colonnade(), 1.0, &LONG);
}

/// Sponza with the lamps of the comparison in `docs/first-shot.md`.
fn sponza(data: &Path) -> SceneDesc {
    let mut desc = load(&data.join("sponza_dabrovic/sponza.obj"));
    desc.lights = load(&root().join("scenes/sponza_lamps.toml")).lights;
    desc
}

#[test]
fn shared_exact_weights_on_closed_cornell() {
    let Some(data) = shared_scenes() else { return };
    compare("closed_cornell/point", &load(&data.join("closed_cornell/point.toml")), 0.5, &SHORT);
}

#[test]
#[ignore = "minutes"]
fn shared_long_exact_weights_on_closed_cornell() {
    let Some(data) = shared_scenes() else { return };
    compare("closed_cornell/point", &load(&data.join("closed_cornell/point.toml")), 0.2, &LONG);
}

#[test]
#[ignore = "minutes"]
fn shared_long_exact_weights_on_sponza() {
    let Some(data) = shared_scenes() else { return };
    compare("sponza", &sponza(&data), 2.0, &LONG);
}

#[test]
#[ignore = "minutes"]
fn shared_long_law_on_sponza() {
    let Some(data) = shared_scenes() else { return };
    let sponza = law("sponza", &sponza(&data), f32::INFINITY, 1 << 19, 16);
    if sponza.bias < 0.005 {
        check_law(&sponza, 16);
    }
}
