//! Starts on pieces: places against their density, and that starts on pieces and photons from the light bring the irradiance between them.

use super::{Finding, map, units};
use crate::inputs::HARD_UNITS;
use crate::statistics::chi2_p;
use crate::truth::vec::{self, V};
use etendue_core::backend::{Backend, BackendError};
use etendue_core::kernel::Kernel;

/// A piece of a triangle with its chance.
pub(super) struct Case {
    name: &'static str,
    /// Second and third barycentric of each corner, in steps of 2^-24.
    corners: [[u32; 2]; 3],
    weights: [f32; 3],
    area: f32,
    pmf: f32,
}

/// The whole, the middle quarter, a needle, and a few thousand steps.
pub(super) const CASES: [Case; 4] = [
    Case {
        name: "whole",
        corners: [[0, 0], [1 << 24, 0], [0, 1 << 24]],
        weights: [3.0, 1.0, 2.0],
        area: 2.5,
        pmf: 0.3,
    },
    Case {
        name: "quarter",
        corners: [[1 << 23, 0], [1 << 23, 1 << 23], [0, 1 << 23]],
        weights: [5.0, 2.0, 0.0],
        area: 0.01,
        pmf: 1e-3,
    },
    Case {
        name: "needle",
        corners: [[0, 0], [1 << 24, 0], [0, 1 << 14]],
        weights: [0.0, 7.0, 0.0],
        area: 4e-6,
        pmf: 1.0 / 1_048_576.0,
    },
    Case {
        name: "small",
        corners: [[5_000_000, 3_000_000], [5_004_096, 3_000_000], [5_000_000, 3_004_096]],
        weights: [1.0, 1.5, 1.0],
        area: 1e-3,
        pmf: 2e-6,
    },
];

/// Parts along an edge for quadrature, and rows and columns of cells for counting.
const PARTS: usize = 64;
const CELLS: usize = 16;
/// Relative error of integrals: roundings of the places within the smallest piece.
const INTEGRAL: f64 = 1e-5;
/// Relative error of the sum of both techniques at a place: roundings of both weights, in units of 2^-24.
const CONSERVATION: f64 = 16.0;
/// Places lie within so many steps of where they should, across the piece.
const STEPS: f64 = 2.0;

impl Case {
    /// The corners as words that travel as floats.
    fn words(&self) -> [f32; 6] {
        let [[a, b], [c, d], [e, f]] = self.corners;
        [a, b, c, d, e, f].map(f32::from_bits)
    }

    /// The least height over the triangle of barycentrics, in steps.
    fn height(&self) -> f64 {
        let [a, b, c] = self.corners.map(|c| c.map(f64::from));
        let side = |p: [f64; 2], q: [f64; 2]| [q[0] - p[0], q[1] - p[1]];
        let (u, v, w) = (side(a, b), side(a, c), side(b, c));
        let length = |x: [f64; 2]| x[0].hypot(x[1]);
        (u[0] * v[1] - u[1] * v[0]) / length(u).max(length(v)).max(length(w))
    }

    /// A point with these barycentrics on the piece, as second and third barycentric on the triangle.
    fn at(&self, local: V) -> [f32; 2] {
        let along =
            |k: usize| (0..3).map(|j| local[j] * f64::from(self.corners[j][k])).sum::<f64>() / 16_777_216.0;
        [along(0) as f32, along(1) as f32]
    }

    /// The density at points of the triangle.
    fn density(&self, backend: &dyn Backend, points: &[[f32; 2]]) -> Result<Vec<f32>, BackendError> {
        let head: Vec<f32> =
            self.words().into_iter().chain(self.weights).chain([self.area, self.pmf]).collect();
        let items: Vec<f32> = points.iter().flat_map(|p| head.iter().chain(p).copied()).collect();
        map(backend, Kernel::StartDensity, &items)
    }
}

