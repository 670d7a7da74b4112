//! Emission coefficients of (piece, light) pairs: the flux \[W\] that a piece of a lit surface sends on after its
//! first reflection, `Em = Ka S I` per channel.
//!
//! - S: the area of the piece \[m^2\], [`piece_area`].
//! - I: the mean direct irradiance over it \[W m^-2\], [`mean_irradiance`]; exact where irradiance is linear.
//! - Ka: the share that survives the reflection. A plain albedo is a factor ([`emission`]). A bitmap is integrated
//!   together with the irradiance ([`emission_textured`]): `Em = S/3 (A0 I0 + A1 I1 + A2 I2)` with the piece's
//!   [`VertexAlbedo`] A, which no light changes, so that a bitmap is visited once per piece and not once per pair.
//!
//! How A is found, cheapest first; each is exact for what it says of itself and bounded in time for any coordinates:
//!
//! | function | what it integrates | cost |
//! |---|---|---|
//! | [`Pyramid::brightest`] | a bound: no sample of the piece is brighter | at most 16 texels |
//! | [`sample_points`] | the bitmap as the renderer filters it, at fixed points | as many samples |
//! | [`Pyramid::coarse`] | constant texels of a coarser level | about `max_texels` texels |
//! | [`scan_texels`] | constant texels, exact overlaps (Kopylov's scan) | the texels that the piece meets |
//! | [`scan`] | the bitmap as the renderer filters it (bilinearly), exact | the texels that the piece meets |
//! | [`RowSums::vertex_albedo`] | the same, exact | the texels that the piece's *edges* meet |
//!
//! [`Published`] is the rule of the source, [`Exact`] the rule to use. Which is right: an emission coefficient is the
//! mean of what the renderer will reflect, hence of the bilinear filter; constant texels differ by up to the contrast
//! of neighbours over a piece of a texel's size and by less over larger ones (the bench states both).
//!
//! Source: Kopylov, "An efficient method of global illumination with a probability distribution for rays" (First
//! Shot), section 3: E(m, n) = Ka S_m I(m, n), brightest texel where many texels cover the triangle, a scan where
//! few do.

mod cut;
mod frame;
mod pyramid;
mod rows;
mod rule;
mod scan;
mod table;
mod texels;

pub use cut::{Overlap, overlap_unit};
pub use frame::{MAX_SIDE, MAX_SPAN, covered_estimate};
pub use pyramid::Pyramid;
pub use rows::RowSums;
pub use rule::{Exact, PieceAlbedo, Published};
pub use scan::{brightest_in, sample_points, scan, scan_texels};
pub use table::{EmissionTable, Entry, FluxSum, TableError};
pub use texels::{Bitmap, BitmapError, Texels};

use crate::math::{self, Vec3, exponent, ldexp, two_prod, two_sum};

/// Negative, NaN: 0. Infinite: the largest float.
#[inline(always)]
fn clean(x: f32) -> f32 {
    if x > 0.0 { math::min(x, f32::MAX) } else { 0.0 }
}

/// `x * 2^k`, at most the largest float; x >= 0.
#[inline(always)]
fn scaled(x: f32, k: i32) -> f32 {
    math::min(ldexp(x, k), f32::MAX)
}

/// Area of a triangle \[m^2\]: half the length of the cross product of two edges.
///
/// Within 4 ulp for edges of any length against their distance from the origin, and for slivers whose height is down
/// to 2^-20 of their length (thinner ones: 2^-44 of the square of the longest edge); edges and products are formed in
/// twice the precision, as rounded ones leave a sliver no correct digit. Scaled by powers of two: no intermediate
/// overflows or underflows. An area above f32::MAX is f32::MAX; a vertex that is not finite gives 0.
pub fn piece_area(vertices: [Vec3; 3]) -> f32 {
    let [a, b, c] = vertices;
    let largest = [a, b, c].iter().fold(0.0_f32, |m, v| math::max(m, math::max_component(v.abs())));
    if !(a.is_finite() && b.is_finite() && c.is_finite()) || largest == 0.0 {
        return 0.0;
    }
    // Differences must stay finite; small coordinates keep their bits.
    let k = if largest > 1e37 { 2 } else { 0 };
    let near = |v: Vec3| [v.x, v.y, v.z].map(|x| ldexp(x, -k));
    let (a, b, c) = (near(a), near(b), near(c));
    // Each edge is brought near length 1 by itself: one may be far longer than the other.
    let edge = |p: [f32; 3]| {
        let e = [two_sum(p[0], -a[0]), two_sum(p[1], -a[1]), two_sum(p[2], -a[2])];
        let k = exponent(e.iter().fold(0.0_f32, |m, x| math::max(m, x.0.abs())));
        (e.map(|(high, low)| (ldexp(high, -k), ldexp(low, -k))), k)
    };
    let ((e, ke), (f, kf)) = (edge(b), edge(c));
    let cross = [minor(e[1], f[2], e[2], f[1]), minor(e[2], f[0], e[0], f[2]), minor(e[0], f[1], e[1], f[0])];
    let largest = cross.iter().fold(0.0_f32, |m, x| math::max(m, x.abs()));
    if largest == 0.0 {
        return 0.0;
    }
    let k3 = exponent(largest);
    let [x, y, z] = cross.map(|x| ldexp(x, -k3));
    scaled(math::sqrt(x * x + y * y + z * z), 2 * k + ke + kf + k3 - 1)
}

