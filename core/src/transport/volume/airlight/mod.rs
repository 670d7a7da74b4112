//! Airlight: what lights without size send to the camera by just one scattering in a medium, summed along the camera's rays instead of drawn by flights.
//!
//! Quantity: radiance \[W m^-2 sr^-1\], the integral over t of T(0, t) sigma_s(t) p(t) E(t) T(t, light): E the irradiance \[W/m^2\] that the light alone would give at t, p the phase function, T transmittances. Each segment of
//! a camera ray within one medium has its own nodes ([`Rule`]) for each of the lights; all lights are summed, none is picked. Each node asks for the nearest hits on the way to its light, as connections of
//! paths do: shadows, boundaries and panes count. A ray goes straight on through null boundaries and panes, with what they let through, to the first surface; flights do not end it, so that nothing but the
//! ray's place in its pixel and the first node of unbiased rules is random.
//!
//! All else is the walk's of [`VolumeTracer`], which begins anew at the camera (one more ray) and leaves out the lights without size at its first collision, if no scattering came before that.

mod rule;

pub use rule::{NODES_MAX, Rule, SingleScatter};

use super::boundaries::resolve;
use super::vertex::Vertex;
use super::{CROSSINGS_MAX, VolumeState, VolumeTracer};
use crate::geometry::{Hit, Ray};
use crate::light::{self, emit::is_point_like};
use crate::math::{self, Vec3};
use crate::medium::{Inside, Medium};
use crate::sampling::sobol::BlockSampler;
use crate::scene::{CompiledScene, LightKind, LightRecord, material_flags};
use crate::transport::paths::{Paths, ProbeStart};
use crate::transport::{Answer, Query, surface_at};
use rule::Segment;

/// The first group of sample dimensions of segments: no walk has so many events.
const GROUP: u32 = 1 << 28;
/// Golden ratio of 2^32: lights of one segment have their first nodes apart.
const TURN: u32 = 0x9E37_79B9;
/// Least distance of a light from a ray beside that from the segment's start: what rounding leaves of it.
const DISTANCE_MIN: f32 = 1.0 / 131_072.0;

/// Whether there is airlight to sum in a scene.
pub fn has_airlight(scene: &CompiledScene) -> bool {
    !scene.media.is_empty() && scene.lights.iter().any(is_summed)
}

#[inline(always)]
fn is_summed(light: &LightRecord) -> bool {
    is_point_like(light) && light.pmf > 0.0
}

/// Where a light that is near lies beside a ray \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Foot {
    /// Of the nearest place on the ray.
    along: f32,
    /// From the ray; above 0.
    distance: f32,
}

impl Foot {
    /// `None` for a light at infinity.
    #[inline(always)]
    fn of(light: &LightRecord, ray: &Ray, lead: f32) -> Option<Self> {
        if light.kind == LightKind::Directional as u32 {
            return None;
        }
        let to = Vec3::from_array(light.point) - ray.origin;
        let along = to.dot(ray.direction);
        let off = to - ray.direction * along;
        let (off, far) = (math::sqrt(off.dot(off)), math::sqrt(to.dot(to)));
        Some(Self { along: along + lead, distance: off.max(far * DISTANCE_MIN).max(1e-20) })
    }
}

/// The volumetric path tracer with summed airlight.
#[derive(Clone, Copy, Debug)]
pub struct Airlight<'a, const LOBES: bool, const TEXTURES: bool, const SHADING: bool> {
    walk: VolumeTracer<'a, LOBES, TEXTURES, SHADING>,
    single: SingleScatter,
    /// There is any to sum.
    any: bool,
}

/// What the last query was about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// The end of a segment.
    Segment,
    /// A node's way to its light.
    Node,
    /// The walk.
    Walk,
}

/// Where the camera's ray goes on.
#[derive(Clone, Copy, Debug)]
struct Beyond {
    origin: Vec3,
    lead: f32,
    inside: Inside,
    /// What is left of light from there to the camera.
    left: Vec3,
}