/// Centroids of equal parts: a rule that is exact for linear functions.
fn centroids() -> Vec<V> {
    let mut out = Vec::new();
    let unit = 1.0 / (3.0 * PARTS as f64);
    for i in 0..PARTS {
        for j in 0..PARTS - i {
            let corner = |d: usize| [(3 * i + d) as f64 * unit, (3 * j + d) as f64 * unit];
            let [x, y] = corner(1);
            out.push([1.0 - x - y, x, y]);
            if i + j + 1 < PARTS {
                let [x, y] = corner(2);
                out.push([1.0 - x - y, x, y]);
            }
        }
    }
    out
}

/// Centres of mass of cells of equal area: strips in (1 - b0)^2, shares in b1 / (1 - b0).
fn cells() -> Vec<V> {
    let edge = |i: usize| (i as f64 / CELLS as f64).sqrt();
    let mut out = Vec::new();
    for i in 0..CELLS {
        let (r, q) = (edge(i), edge(i + 1));
        let mean = 2.0 / 3.0 * (q * q * q - r * r * r) / (q * q - r * r);
        for j in 0..CELLS {
            let share = (j as f64 + 0.5) / CELLS as f64;
            out.push([1.0 - mean, mean * share, mean * (1.0 - share)]);
        }
    }
    out
}

/// Irradiance at a place of the piece: the corners' means per channel, and so in proportion to the density; linear in other ways; bent; and
/// with a shadow across it.
fn fields(case: &Case, local: V) -> [V; 4] {
    let w = case.weights.map(f64::from);
    let linear = vec::dot(w, local);
    let bent = 1.0 / (0.1 + local[0] * local[0] + 0.3 * local[1]);
    [
        [linear, 0.5 * linear, 0.25 * linear],
        [1.0 + local[0], 2.0 - local[1], 0.1 + 3.0 * local[2]],
        [bent, bent * local[2], 1e-3 * bent],
        [f64::from(u8::from(local[1] < 0.3)), 0.0, 0.0],
    ]
}

pub(super) fn check(
    backend: &dyn Backend,
    count: usize,
    level: f64,
    out: &mut Vec<Finding>,
) -> Result<(), BackendError> {
    for (i, case) in CASES.iter().enumerate() {
        let label = |what: &str| format!("trio/first_shot({})/{what}", case.name);
        places(backend, case, &units(count, 0xf125 + i as u64), level, &label, out)?;
        conservation(backend, case, &label, out)?;
    }
    looks(backend, out)?;
    even_words(backend, out)
}

fn places(
    backend: &dyn Backend,
    case: &Case,
    u: &[f32],
    level: f64,
    label: &dyn Fn(&str) -> String,
    out: &mut Vec<Finding>,
) -> Result<(), BackendError> {
    let head: Vec<f32> = case.words().into_iter().chain(case.weights).collect();
    let behind = |head: &[f32], rows: &[f32], width: usize| -> Vec<f32> {
        rows.chunks(width).flat_map(|row| head.iter().chain(row).copied()).collect()
    };
    let on_triangle = map(backend, Kernel::StartPlace, &behind(&head, u, 2))?;
    let points: Vec<[f32; 2]> = on_triangle.chunks(3).map(|b| [b[1], b[2]]).collect();
    let back = map(backend, Kernel::StartWithin, &behind(&case.words(), points.as_flattened(), 2))?;
    let sampled = map(backend, Kernel::SampleLinearTriangle, &behind(&case.weights, u, 2))?;
    let density = case.density(backend, &points)?;
    // Density 0 only at the ends of the unit interval, and where the place's rounding to 2^-24 has left a piece of few such steps.
    let inner = |u: &[f32]| u.iter().all(|u| *u > 0.0);
    let inside = |back: &[f32]| back[1..].iter().all(|b| *b >= 0.0);
    let zero = u
        .chunks(2)
        .zip(back.chunks(4))
        .zip(&density)
        .filter(|((u, back), p)| !p.is_finite() || **p <= 0.0 && inner(u) && inside(back))
        .count();
    out.push((label("total"), zero == 0, format!("{zero} starts without a density, of {}", density.len())));
    let mut worst = 0.0_f64;
    for (back, sampled) in back.chunks(4).zip(sampled.chunks(3)) {
        for (a, b) in back[1..].iter().zip(sampled) {
            let apart = (f64::from(*a) - f64::from(*b)).abs() * case.height();
            let found = back[0].to_bits() == 1 && !apart.is_nan();
            worst = worst.max(if found { apart } else { f64::INFINITY });
        }
    }
    out.push((
        label("round_trip"),
        worst <= STEPS,
        format!("worst {worst:.2} steps of 2^-24, allowed {STEPS}"),
    ));
    let area = f64::from(case.area);
    let centres: Vec<[f32; 2]> = cells().into_iter().map(|l| case.at(l)).collect();
    let mut observed = vec![0_u64; CELLS * CELLS];
    for b in back.chunks(4).skip(HARD_UNITS.len() * HARD_UNITS.len()) {
        let r = f64::from(b[2]) + f64::from(b[3]);
        let share = if r > 0.0 { f64::from(b[2]) / r } else { 0.0 };
        let cell = |x: f64| ((x * CELLS as f64) as usize).min(CELLS - 1);
        observed[cell(r * r) * CELLS + cell(share)] += 1;
    }
    let n: u64 = observed.iter().sum();
    let expected: Vec<f64> = case
        .density(backend, &centres)?
        .iter()
        .map(|p| f64::from(*p) / f64::from(case.pmf) * area * n as f64 / (CELLS * CELLS) as f64)
        .collect();
    let p = chi2_p(&observed, &expected);
    out.push((label("chi_square"), p >= level, format!("p = {p:.3e}, level {level:.2e}, {n} samples")));
    Ok(())
}

