//! Warps of the unit square: trios `sample_x / pdf_x / invert_x`.
//!
//! `sample_x(u, parameters)` maps uniform `u` in `[0, 1 - 2^-24]^2` to a value with a known density; `pdf_x` is that density, with its measure
//! in the name (`pdf_solid_angle_` per steradian, `pdf_area_` per square metre); `invert_x` maps the value back to `u`.
//! Every sampled value has a density that is positive and finite, the ends of the unit interval included; nothing is NaN for finite input.
//! Directions are unit vectors in a local frame whose axis is +z. Azimuths run from +x to +y as `u[1]` runs from 0 to 1.
//!
//! Accuracy: sampled values to a few ulp of f32 of their length; round trips to the figures each function states, in units of `u`
//! (azimuths modulo 1).

mod planar;
mod sphere;

pub use planar::{
    invert_disk, invert_parallelogram, invert_triangle, pdf_area_disk, pdf_area_parallelogram,
    pdf_area_triangle, sample_disk, sample_parallelogram, sample_triangle,
};
pub use sphere::{
    invert_cone, invert_cosine_hemisphere, invert_hemisphere, invert_power_cosine, invert_sphere,
    one_minus_cos_of_sin_squared, pdf_solid_angle_cone, pdf_solid_angle_cosine_hemisphere,
    pdf_solid_angle_hemisphere, pdf_solid_angle_power_cosine, pdf_solid_angle_sphere, sample_cone,
    sample_cosine_hemisphere, sample_hemisphere, sample_power_cosine, sample_sphere,
};

use super::ONE_MINUS_EPSILON;
use crate::math::{self, PI};

/// Clamps to the unit numbers `[0, 1 - 2^-24]`; -0 becomes +0.
#[inline(always)]
#[expect(
    clippy::manual_clamp,
    reason = "max takes NaN, as of directions far from unit length, to 0; clamp would keep it"
)]
fn unit(u: f32) -> f32 {
    u.max(0.0).min(ONE_MINUS_EPSILON) + 0.0
}

/// Sine and cosine of `u` turns, `u` in [0, 1]. The quarter turn is split off exactly, so that the result is symmetric in the four quarters
/// and accurate relative to its own size near the axes.
#[inline]
pub(crate) fn sin_cos_turns(u: f32) -> (f32, f32) {
    let quarters = 4.0 * u;
    let nearest = (quarters + 0.5) as i32;
    let (s, c) = math::sin_cos_quarter((quarters - nearest as f32) * (0.5 * PI));
    match nearest & 3 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// The angle of (x, y) in turns, in `[0, 1 - 2^-24]`; 0 for (0, 0).
#[inline]
fn turns(x: f32, y: f32) -> f32 {
    if x == 0.0 && y == 0.0 {
        return 0.0;
    }
    let t = math::atan2(y, x) * (0.5 / PI);
    unit(if t < 0.0 { t + 1.0 } else { t })
}

/// `1 - exp(-t)` for `t >= 0` without cancellation: Taylor's series (nine terms, 5e-10 relative) below 1/2.
#[inline]
fn one_minus_exp_neg(t: f32) -> f32 {
    if t < 0.5 {
        let mut sum = 1.0;
        for divisor in [9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0] {
            sum = 1.0 - t / divisor * sum;
        }
        t * sum
    } else {
        1.0 - math::exp(-t)
    }
}
