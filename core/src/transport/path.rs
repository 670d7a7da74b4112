//! Path tracing from the sensor with light sampling and multiple importance sampling.
//!
//! Estimates radiance \[W m^-2 sr^-1\] along camera rays, or irradiance \[W/m^2\] at probes. At each vertex one light
//! is sampled by flux and one direction by the lobes; both find surface lights and pictures of environments and are combined by the power
//! heuristic (Veach 1997, ch. 9). The constant environment is found by scattering alone. Paths end by roulette from the
//! fifth edge on: the chance to survive is the factor by which the last scattering changed the throughput (its largest
//! channel), at most 0.95, so that paths end even in a closed room of albedo 1. Unbiased for what surfaces carry, up to
//! `max_depth`.

use super::back::{NO_RAY, Roulette, camera_ray, emission, white_surface};
use super::paths::{Paths, ProbeStart};
use super::{Answer, Query, Surface, mis, surface_at};
use crate::geometry::{Hit, Ray};
use crate::light;
use crate::math::{PI, Vec3};
use crate::sampling::sobol::BlockSampler;
use crate::scene::CompiledScene;

/// The path tracer for one scene, with the code that it needs (see [`super::TransportCode`]).
#[derive(Clone, Copy, Debug)]
pub struct PathTracer<'a, const LOBES: bool, const TEXTURES: bool, const SHADING: bool> {
    scene: &'a CompiledScene,
    max_depth: u32,
    pub(super) roulette: Roulette,
}

/// One path between two rays.
#[derive(Clone, Copy, Debug)]
pub struct PathState {
    sampler: BlockSampler,
    /// What the sample measures so far.
    radiance: Vec3,
    /// Product of f cos / pdf along the path.
    throughput: Vec3,
    /// What the running shadow ray brings if it is free.
    pending: Vec3,
    /// The ray to follow after the shadow ray; of no direction when the path ends there.
    next: Ray,
    /// The ray that is being traced for its hit.
    ray: Ray,
    /// Density per solid angle of the last scattered direction; 0 where only scattering can find lights.
    pdf: f32,
    /// Where the last direction was scattered.
    vertex: Vec3,
    /// Edges of the path up to and including `ray`.
    depth: u32,
}

impl<'a, const LOBES: bool, const TEXTURES: bool, const SHADING: bool>
    PathTracer<'a, LOBES, TEXTURES, SHADING>
{
    /// A tracer of paths with at most `max_depth` edges.
    pub fn new(scene: &'a CompiledScene, max_depth: u32) -> Self {
        Self { scene, max_depth, roulette: Roulette::ON }
    }

    /// The path has reached a surface, or nothing.
    #[inline(always)]
    fn arrive(&self, state: &mut PathState, hit: Option<Hit>) -> Query {
        let Some(hit) = hit else {
            state.radiance +=
                state.throughput * light::escaped(self.scene, state.ray.direction, state.pdf, 1.0);
            return Query::Done;
        };
        let Some(surface) = surface_at::<LOBES, TEXTURES, SHADING>(self.scene, &state.ray, &hit) else {
            return Query::Done;
        };
        let (met, weight) =
            emission(self.scene, &surface, (&state.ray, hit.t), (state.vertex, state.pdf), 1.0);
        state.radiance += state.throughput * met * weight;
        if state.depth >= self.max_depth {
            return Query::Done;
        }
        self.scatter(state, &surface)
    }

    /// Samples a light and a direction at a vertex.
    #[inline(always)]
    fn scatter(&self, state: &mut PathState, surface: &Surface) -> Query {
        let (light_group, lobe_group) = (1 + 2 * state.depth, 2 + 2 * state.depth);
        let shadow = self.sample_light(state, surface, light_group);
        state.next = NO_RAY;
        let [u, v, lobe, survive] = state.sampler.group4(lobe_group);
        if let Some(s) = surface.lobes.sample(surface.shading, surface.wo, [u, v], lobe) {
            // An interpolated normal can send light through the surface; such directions carry nothing.
            if !SHADING || s.wi.dot(surface.geometric) > 0.0 {
                self.continue_with(state, surface, &s, survive);
            }
        }
        match shadow {
            Some(ray) => Query::Shadow(ray),
            None => state.follow(),
        }
    }

    #[inline(always)]
    fn continue_with(
        &self,
        state: &mut PathState,
        surface: &Surface,
        s: &crate::bsdf::BsdfSample,
        survive: f32,
    ) {
        let Some(throughput) = self.roulette.play(state.throughput, s.weight, state.depth, survive) else {
            return;
        };
        state.throughput = throughput;
        state.pdf = s.pdf;
        state.vertex = surface.leave(s.wi);
        state.next = Ray { origin: state.vertex, direction: s.wi, t_max: f32::MAX };
    }

    /// Light sampling: stores what it brings, returns the ray that must be free.
    #[inline(always)]
    fn sample_light(&self, state: &mut PathState, surface: &Surface, group: u32) -> Option<Ray> {
        let scene = self.scene;
        if scene.lights.is_empty() || !surface.lobes.has_density() {
            return None;
        }
        let [pick, u, v, _] = state.sampler.bits4(group);
        let s = light::sample_lights(scene, surface.point.position, [pick, u, v])?;
        if s.wi.dot(surface.geometric) <= 0.0 {
            return None;
        }
        let cos = s.wi.dot(surface.shading);
        let f = surface.lobes.eval(surface.shading, surface.wo, s.wi);
        let mut pending = state.throughput * f * s.contribution * cos.max(0.0);
        if s.pdf > 0.0 {
            let other = surface.lobes.pdf_solid_angle(surface.shading, surface.wo, s.wi);
            pending *= mis::power_heuristic(s.pdf, other);
        }
        if pending == Vec3::ZERO {
            return None;
        }
        state.pending = pending;
        Some(light::shadow_ray(&s, &surface.point, surface.geometric))
    }
}