/// One sample between two rays.
#[derive(Clone, Copy, Debug)]
pub struct AirlightState {
    /// The walk; before it, the segment's ray, what is left of light from its start to the camera (`throughput`), and the sum.
    walk: VolumeState,
    stage: Stage,
    pixel: [u32; 2],
    /// What rules see of the segment.
    segment: Option<Segment>,
    /// How far from the ray's origin nodes may lie \[m\].
    reach: f32,
    beyond: Option<Beyond>,
    /// The first node's place within its step.
    shift: u32,
    /// The next node.
    light: usize,
    node: u32,
}

impl<'a, const LOBES: bool, const TEXTURES: bool, const SHADING: bool>
    Airlight<'a, LOBES, TEXTURES, SHADING>
{
    /// A tracer of paths with at most `max_depth` edges; `camera`: what the camera stands in.
    pub fn new(scene: &'a CompiledScene, max_depth: u32, camera: Inside, single: SingleScatter) -> Self {
        let any = max_depth >= 2 && has_airlight(scene);
        Self { walk: VolumeTracer::new(scene, max_depth, camera), single, any }
    }

    /// The end of a segment is known.
    #[inline(always)]
    fn begin(&self, state: &mut AirlightState, hit: Option<Hit>) -> Query {
        let AirlightState { walk, .. } = state;
        let scene = self.walk.scene;
        let ray = walk.ray;
        let length = hit.map_or(f32::INFINITY, |h| walk.lead + h.t);
        state.segment = segment(scene, walk, length);
        (state.reach, state.beyond) = (f32::MAX, None);
        (state.light, state.node) = (0, 0);
        [state.shift, _] = walk.sampler.bits2(GROUP + walk.crossed);
        let Some(hit) = hit else { return self.next(state) };
        let (hit, inside) = resolve(scene, &ray, hit, walk.inside);
        let Some(surface) = surface_at::<LOBES, TEXTURES, SHADING>(scene, &ray, &hit) else {
            return self.walk_on(state);
        };
        // Short of what is met, or it would be in the way.
        state.reach = (surface.leave(-ray.direction) - ray.origin).dot(ray.direction).max(0.0);
        if self.walk.flags(&hit) & material_flags::PASSES != 0 && walk.crossed < CROSSINGS_MAX {
            let mut left = walk.throughput;
            if let Some(medium) = walk.inside.current(scene).map(|m| Medium::new(scene, m)) {
                left *= medium.transmittance(&ray, walk.lead, length);
            }
            if let Some((transmit, _)) = surface.interface.straight() {
                left *= transmit;
            }
            if left != Vec3::ZERO {
                let origin = surface.leave(ray.direction);
                let lead = surface.lead(origin, ray.direction);
                state.beyond = Some(Beyond { origin, lead, inside, left });
            }
        }
        self.next(state)
    }

    /// The next node that brings anything; after the last one the next segment, after the last one of these the walk.
    #[inline(always)]
    fn next(&self, state: &mut AirlightState) -> Query {
        let scene = self.walk.scene;
        if let Some(segment) = state.segment
            && let Some(medium) = state.walk.inside.current(scene).map(|m| Medium::new(scene, m))
        {
            while let Some(light) = scene.lights.get(state.light) {
                while state.node < self.single.nodes && is_summed(light) {
                    state.node += 1;
                    if self.aim(state, &medium, &segment, light) {
                        state.stage = Stage::Node;
                        return Query::Closest(state.walk.connection.way.ray);
                    }
                }
                state.light += 1;
                state.node = 0;
            }
        }
        let Some(Beyond { origin, lead, inside, left }) = state.beyond else {
            return self.walk_on(state);
        };
        let walk = &mut state.walk;
        walk.ray.origin = origin;
        (walk.lead, walk.inside, walk.throughput) = (lead, inside, left);
        walk.crossed += 1;
        state.stage = Stage::Segment;
        Query::Closest(walk.ray)
    }

    /// Readies the way from the last node to its light; false where nothing could come.
    #[inline(always)]
    fn aim(
        &self,
        state: &mut AirlightState,
        medium: &Medium<'_>,
        segment: &Segment,
        light: &LightRecord,
    ) -> bool {
        let walk = &state.walk;
        let u = math::u32_to_unit(state.shift.wrapping_add(TURN.wrapping_mul(state.light as u32)));
        let foot = Foot::of(light, &walk.ray, walk.lead);
        let Some(node) = segment.node(self.single, state.node - 1, u, foot) else { return false };
        let position = walk.ray.origin + walk.ray.direction * (node.t - walk.lead).clamp(0.0, state.reach);
        let Some(s) = light::sample(light, position, [0.0; 2]) else { return false };
        let vertex = Vertex::Medium { position, wo: -walk.ray.direction, g: medium.g };
        let (phase, _) = vertex.scattering(s.wi);
        // As if the light had been picked for certain.
        let light = s.contribution * light.pmf;
        let left = walk.throughput * medium.transmittance(&walk.ray, walk.lead, node.t);
        let carried = left * medium.sigma_s_at(position) * phase * light * node.weight;
        if carried == Vec3::ZERO || !carried.is_finite() {
            return false;
        }
        state.walk.connection = super::Connection { way: vertex.way(&s, walk.inside), carried };
        true
    }

    /// The rest of what the sample measures.
    #[inline(always)]
    fn walk_on(&self, state: &mut AirlightState) -> Query {
        let [x, y] = state.pixel;
        let airlight = state.walk.radiance;
        let (walk, query) = self.walk.start_camera(x, y, state.walk.sampler);
        state.walk = VolumeState { radiance: airlight, airlight: true, ..walk };
        state.stage = Stage::Walk;
        query
    }
}