/// a d - b c of numbers in two parts, with one rounding's error but for products of two low parts.
#[inline(always)]
fn minor(a: (f32, f32), d: (f32, f32), b: (f32, f32), c: (f32, f32)) -> f32 {
    let (p, p_low) = two_prod(a.0, d.0);
    let (q, q_low) = two_prod(b.0, c.0);
    let (high, low) = two_sum(p, -q);
    let cross = (a.0 * d.1 + a.1 * d.0) - (b.0 * c.1 + b.1 * c.0);
    high + (low + ((p_low - q_low) + cross))
}

/// Mean of a linear irradiance over a triangle \[W m^-2\]: the mean of the vertex values, per channel.
///
/// Within 2 ulp, also where the sum would overflow. Values below 0 and NaN count as 0, infinities as f32::MAX.
pub fn mean_irradiance(irradiance: [Vec3; 3]) -> Vec3 {
    weighted_irradiance([Vec3::ONE; 3], irradiance).map(|x| scaled(x.0, x.1)).into()
}

/// (A0 I0 + A1 I1 + A2 I2) / 3 per channel, as a number times a power of two.
#[inline]
fn weighted_irradiance(albedo: [Vec3; 3], irradiance: [Vec3; 3]) -> [(f32, i32); 3] {
    let a = albedo.map(|v| v.to_array());
    let e = irradiance.map(|v| v.to_array());
    [0, 1, 2].map(|c| {
        let e = [clean(e[0][c]), clean(e[1][c]), clean(e[2][c])];
        let k = exponent(math::max(e[0], math::max(e[1], e[2])));
        let term = |i: usize| clean(a[i][c]) * ldexp(e[i], -k);
        (((term(0) + term(1)) + term(2)) / 3.0, k)
    })
}

/// Emission coefficient Em = Ka S I \[W\] per channel of a piece of uniform albedo under linear irradiance.
///
/// `albedo` in \[0, 1\], `area` \[m^2\], `irradiance` at the vertices \[W m^-2\]. Within 4 ulp of the exact product;
/// no intermediate overflows or underflows, a result beyond f32::MAX is f32::MAX. Negative and NaN count as 0.
pub fn emission(albedo: Vec3, area: f32, irradiance: [Vec3; 3]) -> Vec3 {
    emission_textured(albedo, area, irradiance, &VertexAlbedo::uniform(Vec3::ONE))
}

/// [`emission`] where a bitmap multiplies `albedo`: Em = S/3 sum_i A_i I_i, exact for irradiance that is linear.
///
/// Within 5 ulp for the given `texture`.
pub fn emission_textured(albedo: Vec3, area: f32, irradiance: [Vec3; 3], texture: &VertexAlbedo) -> Vec3 {
    let area = clean(area);
    let ks = exponent(area);
    let area = ldexp(area, -ks);
    let mean = weighted_irradiance(texture.at, irradiance);
    let albedo = albedo.to_array();
    let channel = |c: usize| {
        let (mean, k) = mean[c];
        // Each factor is brought near 1: the exponents are added as integers.
        let (km, ka) = (exponent(mean), exponent(clean(albedo[c])));
        scaled(ldexp(mean, -km) * area * ldexp(clean(albedo[c]), -ka), k + km + ka + ks)
    };
    Vec3::new(channel(0), channel(1), channel(2))
}

/// Albedo of a piece as light at each vertex meets it: `A_i = 3/S int rho b_i dS` over the piece, b_i the barycentric
/// coordinate of vertex i. Each is the mean of rho weighted by b_i, in \[0, 1\].
///
/// The emission under a linear irradiance is S/3 sum A_i I_i, whatever the light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VertexAlbedo {
    /// One per vertex, RGB.
    pub at: [Vec3; 3],
}

impl VertexAlbedo {
    /// That of a surface of one albedo.
    #[inline]
    pub const fn uniform(albedo: Vec3) -> Self {
        Self { at: [albedo; 3] }
    }

    /// Mean albedo over the piece, `1/S int rho dS`.
    #[inline]
    pub fn mean(&self) -> Vec3 {
        (self.at[0] + self.at[1] + self.at[2]) / 3.0
    }
}

/// What a pair weighs in the density of starts \[W\]: the mean of the channels of `emission`, and at least 2^-24 of
/// the mean of `bound`, the emission that the brightest texel would give.
///
/// Nonzero wherever light can be reflected: rounding may leave a dark piece with one bright corner an emission of 0,
/// and a start that is never chosen is a bias. Never below the plain mean, above it by at most 2^-24 of the bound.
pub fn importance(emission: Vec3, bound: Vec3) -> f32 {
    const SHARE: f32 = 1.0 / 16_777_216.0;
    let floor = math::mean(bound) * SHARE;
    // A bound so small that its share would vanish.
    let floor = if floor == 0.0 && math::max_component(bound) > 0.0 { f32::from_bits(1) } else { floor };
    math::max(math::mean(emission), floor)
}
