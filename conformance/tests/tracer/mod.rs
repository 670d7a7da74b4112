//! A path tracer of the tests' own, recursive in spirit and slow, with faults to switch on.

use etendue_conformance::reference::{ReferenceBackend, check_job, serial_blocks};
use etendue_core::backend::{
    self, Backend, BackendError, BackendInfo, Capabilities, Control, JobStats, PathJob, Probe, Session,
};
use etendue_core::bsdf::{Interface, Lobes};
use etendue_core::film::Film;
use etendue_core::geometry::{Bvh2, Hit, Intersector, Primitives, Ray, SurfacePoint, offset_origin};
use etendue_core::kernel::Kernel;
use etendue_core::light;
use etendue_core::math::{PI, Vec3};
use etendue_core::sampling::discrete;
use etendue_core::sampling::sobol::BlockSampler;
use etendue_core::scene::{CompiledScene, LightKind, NO_INDEX};
use etendue_core::transport::{Surface, resolve_probe, surface_at};
use std::sync::Arc;

/// What is wrong with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    CosineForgotten,
    MisWeightDropped,
    LightPickBiased,
    RouletteNotCompensated,
    EmissionTwoSided,
    NormalFlipped,
    /// One per cent per bounce.
    EnergyLost,
    /// Hits within 1/300 of an edge.
    EdgesMissed,
    /// Of coincident surfaces the later one.
    TieRule,
    SrgbNotDecoded,
    DepthOffByOne,
    EnvironmentDropped,
    ShadowsForgotten,
    DistanceNotSquared,
    /// 22/7.
    PiWrong,
    /// Every block draws the same points.
    NoScramble,
    BlockForgotten,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct TracerBackend {
    pub(crate) fault: Option<Fault>,
}

impl Backend for TracerBackend {
    fn info(&self) -> BackendInfo {
        BackendInfo { name: "tracer", adapter: format!("{:?}", self.fault), version: "0" }
    }
    fn capabilities(&self) -> Capabilities {
        Capabilities { path: true, bidirectional: false, volume: true, kernels: true }
    }
    fn open(&self, scene: Arc<CompiledScene>) -> Result<Box<dyn Session>, BackendError> {
        let mut scene = (*scene).clone();
        if self.fault == Some(Fault::SrgbNotDecoded) {
            scene.srgb_decode = (0..256).map(|c| c as f32 / 255.0).collect();
        }
        Ok(Box::new(TracerSession { scene, fault: self.fault }))
    }
    fn map(
        &self,
        kernel: Kernel,
        constants: &[u32],
        items: &[u32],
        out: &mut [u32],
    ) -> Result<(), BackendError> {
        ReferenceBackend.map(kernel, constants, items, out)
    }
}

struct TracerSession {
    scene: CompiledScene,
    fault: Option<Fault>,
}

/// A tree, or one with a fault.
struct Rays<'a> {
    tree: Bvh2<'a>,
    primitives: Primitives<'a>,
    fault: Option<Fault>,
}

impl Rays<'_> {
    fn trace(&self, ray: &Ray) -> Option<Hit> {
        match self.fault {
            Some(Fault::TieRule) => {
                let prepared = etendue_core::geometry::PreparedRay::new(ray);
                (0..self.primitives.count() as u32)
                    .filter_map(|id| self.primitives.intersect(id, &prepared, ray.t_max))
                    .reduce(|a, b| if b.t <= a.t { b } else { a })
            }
            Some(Fault::EdgesMissed) => self
                .tree
                .closest_hit(ray)
                .filter(|h| h.b1 > 1.0 / 300.0 && h.b2 > 1.0 / 300.0 && h.b1 + h.b2 < 1.0 - 1.0 / 300.0),
            _ => self.tree.closest_hit(ray),
        }
    }
}

/// One path under construction.
struct Path<'a> {
    scene: &'a CompiledScene,
    rays: &'a Rays<'a>,
    fault: Option<Fault>,
    max_depth: u32,
    sampler: BlockSampler,
    traced: u64,
}

