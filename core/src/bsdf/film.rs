//! A film that scatters evenly to both sides: f = reflect / pi on the side of `wo`, transmit / pi on the other. Both sides are the same.

use super::diffuse;
use super::lobes::BsdfSample;
use crate::math::{self, INV_PI, Vec3};

/// Chance of a direction on the side of `wo`.
fn share(reflect: Vec3, transmit: Vec3) -> f32 {
    let (r, t) = (math::mean(reflect), math::mean(transmit));
    if r + t > 0.0 { r / (r + t) } else { 1.0 }
}

/// f \[1/sr\], and the density of [`sample`] per solid angle.
pub(super) fn values(reflect: Vec3, transmit: Vec3, n: Vec3, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
    let cos = wi.dot(n);
    let share = share(reflect, transmit);
    let (f, chance) =
        if (cos > 0.0) == (wo.dot(n) >= 0.0) { (reflect, share) } else { (transmit, 1.0 - share) };
    if cos == 0.0 { (Vec3::ZERO, 0.0) } else { (f * INV_PI, chance * math::abs(cos) * INV_PI) }
}

/// A direction on either side.
pub(super) fn sample(
    reflect: Vec3,
    transmit: Vec3,
    n: Vec3,
    wo: Vec3,
    u: [f32; 2],
    lobe: f32,
) -> Option<BsdfSample> {
    let stays = lobe < share(reflect, transmit);
    let side = if stays == (wo.dot(n) >= 0.0) { n } else { -n };
    let wi = diffuse::sample(side, u);
    let (f, pdf) = values(reflect, transmit, n, wo, wi);
    (pdf > 0.0).then(|| BsdfSample { wi, weight: f * (math::abs(wi.dot(n)) / pdf), pdf })
}
