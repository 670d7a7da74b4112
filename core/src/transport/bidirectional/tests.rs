//! Weights against densities that are multiplied out in f64, strategy by strategy.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use super::connect::Exchange;
use super::emitters::Start;
use super::vertex::{From, Scatterer, Vertex};
use super::walk::{Seen, Walk};
use super::weight::Links;
use super::{Bidirectional, Heuristic, Settings};
use crate::bsdf::{Interface, Lobes};
use crate::geometry::{Bvh2, Ray, SurfacePoint};
use crate::light::{self, LightSample};
use crate::math::Vec3;
use crate::medium::Inside;
use crate::sampling::counter::Counter;
use crate::scene::*;
use crate::transport::Surface;
use crate::transport::volume::Surroundings;
use std::boxed::Box;
use std::vec;
use std::vec::Vec;

/// A vertex of a path that is given.
#[derive(Clone, Copy, Debug)]
struct Place {
    at: Vec3,
    /// Zero in a medium.
    normal: Vec3,
    exponent: f32,
    g: f32,
    /// Scatters like a mirror: its neighbours cannot be joined to it.
    specular: bool,
}

const EXTINCTION: f32 = 0.7;

fn f64s(v: Vec3) -> [f64; 3] {
    v.to_array().map(f64::from)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Place {
    fn scatterer(&self) -> Scatterer {
        if self.normal == Vec3::ZERO {
            return Scatterer::Medium { g: self.g, extinction: EXTINCTION };
        }
        let lobes = Lobes {
            albedo: Vec3::splat(0.3),
            specular: Vec3::splat(if self.exponent > 0.0 { 0.4 } else { 0.0 }),
            exponent: self.exponent,
            ..Lobes::diffuse(Vec3::ZERO)
        };
        Scatterer::Surface { lobes, geometric: self.normal, shading: self.normal }
    }

    /// Density of directions in f64.
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f64 {
        let (wo, wi) = (f64s(wo), f64s(wi));
        if self.specular {
            return 1.0;
        }
        let pi = std::f64::consts::PI;
        if self.normal == Vec3::ZERO {
            let g = f64::from(self.g);
            return (1.0 - g * g) / (4.0 * pi * (1.0 + g * g + 2.0 * g * dot(wo, wi)).powf(1.5));
        }
        let n = f64s(self.normal);
        let diffuse = dot(wi, n).max(0.0) / pi;
        if self.exponent == 0.0 {
            return diffuse;
        }
        let share = f64::from(0.3_f32) / (f64::from(0.3_f32) + f64::from(0.4_f32));
        let e = f64::from(self.exponent);
        let mirrored = [0, 1, 2].map(|k| n[k] * (2.0 * dot(wo, n)) - wo[k]);
        let cos = dot(wi, mirrored).max(0.0);
        share * diffuse + (1.0 - share) * (e + 1.0) / (2.0 * pi) * cos.powf(e)
    }

    /// Cosine or extinction.
    fn facing(&self, w: Vec3) -> f64 {
        if self.normal == Vec3::ZERO { f64::from(EXTINCTION) } else { dot(f64s(self.normal), f64s(w)).abs() }
    }
}

fn scene(kind: usize) -> CompiledScene {
    let lamp = MaterialDesc {
        name: "lamp".into(),
        kind: MaterialKind::Diffuse { albedo: Reflectance::flat([0.0; 3]) },
        two_sided: true,
        emission: [3.0; 3],
    };
    let shape = |kind| ShapeDesc { kind, material: "lamp".into(), interior: "".into(), exterior: "".into() };
    let shape = match kind {
        0 => shape(ShapeKind::Rectangle { center: [0.0, 2.0, 0.0], u: [0.5, 0.0, 0.0], v: [0.0, 0.0, 0.4] }),
        _ => shape(ShapeKind::Sphere { center: [0.0, 2.0, 0.0], radius: 0.5 }),
    };
    let intensity = [1.0; 3];
    let direction = [0.2, -1.0, 0.1];
    let lights = match kind {
        2 => vec![LightDesc::Point { position: [0.5, 2.5, 0.0], intensity }],
        3 => vec![LightDesc::Directional { direction, irradiance: [1.0; 3] }],
        4 => vec![LightDesc::Spot {
            position: [0.5, 2.5, 0.0],
            direction,
            intensity,
            cone_deg: 80.0,
            falloff_deg: 20.0,
        }],
        _ => vec![],
    };
    let camera = CameraDesc {
        position: [0.0, 0.0, 5.0],
        look_at: [0.0; 3],
        up: [0.0, 1.0, 0.0],
        fov_x_deg: 60.0,
        resolution: [8, 6],
        lens_radius: 0.0,
        focus_distance: 1.0,
        medium: "".into(),
    };
    let desc = SceneDesc {
        camera: Some(camera),
        materials: vec![lamp],
        shapes: vec![shape],
        lights,
        ..SceneDesc::default()
    };
    compile(&desc).unwrap().0
}

type Tracer<'a> = Bidirectional<'a, true, true, false>;

/// A path from a place on a light to the camera.
struct Path<'a> {
    tracer: Tracer<'a>,
    scene: &'a CompiledScene,
    /// The light, the places between, the camera.
    places: Vec<Place>,
    light: usize,
    pass: f32,
}

