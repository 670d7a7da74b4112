//! Vertices of the two walks joined: what a joint brings, and whether the way is free.

use super::emitters;
use super::vertex::{From, Vertex};
use super::weight::{Chain, End, Links, weigh};
use super::{Bidirectional, CHANCE_GROUPS, GROUPS, LIGHT_GROUPS, Phase, State};
use crate::geometry::{Hit, Ray, SurfacePoint, offset_origin, segment};
use crate::light::LightSample;
use crate::math::{self, Vec3};
use crate::scene::LightRecord;
use crate::sensor::Camera;
use crate::transport::volume::way::{Followed, Way};
use crate::transport::volume::with_unit_direction;
use crate::transport::{Answer, Query};

/// What would bring less than this part of what the sample has brought so far is joined by chance.
const SMALL: f32 = 0.05;

/// One end of a joint: its walk's chain with the densities of the other walk.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weighed {
    chain: Chain,
    forward: f32,
    backward: f32,
    index: u32,
}

/// A straight way between two vertices, or to a light or the camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Connection {
    way: Way,
    /// What it brings if the rest of the way is free and clear, unweighted.
    carried: Vec3,
    /// Mean chance over the channels to fly this far.
    pass: f32,
    ends: [Option<Weighed>; 2],
    /// Where it lands, if not in the sample's own pixel.
    pixel: Option<[u32; 2]>,
}

/// Which vertex a joint leaves.
#[derive(Clone, Copy)]
enum Joined<'a> {
    /// The sensor's last.
    Eye,
    /// One of the light's, for the camera at this pixel.
    Light(&'a Vertex, [u32; 2]),
}

impl Connection {
    pub(super) fn nothing() -> Self {
        Self { way: Way::NOTHING, carried: Vec3::ZERO, pass: 1.0, ends: [None; 2], pixel: None }
    }
}

/// A segment from a vertex to a place with a normal (zero: none), both ends off their surfaces.
#[inline]
fn between(from: &Vertex, to: &SurfacePoint, normal: Vec3, exchange: &Exchange) -> Ray {
    let Exchange { wi, distance, .. } = *exchange;
    let origin = offset_origin(&from.point.within(distance), from.normal(), wi);
    let end =
        if normal == Vec3::ZERO { to.position } else { offset_origin(&to.within(distance), normal, -wi) };
    segment(if from.normal() == Vec3::ZERO { from.position() } else { origin }, end)
}

/// What two vertices exchange if nothing is between them: unweighted, and what its weight needs to know.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exchange {
    pub carried: Vec3,
    pub ends: [Option<Weighed>; 2],
    /// Unit direction from the vertex that the ray leaves, and the distance \[m\].
    wi: Vec3,
    distance: f32,
}

