//! Known fields seen by Poisson photons.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use super::*;
use crate::film::Film;
use crate::illumination::{ElementSettings, Sides, film_settings};
use crate::scene::{
    CompiledScene, MaterialDesc, MaterialKind, Reflectance, SceneDesc, ShapeDesc, ShapeKind, compile,
};
use alloc::string::String;

const REPLICATES: u32 = 16;

/// A floor of 4 m x 4 m.
fn floor() -> CompiledScene {
    let kind = ShapeKind::Rectangle { center: [0.0; 3], u: [0.0, 0.0, 2.0], v: [2.0, 0.0, 0.0] };
    let shape = ShapeDesc { kind, material: "grey".into(), interior: String::new(), exterior: String::new() };
    let kind = MaterialKind::Diffuse { albedo: Reflectance::flat([0.5; 3]) };
    let grey = MaterialDesc { name: "grey".into(), kind, two_sided: true, emission: [0.0; 3] };
    compile(&SceneDesc { shapes: alloc::vec![shape], materials: alloc::vec![grey], ..SceneDesc::default() })
        .unwrap()
        .0
}

struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / 9_007_199_254_740_992.0
    }

    /// A number of photons where `mean` are expected (Knuth).
    fn poisson(&mut self, mean: f64) -> f64 {
        let (limit, mut product, mut count) = ((-mean).exp(), self.uniform(), 0);
        while product > limit {
            product *= self.uniform();
            count += 1;
        }
        f64::from(count)
    }
}

struct Case {
    elements: Elements,
    clustering: Clustering,
    truth: Vec<[f64; 3]>,
    film: Film,
}

/// The floor divided, with `photons` expected on all of it; the third channel is black.
fn case(settings: ElementSettings, photons: f64, field: impl Fn(Vec3) -> f64) -> Case {
    let scene = floor();
    let elements = Elements::new(&scene, settings);
    let clustering = Clustering::new(&scene, &elements);
    let truth: Vec<[f64; 3]> =
        clustering.places().iter().map(|p| field(p.position)).map(|f| [f, 0.5 * f, 0.0]).collect();
    let flux: f64 = truth.iter().enumerate().map(|(i, t)| elements.weight(i) * t[0]).sum();
    let photon = flux / photons;
    let mut film = Film::new(film_settings(elements.count(), [flux, flux, flux], 16.0, 0, 1024));
    let mut random = Random(1);
    for r in 0..REPLICATES {
        let mut seen = |i: usize, truth: f64| {
            // As many photons as bring the flux; of nodes, each has three times the noise of a face of its area.
            let power = photon * f64::from(elements.area(i)) / elements.weight(i);
            let area = f64::from(elements.area(i));
            let unit = power * f64::from(REPLICATES) / area;
            if truth > 0.0 { unit * random.poisson(truth / unit) } else { 0.0 }
        };
        let means: Vec<[f64; 3]> =
            truth.iter().enumerate().map(|(i, t)| [seen(i, t[0]), seen(i, t[1]), 0.0]).collect();
        film.add_blocks(r..r + 1, &means).unwrap();
    }
    Case { elements, clustering, truth, film }
}

/// Root mean square distances to the truth of the map as it is, of that after reconstruction, and as stated; and the mean of z^2.
struct Errors {
    raw: f64,
    found: f64,
    stated: f64,
    z2: f64,
}

fn errors(case: &Case) -> Errors {
    let found = reconstruct(&case.clustering, &case.elements, &case.film).unwrap();
    assert_eq!(Some(&found), reconstruct(&case.clustering, &case.elements, &case.film).as_ref());
    let (mut sums, mut n, mut flux, mut z2) = ([0.0; 3], 0.0, [0.0; 2], 0.0);
    for (i, truth) in case.truth.iter().enumerate() {
        let (w, mean) = (case.elements.weight(i), case.film.mean(i));
        for c in 0..3 {
            let (x, s) = (found.values[i][c], found.stderr[i][c]);
            assert!(x.is_finite() && s.is_finite() && s >= 0.0);
            for (sum, d) in sums.iter_mut().zip([mean[c] - truth[c], x - truth[c], s]) {
                *sum += w * d * d;
            }
            if s > 0.0 {
                z2 += ((x - truth[c]) / s).powi(2);
                n += 1.0;
            }
            flux[0] += w * mean[c];
            flux[1] += w * x;
        }
    }
    assert!((flux[1] / flux[0] - 1.0).abs() <= 1e-3, "flux {flux:?}");
    let [raw, found, stated] = sums.map(f64::sqrt);
    Errors { raw, found, stated, z2: z2 / n }
}

fn fine() -> ElementSettings {
    ElementSettings { largest: 0.1, ..ElementSettings::default() }
}

fn ripples(p: Vec3) -> f64 {
    let [x, _, z] = p.to_array().map(f64::from);
    2.0 + (3.0 * x).sin() + 0.5 * (2.0 * z + x).cos()
}

fn step(p: Vec3) -> f64 {
    if p.x + 0.3 * p.z > 0.2 { 3.0 } else { 0.3 }
}

