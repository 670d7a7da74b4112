//! Maps on triangles after reconstruction: what a total error costs, bias in it.

#![allow(clippy::disallowed_methods, reason = "statistics in f64")]

use super::measure::Method;
use cpu_time::ProcessTime;
use etendue::core::backend::{NoControl, PhotonJob, Session, illumination_film_settings};
use etendue::core::film::Film;
use etendue::core::illumination::{Clustering, Elements, reconstruct};
use etendue::cpu::CpuSession;

/// Replicates of a map, whose spread is all that reconstruction knows of noise.
const REPLICATES: u32 = 16;
/// Logarithms of the photons that are tried.
const BITS: [u32; 5] = [12, 14, 16, 18, 20];

/// The truth with the variance of its mean.
pub struct Truth {
    /// Irradiance per element.
    pub mean: Vec<[f64; 3]>,
    /// Its variance.
    pub variance: Vec<[f64; 3]>,
}

/// A map of some photons.
#[derive(Clone, Copy)]
pub struct Point {
    /// How many.
    pub photons: f64,
    /// Rays that they took.
    pub rays: f64,
    /// CPU seconds of tracing, and of reconstruction.
    pub seconds: [f64; 2],
    /// Total relative error of the map as it is and after reconstruction, and what the latter states.
    pub errors: [f64; 3],
}

fn error(elements: &Elements, truth: &Truth, value: impl Fn(usize, usize) -> f64) -> f64 {
    let (mut distance, mut square) = (0.0, 0.0);
    for i in 0..truth.mean.len() {
        for c in 0..3 {
            let (t, noise) = (truth.mean[i][c], truth.variance[i][c]);
            distance += elements.weight(i) * ((value(i, c) - t).powi(2) - noise);
            square += elements.weight(i) * (t * t - noise);
        }
    }
    (distance.max(0.0) / square).sqrt()
}

/// Maps of more and more photons.
pub fn points(session: &CpuSession, elements: &Elements, method: &Method, truth: &Truth) -> Vec<Point> {
    let clustering = Clustering::new(session.scene(), elements);
    BITS.iter()
        .map(|bits| {
            let job = PhotonJob {
                seed: 5,
                photons: (1 << bits) / REPLICATES,
                replicates: 0..REPLICATES,
                max_hits: u32::MAX,
                start: method.start,
                sequence: method.sequence,
                elements: *elements.settings(),
            };
            let mut film =
                Film::new(illumination_film_settings(session.scene(), elements, &job).expect("light"));
            let clock = ProcessTime::now();
            let stats = session.illumination(&job, &NoControl, &mut film).expect("a map");
            let tracing = clock.elapsed().as_secs_f64();
            let clock = ProcessTime::now();
            let found = reconstruct(&clustering, elements, &film).expect("replicates");
            let rebuilding = clock.elapsed().as_secs_f64();
            let stated = found.rel_error(|i| elements.weight(i)).unwrap_or(0.0);
            Point {
                photons: stats.paths as f64,
                rays: stats.rays as f64,
                seconds: [tracing, rebuilding],
                errors: [
                    error(elements, truth, |i, c| film.mean(i)[c]),
                    error(elements, truth, |i, c| found.values[i][c]),
                    stated,
                ],
            }
        })
        .collect()
}

/// Photons at which `error` falls to a value: between two points along a straight line of logarithms, beyond them along the last one. And whether it is beyond.
pub fn photons_for(points: &[Point], error: impl Fn(&Point) -> f64, wanted: f64) -> (f64, bool) {
    let last = points.len() - 1;
    let k = (1..last).find(|k| error(&points[*k]) <= wanted).unwrap_or(last);
    let (a, b) = (&points[k - 1], &points[k]);
    let slope = (error(a) / error(b)).ln() / (b.photons / a.photons).ln();
    let photons = b.photons * (error(b) / wanted).powf(1.0 / slope.max(0.1));
    (photons, photons > 8.0 * points[last].photons || photons < points[0].photons)
}
