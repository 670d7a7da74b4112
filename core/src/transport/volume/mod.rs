//! Path tracing through participating media: the path tracer of [`super::path`], with flights that may end in a medium and boundaries that are no surfaces.
//!
//! Along each ray a distance is drawn by the medium that the ray is in ([`crate::medium::Medium::fly`]); emission of the medium is added over what the ray could fly. At a collision one light is
//! sampled, and one direction by the phase function; both find surface lights and are combined by the power heuristic over solid angles. Null boundaries are crossed straight on:
//! they are no vertices, count no edges, and a direction keeps its density beyond them. Connections to lights cross them too, with the product of the transmittances on the way.
//! Unbiased up to `max_depth`.

mod airlight;
pub(super) mod boundaries;
mod lights;
mod vertex;
pub(super) mod way;

pub use airlight::{Airlight, NODES_MAX, Rule, SingleScatter, has_airlight};
pub(super) use lights::is_distant;
pub use lights::{LightMedia, Straight};
pub(super) use way::lead;

pub use boundaries::{Surroundings, inside_at, inside_of_probe, probe_starts};

use super::back::{NO_RAY, Roulette, camera_ray, choose_colour, emission, white_surface};
use super::paths::{Paths, ProbeStart};
use super::{Answer, Query, Surface, mis, surface_at};
use crate::bsdf::{BsdfSample, Interface};
use crate::geometry::{Hit, Ray};
use crate::light;
use crate::math::{self, PI, Vec3};
use crate::medium::{Inside, Medium};
use crate::sampling::sobol::BlockSampler;
use crate::scene::{CompiledScene, material_flags};
use boundaries::resolve;
pub(super) use vertex::Vertex;
pub(super) use way::{Followed, Way};

/// Groups of sample dimensions of an event (a scattering, or a boundary that is crossed): the flight, the light, the direction.
const GROUPS: u32 = 3;
/// The first of the groups that choose the colour of paths which rough surfaces disperse, one an event.
const COLOUR_GROUP: u32 = 1 << 24;
/// Most boundaries that are crossed on one straight way: what would go on for ever between coincident ones ends.
pub(super) const CROSSINGS_MAX: u32 = 1 << 12;

/// The volumetric path tracer for one scene, with the code that it needs (see [`super::TransportCode`]).
#[derive(Clone, Copy, Debug)]
pub struct VolumeTracer<'a, const LOBES: bool, const TEXTURES: bool, const SHADING: bool> {
    scene: &'a CompiledScene,
    max_depth: u32,
    /// What the camera stands in.
    camera: Inside,
    pub(super) roulette: Roulette,
}

/// One path between two rays.
#[derive(Clone, Copy, Debug)]
pub struct VolumeState {
    sampler: BlockSampler,
    /// What the sample measures so far.
    radiance: Vec3,
    /// Product of f cos / pdf along the path.
    throughput: Vec3,
    /// The ray to follow after a connection; of no direction when the path ends there.
    next: Ray,
    /// The ray that is being traced for its hit.
    ray: Ray,
    /// The media that it starts in.
    inside: Inside,
    /// The connection that is being traced.
    connection: Connection,
    /// A connection is being traced, and not the path's own ray.
    connecting: bool,
    /// Density per solid angle of the last scattered direction; 0 where only scattering can find lights.
    pdf: f32,
    /// Where the last direction was scattered, and what has been flown since \[m\].
    vertex: Vec3,
    flown: f32,
    /// Boundaries crossed since.
    crossed: u32,
    /// What lies between the surface that `ray` leaves and where it starts \[m\].
    lead: f32,
    /// Edges of the path up to and including `ray`.
    depth: u32,
    /// Scatterings and crossings so far: names the samples.
    event: u32,
    /// The channel of a path that was refracted by its colour.
    channel: Option<u8>,
    /// The airlight of lights without size is known already; see [`Airlight`].
    airlight: bool,
}

/// A straight way to a light.
#[derive(Clone, Copy, Debug)]
struct Connection {
    way: Way,
    /// What it brings if the rest of the way is free and clear.
    carried: Vec3,
}