impl Path<'_> {
    fn has(&self, fault: Fault) -> bool {
        self.fault == Some(fault)
    }

    /// Follows a ray; `pdf` is the density of its direction, 0 where only it can find lights.
    fn follow(&mut self, mut ray: Ray, mut throughput: Vec3, mut pdf: f32, mut depth: u32) -> Vec3 {
        let mut sum = Vec3::ZERO;
        loop {
            self.traced += 1;
            let Some(hit) = self.rays.trace(&ray) else {
                if !self.has(Fault::EnvironmentDropped) {
                    let pdf = if self.has(Fault::MisWeightDropped) { 0.0 } else { pdf };
                    sum += throughput * light::escaped(self.scene, ray.direction, pdf, 1.0);
                }
                return sum;
            };
            let Some(mut s) = surface_at::<true, true, true>(self.scene, &ray, &hit) else { return sum };
            if s.light != NO_INDEX && (s.from_front || self.has(Fault::EmissionTwoSided)) {
                let l = &self.scene.lights[s.light as usize];
                let mut weight = 1.0;
                if pdf > 0.0 {
                    let q = light::pdf_solid_angle(l, ray.origin, ray.direction, hit.t, s.front);
                    weight = power(pdf, q);
                }
                sum += throughput * Vec3::from_array(l.radiance) * weight;
            }
            if depth >= self.max_depth + u32::from(self.has(Fault::DepthOffByOne)) {
                return sum;
            }
            if self.has(Fault::NormalFlipped) {
                s.shading = -s.shading;
            }
            sum += throughput * self.direct(&s, depth);
            let Some((next, factor, density)) = self.bounce(&s, depth, throughput) else { return sum };
            throughput *= factor;
            (ray, pdf) = (next, density);
            depth += 1;
        }
    }

    /// Light sampling, without the throughput.
    fn direct(&mut self, s: &Surface, depth: u32) -> Vec3 {
        if self.scene.lights.is_empty() || s.lobes.mirror {
            return Vec3::ZERO;
        }
        let [pick, u, v, _] = self.sampler.bits4(100 + 2 * depth);
        let mut index = discrete::pick_in(&self.scene.light_cumulative, pick).index as usize;
        if self.has(Fault::LightPickBiased) {
            index = ((u64::from(pick) * self.scene.lights.len() as u64) >> 32) as usize;
        }
        let l = &self.scene.lights[index];
        let p = s.point.position;
        let Some(x) = light::sample_light(self.scene, l, p, [u, v]) else { return Vec3::ZERO };
        let cos = if self.has(Fault::CosineForgotten) { 1.0 } else { x.wi.dot(s.shading).max(0.0) };
        if x.wi.dot(s.geometric) <= 0.0 || cos == 0.0 {
            return Vec3::ZERO;
        }
        let mut value = s.lobes.eval(s.shading, s.wo, x.wi) * x.contribution * cos;
        if x.pdf > 0.0 && !self.has(Fault::MisWeightDropped) {
            value *= power(x.pdf, s.lobes.pdf_solid_angle(s.shading, s.wo, x.wi));
        }
        let point_like = l.kind == LightKind::Point as u32 || l.kind == LightKind::Spot as u32;
        if point_like && self.has(Fault::DistanceNotSquared) {
            value *= (x.point - p).length();
        }
        if value == Vec3::ZERO || self.has(Fault::ShadowsForgotten) {
            return value;
        }
        let distance = if x.distant { 0.0 } else { (x.point - p).length() };
        let from = offset_origin(&s.point.within(distance), s.geometric, x.wi);
        let ray = if x.distant {
            Ray { origin: from, direction: x.wi, t_max: f32::MAX }
        } else {
            let end = SurfacePoint { position: x.point, extent: x.extent }.within(distance);
            let to = if x.normal == Vec3::ZERO { x.point } else { offset_origin(&end, x.normal, -x.wi) };
            etendue_core::geometry::segment(from, to)
        };
        self.traced += 1;
        if self.rays.trace(&ray).is_some() { Vec3::ZERO } else { value }
    }

    /// A scattered ray, what it multiplies the throughput by, and its density.
    fn bounce(&mut self, s: &Surface, depth: u32, throughput: Vec3) -> Option<(Ray, Vec3, f32)> {
        let [u, v, lobe, survive] = self.sampler.group4(101 + 2 * depth);
        let x = s.lobes.sample(s.shading, s.wo, [u, v], lobe)?;
        if x.wi.dot(s.geometric) <= 0.0 {
            return None;
        }
        let mut factor = x.weight;
        if self.has(Fault::EnergyLost) {
            factor *= 0.99;
        }
        // Another roulette than core's: from the third bounce, by the largest channel, at most 0.9.
        if depth >= 3 {
            let t = throughput * factor;
            let q = t.x.max(t.y).max(t.z).min(0.9);
            if survive >= q {
                return None;
            }
            if !self.has(Fault::RouletteNotCompensated) {
                factor /= q;
            }
        }
        let origin = s.leave(x.wi);
        Some((Ray { origin, direction: x.wi, t_max: f32::MAX }, factor, x.pdf))
    }
}

