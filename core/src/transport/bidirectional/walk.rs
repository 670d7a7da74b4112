//! One walk, from a light or from the sensor: flights, boundaries that are passed straight, and the vertices between.

use super::vertex::{From, Scatterer, Vertex};
use super::weight::{Chain, Links, VERTICES_MAX};
use super::{Bidirectional, GROUPS};
use crate::bsdf::Interface;
use crate::geometry::{Hit, Ray, SurfacePoint};
use crate::math::{self, Vec3};
use crate::medium::{Inside, Medium};
use crate::sampling::sobol::BlockSampler;
use crate::scene::material_flags;
use crate::transport::back::{NO_RAY, one_colour};
use crate::transport::volume::{CROSSINGS_MAX, boundaries::resolve};
use crate::transport::{Surface, surface_at};

/// A walk between two of its vertices.
#[derive(Clone, Copy, Debug)]
pub(super) struct Walk {
    pub from: From,
    /// The ray that is followed; of no direction when the walk ends.
    pub ray: Ray,
    /// The media that it starts in.
    pub inside: Inside,
    /// What is carried along it.
    pub carried: Vec3,
    /// Edges up to and including it.
    pub edges: u32,
    /// The last vertex: where, its number, how likely it was, and how it was left (see [`Chain::next`]).
    pub origin: Vec3,
    pub index: u32,
    pub chain: Chain,
    pub left: Option<[f32; 2]>,
    /// Cosine or extinction there; 0 where nothing meets it by chance.
    pub facing: f32,
    /// The light that it comes from.
    pub light: u32,
    /// The last vertex is at infinity.
    pub distant: bool,
    /// What lies between the surface that the ray leaves and where it starts \[m\].
    pub lead: f32,
    /// Mean chance over the channels to have come here from the last vertex.
    pub pass: f32,
    /// Boundaries crossed since.
    pub crossed: u32,
    /// Scatterings and crossings so far: names the samples.
    pub event: u32,
    /// Of one colour from here on.
    pub coloured: bool,
}

/// Where a walk has come to.
#[expect(clippy::large_enum_variant, reason = "one at a time, taken apart where it is made")]
pub(super) enum Step {
    /// It goes on along its ray.
    On,
    /// It ends.
    Over,
    /// It has left the scene.
    Away,
    /// It can scatter, and be connected.
    At(Vertex),
}

impl Walk {
    pub(super) fn new(from: From, ray: Ray, inside: Inside, carried: Vec3) -> Self {
        Self {
            from,
            ray,
            inside,
            carried,
            edges: 1,
            origin: ray.origin,
            index: 0,
            chain: Chain { pdf: 1.0, ..Chain::default() },
            left: None,
            facing: 0.0,
            light: 0,
            distant: false,
            lead: 0.0,
            pass: 1.0,
            crossed: 0,
            event: 0,
            coloured: false,
        }
    }

    /// The vertex at a place: `facing` what it turns to the walk (cosine or extinction).
    #[inline]
    pub(super) fn link<const V: bool, const L: bool, const D: bool>(
        &self,
        tracer: &Bidirectional<'_, V, L, D>,
        position: Vec3,
        facing: f32,
    ) -> Chain {
        let d2 = if self.distant { 1.0 } else { math::max((position - self.origin).length_squared(), 1e-30) };
        let per = self.pass / d2;
        self.chain.next(tracer.settings.heuristic, self.left, self.facing * per, facing * per)
    }
}

