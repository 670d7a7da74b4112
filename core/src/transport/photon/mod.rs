//! Photons: flux that walks from a start through the scene and is registered wherever it arrives.
//!
//! A photon carries flux \[W\] per channel. At each hit it arrives (its flux counts for the irradiance of that surface), and then lives on into a
//! direction by the lobes, with the share of its flux, mean of the channels, that they let through; `f cos / pdf` is divided by that chance, so that
//! the mean is carried unchanged and dark surfaces end walks. Interpolated normals are not symmetric between light and sensor: photons take Veach's factor
//! (1997, section 5.3.2), |wo n_s| |wi n_g| / (|wo n_g| |wi n_s|).
//!
//! A hit is taken in two steps, so that whoever drives the photons may order them in between: [`PhotonTracer::land`] tells the surface and what arrives
//! there, [`PhotonTracer::scatter`] sends the photon on and tells the chance with which it should survive.
//!
//! Where light is changed on its way, or passes surfaces, photons carry what they need to know of the media they fly through ([`Way`]): flights end in a medium by its extinction, panes and dielectrics
//! send them on, and none of these is a place where they land ([`Through`]).
//!
//! Starts: [`LightPlan`] picks a light by flux, the classical way ([`crate::light::emit`]); [`super::first_shot`] starts on lit surfaces.

mod replicate;
mod through;

pub use replicate::{Replicate, WAVE, chance_count, survivor_factor};
pub use through::{Through, Way};

use super::first_shot::Look;
use super::volume::{LightMedia, boundaries::resolve};
use super::{Surface, surface_at};
use crate::geometry::{Hit, Intersector, Ray};
use crate::light::emit;
use crate::math::{self, Vec3};
use crate::sampling::discrete::{IntegerCdf, WeightError};
use crate::sampling::numbers::Numbers;
use crate::scene::{CompiledScene, NO_INDEX};
use alloc::vec::Vec;
use core::marker::PhantomData;

/// Largest chance to survive a hit, so that walks end even in a closed room of albedo 1.
const SURVIVAL_MAX: f32 = 0.95;
/// Groups of numbers: the start, the choice of where, then one for each hit.
pub const START_GROUP: u32 = 0;
/// The choice of a light, or of a piece and its light.
pub const PICK_GROUP: u32 = 1;
/// The first hit's scattering.
pub const WALK_GROUP: u32 = 2;

/// Where a photon's numbers come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sequence {
    /// All photons of a replicate walk together; before each scattering they are put in order along a Hilbert curve and take the points of a fresh scrambled
    /// Sobol' set in that order (array-RQMC: L'Ecuyer, Lecot and Tuffin, 2008), and survive by a systematic roulette.
    #[default]
    Sorted,
    /// Each photon takes one point of a scrambled Sobol' set; photons walk one by one.
    Sobol,
    /// Independent random numbers.
    Random,
}

/// A photon between two hits, or at one; `W`: what it knows of its way.
#[derive(Clone, Copy, Debug)]
pub struct Photon<W = ()> {
    /// Flux per channel \[W\], as if it were the only photon.
    pub flux: Vec3,
    /// Where it flies.
    pub ray: Ray,
    /// Hits so far.
    pub hits: u32,
    /// The light from which it comes straight, where [`super::first_shot`] must weigh its first hit; else [`NO_INDEX`].
    pub light: u32,
    /// Whether its first arrival is registered: not where direct light is known in closed form.
    pub registers_first: bool,
    /// Whether it comes from a light without size and has met mirrors alone: light that no ray back from the sensor finds.
    pub caustic: bool,
    /// Whether it survives its first hit whatever the albedo, and is weighted by it instead.
    pub survives_first: bool,
    /// What it knows of its way.
    pub way: W,
}

impl Photon {
    /// A photon on its first flight, whose first arrival counts.
    #[inline]
    pub fn new(ray: Ray, flux: Vec3) -> Self {
        Self {
            flux,
            ray,
            hits: 0,
            light: NO_INDEX,
            registers_first: true,
            caustic: false,
            survives_first: false,
            way: (),
        }
    }

    /// The same photon, which knows this of its way.
    #[inline]
    pub fn along<W>(self, way: W) -> Photon<W> {
        let Self { flux, ray, hits, light, registers_first, caustic, survives_first, way: () } = self;
        Photon { flux, ray, hits, light, registers_first, caustic, survives_first, way }
    }
}

/// Flux that arrives at a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// At the front of the surface.
    pub from_front: bool,
    /// Straight from a light without size, but for mirrors.
    pub caustic: bool,
    /// Flux per channel \[W\], as if the photon were the only one.
    pub flux: Vec3,
}

