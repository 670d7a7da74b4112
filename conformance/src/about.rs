//! What a reader of the accuracy tables asks of each kernel: where its statement holds, and where it comes from.

use etendue_core::kernel::Kernel;

/// Words beside the numbers of a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct About {
    /// The inputs over which the errors are stated.
    pub domain: &'static str,
    /// Author and year of the method, and the equation where there is one.
    pub source: &'static str,
}

/// The entry of a kernel.
pub fn about(kernel: Kernel) -> About {
    let (domain, source) = words(kernel);
    About { domain, source }
}

fn words(kernel: Kernel) -> (&'static str, &'static str) {
    use Kernel as K;
    match kernel {
        K::Ln => ("x > 0, subnormals too", "own Remez fit; reduction as Cody and Waite 1980, ch. 5"),
        K::Log2 => ("x > 0, subnormals too", "own Remez fit; 1/ln 2 in two pieces"),
        K::Exp => ("-104 <= x <= 104", "own Remez fit; reduction as Cody and Waite 1980, ch. 6"),
        K::Exp2 => ("-151 <= x <= 151", "own Remez fit"),
        K::Pow => ("x > 0, result normal", "exp2(y log2 x), the logarithm in two pieces"),
        K::SinCos => ("abs x <= 3216", "own Remez fit; reduction as Cody and Waite 1980, ch. 8"),
        K::Acos => ("-1 <= x <= 1", "own Remez fit over the half-angle"),
        K::Asin => ("-1 <= x <= 1", "own Remez fit over the half-angle"),
        K::Atan2 => ("finite y, x", "own Remez fit"),
        K::Cbrt => ("finite x, subnormals too", "Newton on x^(-1/3), exact residual"),
        K::Sqrt => ("x >= 0", "IEEE 754-2019, 5.4.1"),
        K::NormalizeOr => ("finite v, any length", "v / sqrt(v . v), scaled by powers of two"),
        K::OrthonormalBasis => ("unit n", "Duff et al. 2017, branchless form"),
        K::U32ToUnit => ("every word", "(x >> 8) 2^-24"),
        K::CounterBits4 => ("every word", "Salmon et al. 2011, 3.3 (Philox4x32-10)"),
        K::SobolBits4 => ("every word", "Joe and Kuo 2008; scrambles: Laine and Karras 2011, Burley 2020"),
        K::SobolSet => (
            "every index, dimensions 0 to 199",
            "Joe and Kuo 2008; scrambles: Laine and Karras 2011, Burley 2020",
        ),
        K::CdfPick => ("every word; tables to 70 000 entries", "inverse of an integer distribution function"),
        K::CdfPmf => ("every index, beyond the table too", "count / 2^32"),
        K::SampleSphere => ("u in [0, 1)^2", "Archimedes: uniform height and azimuth"),
        K::PdfSphere => ("unit w", "1 / (4 pi)"),
        K::InvertSphere => ("unit w", "inverse of the above"),
        K::SampleHemisphere => ("u in [0, 1)^2", "Archimedes: uniform height and azimuth"),
        K::PdfHemisphere => ("unit w", "1 / (2 pi)"),
        K::InvertHemisphere => ("unit w", "inverse of the above"),
        K::SampleCosineHemisphere => ("u in [0, 1)^2", "Malley 1988 over Shirley and Chiu 1997"),
        K::PdfCosineHemisphere => ("unit w", "cos / pi"),
        K::InvertCosineHemisphere => ("unit w, w.z > 0", "inverse of the above"),
        K::SampleCone => ("u in [0, 1)^2, 1e-30 <= 1 - cos <= 2", "Shirley, Wang and Zimmerman 1996"),
        K::PdfCone => ("unit w, 1e-30 <= 1 - cos <= 2", "1 / (2 pi (1 - cos))"),
        K::InvertCone => ("unit w, 1e-30 <= 1 - cos <= 2", "inverse of the above"),
        K::SamplePowerCosine => ("u in [0, 1)^2, exponent 0 to 1e4", "Lafortune and Willems 1994"),
        K::PdfPowerCosine => ("unit w, exponent 0 to 1e4", "(n + 1) / (2 pi) cos^n"),
        K::InvertPowerCosine => ("unit w, exponent 0 to 1e4", "inverse of the above"),
        K::SampleDisk => ("u in [0, 1)^2", "Shirley and Chiu 1997"),
        K::PdfDisk => ("finite points", "1 / pi"),
        K::InvertDisk => ("points of the disk", "inverse of the above"),
        K::SampleTriangle => ("u in [0, 1)^2", "Heitz 2019"),
        K::PdfTriangle => ("edges 1e-6 to 1e6 m", "2 / abs(e0 x e1)"),
        K::InvertTriangle => ("barycentrics", "inverse of the above"),
        K::SampleParallelogram => ("u in [0, 1)^2, edges 1e-3 to 1e3 m", "o + s e0 + t e1"),
        K::PdfParallelogram => ("edges 1e-6 to 1e6 m", "1 / abs(e0 x e1)"),
        K::InvertParallelogram => ("points of its plane", "Cramer's rule"),
        K::Triangle => ("rays at, beside and along triangles; finite", "Woop, Benthin and Wald 2013"),
        K::Slab => ("rays at, beside and along boxes; finite", "Ize 2013"),
        K::RoundShape => ("spheres and disks, near and far", "Haines et al. 2019, eq. 5 and 10"),
        K::OffsetOrigin => ("finite positions", "own, `geometry::surface`"),
        K::EvalDiffuse => ("unit n, wi", "Lambert 1760, albedo / pi"),
        K::PdfDiffuse => ("unit n, wi", "cos / pi"),
        K::SampleDiffuse => ("unit n, u in [0, 1)^2", "Malley 1988 over Shirley and Chiu 1997"),
        K::EvalPhong => ("unit vectors, exponent 0 to 1e4", "Lafortune and Willems 1994"),
        K::PdfPhong => ("unit vectors, exponent 0 to 1e4", "Lafortune and Willems 1994"),
        K::FacetsDensity => ("unit vectors, alpha 1e-3 to 2", "Walter et al. 2007"),
        K::FacetsMasking => ("unit vectors, alpha 1e-3 to 2", "Smith 1967, Walter et al. 2007"),
        K::PdfVisible => ("unit vectors, alpha 1e-3 to 2", "Heitz and d'Eon 2014"),
        K::SampleVisible => {
            ("unit vectors, alpha 1e-3 to 2, u in [0, 1)^2", "Dupuy and Benyoub 2023, Jakob 2014")
        }
        K::SamplePhong => ("unit vectors, u in [0, 1)^2", "Lafortune and Willems 1994"),
        K::EvalLobes => ("unit vectors", "sum of the lobes"),
        K::PdfLobes => ("unit vectors", "mixture by albedo"),
        K::SampleLobes => ("unit vectors, u in [0, 1)^3", "mixture by albedo"),
        K::EvalPhase => ("unit vectors, g -0.99 to 0.9999", "Henyey and Greenstein 1941"),
        K::SamplePhase => ("unit vector, g -0.99 to 0.9999, u in [0, 1)^2", "inverse of its distribution"),
        K::Transmittance => ("sigma 0 to 1e4 / m, lengths 1e-6 to 1e3 m", "Bouguer 1729"),
        K::GridAt => ("grids of up to 459 values, turned too", "trilinear between the centres of cells"),
        K::GridOpticalLength => ("ways of 1 cm to 10 km through such grids", "`core::medium::grid`"),
        K::FresnelDielectric => ("cosines 0 to 1, ratios 0.3 to 3", "Fresnel 1823"),
        K::FresnelConductor => ("cosines 0 to 1, eta 0.02 to 10, k 0 to 20", "Fresnel 1823, complex index"),
        K::SampleLight => ("every kind of light, near and far", "`core::light`"),
        K::PdfLight => ("every kind of light, near and far", "`core::light`"),
        K::PowerHeuristic => ("densities >= 0, to f32::MAX", "Veach and Guibas 1995, eq. 12"),
        K::CameraRay => ("pinhole and thin lens", "thin lens, Cook, Porter and Carpenter 1984"),
        K::ToneDisplay => ("radiance >= 0", "Reinhard et al. 2002, eq. 3; IEC 61966-2-1"),
        K::SrgbDecode => ("every code", "IEC 61966-2-1:1999"),
        K::SampleBitmap => ("finite u, v", "bilinear over the four nearest texel centres"),
        // linear_triangle
        Kernel::SampleLinearTriangle | Kernel::LinearTriangleDistance => (
            "weights >= 0 with a positive sum, normal numbers; u in [0, 1]",
            "density: E. A. Kopylov, algorithm 2; the lightest vertex as apex and Halley's step: core::sampling::linear_triangle",
        ),
        Kernel::PdfLinearTriangle => (
            "weights >= 0 with a positive sum, normal numbers; barycentrics that sum to 1",
            "linear interpolation over its mean",
        ),
        Kernel::InvertLinearTriangle => (
            "weights >= 0 with a positive sum, normal numbers; barycentrics >= 0",
            "distribution functions of the density of E. A. Kopylov, algorithm 2, from the lightest vertex",
        ),
        // emission
        Kernel::EmissionCoefficient => (
            "edges 1e-9 to 1e9 m, heights from 2^-16 of the length, irradiance 1e-12 to 1e9 W m^-2",
            "Kopylov, First Shot, section 3: E(m, n) = Ka S_m I(m, n); area by products in two parts (Dekker 1971)",
        ),
        Kernel::EmissionOverlap => (
            "triangles of 1e-3 to 8 cells about the cell, corners on its borders; u of 1 + size / extent per axis",
            "clipping by half-planes (Sutherland and Hodgman 1974) in barycentric coordinates; this project",
        ),
        Kernel::EmissionScan => (
            "pieces of 0.02 to 12 texels on bitmaps of 1 x 1 to 64 x 32, needles, lines and points; u of albedo 1",
            "integral of the bilinear filter in closed form per cell; this project",
        ),
        Kernel::EmissionScanTexels => (
            "pieces of 0.02 to 12 texels on bitmaps of 1 x 1 to 64 x 32; u of 1 + texel / extent per axis",
            "Kopylov, First Shot, section 3: the scan of the covering texels, with exact overlaps",
        ),
        Kernel::EmissionBrightest => (
            "pieces of 0.02 to 12 texels on bitmaps of 1 x 1 to 64 x 32, within two periods",
            "Kopylov, First Shot, section 3: the brightest texel, here of the piece",
        ),

        // subdivide
        K::SubdividePublished => (
            "corners of any size, irradiance in [0, 2^126]; NaN and negative count as 0",
            "E. Kopylov, First Shot, algorithm 1",
        ),
        K::SubdivideRobust => (
            "corners of any size, irradiance 0 or in [1e-30, 2^126]; NaN and negative count as 0",
            "E. Kopylov, First Shot, algorithm 1, mended; longest-edge bisection: Rosenberg and Stenger 1975",
        ),
        // log_offset
        Kernel::LogOffsetEncode => (
            "every finite x; tables of widths 0.0625 to 174, and of a matrix of zeros",
            "log/offset map of a thesis on compressed radiosity (ln in [-25, 0] to 8 bits); comparison with exact boundaries",
        ),
        Kernel::LogOffsetLookUp => ("every word", "table"),
        Kernel::LogOffsetDecode => (
            "widths 0.0625 to 174, max 0 to 3e38, levels 0 to 255 and beyond",
            "inverse of the log/offset map: max e^(-width (255 - level) / 255)",
        ),
        Kernel::LogOffsetDecodeMean => (
            "widths 0.0625 to 174, max 0 to 3e38, levels 0 to 255 and beyond",
            "conditional mean as the decoded value: Max 1960, Lloyd 1982",
        ),
        // bc1
        K::Bc1Decode => (
            "all blocks",
            "the format BC1 (S. Iourcha, K. Nayak, Z. Hong 1999); thirds and halves to nearest",
        ),
        K::Bc1DecodeWith => {
            ("all blocks, five rules", "Mesa, AMD, NVIDIA (I. Castano 2008): as stated with each rule")
        }
        K::Bc1EncodeRangeFit => (
            "all texels, all sets that count",
            "J. M. P. van Waveren 2006; J. M. P. van Waveren, I. Castano 2007",
        ),
        K::Bc4Decode => {
            ("all blocks", "the format BC4 (ATI 2004; Khronos Data Format 1.3); quotients to nearest")
        }
        K::Bc4EncodeRangeFit => {
            ("all texels, all sets that count", "the format's own range; nearest entries")
        }
        // polynomial
        Kernel::PolynomialDot => {
            ("32 terms; sum of magnitudes below f32::MAX", "16 lanes and a fold, own order")
        }
        Kernel::PolynomialApply => {
            ("up to 8 patches; sums of magnitudes below f32::MAX", "B = F x, C. Goral et al. 1984")
        }
        Kernel::PolynomialApplyHalf => (
            "up to 8 patches of positive area; sums of magnitudes below f32::MAX",
            "reciprocity A_i F_ij = A_j F_ji, J. H. Lambert 1760",
        ),
        Kernel::PolynomialSeries => (
            "up to 8 patches and 64 bounces; sums of magnitudes below f32::MAX",
            "C. Neumann 1877; sum of powers by nesting, W. G. Horner 1819",
        ),
        // first_shot
        Kernel::EvenWord => ("every word; 0 to 39 bits", "one place in each of equal parts; this project"),
        Kernel::StartPlace => (
            "pieces from the whole triangle to a few steps of 2^-24; weights >= 0 with a positive sum, normal numbers; u in [0, 1)",
            "linear_triangle::sample, then the corners by barycentrics",
        ),
        Kernel::StartWithin => (
            "pieces as above, needles and pieces without area; points of the triangle; u of the magnitudes of Cramer's products over the area",
            "ratios of areas (A. F. Moebius 1827)",
        ),
        Kernel::StartDensity => (
            "pieces and points as above, up to 1e-3 beyond the edges; areas 1e-9 to 1e6 m^2, 0 and NaN",
            "Kopylov, First Shot: the linear density over a piece, times its chance over its area",
        ),
        Kernel::StartFlux => (
            "irradiance 1e-12 to 1e12 W m^-2, densities of any ratio, and what has no sense",
            "Veach 1997, section 9.2.2: E over the sum of the densities",
        ),
        Kernel::LightShare => (
            "irradiance 1e-12 to 1e12 W m^-2, densities of any ratio, and what has no sense",
            "Veach 1997, section 9.2.2, the balance heuristic",
        ),
        Kernel::LookFactor => (
            "chances 1e-6 to 1, and what is none",
            "Russian roulette: Arvo and Kirk 1990; 1 - 1/q for q asked",
        ),
        Kernel::PieceFlux => (
            "irradiance 1e-12 to 1e12 W m^-2, areas 1e-6 to 1e6 m^2, chances from 2^-32",
            "Kopylov, First Shot: all starts on a piece carry the same",
        ),
        // emit
        Kernel::EmitLight => (
            "every kind of light; u in [0, 1)^4",
            "`core::light::emit`: spots by inverting 2 x^3 - x^4, surfaces by the cosine, disks for directions",
        ),
        Kernel::EmitEnvironment => {
            ("u in [0, 1)^4", "`core::light::emit`: a sphere of directions, a disk across each")
        }
        // A kernel without an entry says nothing: the coverage test fails on it.
        _ => ("", ""),
    }
}