/// The same way, its parameter in metres.
#[inline(always)]
pub(super) fn with_unit_direction(ray: Ray) -> Ray {
    if ray.t_max == f32::MAX {
        return ray;
    }
    let length = math::sqrt(ray.direction.dot(ray.direction));
    if length > 0.0 {
        Ray { direction: ray.direction / length, t_max: ray.t_max * length, ..ray }
    } else {
        NO_RAY
    }
}

impl<'a, const LOBES: bool, const TEXTURES: bool, const SHADING: bool>
    VolumeTracer<'a, LOBES, TEXTURES, SHADING>
{
    /// A tracer of paths with at most `max_depth` edges; `camera`: what the camera stands in.
    pub fn new(scene: &'a CompiledScene, max_depth: u32, camera: Inside) -> Self {
        Self { scene, max_depth, camera, roulette: Roulette::ON }
    }

    /// The path's ray has reached a surface, or nothing.
    #[inline(always)]
    fn arrive(&self, state: &mut VolumeState, hit: Option<Hit>) -> Query {
        let limit = hit.map_or(f32::INFINITY, |h| state.lead + h.t);
        if let Some(medium) = state.inside.current(self.scene).map(|m| Medium::new(self.scene, m)) {
            state.radiance += state.throughput * medium.emitted(&state.ray, state.lead, limit);
            let u = state.sampler.group2(1 + GROUPS * state.event);
            let flown = medium.fly(&state.ray, state.lead, limit, state.throughput, u);
            state.throughput *= flown.weight;
            if flown.collided {
                let position = state.ray.origin + state.ray.direction * (flown.length - state.lead);
                state.throughput *= medium.sigma_s_at(position);
                if state.throughput == Vec3::ZERO || state.depth >= self.max_depth {
                    return Query::Done;
                }
                let vertex = Vertex::Medium { position, wo: -state.ray.direction, g: medium.g };
                return self.scatter(state, &vertex);
            }
            if state.throughput == Vec3::ZERO {
                return Query::Done;
            }
        }
        let Some(hit) = hit else {
            state.radiance +=
                state.throughput * light::escaped(self.scene, state.ray.direction, state.pdf, 1.0);
            return Query::Done;
        };
        let (hit, beyond) = resolve(self.scene, &state.ray, hit, state.inside);
        let Some(surface) = surface_at::<LOBES, TEXTURES, SHADING>(self.scene, &state.ray, &hit) else {
            return Query::Done;
        };
        if self.flags(&hit) & material_flags::NULL != 0 {
            return self.pass(state, &surface, (hit.t, beyond));
        }
        let (met, weight) =
            emission(self.scene, &surface, (&state.ray, state.flown + hit.t), (state.vertex, state.pdf), 1.0);
        state.radiance += state.throughput * met * weight;
        if LOBES && surface.interface != Interface::Opaque {
            return self.meet_interface(state, &surface, (hit.t, beyond));
        }
        if state.depth >= self.max_depth {
            return Query::Done;
        }
        if LOBES && surface.lobes.disperses() {
            return self.scatter_colour(state, surface, beyond);
        }
        self.scatter(state, &Vertex::Surface(&surface, beyond))
    }

    /// Straight on, beyond a boundary: the same edge, and a direction of the same density.
    #[inline(always)]
    fn pass(&self, state: &mut VolumeState, surface: &Surface, (t, beyond): (f32, Inside)) -> Query {
        state.inside = beyond;
        state.flown += t;
        state.event += 1;
        state.crossed += 1;
        if state.crossed > CROSSINGS_MAX {
            return Query::Done;
        }
        state.ray.origin = surface.leave(state.ray.direction);
        state.lead = surface.lead(state.ray.origin, state.ray.direction);
        Query::Closest(state.ray)
    }

    /// Reflected at a dielectric or a pane, or on through it.
    #[inline]
    fn meet_interface(&self, state: &mut VolumeState, surface: &Surface, behind: (f32, Inside)) -> Query {
        let groups = 1 + GROUPS * state.event;
        let [choice, colour, _, survive] = state.sampler.group4(groups + 2);
        if surface.interface.disperses() {
            state.choose_channel(colour);
        }
        let channel = usize::from(state.channel.unwrap_or(0));
        let Some(passage) = surface.passage::<SHADING>(channel, choice) else { return Query::Done };
        if passage.through && matches!(surface.interface, Interface::Pane { .. }) {
            state.throughput *= passage.weight;
            return if state.throughput == Vec3::ZERO {
                Query::Done
            } else {
                self.pass(state, surface, behind)
            };
        }
        if state.depth >= self.max_depth {
            return Query::Done;
        }
        // The roulette is about what is absorbed: the squared index comes back when light leaves.
        let absorbed = if passage.through { Vec3::ONE } else { passage.weight };
        let Some(throughput) = self.roulette.play(state.throughput, absorbed, state.depth, survive) else {
            return Query::Done;
        };
        state.throughput = if passage.through { throughput * passage.weight } else { throughput };
        if passage.through {
            state.inside = behind.1;
        }
        state.pdf = 0.0;
        state.vertex = surface.leave(passage.wi);
        state.lead = surface.lead(state.vertex, passage.wi);
        (state.flown, state.crossed) = (0.0, 0);
        state.event += 1;
        state.next = Ray { origin: state.vertex, direction: passage.wi, t_max: f32::MAX };
        state.follow()
    }

    /// Scatters at a surface that refracts by colour.
    #[inline(never)]
    fn scatter_colour(&self, state: &mut VolumeState, mut surface: Surface, beyond: Inside) -> Query {
        let [colour, ..] = state.sampler.group4(COLOUR_GROUP + state.event);
        surface.lobes = surface.lobes.of_channel(state.choose_channel(colour));
        self.scatter(state, &Vertex::Surface(&surface, beyond))
    }

    #[inline(always)]
    fn flags(&self, hit: &Hit) -> u32 {
        self.scene.material_of(hit.primitive).flags
    }

    /// Samples a light and a direction at a vertex.
    #[inline(always)]
    fn scatter(&self, state: &mut VolumeState, vertex: &Vertex<'_>) -> Query {
        let groups = 1 + GROUPS * state.event;
        let connection = self.sample_light(state, vertex, groups + 1);
        state.next = NO_RAY;
        let [u, v, lobe, survive] = state.sampler.group4(groups + 2);
        // The roulette is about what is absorbed: the squared index comes back when light leaves.
        let kept = |s: &BsdfSample| {
            let squared = if LOBES { vertex.index_ratio_squared(s.wi) } else { 1.0 };
            Some((self.roulette.play(state.throughput, s.weight * squared, state.depth, survive)?, squared))
        };
        if let Some(s) = vertex.sample::<SHADING>([u, v], lobe)
            && let Some((throughput, squared)) = kept(&s)
        {
            state.throughput = if LOBES { throughput / squared } else { throughput };
            if LOBES {
                state.inside = vertex.media(state.inside, s.wi);
            }
            state.pdf = s.pdf;
            state.vertex = vertex.leave(s.wi);
            state.lead = vertex.lead(state.vertex, s.wi);
            (state.flown, state.crossed) = (0.0, 0);
            state.next = Ray { origin: state.vertex, direction: s.wi, t_max: f32::MAX };
        }
        state.event += 1;
        match connection {
            Some(connection) => {
                state.connection = connection;
                state.connecting = true;
                Query::Closest(connection.way.ray)
            }
            None => state.follow(),
        }
    }

    /// Light sampling: the way to the light, with what it brings.
    #[inline(always)]
    fn sample_light(&self, state: &VolumeState, vertex: &Vertex<'_>, group: u32) -> Option<Connection> {
        let scene = self.scene;
        if scene.lights.is_empty() || !vertex.has_density() {
            return None;
        }
        let [pick, u, v, _] = state.sampler.bits4(group);
        let s = light::sample_lights(scene, vertex.position(), [pick, u, v])?;
        let (f, other) = vertex.scattering(s.wi);
        let mut carried = state.throughput * f * s.contribution;
        if s.pdf > 0.0 {
            carried *= mis::power_heuristic(s.pdf, other);
        } else if state.airlight && state.depth == 1 && matches!(vertex, Vertex::Medium { .. }) {
            return None;
        }
        if carried == Vec3::ZERO {
            return None;
        }
        let inside = if LOBES { vertex.media(state.inside, s.wi) } else { state.inside };
        Some(Connection { way: vertex.way(&s, inside), carried })
    }

    /// A connection has reached a surface, or its end.
    #[inline(always)]
    fn connect(&self, state: &mut VolumeState, hit: Option<Hit>) -> Query {
        let Connection { way, carried } = &mut state.connection;
        match way.follow::<LOBES, TEXTURES, SHADING>(self.scene, hit, |through, _| *carried *= through) {
            Followed::Part if *carried != Vec3::ZERO => return Query::Closest(way.ray),
            Followed::Whole => state.radiance += *carried,
            _ => {}
        }
        state.follow()
    }
}