/// What emits in a scene, and how often each is picked: by its mean flux.
#[derive(Clone, Debug)]
pub struct LightPlan {
    /// Lights, then the environment, then media that emit.
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
        // Without an environment its flux is 0, and it is never picked.
        let fluxes: Vec<Vec3> = (0..emit::entries(scene)).map(|i| emit::entry_flux(scene, i)).collect();
        let weights: Vec<f32> = fluxes.iter().map(|f| math::mean(*f)).collect();
        Ok(Self { cdf: IntegerCdf::try_new(&weights)?, fluxes, sphere })
    }

    /// Flux of everything that emits \[W\] per channel; of what comes from infinity, what reaches the scene's bounding sphere.
    pub fn total(&self) -> [f64; 3] {
        [0, 1, 2].map(|c| self.fluxes.iter().map(|f| f64::from(f[c])).sum())
    }

    /// The cumulative counts by which a word picks what emits, and the bounding sphere of what comes from infinity: for a device.
    pub fn parts(&self) -> (&[u32], (Vec3, f32)) {
        (self.cdf.cumulative(), self.sphere)
    }

    /// Whether there is more than one light to choose from.
    #[inline]
    pub fn has_choice(&self) -> bool {
        self.cdf.cumulative().len() > 1
    }

    /// A photon from the light that the word `pick` chooses, its flux divided by the chance of that light, and the number of the light. The first arrival from a light without size does not
    /// count unless `registers_direct`.
    #[inline]
    pub fn start(
        &self,
        scene: &CompiledScene,
        pick: u32,
        u: [f32; 4],
        registers_direct: bool,
    ) -> (Photon, u32) {
        let pick = self.cdf.pick(pick);
        let (emission, point_like) = emit::emit_entry(scene, pick.index as usize, self.sphere, u);
        let photon = Photon::new(emission.ray, emission.flux / pick.pmf);
        (
            Photon { registers_first: registers_direct || !point_like, caustic: point_like, ..photon },
            pick.index,
        )
    }
}

/// Photons between two landings; `W`: what they know of their way. The same for all code that a scene needs at its surfaces.
#[derive(Clone, Copy, Debug)]
pub struct PhotonFlight<'a, W> {
    scene: &'a CompiledScene,
    lights: &'a LightMedia,
    max_hits: u32,
    way: PhantomData<W>,
}

impl<'a, W: Way> PhotonFlight<'a, W> {
    /// Of photons that arrive, or are sent on by what they pass, at most `max_hits` times; `lights`: the media that lights send into.
    pub fn new(scene: &'a CompiledScene, max_hits: u32, lights: &'a LightMedia) -> Self {
        Self { scene, lights, max_hits, way: PhantomData }
    }

    /// A photon that has just left entry `index` of what emits, as number `id` of those that are told apart. `random`: independent numbers.
    #[inline(always)]
    pub fn begin<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        photon: Photon,
        (index, id): (u32, u32),
        random: &Numbers,
    ) -> Photon<W> {
        if W::VOLUME {
            return self.begin_through(intersector, photon, (index, id), random);
        }
        photon.along(W::default())
    }

    /// A photon as number `id` that has started on a surface, with what the way from its light to its place leaves of it, and the media there; `look`: the way.
    #[inline(never)]
    pub fn land_straight<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        photon: Photon,
        hit: &Hit,
        (look, id): (&Look, u32),
        rays: &mut u64,
    ) -> Photon<W> {
        let place = (photon.ray.origin, look.normal);
        let (straight, took) =
            self.lights.straight(self.scene, intersector, look.light as usize, &look.ray, place);
        *rays += took;
        let flux = photon.flux * look.through(&straight);
        let mut photon = Photon { flux, ..photon }.along(W::new(straight.inside, id));
        let beyond = resolve(self.scene, &photon.ray, *hit, straight.inside).1;
        if let Some(way) = photon.way.through() {
            way.beyond = beyond;
        }
        photon
    }

    /// Where a photon lands. `random`: independent numbers, for what happens on its way. `None` ends the walk.
    #[inline(always)]
    pub fn fly<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        photon: &mut Photon<W>,
        random: &Numbers,
        rays: &mut u64,
    ) -> Option<Hit> {
        if W::VOLUME {
            return self.fly_through(intersector, photon, random, rays);
        }
        *rays += 1;
        intersector.closest_hit(&photon.ray)
    }
}

/// Landings, with the code that a scene needs (see [`super::TransportCode`]); `W`: what photons know of their way.
#[derive(Clone, Copy, Debug)]
pub struct PhotonTracer<'a, W, const LOBES: bool, const TEXTURES: bool, const SHADING: bool> {
    scene: &'a CompiledScene,
    max_hits: u32,
    way: PhantomData<W>,
}

