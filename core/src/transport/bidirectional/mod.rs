//! Bidirectional path tracing, in vacuum and in participating media (Veach and Guibas 1994; Lafortune and Willems 1993 and, in media, 1996).
//!
//! Each sample takes a walk from a light and one from the sensor. Every vertex of the first is joined to the sensor itself (t = 1: what it brings lands in whatever pixel sees it) and to every vertex of the
//! second (s, t >= 2); the second is joined to a sampled light (s = 1) and counts the light that it meets (s = 0). All of these are ways to make the same paths, and share them by the weights of
//! `weight`. Null boundaries and panes are passed straight, by walks and by joints.
//!
//! Emission of media and a uniform environment are met by the sensor's walk alone, with weight 1. The strategy s = t = 1, which only a camera that looks at a light could use, is left to s = 0.
//! What is unlikely to bring anything is joined by roulette: the chance is what it would bring over a part of what the sample has brought so far.

mod connect;
mod emitters;
mod splats;
#[cfg(test)]
mod tests;
mod vertex;
mod walk;
mod weight;

pub use splats::SplatUnit;
pub use weight::{CUTOFF, Heuristic, VERTICES_MAX};

use super::back::{BlockSum, NO_RAY, Roulette, camera_ray, white_surface};
use super::paths::ProbeStart;
use super::volume::{Surroundings, lead};
use super::{Answer, Query, ask};
use crate::geometry::{Hit, Intersector};
use crate::math::{PI, Vec3};
use crate::medium::Inside;
use crate::sampling::sobol::BlockSampler;
use crate::scene::{CompiledScene, NO_INDEX};
use alloc::boxed::Box;
use alloc::vec::Vec;
use connect::Connection;
use emitters::{Emitters, Start};
use vertex::{From, Vertex};
use walk::{Seen, Step, Walk};
use weight::{Chain, End, Links, weigh};

/// Groups of sample dimensions of an event: the flight, the light or the lens, the direction.
const GROUPS: u32 = 3;
/// The first groups of the walk from a light: its start, then which light and which colour; its events follow.
const LIGHT_START: u32 = 1 << 27;
const LIGHT_PICK: u32 = LIGHT_START + 1;
const LIGHT_GROUPS: u32 = LIGHT_START + 2;
/// Chances of connections.
const CHANCE_GROUPS: u32 = 1 << 28;

/// What is asked of the estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Largest number of edges of a path; `u32::MAX` for no limit.
    pub max_depth: u32,
    /// How strategies share paths.
    pub heuristic: Heuristic,
    /// One strategy alone, (s, t) vertices from the light and from the sensor, without weights: to see that each is right by itself.
    pub only: Option<[u32; 2]>,
    /// Whether walks end and joints are left out by chance.
    pub(crate) roulette: Roulette,
}

impl Settings {
    /// By all strategies, or one alone.
    pub fn new(max_depth: u32, heuristic: Heuristic, only: Option<[u32; 2]>) -> Self {
        Self { max_depth, heuristic, only, roulette: Roulette::ON }
    }

    /// Weights are by lists of all strategies.
    #[inline]
    fn lists(&self) -> bool {
        matches!(self.heuristic, Heuristic::Cutoff(_))
    }

    /// Whether a strategy counts.
    #[inline]
    fn uses(&self, s: u32, t: u32) -> bool {
        self.only.is_none_or(|only| only == [s, t])
    }
}

/// The estimator for one scene, with the code that it needs: media and boundaries that light passes; more than two-sided diffuse surfaces; bitmaps and interpolated normals.
#[derive(Clone, Debug)]
pub struct Bidirectional<'a, const VOLUME: bool, const LOBES: bool, const DETAIL: bool> {
    scene: &'a CompiledScene,
    settings: Settings,
    emitters: Emitters,
    surroundings: Surroundings,
}

