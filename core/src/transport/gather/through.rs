//! Rays back from the sensor through media and through surfaces that light passes; see [`crate::transport::volume`], whose paths go the same ways.

use super::{GatherTracer, LIGHTS_GATHERED, LIGHTS_SEEN, Walk};
use crate::bsdf::Interface;
use crate::geometry::{Hit, Intersector, Ray};
use crate::light::{self, LightSample};
use crate::math::Vec3;
use crate::medium::{Inside, Medium};
use crate::scene::material_flags;
use crate::transport::back::{Roulette, choose_colour};
use crate::transport::volume::{CROSSINGS_MAX, Followed, Vertex, boundaries::resolve};
use crate::transport::{Surface, mis, surface_at};

/// The first of the groups of sample dimensions for what happens between vertices, two an event.
const EVENT_GROUP: u32 = 1 << 24;

/// What a ray flies through.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Through {
    /// The media in which it starts, and those beyond the surface that it has met.
    pub inside: Inside,
    pub beyond: Inside,
    /// What lies between the surface that it left and where it starts \[m\].
    lead: f32,
    /// What has been flown since the last vertex \[m\], and the boundaries crossed.
    pub flown: f32,
    crossed: u32,
    /// Names the samples.
    event: u32,
    /// The channel of a ray that was refracted by its colour.
    channel: Option<u8>,
}

impl Through {
    pub(super) fn new(inside: Inside) -> Self {
        Self { inside, ..Self::default() }
    }

    /// Leaves a vertex into these media.
    pub(super) fn leave(&mut self, inside: Inside, lead: f32) {
        (self.inside, self.lead, self.flown, self.crossed) = (inside, lead, 0.0, 0);
    }
}

/// What a flight came to.
pub(super) enum Flown {
    /// On along its ray.
    Goes,
    Over,
    /// A surface that is no null boundary, or nothing at all.
    Meets(Option<Hit>),
}

impl Walk {
    /// From here on it is of one colour, which stands for all three.
    fn colour(&mut self, u: f32) -> usize {
        choose_colour(&mut self.through.channel, &mut self.throughput, u)
    }

    /// Straight on, beyond a boundary: the same edge, and a direction of the same density.
    fn pass(&mut self, surface: &Surface, t: f32) -> bool {
        let way = &mut self.through;
        way.inside = way.beyond;
        way.flown += t;
        way.crossed += 1;
        self.ray.origin = surface.leave(self.ray.direction);
        way.lead = surface.lead(self.ray.origin, self.ray.direction);
        way.crossed <= CROSSINGS_MAX && self.throughput != Vec3::ZERO
    }
}