/// What rules see of a segment that ends at `length` \[m\]; `None` where nothing is scattered.
#[inline(always)]
fn segment(scene: &CompiledScene, walk: &VolumeState, length: f32) -> Option<Segment> {
    let medium = Medium::new(scene, walk.inside.current(scene)?);
    let [from, to] = medium.extent(&walk.ray, walk.lead, length)?;
    let uniform = medium.is_homogeneous();
    let mut sigma = f32::INFINITY;
    for c in 0..3 {
        // A grid of albedos may scatter what is said to be absorbed.
        let scatters = if uniform { medium.sigma_s[c] } else { medium.sigma_t[c] };
        if scatters > 0.0 && walk.throughput[c] > 0.0 {
            sigma = sigma.min(medium.sigma_t[c]);
        }
    }
    let sigma = if sigma == f32::INFINITY {
        return None;
    } else if medium.density().is_some() {
        0.0
    } else {
        sigma
    };
    Some(Segment { from, to, sigma })
}

impl<const LOBES: bool, const TEXTURES: bool, const SHADING: bool> Paths
    for Airlight<'_, LOBES, TEXTURES, SHADING>
{
    type State = AirlightState;

    fn width(&self) -> u32 {
        self.walk.width()
    }

    #[inline(always)]
    fn start_camera(&self, x: u32, y: u32, sampler: BlockSampler) -> (AirlightState, Query) {
        let (walk, query) = self.walk.start_camera(x, y, sampler);
        let mut state = AirlightState::new(walk, [x, y]);
        if self.any {
            state.stage = Stage::Segment;
        }
        (state, query)
    }

    /// Probes have no airlight of their own: the walk alone.
    #[inline(always)]
    fn start_probe(&self, start: &ProbeStart, sampler: BlockSampler) -> (AirlightState, Query) {
        let (walk, query) = self.walk.start_probe(start, sampler);
        (AirlightState::new(walk, [0; 2]), query)
    }

    #[inline(always)]
    fn advance(&self, state: &mut AirlightState, answer: Answer) -> Query {
        match (state.stage, answer) {
            (Stage::Segment, Answer::Closest(hit)) => self.begin(state, hit),
            // Nothing follows a node's connection, so that the walk is done where that ends.
            (Stage::Node, Answer::Closest(hit)) => match self.walk.connect(&mut state.walk, hit) {
                Query::Done => self.next(state),
                query => query,
            },
            (Stage::Walk, answer) => self.walk.advance(&mut state.walk, answer),
            (_, Answer::Occluded(_)) => Query::Done,
        }
    }

    #[inline(always)]
    fn measured(state: &AirlightState) -> Vec3 {
        state.walk.radiance
    }
}

impl AirlightState {
    fn new(walk: VolumeState, pixel: [u32; 2]) -> Self {
        Self {
            walk,
            stage: Stage::Walk,
            pixel,
            segment: None,
            reach: 0.0,
            beyond: None,
            shift: 0,
            light: 0,
            node: 0,
        }
    }
}
