//! Photons: flux that walks from a start through the scene and is registered wherever it arrives.
//!
//! A photon carries flux \[W\] per channel. At each hit it arrives (its flux counts for the irradiance of that surface), and then lives on into a
//! direction by the lobes, with the share of its flux, mean of the channels, that they let through; `f cos / pdf` is divided by that chance, so that
//! the mean is carried unchanged and dark surfaces end walks. Interpolated normals are not symmetric between light and sensor: photons take Veach's factor
//! (1997, section 5.3.2), |wo n_s| |wi n_g| / (|wo n_g| |wi n_s|).
//!
//! Starts: [`LightPlan`] picks a light by flux, the classical way ([`crate::light::emit`]).

use super::{Surface, surface_at};
use crate::geometry::{Hit, PrimitiveId, Ray};
use crate::light::emit::{self, Emission};
use crate::math::{self, Vec3};
use crate::sampling::discrete::{IntegerCdf, WeightError};
use crate::sampling::sobol::BlockSampler;
use crate::scene::CompiledScene;
use alloc::vec::Vec;

/// Largest chance to survive a hit, so that walks end even in a closed room of albedo 1.
const SURVIVAL_MAX: f32 = 0.95;
/// Groups of sample dimensions: the start, the choice of the light, then one for each hit.
pub(super) const START_GROUP: u32 = 0;
pub(super) const PICK_GROUP: u32 = 1;
const WALK_GROUP: u32 = 2;

/// A photon between two hits.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    sampler: BlockSampler,
    /// Flux per channel \[W\], as if it were the only photon.
    pub flux: Vec3,
    /// Where it flies.
    pub ray: Ray,
    /// Hits so far.
    pub hits: u32,
    /// Whether its first arrival is registered: not where direct light is known in closed form.
    pub registers_first: bool,
}

impl Photon {
    /// A photon on its first flight, whose first arrival counts.
    #[inline]
    pub fn new(sampler: BlockSampler, ray: Ray, flux: Vec3) -> Self {
        Self { sampler, flux, ray, hits: 0, registers_first: true }
    }
}

/// Flux that arrives at a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Where.
    pub primitive: PrimitiveId,
    /// Barycentric of vertex 1.
    pub b1: f32,
    /// Barycentric of vertex 2.
    pub b2: f32,
    /// At the front of the surface.
    pub from_front: bool,
    /// Flux per channel \[W\], as if the photon were the only one.
    pub flux: Vec3,
}

/// What emits in a scene, and how often each is picked: by its mean flux.
#[derive(Clone, Debug)]
pub struct LightPlan {
    /// Lights, then the environment where there is one.
    cdf: IntegerCdf,
    fluxes: Vec<Vec3>,
    sphere: (Vec3, f32),
}

impl LightPlan {
    /// The plan of a scene.
    ///
    /// # Errors
    /// When nothing in the scene emits, or fluxes are not finite.
    pub fn new(scene: &CompiledScene) -> Result<Self, WeightError> {
        let sphere = scene.bounding_sphere();
        let mut fluxes: Vec<Vec3> = scene.lights.iter().map(|l| emit::flux(l, sphere.1)).collect();
        let environment = Vec3::from_array(scene.environment);
        if environment != Vec3::ZERO {
            fluxes.push(emit::environment_flux(environment, sphere.1));
        }
        let weights: Vec<f32> = fluxes.iter().map(|f| math::mean(*f)).collect();
        Ok(Self { cdf: IntegerCdf::try_new(&weights)?, fluxes, sphere })
    }

    /// Flux of everything that emits \[W\] per channel; of what comes from infinity, what reaches the scene's bounding sphere.
    pub fn total(&self) -> [f64; 3] {
        [0, 1, 2].map(|c| self.fluxes.iter().map(|f| f64::from(f[c])).sum())
    }

    /// A photon's start: its flight, its flux divided by the chance of its light, and whether that light is without size.
    #[inline]
    pub fn start(&self, scene: &CompiledScene, sampler: &BlockSampler) -> (Emission, bool) {
        let u = sampler.group4(START_GROUP);
        let pick = if self.fluxes.len() > 1 { sampler.bits2(PICK_GROUP)[0] } else { 0 };
        let pick = self.cdf.pick(pick);
        let (mut emission, point_like) = match scene.lights.get(pick.index as usize) {
            Some(light) => (emit::emit(light, self.sphere, u), emit::is_point_like(light)),
            None => (emit::emit_environment(Vec3::from_array(scene.environment), self.sphere, u), false),
        };
        emission.flux /= pick.pmf;
        (emission, point_like)
    }
}

/// The walk, with the code that a scene needs (see [`super::TransportCode`]).
#[derive(Clone, Copy, Debug)]
pub struct PhotonTracer<'a, const LOBES: bool, const TEXTURES: bool, const SHADING: bool> {
    scene: &'a CompiledScene,
    max_hits: u32,
}