impl<const VOLUME: bool, const LOBES: bool, const TEXTURES: bool, const SHADING: bool>
    GatherTracer<'_, VOLUME, LOBES, TEXTURES, SHADING>
{
    /// A ray has reached a surface, or nothing, if it gets so far.
    #[inline(never)]
    pub(super) fn fly<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        walk: &mut Walk,
        hit: Option<Hit>,
    ) -> Flown {
        let Through { inside, lead, event, .. } = walk.through;
        walk.through.event += 1;
        let limit = hit.map_or(f32::INFINITY, |h| lead + h.t);
        if let Some(medium) = inside.current(self.scene).map(|m| Medium::new(self.scene, m)) {
            let u = walk.sampler.group2(EVENT_GROUP + 2 * event);
            walk.radiance += walk.throughput * medium.emitted(&walk.ray, lead, limit);
            let flown = medium.fly(&walk.ray, lead, limit, walk.throughput, u);
            walk.throughput *= flown.weight;
            if flown.collided {
                let position = walk.ray.origin + walk.ray.direction * (flown.length - lead);
                walk.throughput *= medium.sigma_s_at(position);
                if walk.throughput == Vec3::ZERO || walk.depth >= self.max_depth {
                    return Flown::Over;
                }
                let vertex = Vertex::Medium { position, wo: -walk.ray.direction, g: medium.g };
                // What lies behind it is seen at second hand.
                let goes = self.scatter(intersector, walk, &vertex);
                walk.gathers = false;
                walk.seen = false;
                return if goes { Flown::Goes } else { Flown::Over };
            }
            if walk.throughput == Vec3::ZERO {
                return Flown::Over;
            }
        }
        let Some(hit) = hit else { return Flown::Meets(None) };
        let (hit, beyond) = resolve(self.scene, &walk.ray, hit, inside);
        walk.through.beyond = beyond;
        if self.scene.material_of(hit.primitive).flags & material_flags::NULL == 0 {
            return Flown::Meets(Some(hit));
        }
        let surface = surface_at::<LOBES, TEXTURES, SHADING>(self.scene, &walk.ray, &hit);
        match surface.is_some_and(|surface| walk.pass(&surface, hit.t)) {
            true => Flown::Goes,
            false => Flown::Over,
        }
    }

    /// Reflected at a dielectric or a pane, or on through it.
    #[inline(never)]
    pub(super) fn meet_interface(&self, walk: &mut Walk, surface: &Surface, t: f32) -> bool {
        let [choice, colour, ..] = walk.sampler.group4(EVENT_GROUP + 2 * walk.through.event + 1);
        let channel = if surface.interface.disperses() { walk.colour(colour) } else { 0 };
        let Some(passage) = surface.passage::<SHADING>(channel, choice) else { return false };
        if passage.through && matches!(surface.interface, Interface::Pane { .. }) {
            walk.throughput *= passage.weight;
            return walk.pass(surface, t);
        }
        // The roulette is about what is absorbed: the squared index comes back when light leaves.
        let absorbed = if passage.through { Vec3::ONE } else { passage.weight };
        let [.., survive] = walk.sampler.group4(2 + 2 * walk.depth);
        let Some(throughput) = Roulette::ON.play(walk.throughput, absorbed, walk.depth, survive) else {
            return false;
        };
        walk.throughput = if passage.through { throughput * passage.weight } else { throughput };
        walk.pdf = 0.0;
        walk.vertex = surface.leave(passage.wi);
        walk.ray = Ray { origin: walk.vertex, direction: passage.wi, t_max: f32::MAX };
        walk.depth += 1;
        let inside = if passage.through { walk.through.beyond } else { walk.through.inside };
        walk.through.leave(inside, surface.lead(walk.vertex, passage.wi));
        true
    }

    /// The colour of a walk that a rough surface disperses.
    #[inline(never)]
    pub(super) fn colour_of(&self, walk: &mut Walk) -> usize {
        let [_, colour, ..] = walk.sampler.group4(EVENT_GROUP + 2 * walk.through.event + 1);
        walk.colour(colour)
    }

    /// Samples lights and a direction, which competes with the samples of surface lights by the power heuristic.
    #[inline(always)]
    pub(super) fn scatter<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        walk: &mut Walk,
        vertex: &Vertex<'_>,
    ) -> bool {
        let [word, u, v, _] = walk.sampler.bits4(1 + 2 * walk.depth);
        if vertex.has_density() {
            let most = if walk.seen { LIGHTS_SEEN } else { LIGHTS_GATHERED };
            self.point_like_of(walk, most, |walk, light, factor| {
                if let Some(s) = light::sample(light, vertex.position(), [0.0; 2]) {
                    self.add(intersector, walk, vertex, &s, factor, 0.0);
                }
            });
            let choice = self.lights.surfaces.pick(self.scene, word);
            if let Some((light, factor)) = choice
                && let Some(s) = light::sample_light(self.scene, light, vertex.position(), [u, v])
            {
                self.add(intersector, walk, vertex, &s, factor, s.pdf * self.lights.surface_share);
            }
        }
        let [u, v, lobe, survive] = walk.sampler.group4(2 + 2 * walk.depth);
        let Some(s) = vertex.sample::<SHADING>([u, v], lobe) else { return false };
        // The roulette is about what is absorbed: the squared index comes back when light leaves.
        let squared = vertex.index_ratio_squared(s.wi);
        let Some(throughput) = Roulette::ON.play(walk.throughput, s.weight * squared, walk.depth, survive)
        else {
            return false;
        };
        walk.throughput = throughput / squared;
        walk.pdf = s.pdf;
        walk.vertex = vertex.leave(s.wi);
        walk.ray = Ray { origin: walk.vertex, direction: s.wi, t_max: f32::MAX };
        walk.depth += 1;
        if VOLUME {
            walk.through.leave(vertex.media(walk.through.inside, s.wi), vertex.lead(walk.vertex, s.wi));
        }
        true
    }

    /// Adds what a place on a light brings to a vertex; `density` of the sample, 0 where no direction competes with it.
    fn add<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        walk: &mut Walk,
        vertex: &Vertex<'_>,
        s: &LightSample,
        factor: f32,
        density: f32,
    ) {
        let (f, other) = vertex.scattering(s.wi);
        let weight = if density > 0.0 { mis::power_heuristic(density, other) } else { 1.0 };
        let brings = walk.throughput * f * s.contribution * (factor * weight);
        if brings != Vec3::ZERO {
            let left = self.clear(intersector, walk, vertex, s);
            walk.radiance += brings * left;
        }
    }

    /// What is left of the light of a place on a light at a vertex.
    #[inline(always)]
    pub(super) fn clear<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        walk: &mut Walk,
        vertex: &Vertex<'_>,
        s: &LightSample,
    ) -> Vec3 {
        if VOLUME {
            return self.clear_through(intersector, walk, vertex, s);
        }
        walk.rays += 1;
        if intersector.occluded(&vertex.towards(s)) { Vec3::ZERO } else { Vec3::ONE }
    }

    #[inline(never)]
    fn clear_through<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        walk: &mut Walk,
        vertex: &Vertex<'_>,
        s: &LightSample,
    ) -> Vec3 {
        let inside = vertex.media(walk.through.inside, s.wi);
        let mut left = Vec3::ONE;
        let mut way = vertex.way(s, inside);
        loop {
            walk.rays += 1;
            let hit = intersector.closest_hit(&way.ray);
            match way.follow::<LOBES, TEXTURES, SHADING>(self.scene, hit, |through, _| left *= through) {
                Followed::Part if left != Vec3::ZERO => {}
                Followed::Whole => return left,
                _ => return Vec3::ZERO,
            }
        }
    }
}