/// Runs `$body` with `$tracer` bound to the estimator that has just the code that a scene needs.
#[macro_export]
macro_rules! with_bidirectional {
    ($scene:expr, $code:expr, ($($argument:expr),*), |$tracer:ident| $body:expr) => {{
        use $crate::transport::bidirectional::Bidirectional;
        let code: $crate::transport::TransportCode = $code;
        macro_rules! instance {
            ($v:literal, $l:literal, $d:literal) => {{
                let $tracer = Bidirectional::<$v, $l, $d>::new($($argument),*);
                $body
            }};
        }
        let detail = code.textures || code.shading_normals;
        // Six instances: in media there is one for all but diffuse surfaces of one colour.
        match ($scene.needs.volume(), code.lobes, detail) {
            #[cfg(not(fuzzing))]
            (false, false, false) => instance!(false, false, false),
            #[cfg(not(fuzzing))]
            (false, false, true) => instance!(false, false, true),
            #[cfg(not(fuzzing))]
            (false, true, false) => instance!(false, true, false),
            #[cfg(not(fuzzing))]
            (false, true, true) => instance!(false, true, true),
            #[cfg(not(fuzzing))]
            (true, false, false) => instance!(true, false, false),
            _ => instance!(true, true, true),
        }
    }};
}

/// What the sample is busy with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// The walk from a light.
    Light,
    /// A vertex of it is joined to the camera.
    Splat,
    /// The walk from the sensor.
    Sensor,
    /// A vertex of it is joined to the light or the vertex before this one.
    Join(u32),
}

/// One sample between two rays. Made once and used for many: nothing is allocated in between.
#[derive(Clone, Debug)]
pub struct State {
    sampler: BlockSampler,
    /// What the sample measures so far.
    radiance: Vec3,
    phase: Phase,
    walk: Walk,
    /// Vertices of the light's walk that can be joined.
    vertices: Vec<Vertex>,
    /// The sensor's last vertex.
    vertex: Vertex,
    connection: Connection,
    /// The walk that follows that of the light.
    sensor: Walk,
    /// The sensor's first vertex is a probe, not a camera.
    probe: bool,
    /// The colour of walks that are of one.
    channel: usize,
    links: Box<[Links; 2]>,
    /// What landed in a pixel other than the sample's own.
    splat: Option<([u32; 2], Vec3)>,
}

impl Default for State {
    fn default() -> Self {
        let nothing = Walk::new(From::Sensor, NO_RAY, Inside::NOTHING, Vec3::ZERO);
        Self {
            sampler: BlockSampler::new(0, 0, 0, 0),
            radiance: Vec3::ZERO,
            phase: Phase::Sensor,
            walk: nothing,
            vertices: Vec::with_capacity(VERTICES_MAX),
            vertex: Vertex::nowhere(Chain::default()),
            connection: Connection::nothing(),
            sensor: nothing,
            probe: false,
            channel: 0,
            links: Box::new([Links::EMPTY; 2]),
            splat: None,
        }
    }
}

impl<'a, const VOLUME: bool, const LOBES: bool, const DETAIL: bool> Bidirectional<'a, VOLUME, LOBES, DETAIL> {
    /// The estimator for a scene in its surroundings.
    pub fn new<I: Intersector + ?Sized>(
        scene: &'a CompiledScene,
        intersector: &I,
        settings: Settings,
        surroundings: Surroundings,
    ) -> Self {
        let emitters = Emitters::new(scene, intersector, surroundings.outside);
        Self { scene, settings, emitters, surroundings }
    }

    /// Starts a sample of pixel (x, y).
    pub fn start_camera<I: Intersector + ?Sized>(
        &self,
        state: &mut State,
        intersector: &I,
        [x, y]: [u32; 2],
        sampler: BlockSampler,
    ) -> Query {
        let Some(camera) = &self.scene.camera else { return Query::Done };
        let ray = camera_ray(camera, x, y, &sampler);
        let mut walk = Walk::new(From::Sensor, ray, self.surroundings.camera, Vec3::ONE);
        walk.left = Some([camera.pdf_solid_angle(ray.direction), 0.0]);
        state.probe = false;
        self.start(state, intersector, walk, sampler)
    }

