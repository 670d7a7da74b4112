//! Optical lengths of rays through a grid, and where they reach a value, piece by piece: exact up to rounding, without random numbers.
//!
//! Quantity: the integral of d over a length \[m\], per channel; times sigma_t it is the optical thickness. Each piece adds its length times the mean of d at Gauss' two places. Sums and weights
//! are not negative, so that nothing cancels: measured within 8e-6 m for values up to 1 and ways of up to 4 m (against f64).
//!
//! Why this is the default: measured on a cloud of 128^3 cells, a flight takes 2.3 us where the medium is thin (optical thickness about 1) and 1.3 us where it is thick; null collisions ([`super::null`])
//! 1.2 us and 2.9 us, and their transmittances 1.5 us and 11 us against 2.7 us and 2.4 us here, with noise that these do not have.

use super::cell::{Cell, Value};
use super::walk::{Stretch, Walk};
use super::{Grid, Line};
use crate::math::{self, Vec3};

/// Half the distance between Gauss' two places, as a share of a stretch.
const GAUSS: f32 = 0.288_675_13;
/// Newton's steps, or halvings, in the piece where a length is reached. Fewer than 6 are taken where the density is not 0 at the ends.
const STEPS: u32 = 40;
/// Nothing that f32 can tell from 0 is left behind such an optical thickness.
const OPAQUE: f32 = 104.0;
/// Optical thickness of the parts in which emission is integrated, and beyond which it is left out.
const PART: f32 = 0.25;
const DIM: f32 = 17.0;

/// Where a way ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reached {
    /// Metres of the line; `None` where the way is free to its limit.
    pub(crate) length: Option<f32>,
    /// Integral of the density up to there, per channel \[m\].
    pub(crate) optical: Vec3,
}

/// Integral of the density from one place of a walk to another within a piece.
#[inline(always)]
fn integral<V: Value>(walk: &Walk<'_>, cell: &Cell<V>, from: f32, to: f32) -> V {
    let (half, span) = (0.5 * (from + to), to - from);
    let off = GAUSS * span;
    (cell.at(walk.at(half - off)) + cell.at(walk.at(half + off))) * (0.5 * span)
}

/// Integral of the density along a line from 0 to `limit` \[m\], per channel; the walk ends where `until` holds of the sum.
fn along<V: Value>(grid: &Grid<'_>, line: &Line, limit: f32, until: impl Fn(V) -> bool) -> V {
    let mut sum = V::ZERO;
    let Some(mut walk) = Walk::new(grid, line, limit, false) else { return sum };
    while let Some(s) = walk.next() {
        sum = sum + integral(&walk, &Cell::<V>::new(grid, s.piece), s.from, s.to);
        if until(sum) {
            break;
        }
    }
    sum
}

/// Where a line is in the box, on the way from 0 to `limit` \[m\].
pub(crate) fn extent(grid: &Grid<'_>, line: &Line, limit: f32) -> Option<[f32; 2]> {
    let walk = Walk::new(grid, line, limit, true)?;
    Some([walk.before, walk.before + walk.end])
}

/// Integral of the density along a line \[m\], per channel. Where every channel with extinction `sigma` is opaque already, what comes behind is left out.
pub(crate) fn optical_length(grid: &Grid<'_>, line: &Line, limit: f32, sigma: Vec3) -> Vec3 {
    if grid.is_coloured() {
        along(grid, line, limit, |sum: Vec3| {
            let deep = |k: usize| sum[k] * sigma[k] > OPAQUE;
            deep(0) && deep(1) && deep(2)
        })
    } else {
        let least = math::min_component(sigma);
        Vec3::splat(along(grid, line, limit, |sum: f32| sum * least > OPAQUE))
    }
}

/// Where, from `from` to `to` within a piece, the integral of a channel of the density is `wanted`: Newton's steps, halving the bracket where they leave it.
fn invert<V: Value>(walk: &Walk<'_>, cell: &Cell<V>, s: &Stretch, whole: f32, wanted: f32, c: usize) -> f32 {
    let (mut low, mut high) = (s.from, s.to);
    let mut t = s.from + (s.to - s.from) * (wanted / whole).clamp(0.0, 1.0);
    for _ in 0..STEPS {
        let over = integral(walk, cell, s.from, t).channel(c) - wanted;
        if over == 0.0 {
            break;
        }
        if over > 0.0 {
            high = t
        } else {
            low = t
        }
        let slope = cell.at(walk.at(t)).channel(c);
        let newton = t - over / slope;
        // False where it is not a number.
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if next == t || !(next > low && next < high) {
            break;
        }
        t = next;
    }
    t
}