impl Path<'_> {
    fn towards(&self, i: usize, j: usize) -> Vec3 {
        if self.distant() && i == 0 {
            return Vec3::from_array(self.record().normal);
        }
        if self.distant() && j == 0 {
            return -Vec3::from_array(self.record().normal);
        }
        (self.places[j].at - self.places[i].at).normalize()
    }

    fn record(&self) -> &LightRecord {
        &self.scene.lights[self.light]
    }

    fn distant(&self) -> bool {
        super::emitters::is_distant(self.record())
    }

    fn last(&self) -> usize {
        self.places.len() - 1
    }

    /// Sends a walk along the path; vertices 1 up to (without) the other end. Returns them, each with the walk that reaches the place after it.
    fn walk(&self, from: From, links: &mut Links) -> Vec<(Vertex, Walk)> {
        let order: Vec<usize> = match from {
            From::Light => (0..=self.last()).collect(),
            From::Sensor => (0..self.places.len()).rev().collect(),
        };
        let direction = self.towards(order[0], order[1]);
        let ray = Ray { origin: self.places[order[0]].at, direction, t_max: f32::MAX };
        let mut walk = match from {
            From::Light => {
                let start = Start {
                    light: self.light as u32,
                    ray,
                    position: self.places[0].at,
                    normal: self.places[0].normal,
                    carried: Vec3::ONE,
                    pdf_place: super::emitters::pdf_place(self.record()),
                    pdf_direction: self.tracer.emitters.pdf_towards(
                        self.record(),
                        -direction,
                        self.places[0].normal,
                    ),
                };
                self.tracer.light_walk(&start, Inside::NOTHING)
            }
            From::Sensor => {
                let pdf = self.scene.camera.unwrap().pdf_solid_angle(direction);
                let walk = Walk::new(From::Sensor, ray, Inside::NOTHING, Vec3::ONE);
                Walk { left: Some([pdf, 0.0]), ..walk }
            }
        };
        links.leave(0, &walk.chain, Some([0.0; 2]));
        let mut out = Vec::new();
        let count = if from == From::Light { self.last() - 1 } else { self.last() };
        for (i, pair) in order.windows(2).take(count).enumerate() {
            let place = &self.places[pair[1]];
            let wo = self.towards(pair[1], pair[0]);
            walk.pass = self.pass;
            let scatterer = place.scatterer();
            let facing = place.facing(wo) as f32;
            let mut chain = walk.link(&self.tracer, place.at, facing);
            if from == From::Light && i == 0 {
                chain.open *= super::emitters::preference_at(self.record(), place.at, self.places[0].at);
            }
            let vertex = Vertex {
                point: SurfacePoint { position: place.at, extent: 0.0 },
                wo,
                scatterer,
                ..Vertex::nowhere(chain)
            };
            let vertex = self.tracer.vertex(&walk, vertex);
            let reached = walk;
            if let Some(next) = order.get(i + 2) {
                let wi = self.towards(pair[1], *next);
                let (_, densities) = vertex.scattering::<true, false>(from, wi);
                let left = (!place.specular).then_some(densities);
                links.leave(vertex.index as usize, &vertex.chain, left);
                walk.origin = place.at;
                walk.leave((vertex.index, &vertex.chain), left, vertex.facing(wi, 1.0));
            }
            out.push((vertex, reached));
        }
        out
    }

    /// Density per solid angle by which light sampling at a point draws the light's place; 0 for what has no size.
    fn direct_pdf(&self, p: Vec3) -> f32 {
        if self.record().area <= 0.0 {
            return 0.0;
        }
        let to = self.places[0].at - p;
        light::pdf_solid_angle(self.record(), p, to.normalize(), to.length(), self.places[0].normal)
    }

    /// The weights of all strategies by the estimator; `None` where a strategy cannot make the path.
    fn weights(&self) -> Vec<Option<f32>> {
        let mut links = Box::new([Links::EMPTY; 2]);
        let light = self.walk(From::Light, &mut links[0]);
        let eye = self.walk(From::Sensor, &mut links[1]);
        let k = self.last();
        let weigh = |e: &Exchange| self.tracer.weight(&links, &e.ends, self.pass);
        let joins = |i: usize| !self.places[i].specular;
        let mut out = Vec::new();
        for s in 0..=k {
            let t = k + 1 - s;
            let weight = match s {
                0 if self.record().area > 0.0 => {
                    let (vertex, walk) = &eye[t - 2];
                    let surface = Surface {
                        point: vertex.point,
                        front: self.places[0].normal,
                        geometric: self.places[0].normal,
                        shading: self.places[0].normal,
                        interpolated: self.places[0].normal,
                        wo: vertex.wo,
                        lobes: Lobes::diffuse(Vec3::ZERO),
                        interface: Interface::Opaque,
                        light: self.light as u32,
                        from_front: true,
                    };
                    let walk = Walk { carried: Vec3::ONE, ..*walk };
                    let seen = Seen::Surface(&surface, &vertex.chain);
                    Some(self.tracer.seen(&walk, &seen, false, &links[1]).x / self.record().radiance[0])
                }
                1 if t >= 2 && joins(1) => {
                    let (vertex, _) = &eye[t - 2];
                    let pdf = self.direct_pdf(vertex.position());
                    let sample = LightSample {
                        wi: self.towards(1, 0),
                        contribution: Vec3::ONE,
                        pdf,
                        point: self.places[0].at,
                        normal: self.places[0].normal,
                        extent: 0.0,
                        distant: self.distant(),
                    };
                    Some(weigh(&self.tracer.with_light(vertex, self.record(), &sample)))
                }
                s if s >= 2 && t == 1 && joins(s - 1) => {
                    let (vertex, _) = &light[s - 2];
                    let camera = self.scene.camera.unwrap();
                    Some(weigh(&self.tracer.with_camera(&camera, vertex, self.places[k].at)))
                }
                s if s >= 2 && t >= 2 && joins(s - 1) && joins(s) => {
                    self.tracer.between_walks(&eye[t - 2].0, &light[s - 2].0).map(|e| weigh(&e))
                }
                _ => None,
            };
            out.push(weight);
        }
        out
    }

    /// The densities of all strategies, multiplied out.
    fn densities(&self) -> Vec<f64> {
        let k = self.last();
        let pi = std::f64::consts::PI;
        let d2 = |i: usize, j: usize| {
            if self.distant() && i.min(j) == 0 {
                return 1.0;
            }
            let (a, b) = (f64s(self.places[i].at), f64s(self.places[j].at));
            (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum()
        };
        let pass = f64::from(self.pass);
        let record = self.record();
        let place = f64::from(super::emitters::pdf_place(record));
        let radius = f64::from(self.scene.bounding_sphere().1);
        let out = f64s(self.towards(0, 1));
        let cos = dot(f64s(self.places[0].normal), out);
        let emission = if record.area > 0.0 {
            cos / pi
        } else if record.kind == LightKind::Directional as u32 {
            1.0 / (pi * radius * radius)
        } else if record.kind == LightKind::Spot as u32 {
            let full = 20.0_f64.to_radians().cos();
            let cone = 80.0_f64.to_radians().cos();
            let axis = f64s(Vec3::new(0.2, -1.0, 0.1).normalize());
            let x = ((dot(out, axis) - cone) / (full - cone)).clamp(0.0, 1.0);
            x * x * (3.0 - 2.0 * x) / (2.0 * pi * (1.0 - 0.5 * (full + cone)))
        } else {
            1.0 / (4.0 * pi)
        };
        // Density of place i as the walk from the light draws it, and as that from the camera does.
        let from_light = |i: usize| match i {
            0 => place,
            1 => emission * self.places[1].facing(self.towards(1, 0)) / d2(0, 1) * pass,
            _ => {
                let p = self.places[i - 1].pdf(self.towards(i - 1, i - 2), self.towards(i - 1, i));
                p * self.places[i].facing(self.towards(i, i - 1)) / d2(i, i - 1) * pass
            }
        };
        let from_camera = |i: usize| {
            let facing = if i == 0 { cos } else { self.places[i].facing(self.towards(i, i + 1)) };
            let p = if i + 1 == k {
                let cos = -f64s(self.towards(k, k - 1))[2];
                let half = 30.0_f64.to_radians().tan();
                1.0 / (4.0 * half * half * 0.75 * cos.powi(3))
            } else {
                self.places[i + 1].pdf(self.towards(i + 1, i + 2), self.towards(i + 1, i))
            };
            p * facing / d2(i, i + 1) * pass
        };
        let direct = f64::from(self.direct_pdf(self.places[1].at)) * cos / d2(0, 1);
        (0..=k)
            .map(|s| {
                let joins = |i: usize| !self.places[i].specular;
                let possible = match s {
                    0 => record.area > 0.0,
                    _ if s == 1 && k == 1 => false,
                    _ => joins(s - 1) && joins(s),
                };
                if !possible {
                    return 0.0;
                }
                let light: f64 = (0..s).map(from_light).product();
                let light = if s == 1 && record.area > 0.0 { direct } else { light };
                light * (s..k).map(from_camera).product::<f64>()
            })
            .collect()
    }
}