struct Field {
    name: &'static str,
    at: fn(Vec3) -> f64,
    /// Least gain over the map as it is.
    gain: f64,
    /// Range of stated over found error, and of the mean z^2.
    stated: [f64; 2],
    z2: [f64; 2],
}

#[test]
fn smooth_fields_come_out_of_noise_and_the_error_is_known() {
    // What planes fit has next to no error left, and departures that are not there are never quite ruled out: up to 2.5 times too much is stated.
    // Beside a step few elements have most of the error.
    let fields = [
        Field { name: "constant", at: |_| 2.0, gain: 7.0, stated: [0.85, 2.5], z2: [0.5, 2.0] },
        Field {
            name: "linear",
            at: |p| 3.0 + f64::from(p.x) - 0.4 * f64::from(p.z),
            gain: 5.5,
            stated: [0.85, 2.5],
            z2: [0.5, 2.0],
        },
        Field { name: "ripples", at: ripples, gain: 2.5, stated: [0.85, 1.35], z2: [0.7, 3.2] },
        Field { name: "step", at: step, gain: 2.0, stated: [0.85, 1.2], z2: [0.7, 4.5] },
    ];
    for (basis, sides) in [Basis::Constant, Basis::Linear]
        .into_iter()
        .flat_map(|b| [Sides::Together, Sides::Apart].map(|s| (b, s)))
    {
        for Field { name, at, gain: least, stated, z2 } in &fields {
            for photons in [3e4, 3e5] {
                let case = case(ElementSettings { basis, sides, ..fine() }, photons, at);
                let e = errors(&case);
                let (gain, ratio) = (e.raw / e.found, e.stated / e.found);
                let what = std::format!("{name} {basis:?} {sides:?} {photons}: {gain} {ratio} {}", e.z2);
                assert!(gain >= *least, "gain: {what}");
                assert!(ratio >= stated[0] && ratio <= stated[1], "stated: {what}");
                assert!(e.z2 >= z2[0] && e.z2 <= z2[1], "z^2: {what}");
            }
        }
    }
}

/// Noise of a seen map: what is to be left alone.
fn white(p: Vec3) -> f64 {
    let bits = p.to_array().map(f32::to_bits);
    let mixed = bits.iter().fold(7_u32, |h, b| (h ^ b).wrapping_mul(0x9e37_79b1).rotate_left(13));
    0.1 + f64::from(mixed >> 8) / 16_777_216.0
}

#[test]
fn where_surroundings_say_nothing_the_map_stays() {
    let e = errors(&case(fine(), 1e7, white));
    assert!(e.found <= 1.01 * e.raw, "{} {}", e.found, e.raw);
    assert!((e.stated / e.found - 1.0).abs() <= 0.2, "{} {}", e.stated, e.found);
}

fn film_of(n: usize, blocks: &[Vec<[f64; 3]>]) -> Film {
    let mut film = Film::new(film_settings(n, [1.0; 3], 1.0, 0, 16));
    for (r, means) in blocks.iter().enumerate() {
        film.add_blocks(r as u32..r as u32 + 1, means).unwrap();
    }
    film
}

#[test]
fn degenerate_maps_stay_what_they_are() {
    let scene = floor();
    for settings in [ElementSettings::default(), fine()] {
        let elements = Elements::new(&scene, settings);
        let clustering = Clustering::new(&scene, &elements);
        let n = elements.count();
        let of = |clustering: &Clustering, film: &Film| reconstruct(clustering, &elements, film);
        // One replicate, and other elements.
        assert_eq!(of(&clustering, &film_of(n, &[alloc::vec![[1.0; 3]; n]])), None);
        let flat = |n: usize, x: f64| film_of(n, &[alloc::vec![[x; 3]; n], alloc::vec![[x; 3]; n]]);
        assert_eq!(of(&clustering, &flat(n + 1, 1.0)), None);
        // Nothing, and no noise.
        for x in [0.0, 1.0, 1e-12, 1e12] {
            let found = of(&clustering, &flat(n, x)).unwrap();
            assert_eq!(found.values, alloc::vec![flat(n, x).mean(0); n]);
            assert!(found.stderr.iter().flatten().all(|s| *s == 0.0));
            assert_eq!(found.rel_error(|i| elements.weight(i)), (x > 0.0).then_some(0.0));
        }
        // One bright element among dark ones, whose sum is below 0 in one channel.
        let mut lone = alloc::vec![[0.0; 3]; n];
        lone[n / 2] = [5.0, 1e-9, -5.0];
        let film = film_of(n, &[lone, alloc::vec![[0.0; 3]; n]]);
        let found = of(&clustering, &film).unwrap();
        assert!(found.values.iter().chain(&found.stderr).flatten().all(|x| x.is_finite() && *x >= 0.0));
        // No element left to take part.
        let found = of(&clustering.clone().retain(|_| false), &film).unwrap();
        assert!((0..n).all(|i| found.values[i][0] == film.mean(i)[0]));
        let one = clustering.clone().retain(|i| i == n / 2);
        assert!(of(&one, &film).unwrap().values.iter().flatten().all(|x| x.is_finite()));
    }
}
