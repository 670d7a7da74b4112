//! The one door to float functions.
//!
//! Every elementary function here is built of `+ - * /`, `sqrt`, comparisons and integer operations on the bits:
//! no `fma`, no f64, no table. All of these are exact or correctly rounded on every IEEE machine, so that a
//! result has the same bits on every CPU, and a WGSL twin written in the same order has them too wherever the
//! adapter's division and square root are correctly rounded.
//!
//! Units: a *ulp* is the distance between the two f32 neighbours of the true value (2^-149 below 2^-126).
//! The worst error of each function is in [`ACCURACY`], which a test measures; the doc comments refer to it.
//!
//! All functions are total: what lies outside a domain has the value stated with the function. For finite
//! arguments only [`sqrt`] of a negative number is NaN ([`sqrt_clamped`] is not).

mod accuracy;
mod bits;
mod consts;
mod exp_ln;
mod inverse_trig;
mod pow;
mod root_functions;
mod roots;
mod rounding;
mod sums;
mod trig;
mod vector;

pub use accuracy::{ACCURACY, Accuracy, accuracy};
pub use bits::{exponent, ldexp, u32_to_unit};
pub use consts::*;
pub use exp_ln::{exp, exp2, ln, log2};
pub use glam::{Vec2, Vec3};
pub use inverse_trig::{acos, asin, atan, atan2};
pub use pow::pow;
pub use root_functions::{cbrt, sqrt, sqrt_clamped, sqrt64};
pub use roots::{discriminant, quadratic_roots};
pub use rounding::{abs, ceil, clamp, copysign, floor, fract, max, min, round, trunc};
pub use sums::{Compensated, two_prod, two_sum};
pub use trig::{cos, sin, sin_cos, sin_cos_quarter, tan};
pub use vector::{
    from_local, max_component, mean, min_component, normalize_or, orthonormal_basis, reflect, to_local,
};