fn path<'a>(scene: &'a CompiledScene, n: u32, settings: Settings) -> Path<'a> {
    let tree = Bvh2::new(scene.primitives());
    let tracer = Tracer::new(scene, &tree, settings, Surroundings::default());
    let numbers = Counter::new(7);
    let u = |k: u32| numbers.unit(n, k, 0);
    let light = if scene.lights.len() > 1 { 1 } else { 0 };
    let record = &scene.lights[light];
    let edges = 1 + n % 5;
    let at = Vec3::from_array(record.point);
    let count = edges + 1;
    let middle: Vec<Place> = (1..count - 1)
        .map(|i| {
            let r = |k: u32| u(10 * i + k);
            let at = Vec3::new(4.0 * r(0) - 2.0, 1.2 - 2.4 * r(1), 2.0 * r(2) - 1.0);
            Place {
                at,
                normal: Vec3::ZERO,
                exponent: if r(4) < 0.4 { 12.0 } else { 0.0 },
                g: 1.6 * r(5) - 0.8,
                specular: false,
            }
        })
        .collect();
    let camera =
        Place { at: Vec3::new(0.0, 0.0, 5.0), normal: Vec3::ZERO, exponent: 0.0, g: 0.0, specular: false };
    let first = Place { at, ..camera };
    let mut places: Vec<Place> = [first].into_iter().chain(middle).chain([camera]).collect();
    let next = places[1].at;
    if record.kind == LightKind::Sphere as u32 {
        let normal = ((next - at).normalize() + 0.3 * Vec3::new(u(1), u(2), u(3))).normalize();
        (places[0].at, places[0].normal) = (at + normal * record.params[0], normal);
    } else if record.area > 0.0 {
        places[0].at = at + Vec3::from_array(record.edge1) * u(1) + Vec3::from_array(record.edge2) * u(2);
        let normal = Vec3::from_array(record.normal);
        places[0].normal = if normal.dot(next - at) > 0.0 { normal } else { -normal };
    }
    // Surfaces face both of their neighbours, or are a medium.
    for i in 1..places.len() - 1 {
        let beam = -Vec3::from_array(record.normal);
        let distant = i == 1 && super::emitters::is_distant(record);
        let a = if distant { beam } else { (places[i - 1].at - places[i].at).normalize() };
        let b = (places[i + 1].at - places[i].at).normalize();
        let half = (a + b).normalize();
        if u(100 + i as u32) < 0.6 && half.dot(a) > 0.1 {
            places[i].normal = half;
            places[i].specular = u(200 + i as u32) < 0.25;
        }
    }
    Path { tracer, scene, places, light, pass: 0.1 + 0.9 * u(5) }
}

