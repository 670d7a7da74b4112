//! The scalar reference of every kernel.

mod bc1;
mod emission;
mod first_shot;
mod grid;
mod linear_triangle;
mod log_offset;
mod polynomial;
mod subdivide;

use super::Kernel;
use crate::backend::BackendError;
use crate::bsdf::{Facets, Finish, Lobes, diffuse, fresnel, phong};
use crate::geometry::{self, PreparedRay, Ray, RoundShape, SurfacePoint};
use crate::light;
use crate::math::{self, Vec3};
use crate::medium::{flight, phase};
use crate::sampling::counter::Counter;
use crate::sampling::sobol::{BlockSampler, Set};
use crate::sampling::{discrete, u32_to_unit, warp};
use crate::scene::{LightRecord, SRGB_CODES, TextureRecord, sample_bitmap, srgb_to_linear};
use crate::sensor::Camera;
use crate::tone::{self, ToneMap, ToneSettings};
use crate::transport::mis;
use alloc::vec::Vec;
use bytemuck::{Pod, Zeroable};

/// Reads words in order; past the end everything is zero (lengths are checked before).
struct Reader<'a>(&'a [u32]);

impl Reader<'_> {
    #[inline(always)]
    fn word(&mut self) -> u32 {
        match self.0.split_first() {
            Some((first, rest)) => {
                self.0 = rest;
                *first
            }
            None => 0,
        }
    }

    #[inline(always)]
    fn float(&mut self) -> f32 {
        f32::from_bits(self.word())
    }

    #[inline(always)]
    fn pair(&mut self) -> [f32; 2] {
        [self.float(), self.float()]
    }

    #[inline(always)]
    fn vec3(&mut self) -> Vec3 {
        Vec3::new(self.float(), self.float(), self.float())
    }

    fn ray(&mut self) -> Ray {
        Ray { origin: self.vec3(), direction: self.vec3(), t_max: self.float() }
    }

    fn facets(&mut self) -> Facets {
        if self.word() != 0 { Facets::beckmann(self.float()) } else { Facets::ggx(self.float()) }
    }

    fn lobes(&mut self) -> Lobes {
        Lobes {
            albedo: self.vec3(),
            specular: self.vec3(),
            exponent: self.float(),
            mirror: self.word() != 0,
            finish: Finish::Plain,
        }
    }

    /// A record of the compiled scene, word by word.
    fn record<T: Pod + Zeroable>(&mut self) -> T {
        let mut value = T::zeroed();
        for word in bytemuck::cast_slice_mut::<T, u32>(core::slice::from_mut(&mut value)) {
            *word = self.word();
        }
        value
    }
}

/// Writes words in order; past the end nothing (lengths are checked before).
struct Writer<'a> {
    out: &'a mut [u32],
    at: usize,
}

impl Writer<'_> {
    #[inline(always)]
    fn word(&mut self, x: u32) {
        if let Some(slot) = self.out.get_mut(self.at) {
            *slot = x;
        }
        self.at += 1;
    }

    #[inline(always)]
    fn words<const N: usize>(&mut self, x: [u32; N]) {
        for x in x {
            self.word(x);
        }
    }

    #[inline(always)]
    fn floats<const N: usize>(&mut self, x: [f32; N]) {
        for x in x {
            self.word(x.to_bits());
        }
    }

    #[inline(always)]
    fn float(&mut self, x: f32) {
        self.word(x.to_bits());
    }

    #[inline(always)]
    fn vec3(&mut self, v: Vec3) {
        self.floats(v.to_array());
    }
}

/// What a batch shares, read once.
struct Shared<'a> {
    constants: &'a [u32],
    seed: u64,
    decode: Vec<f32>,
    grid: Option<grid::Owned>,
}

