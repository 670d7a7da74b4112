//! Constants, each the f32 nearest to the true value unless it says otherwise.

/// pi, 8.7e-8 above the true value.
pub const PI: f32 = core::f32::consts::PI;
/// 2 pi, the circle in radians.
pub const TAU: f32 = core::f32::consts::TAU;
/// pi / 2.
pub const HALF_PI: f32 = core::f32::consts::FRAC_PI_2;
/// 1 / pi, the Lambertian BRDF of albedo 1 [1/sr].
pub const INV_PI: f32 = core::f32::consts::FRAC_1_PI;
/// 1 / (2 pi).
pub const INV_TAU: f32 = 0.159_154_94;
/// 1 / (4 pi), the isotropic phase function [1/sr].
pub const INV_FOUR_PI: f32 = 0.079_577_47;
/// The largest f32 below 1: 1 - 2^-24. Every random number of [`super::u32_to_unit`] is at most this.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;
/// ln 2.
pub const LN_2: f32 = core::f32::consts::LN_2;

/// What must be added to f32 pi/2 to give pi/2.
pub(super) const HALF_PI_LOW: f32 = -4.371_139e-8;
/// What must be added to f32 pi to give pi.
pub(super) const PI_LOW: f32 = -8.742_278e-8;
