//! What is allowed, per kernel and basis: the one table. Tests carry no literals of their own.

use etendue_core::kernel::Kernel;

/// A limit with its reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Largest error allowed, in the tolerance's unit.
    pub limit: f64,
    /// Why it is not zero; for zero, why it can be.
    pub reason: &'static str,
}

/// What one kernel may differ by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// `ulp`, `u` (2^-24 of a scale) or `bits`.
    pub unit: &'static str,
    /// Against the truth (f64 or closed form), for the scalar reference's own arithmetic.
    pub truth: Bound,
    /// Against the scalar reference, where the adapter rounds otherwise than IEEE 754 (where it does not, it is zero).
    pub peer: Bound,
    /// Against the scalar reference, where the adapter has no subnormal numbers: in the unit of the result, absolute.
    pub flushed: Bound,
}

impl Tolerance {
    /// Nothing may differ on any backend.
    pub fn is_exact(&self) -> bool {
        self.truth.limit == 0.0 && self.peer.limit == 0.0
    }
}

const INTEGER: &str = "integer stage: exact";
const WGSL: &str =
    "WGSL lets division and sqrt err by 2.5 ulp and products fuse; not yet measured on hardware";

/// What is lost where a result below the least normal number becomes zero.
const FLUSHED: Bound = Bound { limit: f32::MIN_POSITIVE as f64, reason: "a result below 2^-126 is 0" };

const fn exact() -> Tolerance {
    let bound = Bound { limit: 0.0, reason: INTEGER };
    Tolerance { unit: "bits", truth: bound, peer: bound, flushed: FLUSHED }
}

/// Decisions on floats: exact wherever the truth says that they hang on no rounding.
const fn exact_choice(reason: &'static str) -> Tolerance {
    let bound = Bound { limit: 0.0, reason };
    Tolerance { unit: "bits", truth: bound, peer: bound, flushed: FLUSHED }
}

const fn float(unit: &'static str, limit: f64, reason: &'static str) -> Tolerance {
    // Each of a kernel's few roundings may become 2.5 on hardware, on both sides.
    let peer = Bound { limit: 8.0 + 5.0 * limit, reason: WGSL };
    Tolerance { unit, truth: Bound { limit, reason }, peer, flushed: FLUSHED }
}

/// What `core::math::ACCURACY` states, the largest of its rows for the function (`sin_cos` has one per result).
fn polynomial(name: &str) -> Tolerance {
    let rows = etendue_core::math::ACCURACY.iter();
    let limit = rows
        .filter(|row| {
            row.name == name || row.name.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'))
        })
        .fold(0.0_f64, |m, row| m.max(row.worst_ulp));
    float("ulp", limit, "polynomial in f32, as core::math::ACCURACY states")
}

/// Kernels in which something below 2^-126 is multiplied by what is large. What their sums lose is far below all that counts.
fn flushed(kernel: Kernel) -> Bound {
    use Kernel as K;
    let least = FLUSHED.limit;
    match kernel {
        K::PdfPowerCosine | K::EvalPhong | K::PdfPhong | K::EvalLobes | K::PdfLobes => Bound {
            limit: least * 2048.0,
            reason: "a power of the cosine below 2^-126 is 0, times (n + 2) / (2 pi) for exponents to 1e4",
        },
        K::FacetsDensity | K::PdfVisible => Bound {
            limit: least * 1_048_576.0,
            reason: "an exponential below 2^-126 is 0, times 1 / (pi alpha^2 cos^4)",
        },
        K::InvertCone => Bound {
            limit: least / 1e-30,
            reason: "a square below 2^-126 is 0, over cones of 1 - cos = 1e-30",
        },
        _ => FLUSHED,
    }
}

/// The entry of a kernel.
pub fn tolerance(kernel: Kernel) -> Tolerance {
    Tolerance { flushed: flushed(kernel), ..rounding(kernel) }
}