impl<const LOBES: bool, const TEXTURES: bool, const SHADING: bool> Paths
    for VolumeTracer<'_, LOBES, TEXTURES, SHADING>
{
    type State = VolumeState;

    fn width(&self) -> u32 {
        self.scene.camera.map_or(0, |c| c.width)
    }

    #[inline(always)]
    fn start_camera(&self, x: u32, y: u32, sampler: BlockSampler) -> (VolumeState, Query) {
        let mut state = VolumeState::new(sampler, self.camera);
        let Some(camera) = &self.scene.camera else { return (state, Query::Done) };
        state.ray = camera_ray(camera, x, y, &sampler);
        state.vertex = state.ray.origin;
        state.depth = 1;
        let query = if self.max_depth >= 1 { Query::Closest(state.ray) } else { Query::Done };
        (state, query)
    }

    #[inline(always)]
    fn start_probe(&self, start: &ProbeStart, sampler: BlockSampler) -> (VolumeState, Query) {
        let mut state = VolumeState::new(sampler, start.inside);
        state.throughput = Vec3::splat(PI);
        let surface = white_surface(start.point, start.normal);
        if self.max_depth == 0 {
            return (state, Query::Done);
        }
        let query = self.scatter(&mut state, &Vertex::Surface(&surface, start.inside));
        (state, query)
    }

    #[inline(always)]
    fn advance(&self, state: &mut VolumeState, answer: Answer) -> Query {
        match answer {
            Answer::Closest(hit) if state.connecting => self.connect(state, hit),
            Answer::Closest(hit) => self.arrive(state, hit),
            // Shadow rays are not asked for: something in the way may be a boundary.
            Answer::Occluded(_) => Query::Done,
        }
    }

    #[inline(always)]
    fn measured(state: &VolumeState) -> Vec3 {
        state.radiance
    }
}

impl VolumeState {
    fn new(sampler: BlockSampler, inside: Inside) -> Self {
        Self {
            sampler,
            radiance: Vec3::ZERO,
            throughput: Vec3::ONE,
            next: NO_RAY,
            ray: NO_RAY,
            inside,
            connection: Connection { way: Way::NOTHING, carried: Vec3::ZERO },
            crossed: 0,
            connecting: false,
            pdf: 0.0,
            vertex: Vec3::ZERO,
            flown: 0.0,
            lead: 0.0,
            depth: 0,
            event: 0,
            channel: None,
            airlight: false,
        }
    }

    /// From here on the path is of one colour, which stands for all three.
    fn choose_channel(&mut self, u: f32) -> usize {
        choose_colour(&mut self.channel, &mut self.throughput, u)
    }

    #[inline(always)]
    fn follow(&mut self) -> Query {
        self.connecting = false;
        if self.next.direction == Vec3::ZERO {
            return Query::Done;
        }
        self.ray = self.next;
        self.depth += 1;
        Query::Closest(self.ray)
    }
}