fn reach<V: Value>(grid: &Grid<'_>, line: &Line, limit: f32, wanted: f32, c: usize) -> Reached {
    let mut sum = V::ZERO;
    let Some(mut walk) = Walk::new(grid, line, limit, false) else {
        return Reached { length: None, optical: sum.wide() };
    };
    while let Some(s) = walk.next() {
        let cell = Cell::<V>::new(grid, s.piece);
        let piece = integral(&walk, &cell, s.from, s.to);
        if (sum + piece).channel(c) > wanted {
            let rest = (wanted - sum.channel(c)).max(0.0);
            let t = invert(&walk, &cell, &s, piece.channel(c), rest, c);
            let optical = sum + integral(&walk, &cell, s.from, t);
            return Reached { length: Some(walk.before + t), optical: optical.wide() };
        }
        sum = sum + piece;
    }
    Reached { length: None, optical: sum.wide() }
}

/// Where the integral of the density of a channel reaches `wanted` \[m\] on the way from 0 to `limit`, and the integrals of all channels up to there.
pub(crate) fn fly(grid: &Grid<'_>, line: &Line, limit: f32, wanted: f32, channel: usize) -> Reached {
    if grid.is_coloured() {
        reach::<Vec3>(grid, line, limit, wanted, channel)
    } else {
        reach::<f32>(grid, line, limit, wanted, channel)
    }
}

/// Integral of T along a part of a piece for one channel, by Gauss' rule over equal parts of mean optical thickness [`PART`]; one of thickness tau is off by tau^4 / 4320 of itself.
fn glow<V: Value>(
    walk: &Walk<'_>,
    cell: &Cell<V>,
    s: &Stretch,
    sigma: f32,
    (before, whole): (f32, f32),
    c: usize,
) -> f32 {
    let (tau, left) = (sigma * whole, math::exp(-sigma * before));
    let to = if tau > DIM { invert(walk, cell, s, whole, DIM / sigma, c) } else { s.to };
    let parts = (math::min(tau, DIM) / PART) as u32 + 1;
    let step = (to - s.from) / parts as f32;
    let (mut sum, mut from, mut behind) = (0.0, s.from, 0.0);
    for _ in 0..parts {
        let half = from + 0.5 * step;
        for t in [half - GAUSS * step, half + GAUSS * step] {
            sum += math::exp(-sigma * (behind + integral(walk, cell, from, t).channel(c)));
        }
        behind += integral(walk, cell, from, from + step).channel(c);
        from += step;
    }
    left * 0.5 * step * sum
}

fn emitted_by<V: Value>(grid: &Grid<'_>, line: &Line, limit: f32, sigma: Vec3, emission: Vec3) -> Vec3 {
    // Where nothing is in the way T stays what it was: what is not walked through is added by its length.
    let (mut sum, mut optical, mut at) = (Vec3::ZERO, V::ZERO, 0.0);
    let left = |optical: V| super::super::flight::transmittance_of(sigma, optical.wide());
    if let Some(mut walk) = Walk::new(grid, line, limit, false) {
        while let Some(s) = walk.next() {
            sum += left(optical) * (walk.before + s.from - at).max(0.0);
            let cell = Cell::<V>::new(grid, s.piece);
            let piece = integral(&walk, &cell, s.from, s.to);
            for c in (0..3).filter(|c| emission[*c] > 0.0) {
                let state = (optical.channel(c), piece.channel(c));
                sum[c] += glow(&walk, &cell, &s, sigma[c], state, c);
            }
            optical = optical + piece;
            at = walk.before + s.to;
        }
    }
    if limit < f32::INFINITY {
        sum += left(optical) * (limit - at).max(0.0);
    }
    emission * sum
}

/// Radiance \[W m^-2 sr^-1\] that a medium of extinction `sigma` times the density, and of the same emission everywhere, sends back along a line: the integral of emission times T.
/// Within 2e-5 of itself (measured, optical thicknesses of up to 100). On a way without end what lies behind the grid has no value and is left out.
pub(crate) fn emitted(grid: &Grid<'_>, line: &Line, limit: f32, sigma: Vec3, emission: Vec3) -> Vec3 {
    if grid.is_coloured() {
        emitted_by::<Vec3>(grid, line, limit, sigma, emission)
    } else {
        emitted_by::<f32>(grid, line, limit, sigma, emission)
    }
}
