//! Which rays may be walked with fused box tests, and how much larger boxes are for their sake.

use etendue_core::geometry::PreparedRay;

/// What [`super::lanes::Lean`] needs to be safe.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// By how much a node's boxes are larger than their contents on each side, metres.
    pub(super) margin: f32,
    /// Origins that it suffices for: at most this, metres, on each axis. Negative: none.
    origin: f32,
}

impl Fit {
    /// Largest coordinate of boxes, metres: reciprocals are at most 1e18, and products must be finite.
    const LIMIT: f32 = 1e18;

    /// For boxes whose coordinates are at most `reach`, and origins of up to twice that.
    ///
    /// The constant of the fused product is off by half an ulp of at most `2 reach`, and the enlarged planes are rounded by half
    /// an ulp of `reach`: with u = 2^-24 3 u reach, of which 4 u are given; and something for where products are subnormal.
    pub(super) fn new(reach: f32) -> Self {
        if reach <= Self::LIMIT {
            let reach = reach.max(0.0);
            Self { margin: reach * (2.0 * f32::EPSILON) + 1e-36, origin: 2.0 * reach }
        } else {
            Self { margin: 0.0, origin: -1.0 }
        }
    }

    /// Whether the ray may be walked with fused box tests; false for NaN.
    #[inline(always)]
    pub(super) fn holds(&self, ray: &PreparedRay) -> bool {
        let o = ray.origin.abs();
        // The last: no reciprocal below 1e-9, where products would be subnormal.
        (o.x <= self.origin) & (o.y <= self.origin) & (o.z <= self.origin) & (ray.shear.z.abs() >= 1e-9)
    }
}
