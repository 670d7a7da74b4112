//! Named numeric kernels: the door through which the conformance suite reaches a backend's math.
//!
//! A kernel is a pure function from a few words per batch (the constants) and a few words per item to a few words per
//! item. Words are u32; floats travel as their bits, `vec3` is three words, a flag is 0 or 1. Where a kernel gives
//! "nothing" (a ray that misses, a light that sends nothing) the flag is 0 and so are the other words.
//! [`evaluate`] is the scalar reference: it calls core's own functions and adds nothing to them.

mod evaluate;

use crate::backend::BackendError;

pub use evaluate::evaluate;

/// How many words a kernel takes and gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KernelShape {
    /// Words shared by the batch: exactly so many, or at least so many where `open` is set.
    pub constants: usize,
    /// The constants end with a table of any length (a cumulative distribution, texels).
    pub open: bool,
    /// Words per item.
    pub item: usize,
    /// Words per result.
    pub out: usize,
}

const fn exact(constants: usize, item: usize, out: usize) -> KernelShape {
    KernelShape { constants, open: false, item, out }
}

const fn table(constants: usize, item: usize, out: usize) -> KernelShape {
    KernelShape { constants, open: true, item, out }
}

macro_rules! kernels {
    ($($(#[$doc:meta])* $variant:ident = $name:literal, $shape:expr;)*) => {
        /// The kernels. Each variant's doc names its words: constants | item -> out.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[non_exhaustive]
        pub enum Kernel {
            $($(#[$doc])* $variant,)*
        }

        impl Kernel {
            /// Every kernel.
            pub const ALL: &'static [Kernel] = &[$(Kernel::$variant),*];

            /// Name `module::function`, stable across versions.
            pub fn name(self) -> &'static str {
                match self {
                    $(Kernel::$variant => $name,)*
                }
            }

            /// Word counts.
            pub fn shape(self) -> KernelShape {
                match self {
                    $(Kernel::$variant => $shape,)*
                }
            }
        }
    };
}

kernels! {
    /// x -> ln x.
    Ln = "math::ln", exact(0, 1, 1);
    /// x -> log2 x.
    Log2 = "math::log2", exact(0, 1, 1);
    /// x -> e^x.
    Exp = "math::exp", exact(0, 1, 1);
    /// x -> 2^x.
    Exp2 = "math::exp2", exact(0, 1, 1);
    /// x, y -> x^y.
    Pow = "math::pow", exact(0, 2, 1);
    /// x -> sin x, cos x.
    SinCos = "math::sin_cos", exact(0, 1, 2);
    /// x -> acos x.
    Acos = "math::acos", exact(0, 1, 1);
    /// x -> asin x.
    Asin = "math::asin", exact(0, 1, 1);
    /// y, x -> the angle of (x, y).
    Atan2 = "math::atan2", exact(0, 2, 1);
    /// x -> cube root of x.
    Cbrt = "math::cbrt", exact(0, 1, 1);
    /// x -> square root of x.
    Sqrt = "math::sqrt", exact(0, 1, 1);
    /// v (vec3), fallback (vec3) -> v / |v| (vec3).
    NormalizeOr = "math::normalize_or", exact(0, 6, 3);
    /// unit n (vec3) -> t (vec3), b (vec3).
    OrthonormalBasis = "math::orthonormal_basis", exact(0, 3, 6);

    /// word -> unit number.
    U32ToUnit = "sampling::u32_to_unit", exact(0, 1, 1);
    /// seed low, seed high | stream, sample, group -> four words.
    CounterBits4 = "counter::bits4", exact(2, 3, 4);
    /// seed low, seed high | stream, block, index, group -> four words.
    SobolBits4 = "sobol::bits4", exact(2, 4, 4);
    /// seed low, seed high | index, dimension -> word.
    SobolSet = "sobol::set_dimension", exact(2, 2, 1);
    /// cumulative counts (at least one word) | word -> index, pmf, remainder.
    CdfPick = "discrete::pick_in", table(1, 1, 3);
    /// cumulative counts (at least one word) | index -> pmf.
    CdfPmf = "discrete::pmf_in", table(1, 1, 1);

    /// u (2) -> w (vec3).
    SampleSphere = "warp::sample_sphere", exact(0, 2, 3);
    /// w (vec3) -> density.
    PdfSphere = "warp::pdf_solid_angle_sphere", exact(0, 3, 1);
    /// w (vec3) -> u (2).
    InvertSphere = "warp::invert_sphere", exact(0, 3, 2);
    /// u (2) -> w (vec3).
    SampleHemisphere = "warp::sample_hemisphere", exact(0, 2, 3);
    /// w (vec3) -> density.
    PdfHemisphere = "warp::pdf_solid_angle_hemisphere", exact(0, 3, 1);
    /// w (vec3) -> u (2).
    InvertHemisphere = "warp::invert_hemisphere", exact(0, 3, 2);
    /// u (2) -> w (vec3).
    SampleCosineHemisphere = "warp::sample_cosine_hemisphere", exact(0, 2, 3);
    /// w (vec3) -> density.
    PdfCosineHemisphere = "warp::pdf_solid_angle_cosine_hemisphere", exact(0, 3, 1);
    /// w (vec3) -> u (2).
    InvertCosineHemisphere = "warp::invert_cosine_hemisphere", exact(0, 3, 2);
    /// u (2), 1 - cos of the half-angle -> w (vec3).
    SampleCone = "warp::sample_cone", exact(0, 3, 3);
    /// w (vec3), 1 - cos of the half-angle -> density.
    PdfCone = "warp::pdf_solid_angle_cone", exact(0, 4, 1);
    /// w (vec3), 1 - cos of the half-angle -> u (2).
    InvertCone = "warp::invert_cone", exact(0, 4, 2);
    /// u (2), exponent -> w (vec3).
    SamplePowerCosine = "warp::sample_power_cosine", exact(0, 3, 3);
    /// w (vec3), exponent -> density.
    PdfPowerCosine = "warp::pdf_solid_angle_power_cosine", exact(0, 4, 1);
    /// w (vec3), exponent -> u (2).
    InvertPowerCosine = "warp::invert_power_cosine", exact(0, 4, 2);
    /// u (2) -> point (2).
    SampleDisk = "warp::sample_disk", exact(0, 2, 2);
    /// point (2) -> density.
    PdfDisk = "warp::pdf_area_disk", exact(0, 2, 1);
    /// point (2) -> u (2).
    InvertDisk = "warp::invert_disk", exact(0, 2, 2);
    /// u (2) -> barycentrics (3).
    SampleTriangle = "warp::sample_triangle", exact(0, 2, 3);
    /// edge (vec3), edge (vec3) -> density.
    PdfTriangle = "warp::pdf_area_triangle", exact(0, 6, 1);
    /// barycentrics (3) -> u (2).
    InvertTriangle = "warp::invert_triangle", exact(0, 3, 2);
    /// origin, edge, edge (vec3 each) | u (2) -> point (vec3).
    SampleParallelogram = "warp::sample_parallelogram", exact(9, 2, 3);
    /// edge (vec3), edge (vec3) -> density.
    PdfParallelogram = "warp::pdf_area_parallelogram", exact(0, 6, 1);
    /// origin, edge, edge (vec3 each) | point (vec3) -> u (2).
    InvertParallelogram = "warp::invert_parallelogram", exact(9, 3, 2);

    /// origin, direction, t_max, three vertices (16 words) -> flag, t, b1, b2.
    Triangle = "geometry::intersect_triangle", exact(0, 16, 4);
    /// origin, direction, t_max, low corner, high corner (13 words) -> flag, entry.
    Slab = "geometry::slab_entry", exact(0, 13, 2);
    /// origin, direction, t_max, `RoundShape` (15 words) -> flag, t.
    RoundShape = "geometry::intersect_shape", exact(0, 15, 2);
    /// position (vec3), extent, unit normal (vec3), toward (vec3) -> origin (vec3).
    OffsetOrigin = "geometry::offset_origin", exact(0, 10, 3);

    /// albedo, n, wi (vec3 each) -> f (vec3).
    EvalDiffuse = "diffuse::eval", exact(0, 9, 3);
    /// n, wi (vec3 each) -> density.
    PdfDiffuse = "diffuse::pdf_solid_angle", exact(0, 6, 1);
    /// n (vec3), u (2) -> wi (vec3).
    SampleDiffuse = "diffuse::sample", exact(0, 5, 3);
    /// specular (vec3), exponent, n, wo, wi (vec3 each) -> f (vec3).
    EvalPhong = "phong::eval", exact(0, 13, 3);
    /// exponent, n, wo, wi (vec3 each) -> density.
    PdfPhong = "phong::pdf_solid_angle", exact(0, 10, 1);
    /// exponent, n, wo (vec3 each), u (2) -> wi (vec3).
    SamplePhong = "phong::sample", exact(0, 9, 3);
    /// albedo, specular (vec3 each), exponent, mirror flag, n, wo, wi (vec3 each) -> f (vec3).
    EvalLobes = "lobes::eval", exact(0, 17, 3);
    /// albedo, specular (vec3 each), exponent, mirror flag, n, wo, wi (vec3 each) -> density.
    PdfLobes = "lobes::pdf_solid_angle", exact(0, 17, 1);
    /// albedo, specular (vec3 each), exponent, mirror flag, n, wo (vec3 each), u (2), lobe -> flag, wi, weight (vec3
    /// each), density.
    SampleLobes = "lobes::sample", exact(0, 17, 8);

    /// g, wo, wi (vec3 each) -> density.
    EvalPhase = "phase::eval", exact(0, 7, 1);
    /// g, wo (vec3), u (2) -> wi (vec3).
    SamplePhase = "phase::sample", exact(0, 6, 3);
    /// sigma_t (vec3), length -> transmittance (vec3).
    Transmittance = "flight::transmittance", exact(0, 4, 3);
    // A grid is its size (3), channels (1 or 3), three rows of the map to cells (4 each), and its values.
    /// grid | point (vec3) -> value (vec3).
    GridAt = "grid::at", table(16, 3, 3);
    /// grid | origin, unit direction (vec3 each), length -> integral of the value (vec3).
    GridOpticalLength = "grid::optical_length", table(16, 7, 3);
    /// cosine, ratio of indices -> reflectance.
    FresnelDielectric = "fresnel::dielectric", exact(0, 2, 1);
    /// cosine, eta, k -> reflectance.
    FresnelConductor = "fresnel::conductor", exact(0, 3, 1);

    /// `LightRecord` (24 words) | p (vec3), u (2) -> flag, wi, contribution (vec3 each), density, point, normal (vec3
    /// each), extent, distant flag.
    SampleLight = "light::sample", exact(24, 5, 16);
    /// `LightRecord` (24 words) | p, wi (vec3 each), distance, normal (vec3) -> density.
    PdfLight = "light::pdf_solid_angle", exact(24, 10, 1);
    /// a, b -> weight.
    PowerHeuristic = "mis::power_heuristic", exact(0, 2, 1);
    /// `Camera` (16 words) | x, y, u (2), lens (2) -> origin, direction (vec3 each).
    CameraRay = "camera::sample_ray", exact(16, 6, 6);
    /// curve (0 Reinhard, 1 gamma, 2 none), exposure, a, c, gamma | rgb -> display rgb.
    ToneDisplay = "tone::display", exact(5, 3, 3);
    /// code (0 to 255; higher bits are ignored) -> linear value.
    SrgbDecode = "bitmap::srgb_to_linear", exact(0, 1, 1);
    /// width, height, texels (0x00BBGGRR) | u, v -> rgb.
    SampleBitmap = "bitmap::sample_bitmap", table(3, 2, 3);

    // linear_triangle
    /// weights (3), u (2) -> barycentrics (3).
    SampleLinearTriangle = "linear_triangle::sample", exact(0, 5, 3);
    /// weights (3), barycentrics (3) -> density.
    PdfLinearTriangle = "linear_triangle::pdf", exact(0, 6, 1);
    /// weights (3), barycentrics (3) -> u (2).
    InvertLinearTriangle = "linear_triangle::invert", exact(0, 6, 2);
    /// weights (3), u -> apex, distance, complement.
    LinearTriangleDistance = "linear_triangle::apex_distance", exact(0, 4, 3);
    // emission
    /// three vertices (vec3 each), albedo (vec3), irradiance at the vertices (vec3 each) -> emission (vec3), area.
    EmissionCoefficient = "emission::coefficient", exact(0, 21, 4);
    /// texel coordinates of three vertices (2 each) -> share of the triangle in the cell [0, 1]^2, mean barycentrics (3).
    EmissionOverlap = "emission::overlap", exact(0, 6, 4);
    /// width, height, texels (0x00BBGGRR) | uv of three vertices (2 each) -> flag (at most 4096 cells), albedo at the
    /// vertices (vec3 each) under the bilinear filter.
    EmissionScan = "emission::scan", table(3, 6, 10);
    /// width, height, texels (0x00BBGGRR) | uv of three vertices (2 each) -> flag (at most 4096 texels), albedo at the
    /// vertices (vec3 each) with constant texels.
    EmissionScanTexels = "emission::scan_texels", table(3, 6, 10);
    /// width, height, texels (0x00BBGGRR) | uv of three vertices (2 each) -> bound (vec3).
    EmissionBrightest = "emission::brightest_in", table(3, 6, 3);

    // subdivide
    /// relative, absolute tolerance | corners (3 vec3), irradiance at corners, at midpoints opposite corners 0 to 2, at the
    /// centroid (7) -> how many pieces (1: accepted), then 4 words, each a piece's three corners as indices of the seven
    /// points, four bits each, the first lowest (0 where there is no such piece).
    SubdividePublished = "subdivide::published", exact(2, 16, 5);
    /// relative, absolute, share tolerance | corners (3 vec3), irradiance at the seven points (7), share of the parent's area, expected error
    /// -> how many pieces, 4 words as above, error, error and largest deviation expected of the worst piece (0 if accepted).
    SubdivideRobust = "subdivide::robust", exact(3, 18, 8);
    // log_offset
    /// 255 thresholds, never decreasing | x -> code.
    LogOffsetEncode = "log_offset::encode", exact(255, 1, 1);
    /// 256 numbers | code (higher bits are ignored) -> number.
    LogOffsetLookUp = "log_offset::look_up", exact(256, 1, 1);
    /// width, max | level (0 to 255, fractions too) -> number.
    LogOffsetDecode = "log_offset::decode", exact(2, 1, 1);
    /// width, max | level (0 to 255, fractions too) -> mean of the cell.
    LogOffsetDecodeMean = "log_offset::decode_mean", exact(2, 1, 1);
    // bc1
    /// both endpoints, indices -> 16 texels (0x00BBGGRR).
    Bc1Decode = "bc1::decode", exact(0, 2, 16);
    /// rule (its place in `Rule::ALL`; others are the first) | both endpoints, indices -> 16 texels (0xAABBGGRR).
    Bc1DecodeWith = "bc1::decode_with", exact(1, 2, 16);
    /// 16 texels (0x00BBGGRR), bits of those that count -> both endpoints, indices.
    Bc1EncodeRangeFit = "bc1::encode_range_fit", exact(0, 17, 2);
    /// endpoints and indices (2) -> 16 texels.
    Bc4Decode = "bc4::decode", exact(0, 2, 16);
    /// 16 texels (the lowest byte of each word), bits of those that count -> endpoints and indices (2).
    Bc4EncodeRangeFit = "bc4::encode_range_fit", exact(0, 17, 2);
    // polynomial
    /// a (32), x (32) -> sum of a_j x_j in 16 lanes.
    PolynomialDot = "polynomial::dot", exact(0, 64, 1);
    /// n (up to 8), n^2 entries of A by rows | x (8) -> A x (8; 0 beyond n).
    PolynomialApply = "polynomial::apply", table(1, 8, 8);
    /// n (up to 8), n areas, the lower half of a symmetric S by rows | x (8) -> A^-1 S x (8; 0 beyond n).
    PolynomialApplyHalf = "polynomial::apply_half", table(1, 8, 8);
    /// n (up to 8), k (up to 64), n^2 entries of A by rows | b (8) -> (A + ... + A^k) b (8; 0 beyond n).
    PolynomialSeries = "polynomial::series", table(2, 8, 8);
    // first_shot: a piece's corners are the second and third barycentrics of each in steps of 2^-24; outside the triangle they are nothing.
    /// index, shift, bits -> word.
    EvenWord = "discrete::even_word", exact(0, 3, 1);
    /// corners (6), weights (3), u (2) -> barycentrics on the triangle (3).
    StartPlace = "first_shot::place", exact(0, 11, 3);
    /// corners (6), second and third barycentric on the triangle -> flag, barycentrics on the piece (3).
    StartWithin = "first_shot::within", exact(0, 8, 4);
    /// corners (6), weights (3), area, pmf, second and third barycentric on the triangle -> density per area.
    StartDensity = "first_shot::density", exact(0, 13, 1);
    /// irradiance (vec3), density, chance per watt -> flux (vec3).
    StartFlux = "first_shot::start_flux", exact(0, 5, 3);
    /// irradiance (vec3), density, chance per watt -> share.
    LightShare = "first_shot::light_share", exact(0, 5, 1);
    /// chance, blocked flag -> factor.
    LookFactor = "first_shot::look_factor", exact(0, 2, 1);
    /// colour (vec3), weights (3), area, pmf -> flux (vec3).
    PieceFlux = "first_shot::piece_flux", exact(0, 8, 3);
    // emit
    /// `LightRecord` (24 words), the scene's bounding sphere (4) | u (4) -> origin, direction, flux (vec3 each).
    EmitLight = "emit::emit", exact(28, 4, 9);
    /// radiance (vec3), the scene's bounding sphere (4) | u (4) -> origin, direction, flux (vec3 each).
    EmitEnvironment = "emit::emit_environment", exact(7, 4, 9);
    // facets
    /// Beckmann flag, alpha, n, m (vec3 each) -> density.
    FacetsDensity = "facets::density", exact(0, 8, 1);
    /// Beckmann flag, alpha, n, v (vec3 each) -> share.
    FacetsMasking = "facets::masking", exact(0, 8, 1);
    /// Beckmann flag, alpha, n, wo, m (vec3 each) -> density.
    PdfVisible = "facets::pdf_visible", exact(0, 11, 1);
    /// Beckmann flag, alpha, n, wo (vec3 each), u (2) -> m (vec3).
    SampleVisible = "facets::sample_visible", exact(0, 10, 3);
}

impl Kernel {
    /// The first half of its name.
    pub fn module(self) -> &'static str {
        self.name().split("::").next().unwrap_or("")
    }

    /// Checks slices against the shape.
    ///
    /// # Errors
    /// The first slice of wrong length.
    pub fn check(self, constants: &[u32], items: &[u32], out: &[u32]) -> Result<KernelShape, BackendError> {
        let shape = self.shape();
        let wrong = |slice, found, expected| {
            Err(BackendError::WrongLength { kernel: self.name(), slice, found, expected })
        };
        let fits =
            |found: usize| if shape.open { found >= shape.constants } else { found == shape.constants };
        if !fits(constants.len()) {
            return wrong("constants", constants.len(), shape.constants);
        }
        let count = items.len() / shape.item.max(1);
        if items.len() != count * shape.item {
            return wrong("items", items.len(), count * shape.item);
        }
        if out.len() != count * shape.out {
            return wrong("out", out.len(), count * shape.out);
        }
        Ok(shape)
    }
}