impl<const VOLUME: bool, const LOBES: bool, const DETAIL: bool> Bidirectional<'_, VOLUME, LOBES, DETAIL> {
    #[inline]
    pub(super) fn flags(&self, hit: &Hit) -> u32 {
        self.scene.material_of(hit.primitive).flags
    }

    /// What becomes of a walk whose ray has met a surface, or nothing. `seen` takes what surfaces and media send to the sensor.
    #[inline]
    pub(super) fn arrive(
        &self,
        walk: &mut Walk,
        hit: Option<Hit>,
        sampler: &BlockSampler,
        channel: usize,
        links: &mut Links,
        mut seen: impl FnMut(&Walk, Seen<'_>, &Links),
    ) -> Step {
        if VOLUME && let Some(medium) = walk.inside.current(self.scene).map(|m| Medium::new(self.scene, m)) {
            let limit = hit.map_or(f32::INFINITY, |h| walk.lead + h.t);
            seen(walk, Seen::Glow(medium.emitted(&walk.ray, walk.lead, limit)), links);
            let u = sampler.group2(self.groups(walk));
            let flown = medium.fly(&walk.ray, walk.lead, limit, walk.carried, u);
            walk.carried *= flown.weight;
            walk.pass *= math::mean(flown.left);
            if flown.collided {
                let position = walk.ray.origin + walk.ray.direction * (flown.length - walk.lead);
                walk.carried *= medium.sigma_s_at(position);
                if walk.carried == Vec3::ZERO {
                    return Step::Over;
                }
                let extinction = math::mean(medium.sigma_t_at(position));
                let chain = walk.link(self, position, extinction);
                return Step::At(self.vertex(
                    walk,
                    Vertex {
                        point: SurfacePoint { position, extent: 0.0 },
                        wo: -walk.ray.direction,
                        scatterer: Scatterer::Medium { g: medium.g, extinction },
                        ..Vertex::nowhere(chain)
                    },
                ));
            }
            if walk.carried == Vec3::ZERO {
                return Step::Over;
            }
        }
        let Some(hit) = hit else { return Step::Away };
        let (hit, beyond) =
            if VOLUME { resolve(self.scene, &walk.ray, hit, walk.inside) } else { (hit, walk.inside) };
        let Some(mut surface) = surface_at::<LOBES, DETAIL, DETAIL>(self.scene, &walk.ray, &hit) else {
            return Step::Over;
        };
        if VOLUME && self.flags(&hit) & material_flags::NULL != 0 {
            return pass(walk, &surface, beyond);
        }
        let chain = walk.link(self, surface.point.position, math::abs(surface.wo.dot(surface.geometric)));
        seen(walk, Seen::Surface(&surface, &chain), links);
        if VOLUME && LOBES && surface.interface != Interface::Opaque {
            return self.meet_interface(walk, &surface, chain, beyond, sampler, channel, links);
        }
        if VOLUME && LOBES && surface.lobes.disperses() {
            walk.choose(channel);
            surface.lobes = surface.lobes.of_channel(channel);
        }
        let vertex = Vertex { beyond, ..Vertex::at_surface(&surface, chain) };
        Step::At(self.vertex(walk, vertex))
    }

    /// Groups of sample dimensions of what happens next.
    #[inline]
    fn groups(&self, walk: &Walk) -> u32 {
        let base = if walk.from == From::Light { super::LIGHT_GROUPS } else { 1 };
        base + GROUPS * walk.event
    }

    /// Fills in what a vertex has of its walk.
    #[inline]
    pub(super) fn vertex(&self, walk: &Walk, vertex: Vertex) -> Vertex {
        Vertex {
            carried: walk.carried,
            inside: walk.inside,
            beyond: if VOLUME { vertex.beyond } else { walk.inside },
            edges: walk.edges,
            index: walk.index + 1,
            coloured: walk.coloured,
            ..vertex
        }
    }

    /// Sends a walk on from a vertex. False where it ends.
    #[inline]
    pub(super) fn scatter(
        &self,
        walk: &mut Walk,
        vertex: &Vertex,
        sampler: &BlockSampler,
        links: &mut Links,
    ) -> bool {
        let [u, v, lobe, survive] = sampler.group4(self.groups(walk) + 2);
        walk.event += 1;
        // The last edge of a walk from a light is the one to the sensor.
        let room = if walk.from == From::Light { 2 } else { 1 };
        if vertex.edges.saturating_add(room) > self.settings.max_depth
            || vertex.index as usize + 2 >= VERTICES_MAX
        {
            return false;
        }
        let Some((s, left)) = vertex.sample::<LOBES, DETAIL>(walk.from, [u, v], lobe) else { return false };
        // The roulette is about what is absorbed: the squared index comes back when light leaves.
        let squared = if LOBES { vertex.index_ratio_squared(walk.from, s.wi) } else { 1.0 };
        let Some(carried) =
            self.settings.roulette.play(vertex.carried, s.weight * squared, vertex.edges, survive)
        else {
            return false;
        };
        walk.carried = if LOBES { carried / squared } else { carried };
        if self.settings.lists() {
            links.leave(vertex.index as usize, &vertex.chain, left);
        }
        walk.origin = vertex.position();
        walk.ray = Ray { origin: vertex.leave(s.wi), direction: s.wi, t_max: f32::MAX };
        walk.lead = if VOLUME { vertex.lead(walk.ray.origin, s.wi) } else { 0.0 };
        if VOLUME {
            walk.inside = vertex.media(s.wi);
        }
        walk.leave((vertex.index, &vertex.chain), left, vertex.facing(s.wi, 1.0));
        true
    }

    /// Reflected at a dielectric or a pane, or on through it.
    #[inline]
    #[allow(clippy::too_many_arguments, reason = "all that a walk is made of")]
    fn meet_interface(
        &self,
        walk: &mut Walk,
        surface: &Surface,
        chain: Chain,
        beyond: Inside,
        sampler: &BlockSampler,
        channel: usize,
        links: &mut Links,
    ) -> Step {
        let [choice, _, _, survive] = sampler.group4(self.groups(walk) + 2);
        if surface.interface.disperses() {
            walk.choose(channel);
        }
        let Some(passage) = surface.passage::<DETAIL>(channel, choice) else { return Step::Over };
        let mut weight = passage.weight;
        if passage.through
            && let Some((_, chance)) = surface.interface.straight()
        {
            walk.carried *= weight;
            walk.pass *= chance;
            return if walk.carried == Vec3::ZERO { Step::Over } else { pass(walk, surface, beyond) };
        }
        walk.event += 1;
        let room = if walk.from == From::Light { 2 } else { 1 };
        if walk.edges.saturating_add(room) > self.settings.max_depth
            || walk.index as usize + 3 >= VERTICES_MAX
        {
            return Step::Over;
        }
        if walk.from == From::Light {
            // Importance keeps its measure where radiance is squeezed into a smaller solid angle.
            if passage.through {
                weight = Vec3::ONE;
            }
            if DETAIL {
                let (n, g) = (surface.shading, surface.geometric);
                let turned = surface.wo.dot(n) * passage.wi.dot(g) / (surface.wo.dot(g) * passage.wi.dot(n));
                weight *= math::abs(turned);
            }
        }
        // The roulette is about what is absorbed: the squared index comes back when light leaves.
        let absorbed = if passage.through { Vec3::ONE } else { weight };
        let Some(carried) = self.settings.roulette.play(walk.carried, absorbed, walk.edges, survive) else {
            return Step::Over;
        };
        walk.carried = if passage.through { carried * weight } else { carried };
        if passage.through {
            walk.inside = beyond;
        }
        if self.settings.lists() {
            links.leave(walk.index as usize + 1, &chain, None);
        }
        walk.origin = surface.point.position;
        walk.ray = Ray { origin: surface.leave(passage.wi), direction: passage.wi, t_max: f32::MAX };
        walk.lead = surface.lead(walk.ray.origin, passage.wi);
        walk.leave((walk.index + 1, &chain), None, math::abs(passage.wi.dot(surface.geometric)));
        Step::On
    }
}