/// The density over the piece is its chance; and at every place what starts on the piece carry, times their density, and what photons from the
/// light keep of the irradiance is that irradiance.
fn conservation(
    backend: &dyn Backend,
    case: &Case,
    label: &dyn Fn(&str) -> String,
    out: &mut Vec<Finding>,
) -> Result<(), BackendError> {
    let locals = centroids();
    let points: Vec<[f32; 2]> = locals.iter().map(|l| case.at(*l)).collect();
    let density = case.density(backend, &points)?;
    let part = f64::from(case.area) / locals.len() as f64;
    let sum = density.iter().map(|p| f64::from(*p) * part).sum::<f64>() / f64::from(case.pmf);
    out.push((
        label("integral"),
        (sum - 1.0).abs() <= INTEGRAL,
        format!("integral {sum:.8} of the chance, allowed error {INTEGRAL}"),
    ));
    let mean = case.weights.iter().map(|w| f64::from(*w)).sum::<f64>() / 3.0;
    let typical = f64::from(case.pmf) / (f64::from(case.area) * mean);
    let (mut worst, mut drift) = (0.0_f64, 0.0_f64);
    // The light's photons few, as many, and many beside the starts on pieces.
    for per_watt in [0.01, 1.0, 100.0].map(|x| (x * typical) as f32) {
        for field in 0..4 {
            let e: Vec<[f32; 3]> = locals.iter().map(|l| fields(case, *l)[field].map(|x| x as f32)).collect();
            let items: Vec<f32> =
                e.iter().zip(&density).flat_map(|(e, p)| [e[0], e[1], e[2], *p, per_watt]).collect();
            let flux = map(backend, Kernel::StartFlux, &items)?;
            let share = map(backend, Kernel::LightShare, &items)?;
            let mut totals = [[0.0; 2]; 3];
            for ((e, flux), (p, share)) in e.iter().zip(flux.chunks(3)).zip(density.iter().zip(&share)) {
                for c in 0..3 {
                    let truth = f64::from(e[c]);
                    let brought = f64::from(*p) * f64::from(flux[c]) + f64::from(*share) * truth;
                    let apart = if truth == 0.0 { brought } else { brought / truth - 1.0 };
                    worst =
                        worst.max(if apart.is_nan() { f64::INFINITY } else { apart.abs() * 16_777_216.0 });
                    totals[c] = [totals[c][0] + brought * part, totals[c][1] + truth * part];
                }
            }
            // Of the linear fields the flux on the piece is known without quadrature.
            let closed = match field {
                0 => Some([mean, 0.5 * mean, 0.25 * mean]),
                1 => Some([4.0 / 3.0, 5.0 / 3.0, 1.1]),
                _ => None,
            };
            for (c, [brought, sum]) in totals.into_iter().enumerate() {
                let truth = closed.map_or(sum, |m| m[c] * f64::from(case.area));
                if truth > 0.0 {
                    drift = drift.max((brought / truth - 1.0).abs());
                }
            }
        }
    }
    out.push((
        label("conservation"),
        worst <= CONSERVATION && drift <= INTEGRAL,
        format!("worst {worst:.2} u at a place, allowed {CONSERVATION}; {drift:.1e} of the flux, allowed {INTEGRAL}"),
    ));
    // As published, all starts carry the same: with its chance the flux of the linear irradiance.
    let item: Vec<f32> =
        [1.5, 1.0, 0.5].into_iter().chain(case.weights).chain([case.area, case.pmf]).collect();
    let flux = map(backend, Kernel::PieceFlux, &item)?;
    let worst = flux.iter().zip([1.5, 1.0, 0.5]).fold(0.0_f64, |worst, (f, colour)| {
        worst.max((f64::from(*f) * f64::from(case.pmf) / (colour * mean * f64::from(case.area)) - 1.0).abs())
    });
    out.push((label("published"), worst <= INTEGRAL, format!("{worst:.1e} of the flux, allowed {INTEGRAL}")));
    Ok(())
}

