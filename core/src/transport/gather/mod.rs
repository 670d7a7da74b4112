//! Images and irradiance from an illumination map, by tracing back from the sensor.
//!
//! Estimates radiance \[W m^-2 sr^-1\] along camera rays, or irradiance \[W/m^2\] at probes, where a map of photons ([`crate::illumination`]) knows the light that
//! has been scattered. Who brings which light, so that each path from a light counts once:
//!
//! - The **map** holds all arrivals but the first of lights without size (point, spot, directional); first arrivals of emissive surfaces and of the environment are
//!   in it. (Of surfaces below the picture of an environment is one, far away.)
//! - **Reading** at a vertex x: albedo / pi times (the map at x + the direct irradiance of lights without size, in closed form but for its shadow rays; beyond 64 lights, or 4 at second hand, of so many chosen by flux). The
//!   map knows nothing of directions, so that it answers for the diffuse part alone. A Phong lobe takes the direct light of lights without size by its value, one
//!   sample of surface lights, and is followed by a ray of its own; mirrors are followed. So are all lobes of rough metals and of plastic together, whose body
//!   sends on what depends on where it comes from; of the map it takes caustics alone, as if they were diffuse light. That ray, and no map, brings what it finds: emission (surfaces by
//!   the power heuristic against the sample; after a mirror all of it; the environment all of it) and what is read where it lands.
//! - **Final gather** (one bounce): the first vertex that is no mirror is not read. Lights without size bring what they do in a reading; one surface light is sampled for all lobes, and one direction of one lobe, chosen by its
//!   share of the reflectance. A diffuse direction is the gather ray: where it lands, through mirrors too, is read as above. A Phong direction only
//!   moves the vertex at which is gathered. Each lobe is an integral of its own, whose direction competes with the light sample by the power heuristic. What
//!   the gather ray meets is emission (direct light of x, the other half of the heuristic), or a surface whose reading is light with one more vertex.
//!   The one thing that neither finds is a light without size seen through mirrors alone: such arrivals are summed a second time, by themselves, and
//!   read at x ([`crate::transport::photon::Photon::caustic`]).
//!
//! - **Near surfaces**, within an element's largest length of where a gather ray starts, are not read either but gathered at again, where that length and no limit of depth are
//!   given: a photon there counts 1 / (pi r^2) times its flux, rarely and without bound as r falls, and the element's blur is seen at first hand.
//! - **Spheres and disks** are one element each, too coarse to be read: rays gather there as they do at the first surface, and go on to what can be read.
//!
//! - **Media** hold no map: where a ray's flight ends in one, lights are sampled and the ray goes on by the phase function, until it lands on a surface that is read. Boundaries that light passes are
//!   mirrors here, and what they let through.
//!
//! What stays out: a light without size that a Phong lobe or a medium sees through a mirror or a refracting boundary (no direction meets it; path tracing misses it, too).
//!
//! Accuracy: unbiased but for the map's elements, within which irradiance is constant or linear. Without the final gather they are seen as they are; with it their
//! error is averaged over what x sees. Where normals are interpolated the map still holds the irradiance of the flat faces.
//!
//! Numbers come in the groups of [`super::path`]: the sensor first, then two groups an edge. Roulette is that of path tracing, from the fifth edge.
//! Source: H. W. Jensen, "Realistic Image Synthesis Using Photon Mapping" (2001), chapter 8, for the parts; his map is another.

mod through;

use super::back::{BlockSum, NO_RAY, Roulette, camera_ray, emission, white_surface};
use super::volume::Vertex;
use super::{Surface, mis, surface_at};
use crate::bsdf::{Interface, diffuse, phong};
use crate::geometry::{Hit, Intersector, Ray, SurfacePoint};
use crate::illumination::Elements;
use crate::light::{self, LightSample, emit};
use crate::math::{INV_PI, PI, Vec3};
use crate::medium::Inside;
use crate::sampling::discrete::IntegerCdf;
use crate::sampling::sobol::BlockSampler;
use crate::scene::{CompiledScene, LightRecord};
use alloc::vec::Vec;

/// Most lights without size that are looked at where the sensor sees a surface: as many as there are in most scenes, which leaves no noise of their choice.
const LIGHTS_SEEN: u32 = 64;
/// Where a gather ray lands: there are many such places for each that is seen, but their light is the noisiest part.
const LIGHTS_GATHERED: u32 = 4;