fn shared(kernel: Kernel, constants: &[u32]) -> Shared<'_> {
    let at = |i: usize| u64::from(constants.get(i).copied().unwrap_or(0));
    let decode = if kernel == Kernel::SampleBitmap || kernel.module() == "emission" {
        (0..SRGB_CODES).map(|code| srgb_to_linear(code as u8)).collect()
    } else {
        Vec::new()
    };
    let grid = if kernel.module() == "grid" { grid::Owned::new(constants) } else { None };
    Shared { constants, seed: at(0) | at(1) << 32, decode, grid }
}

/// Evaluates a kernel over a batch, one item after the other.
///
/// # Errors
/// When a slice has the wrong length.
pub fn evaluate(
    kernel: Kernel,
    constants: &[u32],
    items: &[u32],
    out: &mut [u32],
) -> Result<(), BackendError> {
    let shape = kernel.check(constants, items, out)?;
    let shared = shared(kernel, constants);
    let one = evaluator(kernel);
    for (item, out) in items.chunks_exact(shape.item).zip(out.chunks_exact_mut(shape.out)) {
        // What is not written is zero.
        out.fill(0);
        one(kernel, &shared, Reader(item), &mut Writer { out, at: 0 });
    }
    Ok(())
}

type Evaluator = fn(Kernel, &Shared<'_>, Reader<'_>, &mut Writer<'_>);

/// The function that evaluates the kernels of a module.
fn evaluator(kernel: Kernel) -> Evaluator {
    match kernel.module() {
        "linear_triangle" => linear_triangle::one,
        "emission" => emission::one,
        "subdivide" => subdivide::one,
        "log_offset" => log_offset::one,
        "bc1" | "bc4" => bc1::one,
        "polynomial" => polynomial::one,
        "first_shot" | "emit" => first_shot::one,
        "grid" => grid::one,
        _ => one,
    }
}

fn one(kernel: Kernel, shared: &Shared<'_>, mut r: Reader<'_>, w: &mut Writer<'_>) {
    use Kernel as K;
    match kernel {
        K::Ln => w.float(math::ln(r.float())),
        K::Log2 => w.float(math::log2(r.float())),
        K::Exp => w.float(math::exp(r.float())),
        K::Exp2 => w.float(math::exp2(r.float())),
        K::Pow => w.float(math::pow(r.float(), r.float())),
        K::SinCos => {
            let (s, c) = math::sin_cos(r.float());
            w.floats([s, c]);
        }
        K::Acos => w.float(math::acos(r.float())),
        K::Asin => w.float(math::asin(r.float())),
        K::Atan2 => w.float(math::atan2(r.float(), r.float())),
        K::Cbrt => w.float(math::cbrt(r.float())),
        K::Sqrt => w.float(math::sqrt(r.float())),
        K::NormalizeOr => w.vec3(math::normalize_or(r.vec3(), r.vec3())),
        K::OrthonormalBasis => {
            let (t, b) = math::orthonormal_basis(r.vec3());
            w.vec3(t);
            w.vec3(b);
        }
        K::U32ToUnit => w.float(u32_to_unit(r.word())),
        K::CounterBits4 => {
            w.words(Counter::new(shared.seed).bits4(r.word(), r.word(), r.word()));
        }
        K::SobolBits4 => {
            let sampler = BlockSampler::new(shared.seed, r.word(), r.word(), r.word());
            w.words(sampler.bits4(r.word()));
        }
        K::SobolSet => w.word(Set::new(shared.seed).dimension(r.word(), r.word())),
        K::CdfPick => {
            let pick = discrete::pick_in(shared.constants, r.word());
            w.word(pick.index);
            w.float(pick.pmf);
            w.word(pick.remainder);
        }
        K::CdfPmf => w.float(discrete::pmf_in(shared.constants, r.word())),
        K::EvenWord => w.word(discrete::even_word(r.word(), r.word(), r.word())),
        K::Triangle => {
            let ray = r.ray();
            let vertices = [r.vec3(), r.vec3(), r.vec3()];
            if let Some(hit) = geometry::intersect_triangle(&PreparedRay::new(&ray), vertices, ray.t_max) {
                w.word(1);
                w.floats([hit.t, hit.b1, hit.b2]);
            }
        }
        K::Slab => {
            let ray = r.ray();
            let (low, high) = (r.vec3(), r.vec3());
            if let Some(entry) = geometry::slab_entry(&PreparedRay::new(&ray), low, high, ray.t_max) {
                w.word(1);
                w.float(entry);
            }
        }
        K::RoundShape => {
            let ray = r.ray();
            let shape: RoundShape = r.record();
            if let Some(t) = geometry::intersect_shape(&PreparedRay::new(&ray), &shape, ray.t_max) {
                w.word(1);
                w.float(t);
            }
        }
        K::OffsetOrigin => {
            let p = SurfacePoint { position: r.vec3(), extent: r.float() };
            w.vec3(geometry::offset_origin(&p, r.vec3(), r.vec3()));
        }
        K::EvalDiffuse => w.vec3(diffuse::eval(r.vec3(), r.vec3(), r.vec3())),
        K::PdfDiffuse => w.float(diffuse::pdf_solid_angle(r.vec3(), r.vec3())),
        K::SampleDiffuse => w.vec3(diffuse::sample(r.vec3(), r.pair())),
        K::EvalPhong => w.vec3(phong::eval(r.vec3(), r.float(), r.vec3(), r.vec3(), r.vec3())),
        K::PdfPhong => w.float(phong::pdf_solid_angle(r.float(), r.vec3(), r.vec3(), r.vec3())),
        K::FacetsDensity => w.float(r.facets().density(r.vec3(), r.vec3())),
        K::FacetsMasking => w.float(r.facets().masking(r.vec3(), r.vec3())),
        K::PdfVisible => w.float(r.facets().pdf_visible(r.vec3(), r.vec3(), r.vec3())),
        K::SampleVisible => w.vec3(r.facets().sample_visible(r.vec3(), r.vec3(), r.pair())),
        K::SamplePhong => w.vec3(phong::sample(r.float(), r.vec3(), r.vec3(), r.pair())),
        K::EvalLobes => w.vec3(r.lobes().eval(r.vec3(), r.vec3(), r.vec3())),
        K::PdfLobes => w.float(r.lobes().pdf_solid_angle(r.vec3(), r.vec3(), r.vec3())),
        K::SampleLobes => {
            if let Some(s) = r.lobes().sample(r.vec3(), r.vec3(), r.pair(), r.float()) {
                w.word(1);
                w.vec3(s.wi);
                w.vec3(s.weight);
                w.float(s.pdf);
            }
        }
        K::EvalPhase => w.float(phase::eval(r.float(), r.vec3(), r.vec3())),
        K::SamplePhase => w.vec3(phase::sample(r.float(), r.vec3(), r.pair())),
        K::Transmittance => w.vec3(flight::transmittance(r.vec3(), r.float())),
        K::FresnelDielectric => w.float(fresnel::dielectric(r.float(), r.float())),
        K::FresnelConductor => w.float(fresnel::conductor(r.float(), r.float(), r.float())),
        K::SampleLight => {
            let record: LightRecord = Reader(shared.constants).record();
            if let Some(s) = light::sample(&record, r.vec3(), r.pair()) {
                w.word(1);
                w.vec3(s.wi);
                w.vec3(s.contribution);
                w.float(s.pdf);
                w.vec3(s.point);
                w.vec3(s.normal);
                w.float(s.extent);
                w.word(u32::from(s.distant));
            }
        }
        K::PdfLight => {
            let record: LightRecord = Reader(shared.constants).record();
            w.float(light::pdf_solid_angle(&record, r.vec3(), r.vec3(), r.float(), r.vec3()));
        }
        K::PowerHeuristic => w.float(mis::power_heuristic(r.float(), r.float())),
        K::CameraRay => {
            let camera: Camera = Reader(shared.constants).record();
            let ray = camera.sample_ray(r.word(), r.word(), r.pair(), r.pair());
            w.vec3(ray.origin);
            w.vec3(ray.direction);
        }
        K::ToneDisplay => {
            let mut c = Reader(shared.constants);
            let map = match c.word() {
                0 => ToneMap::Reinhard,
                1 => ToneMap::Gamma,
                _ => ToneMap::None,
            };
            let [exposure, gamma_a, gamma_c, gamma] = [c.float(), c.float(), c.float(), c.float()];
            let settings = ToneSettings { map, exposure, gamma_a, gamma_c, gamma };
            w.floats(tone::display(settings, r.vec3().to_array()));
        }
        K::SrgbDecode => w.float(srgb_to_linear((r.word() & 255) as u8)),
        K::SampleBitmap => {
            let texels = shared.constants.get(2..).unwrap_or(&[]);
            let [width, height] = [0, 1].map(|i| shared.constants.get(i).copied().unwrap_or(1).max(1));
            let record = TextureRecord { width, height, first_texel: 0, pad: 0 };
            w.vec3(sample_bitmap(&record, texels, &shared.decode, r.pair()));
        }
        _ => warps(kernel, shared, r, w),
    }
}

fn warps(kernel: Kernel, shared: &Shared<'_>, mut r: Reader<'_>, w: &mut Writer<'_>) {
    use Kernel as K;
    match kernel {
        K::SampleSphere => w.vec3(warp::sample_sphere(r.pair())),
        K::PdfSphere => w.float(warp::pdf_solid_angle_sphere(r.vec3())),
        K::InvertSphere => w.floats(warp::invert_sphere(r.vec3())),
        K::SampleHemisphere => w.vec3(warp::sample_hemisphere(r.pair())),
        K::PdfHemisphere => w.float(warp::pdf_solid_angle_hemisphere(r.vec3())),
        K::InvertHemisphere => w.floats(warp::invert_hemisphere(r.vec3())),
        K::SampleCosineHemisphere => w.vec3(warp::sample_cosine_hemisphere(r.pair())),
        K::PdfCosineHemisphere => w.float(warp::pdf_solid_angle_cosine_hemisphere(r.vec3())),
        K::InvertCosineHemisphere => w.floats(warp::invert_cosine_hemisphere(r.vec3())),
        K::SampleCone => w.vec3(warp::sample_cone(r.pair(), r.float())),
        K::PdfCone => {
            let (direction, size) = (r.vec3(), r.float());
            w.float(warp::pdf_solid_angle_cone(size, direction));
        }
        K::InvertCone => {
            let (direction, size) = (r.vec3(), r.float());
            w.floats(warp::invert_cone(size, direction));
        }
        K::SamplePowerCosine => w.vec3(warp::sample_power_cosine(r.pair(), r.float())),
        K::PdfPowerCosine => {
            let (direction, exponent) = (r.vec3(), r.float());
            w.float(warp::pdf_solid_angle_power_cosine(exponent, direction));
        }
        K::InvertPowerCosine => {
            let (direction, exponent) = (r.vec3(), r.float());
            w.floats(warp::invert_power_cosine(exponent, direction));
        }
        K::SampleDisk => w.floats(warp::sample_disk(r.pair())),
        K::PdfDisk => w.float(warp::pdf_area_disk(r.pair())),
        K::InvertDisk => w.floats(warp::invert_disk(r.pair())),
        K::SampleTriangle => w.floats(warp::sample_triangle(r.pair())),
        K::PdfTriangle => w.float(warp::pdf_area_triangle(r.vec3(), r.vec3())),
        K::InvertTriangle => w.floats(warp::invert_triangle([r.float(), r.float(), r.float()])),
        K::PdfParallelogram => w.float(warp::pdf_area_parallelogram(r.vec3(), r.vec3())),
        K::SampleParallelogram => {
            let mut c = Reader(shared.constants);
            w.vec3(warp::sample_parallelogram(r.pair(), c.vec3(), c.vec3(), c.vec3()));
        }
        K::InvertParallelogram => {
            let mut c = Reader(shared.constants);
            w.floats(warp::invert_parallelogram(c.vec3(), c.vec3(), c.vec3(), r.vec3()));
        }
        _ => {}
    }
}