/// In the mean over being asked or not, hidden starts carry nothing and seen ones all.
fn looks(backend: &dyn Backend, out: &mut Vec<Finding>) -> Result<(), BackendError> {
    let mut worst = 0.0_f64;
    for chance in [1.0, 0.9, 0.5, 0.25, 0.1, 1e-3_f32] {
        for (blocked, truth) in [(0, 1.0), (1, 0.0)] {
            let factor = map(backend, Kernel::LookFactor, &[chance, f32::from_bits(blocked)])?;
            let q = f64::from(chance);
            let mean = q * f64::from(factor[0]) + (1.0 - q);
            let apart = (mean - truth).abs() * 16_777_216.0;
            worst = worst.max(if apart.is_nan() { f64::INFINITY } else { apart });
        }
    }
    out.push(("trio/first_shot/looks".into(), worst <= 2.0, format!("worst {worst:.2} u, allowed 2")));
    Ok(())
}

/// Photons that walk along a distribution pick each entry as often as its counts say, but for one.
fn even_words(backend: &dyn Backend, out: &mut Vec<Finding>) -> Result<(), BackendError> {
    // Counts before the entries: large ones, none, one, and the rest.
    let before = [0_u32, 1 << 30, 1 << 30, (1 << 30) + 1, 3_000_000_000, 3_000_000_001, 4_294_967_295];
    let mut wrong = Vec::new();
    for bits in [0_u32, 1, 4, 10, 14] {
        for shift in [0, 1, 0x1234_5678, 1 << 31, u32::MAX] {
            let items: Vec<f32> =
                (0..1_u32 << bits).flat_map(|i| [i, shift, bits]).map(f32::from_bits).collect();
            let words: Vec<u32> =
                map(backend, Kernel::EvenWord, &items)?.into_iter().map(f32::to_bits).collect();
            let mut picks = vec![0; words.len() * 3];
            backend.map(Kernel::CdfPick, &before, &words, &mut picks)?;
            for (i, start) in before.into_iter().enumerate() {
                let end = before.get(i + 1).map_or(4_294_967_296.0, |c| f64::from(*c));
                let expected = (end - f64::from(start)) / 4_294_967_296.0 * words.len() as f64;
                let found = picks.chunks(3).filter(|p| p[0] == i as u32).count() as f64;
                if (found - expected).abs() >= 1.0 {
                    wrong.push(format!("{found} for {expected:.2} of entry {i}, {bits} bits"));
                }
            }
        }
    }
    let detail =
        format!("{} entries off by one pick or more; {}", wrong.len(), wrong.first().map_or("", |w| w));
    out.push(("trio/first_shot/even_words".into(), wrong.is_empty(), detail));
    Ok(())
}