    /// Starts a sample of the irradiance \[W/m^2\] at a probe: the radiance that a white Lambert surface there reflects, times pi.
    pub fn start_probe<I: Intersector + ?Sized>(
        &self,
        state: &mut State,
        intersector: &I,
        start: &ProbeStart,
        sampler: BlockSampler,
    ) -> Query {
        let surface = white_surface(start.point, start.normal);
        let chain = Chain { pdf: 1.0, ..Chain::default() };
        state.vertex = Vertex {
            carried: Vec3::splat(PI),
            inside: start.inside,
            beyond: start.inside,
            ..Vertex::at_surface(&surface, chain)
        };
        state.probe = true;
        let walk = Walk { edges: 0, ..Walk::new(From::Sensor, NO_RAY, start.inside, Vec3::splat(PI)) };
        self.start(state, intersector, walk, sampler)
    }

    fn start<I: Intersector + ?Sized>(
        &self,
        state: &mut State,
        intersector: &I,
        sensor: Walk,
        sampler: BlockSampler,
    ) -> Query {
        state.sampler = sampler;
        (state.radiance, state.splat) = (Vec3::ZERO, None);
        state.vertices.clear();
        state.sensor = sensor;
        if VOLUME && LOBES && self.scene.needs.refraction {
            let [_, u] = sampler.group2(LIGHT_PICK);
            state.channel = ((3.0 * u) as usize).min(2);
        }
        if self.settings.lists() {
            state.links[1].leave(0, &sensor.chain, Some([0.0; 2]));
        }
        // A path with a vertex of the light's walk has two edges at least.
        if self.settings.max_depth >= 2
            && !self.scene.lights.is_empty()
            && let Some(start) = self.light_start(&sampler)
        {
            let inside =
                if VOLUME { self.emitters.media(self.scene, intersector, &start) } else { Inside::NOTHING };
            let light = &self.scene.lights[start.light as usize];
            if !emitters::is_distant(light) || inside.is_nothing() {
                state.phase = Phase::Light;
                state.walk = self.light_walk(&start, inside);
                if self.settings.lists() {
                    state.links[0].leave(0, &state.walk.chain, Some([0.0; 2]));
                }
                return Query::Closest(state.walk.ray);
            }
        }
        self.turn_to_sensor(state)
    }

    fn light_start(&self, sampler: &BlockSampler) -> Option<Start> {
        let u = sampler.group4(LIGHT_START);
        let [pick, _] = if self.scene.needs.light_choice { sampler.bits2(LIGHT_PICK) } else { [0; 2] };
        self.emitters.start(self.scene, pick, u)
    }

    fn light_walk(&self, start: &Start, inside: Inside) -> Walk {
        let light = &self.scene.lights[start.light as usize];
        let mut walk = Walk::new(From::Light, start.ray, inside, start.carried);
        walk.light = start.light;
        walk.origin = start.position;
        walk.chain.pdf = start.pdf_place;
        walk.chain.open = if emitters::is_met(light) { 1.0 } else { 0.0 };
        walk.left = Some([start.pdf_direction, 0.0]);
        walk.distant = emitters::is_distant(light);
        walk.facing = match (emitters::is_met(light), walk.distant) {
            (false, _) => 0.0,
            (true, false) => start.ray.direction.dot(start.normal).max(0.0),
            // Its place is a direction.
            (true, true) => 1.0,
        };
        if VOLUME && start.normal != Vec3::ZERO {
            walk.lead = lead((start.position, start.normal), start.ray.origin, start.ray.direction);
        }
        walk
    }

    /// The walk from the light is over; that from the sensor begins.
    fn turn_to_sensor(&self, state: &mut State) -> Query {
        state.walk = state.sensor;
        state.phase = Phase::Sensor;
        if self.settings.max_depth == 0 {
            return Query::Done;
        }
        if state.probe {
            return self.visit(state);
        }
        Query::Closest(state.walk.ray)
    }