fn power(a: f32, b: f32) -> f32 {
    let (a, b) = (f64::from(a), f64::from(b));
    (a * a / (a * a + b * b)) as f32
}

impl TracerSession {
    fn blocks(
        &self,
        job: &PathJob,
        control: &dyn Control,
        film: &mut Film,
        start: impl Fn(&mut Path<'_>, u32) -> Vec3,
    ) -> Result<JobStats, BackendError> {
        let primitives = self.scene.primitives();
        let rays = Rays { tree: Bvh2::new(primitives), primitives, fault: self.fault };
        serial_blocks(job, control, film, |element, block| {
            let mut sum = [0.0; 3];
            let mut traced = 0;
            for i in 0..job.block_length {
                let sampler = if self.fault == Some(Fault::NoScramble) {
                    BlockSampler::new(job.seed, 0, 0, i)
                } else {
                    BlockSampler::new(!job.seed, element, block, i)
                };
                let mut path = Path {
                    scene: &self.scene,
                    rays: &rays,
                    fault: self.fault,
                    max_depth: job.max_depth.min(1 << 20),
                    sampler,
                    traced: 0,
                };
                let value = start(&mut path, element);
                traced += path.traced;
                for c in 0..3 {
                    sum[c] += f64::from(value[c]);
                }
            }
            let forgotten = self.fault == Some(Fault::BlockForgotten) && job.blocks.end - block == 1;
            let n = f64::from(job.block_length) * if forgotten { f64::INFINITY } else { 1.0 };
            (sum.map(|s| s / n), traced)
        })
    }
}

impl Session for TracerSession {
    fn scene(&self) -> &CompiledScene {
        &self.scene
    }
    fn preparation(&self) -> &[(&'static str, f64)] {
        &[]
    }

    fn path_image(
        &self,
        job: &PathJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::image_film_settings(&self.scene, job)?;
        check_job(&self.scene, job, film, &expected)?;
        let camera = self.scene.camera.ok_or(BackendError::NoCamera)?;
        self.blocks(job, control, film, |path, element| {
            if job.max_depth == 0 {
                return Vec3::ZERO;
            }
            let [u, v, a, b] = path.sampler.group4(99);
            let ray = camera.sample_ray(element % expected.width, element / expected.width, [u, v], [a, b]);
            path.follow(ray, Vec3::ONE, 0.0, 1)
        })
    }

    fn path_probes(
        &self,
        job: &PathJob,
        probes: &[Probe],
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::probe_film_settings(&self.scene, job, probes.len());
        check_job(&self.scene, job, film, &expected)?;
        let tree = Bvh2::new(self.scene.primitives());
        let points: Vec<_> = backend::check_probes(probes)?
            .into_iter()
            .map(|(p, n)| (resolve_probe(&self.scene, &tree, p, n), n))
            .collect();
        self.blocks(job, control, film, |path, element| {
            if job.max_depth == 0 {
                return Vec3::ZERO;
            }
            let (point, n) = points[element as usize];
            let pi = if path.has(Fault::PiWrong) { 22.0 / 7.0 } else { PI };
            let s = Surface {
                point,
                front: n,
                geometric: n,
                shading: if path.has(Fault::NormalFlipped) { -n } else { n },
                interpolated: n,
                wo: n,
                lobes: Lobes::diffuse(Vec3::ONE),
                interface: Interface::Opaque,
                light: NO_INDEX,
                from_front: true,
            };
            let mut sum = path.direct(&s, 0);
            if let Some((ray, factor, pdf)) = path.bounce(&s, 0, Vec3::ONE) {
                sum += path.follow(ray, factor, pdf, 1);
            }
            sum * pi
        })
    }
}