/// What a walk from the sensor sees.
pub(super) enum Seen<'a> {
    /// Radiance of a medium along the ray.
    Glow(Vec3),
    /// A surface, and how likely the walk is to have come to it.
    Surface(&'a Surface, &'a Chain),
}

impl Walk {
    /// From here on the walk is of one colour, which stands for all three.
    fn choose(&mut self, channel: usize) {
        if !self.coloured {
            self.coloured = true;
            self.carried = one_colour(self.carried, channel);
        }
    }

    /// Leaves a vertex.
    #[inline]
    pub(super) fn leave(&mut self, (index, chain): (u32, &Chain), left: Option<[f32; 2]>, facing: f32) {
        (self.index, self.chain, self.left, self.facing) = (index, *chain, left, facing);
        (self.pass, self.crossed, self.distant) = (1.0, 0, false);
        self.edges += 1;
    }

    /// It ends.
    #[inline]
    pub(super) fn end(&mut self) {
        self.ray = NO_RAY;
    }
}

/// Straight on, beyond a boundary: the same edge, and a direction of the same density.
#[inline]
fn pass(walk: &mut Walk, surface: &Surface, beyond: Inside) -> Step {
    walk.inside = beyond;
    walk.event += 1;
    walk.crossed += 1;
    if walk.crossed > CROSSINGS_MAX {
        return Step::Over;
    }
    walk.ray.origin = surface.leave(walk.ray.direction);
    walk.lead = surface.lead(walk.ray.origin, walk.ray.direction);
    Step::On
}