impl<'a, const LOBES: bool, const TEXTURES: bool, const SHADING: bool>
    PhotonTracer<'a, LOBES, TEXTURES, SHADING>
{
    /// A tracer of photons that arrive at most `max_hits` times.
    pub fn new(scene: &'a CompiledScene, max_hits: u32) -> Self {
        Self { scene, max_hits }
    }

    /// A photon from the lights. With `registers_direct` all first arrivals count, else only those that no closed form knows.
    #[inline]
    pub fn start_from_lights(
        &self,
        plan: &LightPlan,
        sampler: BlockSampler,
        registers_direct: bool,
    ) -> Photon {
        let (emission, point_like) = plan.start(self.scene, &sampler);
        Photon {
            sampler,
            flux: emission.flux,
            ray: emission.ray,
            hits: 0,
            registers_first: registers_direct || !point_like,
        }
    }

    /// The photon has reached a surface, or nothing: what arrives, and whether it flies on.
    #[inline(always)]
    pub fn advance(&self, photon: &mut Photon, hit: Option<Hit>) -> (Option<Arrival>, bool) {
        // A photon that starts on a surface has arrived once already.
        let Some(hit) = hit.filter(|_| photon.hits < self.max_hits) else { return (None, false) };
        let Some(surface) = surface_at::<LOBES, TEXTURES, SHADING>(self.scene, &photon.ray, &hit) else {
            return (None, false);
        };
        let counts = photon.hits > 0 || photon.registers_first;
        let arrival = counts.then_some(Arrival {
            primitive: hit.primitive,
            b1: hit.b1,
            b2: hit.b2,
            from_front: surface.from_front,
            flux: photon.flux,
        });
        let group = WALK_GROUP.wrapping_add(photon.hits);
        photon.hits += 1;
        if photon.hits >= self.max_hits {
            return (arrival, false);
        }
        let [u, v, lobe, survive] = photon.sampler.group4(group);
        let Some((wi, weight)) = self.leave(&surface, [u, v], lobe) else { return (arrival, false) };
        // The chance keeps the mean of the channels that are carried, so that no channel ever exceeds three times the start's mean. The mean of
        // the weight would not do: where one channel survives best, its share of the flux grows, and its variance without bound.
        let (before, after) = (math::mean(photon.flux), photon.flux * weight);
        let chance = (math::mean(after) / before.max(f32::MIN_POSITIVE)).min(SURVIVAL_MAX);
        if survive >= chance {
            return (arrival, false);
        }
        photon.flux = after / chance;
        photon.ray = Ray { origin: surface.leave(wi), direction: wi, t_max: f32::MAX };
        (arrival, true)
    }

    /// A direction in which flux leaves a surface, and what it is multiplied by.
    #[inline(always)]
    fn leave(&self, surface: &Surface, u: [f32; 2], lobe: f32) -> Option<(Vec3, Vec3)> {
        let s = surface.lobes.sample(surface.shading, surface.wo, u, lobe)?;
        if !SHADING {
            return Some((s.wi, s.weight));
        }
        let (before, after) = (surface.wo.dot(surface.geometric), s.wi.dot(surface.geometric));
        if after <= 0.0 {
            return None;
        }
        let down = before * s.wi.dot(surface.shading);
        // Unbounded at grazing angles; the limit is a bias, of what leaves or arrives within 4 degrees of the surface where normals are interpolated.
        let factor =
            if down > 0.0 { (surface.wo.dot(surface.shading) * after / down).clamp(0.0, 16.0) } else { 0.0 };
        Some((s.wi, s.weight * factor))
    }

    /// A photon that starts where light without size arrives: `flux` \[W\] is what arrives at a point of a triangle along `ray`, as if it were the only one.
    /// It leaves by the lobes with what they let through; `None` where nothing does.
    #[inline]
    pub fn start_on_surface(
        &self,
        hit: &Hit,
        ray: &Ray,
        flux: Vec3,
        sampler: BlockSampler,
    ) -> Option<Photon> {
        let surface = surface_at::<LOBES, TEXTURES, SHADING>(self.scene, ray, hit)?;
        let [u, v, lobe, _] = sampler.group4(WALK_GROUP);
        let (wi, weight) = self.leave(&surface, [u, v], lobe)?;
        let flux = flux * weight;
        let ray = Ray { origin: surface.leave(wi), direction: wi, t_max: f32::MAX };
        (flux != Vec3::ZERO).then_some(Photon { sampler, flux, ray, hits: 1, registers_first: true })
    }
}

/// Runs `$body` with `$tracer` bound to the photon tracer that has just the code that `$code` names.
#[macro_export]
macro_rules! with_photon_tracer {
    ($code:expr, $scene:expr, $max_hits:expr, |$tracer:ident| $body:expr) => {{
        use $crate::transport::photon::PhotonTracer;
        $crate::with_transport_code!($code, |$tracer = PhotonTracer($scene, $max_hits)| $body)
    }};
}