/// Some of a scene's lights, to choose one by flux.
#[derive(Clone, Debug)]
struct Choice {
    lights: Vec<u32>,
    cdf: Option<IntegerCdf>,
}

impl Choice {
    fn new(scene: &CompiledScene, of: impl Fn(&LightRecord) -> bool) -> Self {
        let lights: Vec<u32> = (0..scene.lights.len() as u32)
            .filter(|i| of(&scene.lights[*i as usize]) && scene.lights[*i as usize].pmf > 0.0)
            .collect();
        let weights: Vec<f32> = lights.iter().map(|i| scene.lights[*i as usize].pmf).collect();
        Self { lights, cdf: IntegerCdf::try_new(&weights).ok() }
    }

    fn parts(&self) -> (&[u32], &[u32]) {
        (&self.lights, self.cdf.as_ref().map_or(&[], IntegerCdf::cumulative))
    }

    /// The light that a random word chooses, and by how much its own chance, by which its samples are divided, exceeds that of this choice.
    #[inline(always)]
    fn pick<'s>(&self, scene: &'s CompiledScene, word: u32) -> Option<(&'s LightRecord, f32)> {
        let pick = self.cdf.as_ref()?.pick(word);
        let light = scene.lights.get(*self.lights.get(pick.index as usize)? as usize)?;
        Some((light, light.pmf / pick.pmf))
    }
}

/// The lights of a scene as they are sampled here: those without size, and those that are surfaces or the picture of an environment.
#[derive(Clone, Debug)]
pub struct GatherLights {
    point_like: Choice,
    surfaces: Choice,
    /// Chance of a surface light to be chosen, over its chance among all lights.
    surface_share: f32,
}

impl GatherLights {
    /// Those of a scene.
    pub fn new(scene: &CompiledScene) -> Self {
        let surfaces = Choice::new(scene, |l| !emit::is_point_like(l));
        let all: f32 = surfaces.lights.iter().map(|i| scene.lights[*i as usize].pmf).sum();
        let surface_share = if all > 0.0 { 1.0 / all } else { 0.0 };
        Self { point_like: Choice::new(scene, emit::is_point_like), surfaces, surface_share }
    }

    /// What a device needs of them.
    pub fn parts(&self) -> GatherLightsParts<'_> {
        GatherLightsParts {
            point_like: self.point_like.parts(),
            surfaces: self.surfaces.parts(),
            surface_share: self.surface_share,
        }
    }
}

/// Lights as a device samples them: the numbers of those without size, and of the others, with the cumulative counts by which one is picked.
#[derive(Clone, Copy, Debug)]
pub struct GatherLightsParts<'a> {
    /// Without size.
    pub point_like: (&'a [u32], &'a [u32]),
    /// Surfaces and the picture of an environment.
    pub surfaces: (&'a [u32], &'a [u32]),
    /// Chance of one of these to be chosen, over its chance among all lights.
    pub surface_share: f32,
}

/// A map to read: numbers per element.
#[derive(Clone, Copy, Debug)]
pub struct MapView<'a> {
    /// Which numbers count where.
    pub elements: &'a Elements,
    /// Irradiance of all arrivals \[W/m^2\], one per element.
    pub all: &'a [[f32; 3]],
    /// Of it, what came from lights without size by mirrors alone; empty where there are no such lights or mirrors.
    pub caustics: &'a [[f32; 3]],
}

/// A probe where it lies on the scene's surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbePlace {
    /// Where, with the extent that scales its rounding.
    pub point: SurfacePoint,
    /// Unit normal of the receiving side.
    pub normal: Vec3,
    /// The surface that is there, if one is, and whether the normal is on the side of its front.
    pub hit: Option<(Hit, bool)>,
    /// The media on the side of the normal.
    pub inside: Inside,
}

/// What a ray brings, followed back from the sensor.
#[derive(Clone, Copy, Debug)]
struct Walk {
    sampler: BlockSampler,
    radiance: Vec3,
    /// Product of f cos / pdf along the path.
    throughput: Vec3,
    ray: Ray,
    /// Density per solid angle of the ray's direction; 0 where light sampling did not compete with it.
    pdf: f32,
    /// Where the ray's direction was scattered.
    vertex: Vec3,
    /// Edges of the path up to and including the ray.
    depth: u32,
    /// The final gather is still to come.
    gathers: bool,
    /// No diffuse surface lies between here and the sensor.
    seen: bool,
    rays: u32,
    /// What the ray flies through.
    through: through::Through,
}