impl<const VOLUME: bool, const LOBES: bool, const DETAIL: bool> Bidirectional<'_, VOLUME, LOBES, DETAIL> {
    /// Between a vertex of the light's walk and a point of the lens.
    #[inline]
    pub(super) fn with_camera(&self, camera: &Camera, vertex: &Vertex, lens: Vec3) -> Exchange {
        let to = lens - vertex.position();
        let d2 = to.length_squared();
        let distance = math::sqrt(d2);
        let wi = to / distance;
        let pdf = camera.pdf_solid_angle(-wi);
        let (f, densities) = vertex.scattering::<LOBES, DETAIL>(From::Light, wi);
        let end = Weighed {
            chain: vertex.chain,
            forward: pdf * vertex.facing(wi, d2),
            backward: densities[1],
            index: vertex.index,
        };
        Exchange { carried: vertex.carried * f * (pdf / d2), ends: [Some(end), None], wi, distance }
    }

    /// Between a vertex of the sensor's walk and a place on a light.
    #[inline]
    pub(super) fn with_light(&self, vertex: &Vertex, light: &LightRecord, s: &LightSample) -> Exchange {
        let (f, densities) = vertex.scattering::<LOBES, DETAIL>(From::Sensor, s.wi);
        let to = s.point - vertex.position();
        let d2 = if s.distant { 1.0 } else { to.length_squared() };
        let preference = emitters::preference(light, s.pdf, math::abs(s.wi.dot(s.normal)) / d2);
        let own = Weighed {
            chain: vertex.chain,
            forward: self.emitters.pdf_towards(light, s.wi, s.normal) * vertex.facing(s.wi, d2) / preference,
            backward: densities[1],
            index: vertex.index,
        };
        // Densities of the place on the light are over that of light sampling here.
        let met = s.pdf > 0.0;
        let (pdf, open) = if met { (s.pdf, 1.0) } else { (1.0, 0.0) };
        let chain = Chain { pdf, open, ..Chain::default() };
        let other = Weighed { chain, forward: densities[0], backward: 0.0, index: 0 };
        let distance = if s.distant { f32::INFINITY } else { math::sqrt(d2) };
        Exchange {
            carried: vertex.carried * f * s.contribution,
            ends: [Some(other), Some(own)],
            wi: s.wi,
            distance,
        }
    }

    /// Between vertices of the two walks.
    #[inline]
    pub(super) fn between_walks(&self, eye: &Vertex, light: &Vertex) -> Option<Exchange> {
        let to = light.position() - eye.position();
        let d2 = to.length_squared();
        if !(f32::MIN_POSITIVE..=f32::MAX).contains(&d2) {
            return None;
        }
        let distance = math::sqrt(d2);
        let wi = to / distance;
        let (f, densities) = eye.scattering::<LOBES, DETAIL>(From::Sensor, wi);
        if f == Vec3::ZERO {
            return None;
        }
        let (g, back) = light.scattering::<LOBES, DETAIL>(From::Light, -wi);
        let mut carried = eye.carried * f * (light.carried * g) / d2;
        if VOLUME && eye.coloured && light.coloured {
            // Both stand for three colours.
            carried *= 1.0 / 3.0;
        }
        let theirs = Weighed {
            chain: light.chain,
            forward: densities[0] * light.facing(wi, d2),
            backward: back[1],
            index: light.index,
        };
        let ours = Weighed {
            chain: eye.chain,
            forward: back[0] * eye.facing(wi, d2),
            backward: densities[1],
            index: eye.index,
        };
        Some(Exchange { carried, ends: [Some(theirs), Some(ours)], wi, distance })
    }

    /// A vertex of the light's walk joined to the camera.
    #[inline]
    pub(super) fn splat(&self, state: &mut State, vertex: &Vertex) -> Option<Query> {
        let camera = self.scene.camera.as_ref().filter(|_| !state.probe)?;
        if !vertex.connects() || !self.settings.uses(vertex.index + 1, 1) {
            return None;
        }
        let lens = if camera.lens_radius > 0.0 {
            camera.sample_lens(state.sampler.group2(LIGHT_GROUPS + GROUPS * state.walk.event + 1))
        } else {
            Vec3::from_array(camera.position)
        };
        let pixel = camera.pixel(lens, vertex.position())?;
        let exchange = self.with_camera(camera, vertex, lens);
        let point = SurfacePoint { position: lens, extent: 0.0 };
        let ray = between(vertex, &point, Vec3::ZERO, &exchange);
        self.launch(state, Joined::Light(vertex, pixel), &exchange, ray)
    }

    /// The sensor's last vertex joined to a sampled light.
    #[inline]
    fn join_light(&self, state: &mut State) -> Option<Query> {
        let vertex = &state.vertex;
        if !self.settings.uses(1, vertex.index + 1) || self.scene.lights.is_empty() {
            return None;
        }
        // The walk has been sent on already.
        let group = 1 + GROUPS * state.walk.event.wrapping_sub(1) + 1;
        let [pick, u, v, _] = state.sampler.bits4(group);
        let (index, s) = emitters::sample(self.scene, vertex.position(), pick, [u, v])?;
        let exchange = self.with_light(vertex, &self.scene.lights[index as usize], &s);
        let ray = if s.distant {
            Ray { origin: vertex.leave(s.wi), direction: s.wi, t_max: f32::MAX }
        } else {
            let point = SurfacePoint { position: s.point, extent: s.extent };
            between(vertex, &point, s.normal, &exchange)
        };
        self.launch(state, Joined::Eye, &exchange, ray)
    }

    /// The sensor's last vertex joined to one of the light's.
    #[inline]
    fn join_vertex(&self, state: &mut State, number: usize) -> Option<Query> {
        let (eye, light) = (&state.vertex, &state.vertices[number]);
        let edges = eye.edges.saturating_add(light.edges).saturating_add(1);
        if edges > self.settings.max_depth || !self.settings.uses(light.index + 1, eye.index + 1) {
            return None;
        }
        let exchange = self.between_walks(eye, light)?;
        let ray = between(eye, &light.point, light.normal(), &exchange);
        self.launch(state, Joined::Eye, &exchange, ray)
    }

    /// The next joint of the sensor's last vertex from this one on: 0 is that to a light.
    #[inline]
    pub(super) fn join_from(&self, state: &mut State, first: u32) -> Query {
        if state.vertex.connects() && state.vertex.edges < self.settings.max_depth {
            for number in first..=state.vertices.len() as u32 {
                let query = match number {
                    0 => self.join_light(state),
                    n => self.join_vertex(state, n as usize - 1),
                };
                if let Some(query) = query {
                    state.phase = Phase::Join(number);
                    return query;
                }
            }
        }
        self.follow_sensor(state)
    }

    #[inline]
    pub(super) fn weight(&self, links: &[Links; 2], ends: &[Option<Weighed>; 2], pass: f32) -> f32 {
        if self.settings.only.is_some() {
            return 1.0;
        }
        let end = |k: usize| {
            ends[k].as_ref().map(|e| End {
                chain: &e.chain,
                forward: e.forward,
                backward: e.backward,
                index: e.index as usize,
                links: &links[k],
            })
        };
        weigh(self.settings.heuristic, pass, [end(0), end(1)])
    }

    /// Sends a joint on its way, if it can bring anything.
    #[inline]
    fn launch(&self, state: &mut State, joined: Joined<'_>, exchange: &Exchange, ray: Ray) -> Option<Query> {
        let Exchange { carried, ends, distance, .. } = *exchange;
        if carried == Vec3::ZERO || !carried.is_finite() {
            return None;
        }
        let pixel = match joined {
            Joined::Eye => None,
            Joined::Light(_, pixel) => Some(pixel),
        };
        let mut carried = carried;
        // Weights by cutoff may be nothing now and something when the way is known.
        let known = !VOLUME || !self.settings.lists();
        let weight = if known { self.weight(&state.links, &ends, 1.0) } else { 1.0 };
        let brings = math::mean(carried) * weight;
        let enough = SMALL * math::mean(state.radiance);
        let by_chance = self.settings.only.is_none() && self.settings.roulette.is_on();
        if brings < enough && pixel.is_none() && by_chance {
            let chance = brings / enough;
            let number = (ends[0].map_or(0, |e| e.index) << 12).wrapping_add(state.vertex.index);
            let [u, _] = state.sampler.group2(CHANCE_GROUPS + number);
            if u >= chance {
                return None;
            }
            carried /= chance;
        }
        if !VOLUME {
            // Nothing on the way changes what it brings.
            state.connection.carried = carried * weight;
            state.connection.pixel = pixel;
            return Some(Query::Shadow(ray));
        }
        let ray = with_unit_direction(ray);
        let from = match joined {
            Joined::Eye => &state.vertex,
            Joined::Light(vertex, _) => vertex,
        };
        let lead = from.lead(ray.origin, ray.direction);
        state.connection = Connection {
            way: Way { ray, lead, left: distance, inside: from.media(ray.direction), crossed: 0 },
            carried,
            ends,
            pixel,
            ..Connection::nothing()
        };
        Some(Query::Closest(ray))
    }

    /// A joint has reached its end or something in the way.
    #[inline]
    pub(super) fn join(&self, state: &mut State, answer: Answer) -> Query {
        match answer {
            Answer::Occluded(false) => self.arrived(state, 1.0),
            Answer::Occluded(true) => {}
            Answer::Closest(hit) => {
                if let Some(query) = self.join_on(state, hit) {
                    return query;
                }
            }
        }
        match state.phase {
            Phase::Splat => self.follow_light(state),
            Phase::Join(number) => self.join_from(state, number + 1),
            _ => Query::Done,
        }
    }

    #[inline]
    fn arrived(&self, state: &mut State, weight: f32) {
        let value = state.connection.carried * weight;
        match state.connection.pixel {
            Some(pixel) => state.splat = Some((pixel, value)),
            None => state.radiance += value,
        }
    }

    /// The next part of a joint through media and boundaries; `None` where it is at its end.
    #[inline]
    fn join_on(&self, state: &mut State, hit: Option<Hit>) -> Option<Query> {
        let Connection { way, carried, pass, .. } = &mut state.connection;
        let followed = way.follow::<LOBES, DETAIL, DETAIL>(self.scene, hit, |through, chance| {
            *carried *= through;
            *pass *= chance;
        });
        match followed {
            Followed::Part if *carried != Vec3::ZERO => return Some(Query::Closest(way.ray)),
            Followed::Whole => {
                let weight = self.weight(&state.links, &state.connection.ends, state.connection.pass);
                self.arrived(state, weight);
            }
            _ => {}
        }
        None
    }
}