impl<const LOBES: bool, const TEXTURES: bool, const SHADING: bool> Paths
    for PathTracer<'_, LOBES, TEXTURES, SHADING>
{
    type State = PathState;

    fn width(&self) -> u32 {
        self.scene.camera.map_or(0, |c| c.width)
    }

    #[inline(always)]
    fn start_camera(&self, x: u32, y: u32, sampler: BlockSampler) -> (PathState, Query) {
        let Some(camera) = &self.scene.camera else { return (PathState::new(sampler), Query::Done) };
        let mut state = PathState::new(sampler);
        state.ray = camera_ray(camera, x, y, &sampler);
        state.depth = 1;
        let query = if self.max_depth >= 1 { Query::Closest(state.ray) } else { Query::Done };
        (state, query)
    }

    #[inline(always)]
    fn start_probe(&self, start: &ProbeStart, sampler: BlockSampler) -> (PathState, Query) {
        let mut state = PathState::new(sampler);
        state.throughput = Vec3::splat(PI);
        let surface = white_surface(start.point, start.normal);
        let query = if self.max_depth >= 1 { self.scatter(&mut state, &surface) } else { Query::Done };
        (state, query)
    }

    #[inline(always)]
    fn advance(&self, state: &mut PathState, answer: Answer) -> Query {
        match answer {
            Answer::Closest(hit) => self.arrive(state, hit),
            Answer::Occluded(occluded) => {
                if !occluded {
                    state.radiance += state.pending;
                }
                state.follow()
            }
        }
    }

    #[inline(always)]
    fn measured(state: &PathState) -> Vec3 {
        state.radiance
    }
}

impl PathState {
    fn new(sampler: BlockSampler) -> Self {
        Self {
            sampler,
            radiance: Vec3::ZERO,
            throughput: Vec3::ONE,
            pending: Vec3::ZERO,
            next: NO_RAY,
            ray: NO_RAY,
            pdf: 0.0,
            vertex: Vec3::ZERO,
            depth: 0,
        }
    }

    #[inline(always)]
    fn follow(&mut self) -> Query {
        if self.next.direction == Vec3::ZERO {
            return Query::Done;
        }
        self.ray = self.next;
        self.depth += 1;
        Query::Closest(self.ray)
    }
}