    /// Takes the answer to the last query and says what is asked next.
    #[inline]
    pub fn advance(&self, state: &mut State, answer: Answer) -> Query {
        match (state.phase, answer) {
            (Phase::Light, Answer::Closest(hit)) => self.walk_from_light(state, hit),
            (Phase::Sensor, Answer::Closest(hit)) => self.walk_from_sensor(state, hit),
            (Phase::Splat | Phase::Join(_), answer) => self.join(state, answer),
            (_, Answer::Occluded(_)) => Query::Done,
        }
    }

    #[inline]
    fn walk_from_light(&self, state: &mut State, hit: Option<Hit>) -> Query {
        let first = state.walk.index == 0;
        let own = &mut state.links[0];
        let step = self.arrive(&mut state.walk, hit, &state.sampler, state.channel, own, |_, _, _| {});
        match step {
            Step::On => Query::Closest(state.walk.ray),
            Step::Over | Step::Away => self.turn_to_sensor(state),
            Step::At(mut vertex) => {
                if first {
                    let light = &self.scene.lights[state.walk.light as usize];
                    vertex.chain.open *= emitters::preference_at(light, vertex.position(), state.walk.origin);
                }
                let query = self.splat(state, &vertex);
                if !self.scatter(&mut state.walk, &vertex, &state.sampler, &mut state.links[0]) {
                    state.walk.end();
                }
                if vertex.connects() && state.vertices.len() < VERTICES_MAX {
                    state.vertices.push(vertex);
                }
                if let Some(query) = query {
                    state.phase = Phase::Splat;
                    return query;
                }
                self.follow_light(state)
            }
        }
    }

    #[inline]
    fn follow_light(&self, state: &mut State) -> Query {
        if state.walk.ray.direction == Vec3::ZERO {
            return self.turn_to_sensor(state);
        }
        state.phase = Phase::Light;
        Query::Closest(state.walk.ray)
    }

    #[inline]
    fn walk_from_sensor(&self, state: &mut State, hit: Option<Hit>) -> Query {
        let (probe, radiance) = (state.probe, &mut state.radiance);
        let seen =
            |walk: &Walk, seen: Seen<'_>, links: &Links| *radiance += self.seen(walk, &seen, probe, links);
        let own = &mut state.links[1];
        let step = self.arrive(&mut state.walk, hit, &state.sampler, state.channel, own, seen);
        match step {
            Step::On => Query::Closest(state.walk.ray),
            Step::Over => Query::Done,
            Step::Away => {
                let t = state.walk.index + 1;
                if self.settings.uses(0, t + 1) {
                    let brings = Vec3::from_array(self.scene.environment) + self.picture(state);
                    state.radiance += state.walk.carried * brings;
                }
                Query::Done
            }
            Step::At(vertex) => {
                state.vertex = vertex;
                self.visit(state)
            }
        }
    }

    /// Joins the sensor's last vertex, and goes on from it.
    #[inline]
    fn visit(&self, state: &mut State) -> Query {
        if !self.scatter(&mut state.walk, &state.vertex, &state.sampler, &mut state.links[1]) {
            state.walk.end();
        }
        self.join_from(state, 0)
    }

    #[inline]
    fn follow_sensor(&self, state: &mut State) -> Query {
        if state.walk.ray.direction == Vec3::ZERO {
            return Query::Done;
        }
        state.phase = Phase::Sensor;
        Query::Closest(state.walk.ray)
    }

    /// Radiance of the picture of the environment where the sensor's walk leaves the scene, weighted: s = 0, the last vertex being a direction.
    #[inline(always)]
    fn picture(&self, state: &State) -> Vec3 {
        let Some(map) = &self.scene.environment_map else { return Vec3::ZERO };
        let Some(light) = self.scene.lights.get(map.light as usize) else { return Vec3::ZERO };
        let (walk, direct) = (&state.walk, state.walk.index == 0 && !state.probe);
        let radiance = map.radiance(walk.ray.direction);
        if self.settings.only.is_some() || radiance == Vec3::ZERO {
            return radiance;
        }
        let mut chain =
            walk.chain.next(self.settings.heuristic, walk.left, walk.facing * walk.pass, walk.pass);
        if direct {
            chain.open = 0.0;
        }
        let end = End {
            chain: &chain,
            forward: emitters::pdf_picture(map, walk.ray.direction),
            backward: self.emitters.pdf_towards(light, walk.ray.direction, Vec3::ZERO),
            index: walk.index as usize + 1,
            links: &state.links[1],
        };
        radiance * weigh(self.settings.heuristic, 1.0, [Some(end), None])
    }