/// The tracer back from the sensor for one scene, with the code that it needs (see [`super::TransportCode`]; `VOLUME`: light is changed on its way, or passes surfaces).
#[derive(Clone, Copy, Debug)]
pub struct GatherTracer<'a, const VOLUME: bool, const LOBES: bool, const TEXTURES: bool, const SHADING: bool>
{
    scene: &'a CompiledScene,
    lights: &'a GatherLights,
    max_depth: u32,
    gather: bool,
    /// What the camera stands in.
    camera: Inside,
}

/// Of scenes of surfaces alone.
pub type SurfaceGather<'a, const L: bool, const T: bool, const S: bool> = GatherTracer<'a, false, L, T, S>;

impl<'a, const VOLUME: bool, const LOBES: bool, const TEXTURES: bool, const SHADING: bool>
    GatherTracer<'a, VOLUME, LOBES, TEXTURES, SHADING>
{
    /// A tracer of at most `max_depth` edges from the sensor to a lamp or, with those of its photons, to the map; with or without a final gather. `camera`: the media in which it stands.
    pub fn new(
        scene: &'a CompiledScene,
        lights: &'a GatherLights,
        max_depth: u32,
        gather: bool,
        camera: Inside,
    ) -> Self {
        Self { scene, lights, max_depth, gather, camera }
    }

    /// Mean of one block of camera rays through a pixel, summed in the order of the samples; and the rays it took.
    #[inline(always)]
    pub fn pixel_block<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        map: &MapView<'_>,
        [x, y]: [u32; 2],
        seed: u64,
        block: u32,
        block_length: u32,
    ) -> ([f64; 3], u64) {
        let mut sum = BlockSum::default();
        let Some(camera) = &self.scene.camera else { return sum.mean(block_length) };
        if self.max_depth == 0 {
            return sum.mean(block_length);
        }
        let first = BlockSampler::new(seed, y.wrapping_mul(camera.width).wrapping_add(x), block, 0);
        for i in 0..block_length {
            let mut walk = self.start(first.with_index(i));
            walk.ray = camera_ray(camera, x, y, &walk.sampler);
            walk.depth = 1;
            walk.vertex = walk.ray.origin;
            walk.through = through::Through::new(self.camera);
            self.follow(intersector, map, &mut walk);
            sum.add((walk.radiance, walk.rays));
        }
        sum.mean(block_length)
    }

    /// Mean of one block of samples of the irradiance at a probe; and the rays it took. Lights without size are the same for all samples and are looked at once;
    /// without a final gather that and the map at the probe, which then must lie on a surface, are all there is.
    #[inline(always)]
    pub fn probe_block<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        map: &MapView<'_>,
        (index, probe): (u32, &ProbePlace),
        seed: u64,
        block: u32,
        block_length: u32,
    ) -> ([f64; 3], u64) {
        if self.max_depth == 0 {
            return ([0.0; 3], 0);
        }
        let surface = white_surface(probe.point, probe.normal);
        let first = BlockSampler::new(seed, index, block, 0);
        let through = through::Through::new(probe.inside);
        let mut once = Walk { throughput: Vec3::splat(PI), through, ..self.start(first) };
        self.point_like(intersector, &mut once, &surface, u32::MAX);
        let gather = self.gather || probe.hit.is_some_and(|(hit, _)| self.is_round(&hit));
        let values = if gather { map.caustics } else { map.all };
        if let Some((hit, from_front)) = &probe.hit {
            once.radiance += map.elements.read(values, hit, *from_front);
        }
        let once = (once.radiance, once.rays);
        let mut sum = BlockSum::default();
        if !gather {
            sum.add(once);
            return sum.mean(1);
        }
        for i in 0..block_length {
            let mut walk = Walk { throughput: Vec3::splat(PI), through, ..self.start(first.with_index(i)) };
            if self.spread(intersector, &mut walk, &surface) {
                self.follow(intersector, map, &mut walk);
            }
            sum.add((walk.radiance, walk.rays));
        }
        let (mean, rays) = sum.mean(block_length);
        let [x, y, z] = once.0.to_array().map(f64::from);
        ([mean[0] + x, mean[1] + y, mean[2] + z], rays + u64::from(once.1))
    }

    fn start(&self, sampler: BlockSampler) -> Walk {
        Walk {
            sampler,
            radiance: Vec3::ZERO,
            throughput: Vec3::ONE,
            ray: NO_RAY,
            pdf: 0.0,
            vertex: Vec3::ZERO,
            depth: 0,
            gathers: self.gather,
            seen: true,
            rays: 0,
            through: through::Through::default(),
        }
    }

    /// Follows the ray of a walk to its end.
    #[inline(always)]
    fn follow<I: Intersector + ?Sized>(&self, intersector: &I, map: &MapView<'_>, walk: &mut Walk) {
        loop {
            walk.rays += 1;
            let mut hit = intersector.closest_hit(&walk.ray);
            if VOLUME {
                match self.fly(intersector, walk, hit) {
                    through::Flown::Goes => continue,
                    through::Flown::Over => return,
                    through::Flown::Meets(surface) => hit = surface,
                }
            }
            let Some(hit) = hit else {
                walk.radiance += walk.throughput
                    * light::escaped(self.scene, walk.ray.direction, walk.pdf, self.lights.surface_share);
                return;
            };
            let Some(surface) = surface_at::<LOBES, TEXTURES, SHADING>(self.scene, &walk.ray, &hit) else {
                return;
            };
            let share = self.lights.surface_share;
            let t = if VOLUME { walk.through.flown + hit.t } else { hit.t };
            let (met, weight) =
                emission(self.scene, &surface, (&walk.ray, t), (walk.vertex, walk.pdf), share);
            walk.radiance += walk.throughput * met * weight;
            if walk.depth >= self.max_depth {
                return;
            }
            let goes_on = if VOLUME && surface.interface != Interface::Opaque {
                self.meet_interface(walk, &surface, hit.t)
            } else if LOBES && surface.lobes.mirror {
                self.reflect(walk, &surface)
            } else if LOBES && !surface.lobes.is_plain() {
                self.follow_lobes(intersector, map, walk, surface, &hit)
            } else if walk.gathers || self.is_round(&hit) || self.is_near(map, walk, &hit) {
                self.gather_at(intersector, map, walk, &surface, &hit)
            } else {
                self.read_at(intersector, map, walk, &surface, &hit)
            };
            if !goes_on {
                return;
            }
        }
    }

    /// A sphere or a disk, which is one element.
    #[inline(always)]
    fn is_round(&self, hit: &Hit) -> bool {
        hit.primitive as usize >= self.scene.triangles.len()
    }

    /// A gather ray ends within an element's length: see the module's text.
    #[inline(always)]
    fn is_near(&self, map: &MapView<'_>, walk: &Walk, hit: &Hit) -> bool {
        let largest = map.elements.settings().largest;
        // The photons of a map have one limit of depth, and another surface would be one edge more.
        let free = self.max_depth == u32::MAX && largest.is_finite();
        free && self.gather && !walk.seen && hit.t < largest
    }

    fn reflect(&self, walk: &mut Walk, surface: &Surface) -> bool {
        let [.., survive] = walk.sampler.group4(2 + 2 * walk.depth);
        match surface.lobes.sample(surface.shading, surface.wo, [0.0; 2], 0.0) {
            Some(s) => self.go(walk, surface, s.wi, s.weight, 0.0, survive),
            None => false,
        }
    }

    /// A vertex whose lobes are followed together: all light by samples and rays, but what lights without size send through mirrors.
    #[inline(never)]
    fn follow_lobes<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        map: &MapView<'_>,
        walk: &mut Walk,
        mut surface: Surface,
        hit: &Hit,
    ) -> bool {
        if VOLUME && surface.lobes.disperses() {
            let channel = self.colour_of(walk);
            surface.lobes = surface.lobes.of_channel(channel);
        }
        let albedo = surface.lobes.diffuse_albedo(surface.shading, surface.wo);
        if albedo != Vec3::ZERO && !map.caustics.is_empty() {
            let irradiance = map.elements.read(map.caustics, hit, surface.from_front);
            walk.radiance += walk.throughput * albedo * INV_PI * irradiance;
        }
        self.scatter(intersector, walk, &Vertex::Surface(&surface, walk.through.beyond))
    }

    /// A vertex where the light is gathered: all of it by rays, but what lights without size send through mirrors.
    #[inline(always)]
    fn gather_at<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        map: &MapView<'_>,
        walk: &mut Walk,
        surface: &Surface,
        hit: &Hit,
    ) -> bool {
        if LOBES && !map.caustics.is_empty() {
            let irradiance = map.elements.read(map.caustics, hit, surface.from_front);
            walk.radiance += walk.throughput * surface.lobes.albedo * INV_PI * irradiance;
        }
        self.point_like(intersector, walk, surface, if walk.seen { LIGHTS_SEEN } else { LIGHTS_GATHERED });
        self.spread(intersector, walk, surface)
    }

    /// Samples a surface light and a direction of one lobe.
    #[inline(always)]
    fn spread<I: Intersector + ?Sized>(&self, intersector: &I, walk: &mut Walk, surface: &Surface) -> bool {
        let share = if LOBES { surface.lobes.diffuse_share() } else { 1.0 };
        self.surface_light(intersector, walk, surface, [share, 1.0 - share]);
        let [u, v, lobe, survive] = walk.sampler.group4(2 + 2 * walk.depth);
        if LOBES && lobe >= share {
            return self.phong_ray(walk, surface, 1.0 - share, [u, v], survive);
        }
        let wi = diffuse::sample(surface.shading, [u, v]);
        let pdf = share * diffuse::pdf_solid_angle(surface.shading, wi);
        walk.gathers = false;
        walk.seen = false;
        self.go(walk, surface, wi, surface.lobes.albedo / share, pdf, survive)
    }

    /// A vertex where the map and the lights without size are read.
    #[inline(always)]
    fn read_at<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        map: &MapView<'_>,
        walk: &mut Walk,
        surface: &Surface,
        hit: &Hit,
    ) -> bool {
        let lobes = &surface.lobes;
        if lobes.albedo != Vec3::ZERO {
            let irradiance = map.elements.read(map.all, hit, surface.from_front);
            walk.radiance += walk.throughput * lobes.albedo * INV_PI * irradiance;
        }
        self.point_like(intersector, walk, surface, if walk.seen { LIGHTS_SEEN } else { LIGHTS_GATHERED });
        if !LOBES || lobes.specular == Vec3::ZERO {
            return false;
        }
        self.surface_light(intersector, walk, surface, [0.0, 1.0]);
        let [u, v, _, survive] = walk.sampler.group4(2 + 2 * walk.depth);
        self.phong_ray(walk, surface, 1.0, [u, v], survive)
    }

    /// A direction of the Phong lobe, which was chosen with the given chance.
    #[inline(always)]
    fn phong_ray(&self, walk: &mut Walk, surface: &Surface, chance: f32, u: [f32; 2], survive: f32) -> bool {
        let (lobes, n, wo) = (&surface.lobes, surface.shading, surface.wo);
        let wi = phong::sample(lobes.exponent, n, wo, u);
        let density = phong::pdf_solid_angle(lobes.exponent, n, wo, wi);
        let cos = wi.dot(n);
        if !(cos > 0.0 && density > 0.0) {
            return false;
        }
        // f = specular times the density.
        self.go(walk, surface, wi, lobes.specular * (cos / chance), chance * density, survive)
    }

    /// Sends a walk on, its throughput times `weight`, if it survives the roulette.
    #[inline(always)]
    fn go(&self, walk: &mut Walk, surface: &Surface, wi: Vec3, weight: Vec3, pdf: f32, survive: f32) -> bool {
        if SHADING && wi.dot(surface.geometric) <= 0.0 {
            return false;
        }
        let Some(throughput) = Roulette::ON.play(walk.throughput, weight, walk.depth, survive) else {
            return false;
        };
        walk.throughput = throughput;
        walk.pdf = pdf;
        walk.vertex = surface.leave(wi);
        walk.ray = Ray { origin: walk.vertex, direction: wi, t_max: f32::MAX };
        walk.depth += 1;
        if VOLUME {
            walk.through.leave(walk.through.inside, surface.lead(walk.vertex, wi));
        }
        true
    }

    /// Direct light of lights without size, by all lobes: of all of them where they are no more than `most`, else of so many that are chosen by flux, in equal
    /// steps along their distribution.
    #[inline(always)]
    fn point_like<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        walk: &mut Walk,
        surface: &Surface,
        most: u32,
    ) {
        self.point_like_of(walk, most, |walk, light, factor| {
            self.add_point_like(intersector, walk, surface, light, factor);
        });
    }

    /// Hands out those lights, each with what its sample is multiplied by.
    #[inline(always)]
    fn point_like_of(&self, walk: &mut Walk, most: u32, mut add: impl FnMut(&mut Walk, &LightRecord, f32)) {
        let choice = &self.lights.point_like;
        if choice.lights.len() <= most as usize {
            for index in &choice.lights {
                if let Some(light) = self.scene.lights.get(*index as usize) {
                    add(walk, light, light.pmf);
                }
            }
            return;
        }
        let [.., word] = walk.sampler.bits4(1 + 2 * walk.depth);
        for k in 0..most {
            let step = ((u64::from(k) << 32) / u64::from(most)) as u32;
            if let Some((light, factor)) = choice.pick(self.scene, word.wrapping_add(step)) {
                add(walk, light, factor / most as f32);
            }
        }
    }

    #[inline(always)]
    fn add_point_like<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        walk: &mut Walk,
        surface: &Surface,
        light: &LightRecord,
        factor: f32,
    ) {
        let Some(s) = light::sample(light, surface.point.position, [0.0; 2]) else { return };
        let f = if LOBES {
            surface.lobes.eval(surface.shading, surface.wo, s.wi)
        } else {
            diffuse::eval(surface.lobes.albedo, surface.shading, s.wi)
        };
        self.add_sample(intersector, walk, surface, &s, f * factor);
    }

    /// One sample of a surface light for the lobes that compete with it, each with the chance to be chosen for a direction; 0: it is left out.
    #[inline(always)]
    fn surface_light<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        walk: &mut Walk,
        surface: &Surface,
        [diffuse_chance, phong_chance]: [f32; 2],
    ) {
        let Some((s, factor)) = self.sample_surface_light(walk, surface) else { return };
        let (lobes, n) = (&surface.lobes, surface.shading);
        let density = s.pdf * self.lights.surface_share;
        let mut f = Vec3::ZERO;
        if diffuse_chance > 0.0 {
            let other = diffuse_chance * diffuse::pdf_solid_angle(n, s.wi);
            f += diffuse::eval(lobes.albedo, n, s.wi) * mis::power_heuristic(density, other);
        }
        if LOBES && phong_chance > 0.0 && lobes.specular != Vec3::ZERO {
            let other = phong_chance * phong::pdf_solid_angle(lobes.exponent, n, surface.wo, s.wi);
            let value = phong::eval(lobes.specular, lobes.exponent, n, surface.wo, s.wi);
            f += value * mis::power_heuristic(density, other);
        }
        self.add_sample(intersector, walk, surface, &s, f * factor);
    }

    /// A place on a surface light, and what its contribution is to be multiplied by.
    #[inline(always)]
    fn sample_surface_light(&self, walk: &Walk, surface: &Surface) -> Option<(LightSample, f32)> {
        let choice = &self.lights.surfaces;
        choice.cdf.as_ref()?;
        let [word, u, v, _] = walk.sampler.bits4(1 + 2 * walk.depth);
        let (light, factor) = choice.pick(self.scene, word)?;
        Some((light::sample_light(self.scene, light, surface.point.position, [u, v])?, factor))
    }

    /// Adds what a place on a light brings for a value f of the lobes, if it is in sight.
    #[inline(always)]
    fn add_sample<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        walk: &mut Walk,
        surface: &Surface,
        s: &LightSample,
        f: Vec3,
    ) {
        if s.wi.dot(surface.geometric) <= 0.0 {
            return;
        }
        let brings = walk.throughput * f * s.contribution * s.wi.dot(surface.shading).max(0.0);
        if brings == Vec3::ZERO {
            return;
        }
        let left = self.clear(intersector, walk, &Vertex::Surface(surface, walk.through.beyond), s);
        walk.radiance += brings * left;
    }
}

/// Runs `$body` with `$tracer` bound to the tracer from a map that has just the code that `$code` names; `$camera`: the media that the camera stands in.
#[macro_export]
macro_rules! with_gather_tracer {
    ($code:expr, ($scene:expr, $lights:expr, $max_depth:expr, $gather:expr, $camera:expr), |$tracer:ident| $body:expr) => {{
        use $crate::transport::gather::{GatherTracer, SurfaceGather};
        if $scene.needs.volume() {
            // One instance: what else a scene does not need costs little beside flights.
            let $tracer =
                GatherTracer::<true, true, true, true>::new($scene, $lights, $max_depth, $gather, $camera);
            $body
        } else {
            $crate::with_transport_code!(
                $code,
                |$tracer = SurfaceGather($scene, $lights, $max_depth, $gather, $camera)| $body
            )
        }
    }};
}
