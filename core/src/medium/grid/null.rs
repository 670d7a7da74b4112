//! Flights and transmittances by null collisions: random, unbiased, and of no known density.
//!
//! Within blocks of pieces a majorant mu of all channels is known. Distances are drawn by it; at each tentative collision it is a true one with probability sum p_c sigma_c / mu, and weights
//! sigma_c / (mu P) or (mu - sigma_c) / (mu (1 - P)) keep every channel's mean (Woodcock et al. 1965; Kutz et al. 2017 for several channels). Transmittance is the product of
//! (1 - sigma_c / mu) over tentative collisions (ratio tracking, Novak et al. 2014). Both see the density only at points: an independent check of regular tracking.

use super::walk::Walk;
use super::{Grid, Line};
use crate::math::{self, Vec3};
use crate::medium::flight::{Flight, channels};
use crate::sampling::counter::Counter;

/// Most tentative collisions of a flight; a way of a larger optical thickness is said to let nothing through.
const COLLISIONS_MAX: u32 = 1 << 20;

/// Random numbers, one after the other: those of one sample in a stream.
#[derive(Clone, Copy, Debug)]
pub struct Draws {
    counter: Counter,
    stream: u32,
    sample: u32,
    next: u32,
}

impl Draws {
    /// The numbers of a sample.
    pub fn new(seed: u64, stream: u32, sample: u32) -> Self {
        Self { counter: Counter::new(seed), stream, sample, next: 0 }
    }

    /// Two numbers in [0, 1).
    #[inline]
    pub fn pair(&mut self) -> [f32; 2] {
        let [a, b, ..] = self.counter.bits4(self.stream, self.sample, self.next);
        self.next = self.next.wrapping_add(1);
        [math::u32_to_unit(a), math::u32_to_unit(b)]
    }
}

/// Calls `at` with the metres of the line, sigma_t / mu there and a second number at each tentative collision, until it returns true.
fn tentative(
    grid: &Grid<'_>,
    line: &Line,
    limit: f32,
    sigma: Vec3,
    draws: &mut Draws,
    mut at: impl FnMut(f32, Vec3, f32) -> bool,
) {
    let Some(mut walk) = Walk::new(grid, line, limit, true) else { return };
    let largest = math::max_component(sigma);
    let mut count = 0;
    while let Some(s) = walk.next() {
        let mu = s.majorant * largest;
        let mut t = s.from;
        loop {
            let [u, v] = draws.pair();
            t -= math::ln(1.0 - u) / mu;
            // It is no number where there is no extinction at all.
            let within = t < s.to;
            if !within {
                break;
            }
            let place = walk.at(t);
            let d = if grid.is_coloured() {
                grid.value::<Vec3>(place)
            } else {
                Vec3::splat(grid.value::<f32>(place))
            };
            count += 1;
            if at(walk.before + t, d * sigma / mu, v) || count >= COLLISIONS_MAX {
                return;
            }
        }
    }
}

/// A flight as [`crate::medium::Medium::fly`] draws it, along a ray from `origin` \[m\] into a unit direction.
pub fn fly(
    grid: &Grid<'_>,
    (origin, direction): (Vec3, Vec3),
    limit: f32,
    sigma_t: Vec3,
    carried: Vec3,
    draws: &mut Draws,
) -> Flight {
    let line = grid.line(origin, direction);
    let (mut weight, mut left) = (Vec3::ONE, Vec3::ONE);
    let mut length = None;
    tentative(grid, &line, limit, sigma_t, draws, |t, share, v| {
        let p = channels(carried * weight);
        let chance = p.dot(share).clamp(0.0, 1.0);
        left *= (Vec3::ONE - share).max(Vec3::ZERO);
        if v < chance {
            // Scattering multiplies by sigma_s yet: T / density has no sigma.
            let sigma = sigma_t * grid.at(origin + direction * t);
            let per = |s: f32, x: f32| if s > 0.0 { x / s } else { 0.0 };
            let kept = weight * share / chance;
            weight = Vec3::new(per(sigma.x, kept.x), per(sigma.y, kept.y), per(sigma.z, kept.z));
            length = Some(t);
            return true;
        }
        weight *= (Vec3::ONE - share).max(Vec3::ZERO) / (1.0 - chance);
        false
    });
    Flight { length: length.unwrap_or(limit), collided: length.is_some(), weight, left }
}

/// An estimate of the transmittance along a ray from `origin` \[m\] into a unit direction, per channel.
pub fn transmittance(
    grid: &Grid<'_>,
    (origin, direction): (Vec3, Vec3),
    limit: f32,
    sigma_t: Vec3,
    draws: &mut Draws,
) -> Vec3 {
    let mut left = Vec3::ONE;
    tentative(grid, &grid.line(origin, direction), limit, sigma_t, draws, |_, share, _| {
        left *= (Vec3::ONE - share).max(Vec3::ZERO);
        left == Vec3::ZERO
    });
    left
}
