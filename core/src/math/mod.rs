//! The one door to float functions.

pub use glam::{Vec2, Vec3};

/// Square root, correctly rounded.
#[inline(always)]
pub fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}
/// Natural logarithm.
pub fn ln(x: f32) -> f32 {
    libm::logf(x)
}
/// Natural exponential.
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}
/// `x` to the power `y`, `x >= 0`.
pub fn pow(x: f32, y: f32) -> f32 {
    libm::powf(x, y)
}
/// Sine and cosine.
pub fn sin_cos(x: f32) -> (f32, f32) {
    libm::sincosf(x)
}
/// Arc cosine.
pub fn acos(x: f32) -> f32 {
    libm::acosf(x)
}
/// Angle of the vector (x, y).
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}
/// Cube root.
pub fn cbrt(x: f32) -> f32 {
    libm::cbrtf(x)
}