#[test]
fn weights_are_shares_of_densities_and_add_up_to_one() {
    let mut counted = [0; 6];
    for kind in 0..5 {
        let scene = scene(kind);
        // The rectangle's front is where its light goes.
        for heuristic in [Heuristic::Power, Heuristic::Balance, Heuristic::Cutoff(0.1)] {
            for n in 0..400 {
                let settings = Settings::new(u32::MAX, heuristic, None);
                let path = path(&scene, n, settings);
                let densities = path.densities();
                let share = |p: &f64| match heuristic {
                    Heuristic::Power => p * p,
                    Heuristic::Balance => *p,
                    Heuristic::Cutoff(part) => {
                        let largest = densities.iter().fold(0.0_f64, |m, p| m.max(*p));
                        if *p < f64::from(part) * largest { 0.0 } else { *p }
                    }
                };
                let sum: f64 = densities.iter().map(share).sum();
                if sum <= 0.0 || densities.iter().any(|p| !p.is_finite()) {
                    continue;
                }
                // Next to the threshold rounding decides.
                let largest = densities.iter().fold(0.0_f64, |m, p| m.max(*p));
                if densities.iter().any(|p| (p / largest / 0.1 - 1.0).abs() < 1e-3) {
                    continue;
                }
                let mut total = 0.0;
                for (s, weight) in path.weights().iter().enumerate() {
                    let truth = share(&densities[s]) / sum;
                    let found = f64::from(weight.unwrap_or(0.0));
                    if densities[s] > 0.0 {
                        assert!(weight.is_some(), "{kind} {n} {s}");
                        total += found;
                        counted[s] += 1;
                        let off = (found - truth).abs();
                        assert!(
                            off < 2e-4,
                            "{kind} {n} {heuristic:?} s = {s}: {found} {truth}\n{:?}",
                            path.places
                        );
                    }
                }
                assert!((total - 1.0).abs() < 3e-4, "{kind} {n} {heuristic:?}: {total}");
            }
        }
    }
    assert!(counted.iter().all(|c| *c > 300), "{counted:?}");
}