fn rounding(kernel: Kernel) -> Tolerance {
    use Kernel as K;
    const ROUNDING: &str = "roundings of the formula";
    const ANGLE: &str = "sine and cosine of the azimuth, square root of the height";
    const CONDITION: &str = "roundings, in units of what the input's own rounding amounts to";
    const PI_ROUNDED: &str = "pi rounded to f32, then one or two roundings";
    match kernel {
        K::U32ToUnit
        | K::CounterBits4
        | K::SobolBits4
        | K::SobolSet
        | K::CdfPick
        | K::CdfPmf
        | K::EvenWord => exact(),
        K::Sqrt => float("ulp", 0.5, "correctly rounded"),
        K::Ln => polynomial("ln"),
        K::Log2 => polynomial("log2"),
        K::Exp => polynomial("exp"),
        K::Exp2 => polynomial("exp2"),
        K::Pow => polynomial("pow"),
        K::SinCos => polynomial("sin_cos"),
        K::Acos => polynomial("acos"),
        K::Asin => polynomial("asin"),
        K::Atan2 => polynomial("atan2"),
        K::Cbrt => polynomial("cbrt"),
        K::NormalizeOr => float("ulp", 3.0, ROUNDING),
        K::OrthonormalBasis => float("u", 4.0, ROUNDING),
        K::SampleSphere | K::SampleHemisphere | K::SampleCosineHemisphere | K::SampleDisk | K::SampleCone => {
            float("u", 3.0, ANGLE)
        }
        K::SamplePowerCosine => float("u", 3.0, "logarithm, exponential and azimuth"),
        K::SampleTriangle => {
            float("ulp", 0.5, "exact for multiples of 2^-24 but where a half of one is subtracted")
        }
        K::SampleParallelogram => float("u", 2.0, ROUNDING),
        K::PdfSphere | K::PdfHemisphere | K::PdfCosineHemisphere | K::PdfCone | K::PdfDisk => {
            float("ulp", 1.5, PI_ROUNDED)
        }
        K::PdfPowerCosine => float("u", 6.0, CONDITION),
        K::PdfTriangle | K::PdfParallelogram => {
            float("u", 6.0, "cross product, length and quotient, over the sine")
        }
        K::InvertSphere
        | K::InvertHemisphere
        | K::InvertCosineHemisphere
        | K::InvertDisk
        | K::InvertTriangle => float("u", 4.0, "arctangent and rounding of the vector's length"),
        K::InvertCone => float("u", 5.0, "arctangent and rounding of the vector's length"),
        K::InvertPowerCosine => float("u", 4.0, CONDITION),
        K::InvertParallelogram => float("u", 4.0, CONDITION),
        K::Triangle => float("u", 10.0, CONDITION),
        K::Slab => float("u", 12.0, "reciprocal and the conservative margin of 3 eps"),
        K::RoundShape => float("u", 10.0, CONDITION),
        K::OffsetOrigin => float("u", 2.0, ROUNDING),
        K::EvalDiffuse => float("ulp", 1.5, PI_ROUNDED),
        K::PdfDiffuse => float("u", 2.0, "dot product of rounded vectors"),
        K::SampleDiffuse => float("u", 4.0, ANGLE),
        K::EvalPhong | K::PdfPhong => float("u", 16.0, CONDITION),
        K::SamplePhong => float("u", 10.0, "logarithm, exponential, azimuth and frame"),
        K::FacetsDensity => float("u", 4.0, CONDITION),
        K::FacetsMasking => float("u", 5.0, ROUNDING),
        K::PdfVisible => float("u", 4.0, CONDITION),
        K::SampleVisible => float("u", 8.0, CONDITION),
        K::EvalLobes | K::PdfLobes => float("u", 16.0, CONDITION),
        K::SampleLobes => float("u", 16.0, CONDITION),
        K::EvalPhase => float("u", 12.0, "a sum of squares to the power of 3/2"),
        K::SamplePhase => float("u", 8.0, CONDITION),
        K::Transmittance => float("u", 3.0, CONDITION),
        K::GridAt => float("u", 4.0, CONDITION),
        K::GridOpticalLength => float("u", 4.0, CONDITION),
        K::FresnelDielectric => float("u", 8.0, CONDITION),
        K::FresnelConductor => float("u", 8.0, CONDITION),
        K::SampleLight => float("u", 16.0, CONDITION),
        K::PdfLight => float("u", 6.0, CONDITION),
        K::PowerHeuristic => float("u", 2.0, ROUNDING),
        K::CameraRay => float("u", 3.0, ROUNDING),
        K::ToneDisplay => float("u", 8.0, "power function; absolute 5e-7 as core::tone states"),
        K::SrgbDecode => {
            float("ulp", 8.0, "power of a rounded base: 2.4 roundings and those of the quotient")
        }
        K::SampleBitmap => float("u", 3.0, CONDITION),
        // linear_triangle
        K::SampleLinearTriangle => float("u", 8.0, "roundings of both conditional inversions, relative"),
        K::PdfLinearTriangle => float("ulp", 5.0, ROUNDING),
        K::InvertLinearTriangle => float("u", 12.0, "roundings of ratios, cubed, relative"),
        K::LinearTriangleDistance => {
            float("u", 1.25, "one rounding of a sum, and what its step lacks; relative")
        }
        // emission
        K::EmissionCoefficient => {
            float("ulp", 6.0, "two-part cross product and length, sum and three products")
        }
        K::EmissionOverlap => float("u", 6.0, "four crossings and the cross product of each part"),
        K::EmissionScan => float("u", 12.0, "crossings, and the sums over the cells"),
        K::EmissionScanTexels => float("u", 12.0, "crossings, and the sums over the texels"),
        K::EmissionBrightest => float("ulp", 8.5, "that of the decoded texel, and the margin's product"),

        // subdivide
        K::SubdividePublished => exact_choice("comparisons of rounded numbers: the same, or undecided"),
        K::SubdivideRobust => float("u", 4.0, "differences of samples, in units of the largest"),
        // log_offset
        K::LogOffsetEncode => exact(),
        K::LogOffsetLookUp => exact(),
        K::LogOffsetDecode | K::LogOffsetDecodeMean => {
            float("u", 3.0, "exponent rounded twice, exponential and product, over 1 + |exponent|")
        }
        // bc1
        K::Bc1Decode | K::Bc1DecodeWith | K::Bc1EncodeRangeFit | K::Bc4Decode | K::Bc4EncodeRangeFit => {
            exact()
        }
        // polynomial
        K::PolynomialDot => float("u", 6.0, "32 products and their sums, over the sum of magnitudes"),
        K::PolynomialApply => float("u", 4.0, "8 products and their sums, over the sum of magnitudes"),
        K::PolynomialApplyHalf => {
            float("u", 6.0, "8 products, their sums in two parts and a quotient, over the sum of magnitudes")
        }
        K::PolynomialSeries => {
            float("u", 6.0, "each bounce as polynomial::apply, over the magnitudes of all bounces before it")
        }
        // first_shot
        K::StartPlace => {
            float("u", 8.0, "those of linear_triangle::sample, three products and their sum, relative")
        }
        K::StartWithin => float("u", 3.0, CONDITION),
        K::StartDensity => float("u", 4.0, CONDITION),
        K::StartFlux => float("ulp", 5.0, ROUNDING),
        K::LightShare => float("ulp", 5.0, ROUNDING),
        K::LookFactor => float("u", 1.5, "quotient and difference, over the quotient"),
        K::PieceFlux => float("ulp", 5.0, ROUNDING),
        // emit
        K::EmitLight => float("u", 6.0, CONDITION),
        K::EmitEnvironment => float("u", 6.0, CONDITION),
        // A kernel without an entry allows nothing and says so: the coverage test fails on it.
        _ => Tolerance {
            unit: "bits",
            truth: Bound { limit: 0.0, reason: "" },
            peer: Bound { limit: 0.0, reason: "" },
            flushed: FLUSHED,
        },
    }
}