/// Of photons that meet surfaces alone.
pub type SurfacePhotons<'a, const L: bool, const T: bool, const S: bool> = PhotonTracer<'a, (), L, T, S>;

impl<'a, W: Way, const LOBES: bool, const TEXTURES: bool, const SHADING: bool>
    PhotonTracer<'a, W, LOBES, TEXTURES, SHADING>
{
    /// A tracer of photons that arrive, or are sent on by what they pass, at most `max_hits` times.
    pub fn new(scene: &'a CompiledScene, max_hits: u32) -> Self {
        Self { scene, max_hits, way: PhantomData }
    }

    /// Their flights; `lights`: the media that lights send into.
    pub fn flight(&self, lights: &'a LightMedia) -> PhotonFlight<'a, W> {
        PhotonFlight::new(self.scene, self.max_hits, lights)
    }

    /// The surface at which a photon is, and what arrives there if that counts. `None` ends the walk.
    #[inline(always)]
    pub fn land(&self, photon: &Photon<W>, hit: &Hit) -> Option<(Surface, Option<Arrival>)> {
        if photon.hits >= self.max_hits {
            return None;
        }
        let surface = surface_at::<LOBES, TEXTURES, SHADING>(self.scene, &photon.ray, hit)?;
        let counts = photon.hits > 0 || photon.registers_first;
        let arrival = counts.then_some(Arrival {
            from_front: surface.from_front,
            caustic: photon.caustic,
            flux: photon.flux,
        });
        Some((surface, arrival))
    }

    /// Sends a photon on from a surface; the chance with which it should survive, by which its flux must then be divided. 0: it ends.
    ///
    /// The chance keeps the mean of the channels that are carried, so that no channel ever exceeds three times the start's mean. The mean of
    /// the weight would not do: where one channel survives best, its share of the flux grows, and its variance without bound.
    #[inline(always)]
    pub fn scatter(&self, photon: &mut Photon<W>, surface: &Surface, u: [f32; 2], lobe: f32) -> f32 {
        photon.hits += 1;
        if photon.hits >= self.max_hits {
            return 0.0;
        }
        let left = if W::VOLUME {
            self.leave_through(photon, surface, u, lobe)
        } else {
            self.leave(surface, u, lobe)
        };
        let Some((wi, weight, mirrored)) = left else { return 0.0 };
        photon.caustic &= LOBES && mirrored;
        let (before, after) = (math::mean(photon.flux).abs(), photon.flux * weight);
        photon.flux = after;
        photon.ray = Ray { origin: surface.leave(wi), direction: wi, t_max: f32::MAX };
        let carried = math::mean(after).abs();
        if photon.hits == 1 && photon.survives_first {
            return if carried > 0.0 { 1.0 } else { 0.0 };
        }
        (carried / before.max(f32::MIN_POSITIVE)).min(SURVIVAL_MAX)
    }

    /// A direction in which flux leaves a surface, what it is multiplied by, and whether a mirror sends it there.
    #[inline(always)]
    fn leave(&self, surface: &Surface, u: [f32; 2], lobe: f32) -> Option<(Vec3, Vec3, bool)> {
        let s = surface.lobes.sample(surface.shading, surface.wo, u, lobe)?;
        let mirrored = LOBES && s.pdf == 0.0;
        if !SHADING {
            return Some((s.wi, s.weight, mirrored));
        }
        let (before, after) = (surface.wo.dot(surface.geometric), s.wi.dot(surface.geometric));
        if after <= 0.0 {
            return None;
        }
        let down = before * s.wi.dot(surface.shading);
        // Unbounded at grazing angles; the limit is a bias, of what leaves or arrives within 4 degrees of the surface where normals are interpolated.
        let factor =
            if down > 0.0 { (surface.wo.dot(surface.shading) * after / down).clamp(0.0, 16.0) } else { 0.0 };
        Some((s.wi, s.weight * factor, mirrored))
    }
}

/// Runs `$body` with `$tracer` bound to the photon tracer that has just the code that `$code` names.
#[macro_export]
macro_rules! with_photon_tracer {
    ($code:expr, $scene:expr, $max_hits:expr, |$tracer:ident| $body:expr) => {{
        use $crate::transport::photon::{PhotonTracer, SurfacePhotons, Through};
        if $scene.needs.volume() {
            // One instance: what else a scene does not need costs little beside flights.
            let $tracer = PhotonTracer::<Through, true, true, true>::new($scene, $max_hits);
            $body
        } else {
            $crate::with_transport_code!($code, |$tracer = SurfacePhotons($scene, $max_hits)| $body)
        }
    }};
}