    /// Radiance that the sensor's walk sees by itself, weighted: s = 0.
    #[inline]
    fn seen(&self, walk: &Walk, seen: &Seen<'_>, probe: bool, links: &Links) -> Vec3 {
        let (index, t) = (walk.index + 1, walk.index + 2);
        match seen {
            Seen::Glow(radiance) if self.settings.uses(0, t) => walk.carried * *radiance,
            Seen::Glow(_) => Vec3::ZERO,
            Seen::Surface(surface, chain) => {
                if surface.light == NO_INDEX || !surface.from_front || !self.settings.uses(0, t) {
                    return Vec3::ZERO;
                }
                let Some(light) = self.scene.lights.get(surface.light as usize) else { return Vec3::ZERO };
                let radiance = walk.carried * Vec3::from_array(light.radiance);
                if self.settings.only.is_some() {
                    return radiance;
                }
                let mut chain = **chain;
                let direct = walk.index == 0 && !probe;
                let place = surface.point.position;
                chain.open *= if direct { 0.0 } else { emitters::preference_at(light, walk.origin, place) };
                let end = End {
                    chain: &chain,
                    forward: emitters::pdf_place(light),
                    backward: self.emitters.pdf_towards(light, -surface.wo, surface.front),
                    index: index as usize,
                    links,
                };
                radiance * weigh(self.settings.heuristic, 1.0, [Some(end), None])
            }
        }
    }

    /// Runs a sample to its end; returns what it measures and the number of rays it took. `splat` takes what lands in other pixels.
    // Images and probes share it, with the walks through the tree that it holds.
    #[inline(never)]
    pub fn run<I: Intersector + ?Sized>(
        &self,
        state: &mut State,
        intersector: &I,
        mut query: Query,
        mut splat: impl FnMut([u32; 2], Vec3),
    ) -> (Vec3, u32) {
        let mut rays = 0;
        while let Some(answer) = ask(intersector, &query) {
            rays += 1;
            query = self.advance(state, answer);
            if let Some((pixel, value)) = state.splat.take() {
                splat(pixel, value);
            }
        }
        (state.radiance, rays)
    }

    /// Mean of one block of samples of a pixel, but for what lands in it from elsewhere; and the rays it took. `splat` takes the sum of what lands elsewhere.
    #[inline]
    pub fn pixel_block<I: Intersector + ?Sized>(
        &self,
        state: &mut State,
        intersector: &I,
        [x, y]: [u32; 2],
        (seed, block, block_length): (u64, u32, u32),
        mut splat: impl FnMut([u32; 2], Vec3),
    ) -> ([f64; 3], u64) {
        let stream = y.wrapping_mul(self.scene.camera.map_or(0, |c| c.width)).wrapping_add(x);
        let mut sum = BlockSum::default();
        for i in 0..block_length {
            let sampler = BlockSampler::new(seed, stream, block, i);
            let query = self.start_camera(state, intersector, [x, y], sampler);
            sum.add(self.run(state, intersector, query, &mut splat));
        }
        sum.mean(block_length)
    }

    /// Mean of one block of samples of a probe of this number; and the rays it took.
    #[inline]
    pub fn probe_block<I: Intersector + ?Sized>(
        &self,
        state: &mut State,
        intersector: &I,
        (index, start): (u32, &ProbeStart),
        (seed, block, block_length): (u64, u32, u32),
    ) -> ([f64; 3], u64) {
        let mut sum = BlockSum::default();
        for i in 0..block_length {
            let sampler = BlockSampler::new(seed, index, block, i);
            let query = self.start_probe(state, intersector, start, sampler);
            sum.add(self.run(state, intersector, query, |_, _| {}));
        }
        sum.mean(block_length)
    }
}
