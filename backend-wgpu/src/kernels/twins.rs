//! Twins that no kernel reaches, against core: finishes of surfaces, boundaries, media, and all that reads a scene's lights.

use super::{FEATURES, root_of, run};
use crate::shaders::Link;
use etendue_core::backend::Arithmetic;
use etendue_core::bsdf::plastic::{Coat, CoatTable};
use etendue_core::bsdf::{Boundary, BsdfSample, Facets, Finish, Interface, Lobes, Metal, Rough};
use etendue_core::geometry::{Ray, SurfacePoint};
use etendue_core::light::{self, LightSample, emit};
use etendue_core::math::Vec3;
use etendue_core::medium::Medium;
use etendue_core::medium::flight::{self, Flight};
use etendue_core::sampling::counter::Counter;
use etendue_core::scene::{
    CheckerRecord, CompiledScene, EnvironmentDesc, EnvironmentImage, GridDesc, LightDesc, MediumDesc,
    SceneDesc, ShapeDesc, ShapeKind, compile,
};
use etendue_core::sensor::Camera;

const COUNT: u32 = 4096;

/// Numbers of one case.
struct Draw {
    counter: Counter,
    case: u32,
    next: u32,
}

impl Draw {
    fn word(&mut self) -> u32 {
        self.next += 1;
        self.counter.bits(7, self.case, self.next)
    }

    fn below(&mut self, n: u32) -> u32 {
        self.word() % n
    }

    fn unit(&mut self) -> f32 {
        // Ends of the interval among them.
        match self.below(32) {
            0 => 0.0,
            1 => 1.0 - 1.0 / 16_777_216.0,
            _ => (self.word() >> 8) as f32 / 16_777_216.0,
        }
    }

    fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    fn vec3(&mut self, low: f32, high: f32) -> Vec3 {
        Vec3::new(self.range(low, high), self.range(low, high), self.range(low, high))
    }

    fn direction(&mut self) -> Vec3 {
        etendue_core::math::normalize_or(self.vec3(-1.0, 1.0), Vec3::Z)
    }

    fn colour(&mut self) -> Vec3 {
        match self.below(4) {
            0 => Vec3::ZERO,
            _ => self.vec3(0.0, 1.0),
        }
    }
}

/// Words in order.
#[derive(Default)]
struct Words(Vec<u32>);

impl Words {
    fn word(&mut self, x: u32) {
        self.0.push(x);
    }

    fn float(&mut self, x: f32) {
        self.0.push(x.to_bits());
    }

    fn vec3(&mut self, v: Vec3) {
        for x in v.to_array() {
            self.float(x);
        }
    }
}

/// What reads a scene out of the constants.
const ARENA: &str = "
fn scene_word(i: u32) -> u32 { return constants[i]; }
fn scene_float(i: u32) -> f32 { return bitcast<f32>(constants[i]); }
fn grid_value(i: u32) -> f32 { return scene_float(scene_at.grid_values + i); }
struct SceneOffsets {
    light_count: u32, lights: u32, light_cumulative: u32, environment: u32, environment_width: u32,
    environment_height: u32, environment_light: u32, environment_to_world: u32, environment_texels: u32,
    environment_rows: u32, environment_row_count: u32, environment_starts: u32, environment_columns: u32,
    media: u32, grids: u32, grid_values: u32
}
var<private> scene_at: SceneOffsets;
fn find_scene() {
    scene_at = SceneOffsets(
        constants[0], constants[1], constants[2], constants[3], constants[4], constants[5], constants[6], constants[7],
        constants[8], constants[9], constants[10], constants[11], constants[12], constants[13], constants[14],
        constants[15]
    );
}
";

fn arena(scene: &CompiledScene) -> Vec<u32> {
    let mut at = [0_u32; 16];
    let mut words = vec![0; at.len()];
    let mut add = |more: &[u32]| {
        let start = words.len() as u32;
        words.extend_from_slice(more);
        start
    };
    at[0] = scene.lights.len() as u32;
    at[1] = add(bytemuck::cast_slice(&scene.lights));
    at[2] = add(&scene.light_cumulative);
    at[3] = add(bytemuck::cast_slice(&scene.environment));
    if let Some(map) = &scene.environment_map {
        at[4..7].copy_from_slice(&[map.width, map.height, map.light]);
        at[7] = add(bytemuck::cast_slice(&map.to_world));
        at[8] = add(bytemuck::cast_slice(&map.texels));
        at[9] = add(&map.rows);
        at[10] = map.rows.len() as u32;
        at[11] = add(&map.starts);
        at[12] = add(&map.columns);
    }
    at[13] = add(bytemuck::cast_slice(&scene.media));
    at[14] = add(bytemuck::cast_slice(&scene.grids));
    at[15] = add(bytemuck::cast_slice(&scene.grid_values));
    words[..16].copy_from_slice(&at);
    words
}

/// Runs `fn twin()` of a text over cases that `case` makes, each with what core answers; `sizes`: words of an item and of its result.
fn compare(
    name: &str,
    (module, text): (&str, &str),
    features: &[&str],
    sizes: [usize; 2],
    constants: &[u32],
    mut case: impl FnMut(&mut Draw, &mut Words, &mut Words),
) {
    let Some(backend) = crate::adapter::backend() else { return };
    let gpu = backend.source.gpu();
    let root = root_of(module, "twin", sizes) + text;
    let link = Link { root: &root, features, mutations: &[] };
    let (mut items, mut expected) = (Words::default(), Words::default());
    for i in 0..COUNT {
        let mut draw = Draw { counter: Counter::new(5), case: i, next: 0 };
        case(&mut draw, &mut items, &mut expected);
        let end = i as usize + 1;
        assert_eq!(items.0.len(), end * sizes[0]);
        expected.0.resize(end * sizes[1], 0);
    }
    let mut found = vec![0; expected.0.len()];
    run(&gpu, name, link, sizes, constants, &items.0, &mut found).unwrap();
    let arithmetic = gpu.arithmetic().unwrap();
    if arithmetic == Arithmetic::Loose {
        return;
    }
    let flushes = arithmetic == Arithmetic::FlushesSubnormals;
    let flat = |x: u32| if x & 0x7f80_0000 == 0 { 0 } else { x };
    let nan = |x: u32| x & 0x7fff_ffff > 0x7f80_0000;
    let same = |a: u32, b: u32| a == b || flat(a) == flat(b) && flushes || nan(a) && nan(b);
    let rows = found.chunks(sizes[1]).zip(expected.0.chunks(sizes[1]));
    let wrong: Vec<usize> = rows
        .enumerate()
        .filter(|(_, (f, e))| f.iter().zip(*e).any(|(a, b)| !same(*a, *b)))
        .map(|(i, _)| i)
        .collect();
    if let Some(i) = wrong.first() {
        let row = |words: &[u32], n: usize| -> Vec<f32> {
            words[i * n..(i + 1) * n].iter().map(|w| f32::from_bits(*w)).collect()
        };
        panic!(
            "{name}: {} of {COUNT} differ; case {i}: {:?} gives {:?}, core {:?}",
            wrong.len(),
            row(&items.0, sizes[0]),
            row(&found, sizes[1]),
            row(&expected.0, sizes[1]),
        );
    }
}

fn put_sample(w: &mut Words, s: Option<BsdfSample>) {
    let Some(s) = s else {
        for _ in 0..8 {
            w.word(0);
        }
        return;
    };
    w.word(1);
    w.vec3(s.wi);
    w.vec3(s.weight);
    w.float(s.pdf);
}

fn rough(kind: u32, size: f32) -> Option<Rough> {
    match kind {
        1 => Some(Rough::Facets(Facets::ggx(size))),
        2 => Some(Rough::Facets(Facets::beckmann(size))),
        3 => Some(Rough::Phong(size)),
        _ => None,
    }
}

/// Coats: roughness, its size, index.
const COATS: [(u32, f32, f32); 5] =
    [(0, 0.0, 1.5), (1, 0.2, 1.5), (2, 0.4, 1.33), (3, 40.0, 1.9), (1, 0.7, 0.8)];

#[test]
fn finishes_are_cores() {
    let mut constants = Words::default();
    let tables = COATS.map(|(kind, size, ior)| CoatTable::new(ior, rough(kind, size)));
    for t in &tables {
        for x in [t.internal, t.mean, 0.0, 0.0].into_iter().chain(t.transmittance) {
            constants.float(x);
        }
    }
    let text = "
fn scene_word(i: u32) -> u32 { return constants[i]; }
fn scene_float(i: u32) -> f32 { return bitcast<f32>(constants[i]); }
fn twin() {
    let finish = word();
    let kind = word();
    let rough = Rough(kind, float());
    let ior = triple();
    let second = triple();
    let albedo = triple();
    let flag = word() != 0u;
    let coat = 20u * word();
    let channel = word();
    let n = triple();
    let wo = triple();
    let wi = triple();
    let u = pair();
    let lobe = float();
    var lobes = lobes_of_film(albedo, second);
    if finish == 1u { lobes = lobes_of_metal(rough, ior, second); }
    if finish == 2u { lobes = lobes_of_channel(lobes_of_boundary(rough, ior, flag), channel); }
    if finish == 3u {
        let body = plastic_body(scene_float(coat), ior.x, albedo, flag);
        lobes = lobes_of_plastic(body, rough, ior.x, coat);
    }
    put3(lobes_eval(lobes, n, wo, wi));
    put(lobes_pdf_solid_angle(lobes, n, wo, wi));
    put3(lobes_diffuse_albedo(lobes, n, wo));
    put(lobes_index_ratio_squared(lobes, n, wo, wi));
    put_word(u32(lobes_has_density(lobes)) | u32(lobes_has_delta(lobes)) << 1u | u32(lobes_transmits(lobes)) << 2u
        | u32(lobes_disperses(lobes)) << 3u);
    let s = lobes_sample(lobes, n, wo, u, lobe);
    put_word(u32(s.found));
    if s.found {
        put3(s.wi);
        put3(s.weight);
        put(s.pdf);
    }
}
";
    compare("finishes", ("bsdf::lobes", text), FEATURES, [27, 17], &constants.0, |d, item, out| {
        let finish = 1 + d.below(4);
        let (mut kind, mut size) = (1 + d.below(3), d.range(0.0, 1.5));
        if kind == 3 {
            size = d.range(0.0, 200.0);
        }
        let mut ior = d.vec3(0.4, 2.5);
        let (second, albedo, flag, coat, channel) =
            (d.vec3(0.0, 4.0), d.colour(), d.below(2), d.below(COATS.len() as u32), d.below(3));
        if finish == 3 {
            (kind, size, _) = COATS[coat as usize];
            ior = Vec3::splat(COATS[coat as usize].2);
        }
        let n = d.direction();
        let (wo, wi) = (d.direction(), d.direction());
        // Mostly above.
        let wo = if wo.dot(n) < 0.0 && d.below(4) > 0 { -wo } else { wo };
        let (u, lobe) = ([d.unit(), d.unit()], d.unit());
        for x in [finish, kind, size.to_bits()] {
            item.word(x);
        }
        item.vec3(ior);
        item.vec3(second);
        item.vec3(albedo);
        for x in [flag, coat, channel] {
            item.word(x);
        }
        item.vec3(n);
        item.vec3(wo);
        item.vec3(wi);
        for x in [u[0], u[1], lobe] {
            item.float(x);
        }
        let surface = rough(kind, size);
        let lobes = match finish {
            1 => {
                let metal = Metal { rough: surface.unwrap(), eta: ior, k: second };
                Lobes::finished(Vec3::ZERO, Finish::Metal(metal))
            }
            2 => {
                let boundary = Boundary { rough: surface.unwrap(), ratio: ior, schlick: flag != 0 };
                Lobes::finished(Vec3::ZERO, Finish::Boundary(boundary)).of_channel(channel as usize)
            }
            3 => {
                let t = &tables[coat as usize];
                let body = CoatTable::body(t.internal, ior.x, albedo, flag != 0);
                let coat = Coat { ior: ior.x, rough: surface, mean: t.mean, transmittance: t.transmittance };
                Lobes::finished(body, Finish::Plastic(coat))
            }
            _ => Lobes::finished(albedo, Finish::Film { transmit: second }),
        };
        out.vec3(lobes.eval(n, wo, wi));
        out.float(lobes.pdf_solid_angle(n, wo, wi));
        out.vec3(lobes.diffuse_albedo(n, wo));
        out.float(lobes.index_ratio_squared(n, wo, wi));
        let bits = [lobes.has_density(), lobes.has_delta(), lobes.transmits(), lobes.disperses()];
        out.word((0..4).map(|k| u32::from(bits[k]) << k).sum());
        put_sample(out, lobes.sample(n, wo, u, lobe));
    });
}

#[test]
fn boundaries_are_passed_as_in_core() {
    let text = "
fn twin() {
    let kind = word();
    let schlick = word() != 0u;
    let first = triple();
    let second = triple();
    let n = triple();
    let wo = triple();
    let channel = word();
    let u = float();
    var boundary = interface_opaque();
    if kind == 1u { boundary = interface_dielectric(first, schlick); }
    if kind == 2u { boundary = interface_pane(first, second); }
    if kind == 3u { boundary = interface_plate(math_dot(wo, n), first, schlick); }
    put_word(u32(interface_disperses(boundary)));
    let straight = interface_straight(boundary);
    put_word(u32(straight.found));
    put3(straight.transmit);
    put(straight.chance);
    let p = interface_pass(boundary, n, wo, channel, u);
    put_word(u32(p.found));
    if p.found {
        put_word(u32(p.through));
        put3(p.wi);
        put3(p.weight);
    }
}
";
    compare("boundaries", ("bsdf::interface", text), FEATURES, [16, 14], &[0; 4], |d, item, out| {
        let (kind, schlick) = (d.below(4), d.below(2));
        let first = if kind == 2 { d.colour() } else { d.vec3(0.4, 2.5) };
        let (second, n, wo) = (d.colour(), d.direction(), d.direction());
        let wo = if wo.dot(n) < 0.0 { -wo } else { wo };
        let (channel, u) = (d.below(3), d.unit());
        item.word(kind);
        item.word(schlick);
        for v in [first, second, n, wo] {
            item.vec3(v);
        }
        item.word(channel);
        item.float(u);
        let boundary = match kind {
            0 => Interface::Opaque,
            1 => Interface::Dielectric { ratio: first, schlick: schlick != 0 },
            2 => Interface::Pane { reflect: first, transmit: second },
            _ => Interface::plate(wo.dot(n), first, schlick != 0),
        };
        out.word(u32::from(boundary.disperses()));
        let (transmit, chance) = boundary.straight().unwrap_or((Vec3::ZERO, 0.0));
        out.word(u32::from(boundary.straight().is_some()));
        out.vec3(transmit);
        out.float(chance);
        if let Some(p) = boundary.pass(n, wo, channel as usize, u) {
            out.word(1);
            out.word(u32::from(p.through));
            out.vec3(p.wi);
            out.vec3(p.weight);
        }
    });
}

fn put_flight(w: &mut Words, f: &Flight) {
    w.float(f.length);
    w.word(u32::from(f.collided));
    w.vec3(f.weight);
    w.vec3(f.left);
}

const FLIGHT: &str = "
fn put_flight(f: Flight) {
    put(f.length);
    put_word(u32(f.collided));
    put3(f.weight);
    put3(f.left);
}
";

#[test]
fn flights_are_cores() {
    let text = FLIGHT.to_string()
        + "
fn twin() {
    let sigma_t = triple();
    let carried = triple();
    let emission = triple();
    let limit = float();
    put_flight(flight_sample(sigma_t, carried, limit, pair()));
    put3(flight_emitted(emission, sigma_t, limit));
}
";
    compare("flights", ("medium::flight", &text), FEATURES, [12, 11], &[0; 4], |d, item, out| {
        let (sigma, carried, emission) = (d.colour() * 3.0, d.colour(), d.colour());
        let limit = if d.below(8) == 0 { f32::INFINITY } else { d.range(0.0, 3.0) };
        let u = [d.unit(), d.unit()];
        for v in [sigma, carried, emission] {
            item.vec3(v);
        }
        for x in [limit, u[0], u[1]] {
            item.float(x);
        }
        put_flight(out, &flight::sample(sigma, carried, limit, u));
        out.vec3(flight::emitted(emission, sigma, limit));
    });
}

fn grid(size: [u32; 3], channels: u32, salt: u32) -> GridDesc {
    let numbers = Counter::new(9);
    let count = size.iter().product::<u32>() * channels;
    let value = |i: u32| if i.is_multiple_of(3) { 0.0 } else { numbers.unit(salt, i, 0) };
    let to_world = [[1.0, 0.1, 0.0, -0.5], [0.0, 1.2, 0.2, -0.6], [0.1, 0.0, 0.9, -0.45]];
    GridDesc { size, channels, values: (0..count).map(value).collect(), to_world }
}

fn room(mut desc: SceneDesc) -> CompiledScene {
    let kind = ShapeKind::Sphere { center: [0.1, 0.2, 0.3], radius: 2.0 };
    desc.shapes.push(ShapeDesc {
        kind,
        material: String::new(),
        interior: String::new(),
        exterior: String::new(),
    });
    compile(&desc).unwrap().0
}

#[test]
fn media_are_cores() {
    let mut desc = SceneDesc::default();
    let shapes =
        [([9, 2, 3], 1, [2, 2, 2], 3), ([17, 9, 1], 1, [1, 1, 1], 1), ([20, 3, 11], 3, [5, 6, 7], 1)];
    for (i, (size, channels, albedo, albedo_channels)) in shapes.into_iter().enumerate() {
        for (k, grids) in [[false, false], [true, false], [true, true], [false, true]].into_iter().enumerate()
        {
            let mut medium = MediumDesc::new(&format!("{i} {k}"), [0.3, 0.1, 0.0], [2.0, 1.0, 0.0], 0.4);
            medium.emission = if k == 1 { [0.0; 3] } else { [0.5, 0.0, 1.5] };
            medium.density = grids[0].then(|| grid(size, channels, 1));
            medium.albedo = grids[1].then(|| grid(albedo, albedo_channels, 2));
            if i == 2 {
                // So thick that ways end before their limits.
                medium.sigma_s = [400.0, 300.0, 500.0];
            }
            desc.media.push(medium);
        }
    }
    let scene = room(desc);
    let constants = arena(&scene);
    let text = ARENA.to_string()
        + FLIGHT
        + "
fn twin() {
    find_scene();
    let medium = medium_new(scene_at.media + MEDIUM_WORDS * word());
    let origin = triple();
    let ray = Ray(origin, triple(), MAX_FLOAT);
    let lead = float();
    let limit = float();
    let carried = triple();
    put_flight(medium_fly(medium, ray, lead, limit, carried, pair()));
    put3(medium_transmittance(medium, ray, lead, limit));
    put3(medium_emitted(medium, ray, lead, limit));
    put3(medium_sigma_t_at(medium, origin));
    put3(medium_sigma_s_at(medium, origin));
}
";
    let grey: Vec<&str> = FEATURES.iter().copied().filter(|f| *f != "COLOURED_GRIDS").collect();
    // All media, and with code for grids of one channel the two that have no others.
    for (name, features, media) in [("media", FEATURES, 12), ("grey media", &grey[..], 2)] {
        compare(name, ("medium", &text), features, [14, 20], &constants, |d, item, out| {
            let index = if media == 2 { 4 + d.below(4) } else { d.below(media) };
            let (target, direction) = (d.vec3(-0.7, 0.7), d.direction());
            let direction = if d.below(4) == 0 { Vec3::Y } else { direction };
            let origin = if d.below(2) == 0 { target } else { target - direction * d.range(0.0, 3.0) };
            let (lead, carried, u) = (d.unit() * 1e-3, d.colour(), [d.unit(), d.unit()]);
            let limit = if d.below(8) == 0 { f32::INFINITY } else { d.range(0.0, 4.0) };
            item.word(index);
            item.vec3(origin);
            item.vec3(direction);
            item.float(lead);
            item.float(limit);
            item.vec3(carried);
            item.float(u[0]);
            item.float(u[1]);
            let medium = Medium::new(&scene, &scene.media[index as usize]);
            let ray = Ray { origin, direction, t_max: f32::MAX };
            put_flight(out, &medium.fly(&ray, lead, limit, carried, u));
            out.vec3(medium.transmittance(&ray, lead, limit));
            out.vec3(medium.emitted(&ray, lead, limit));
            out.vec3(medium.sigma_t_at(origin));
            out.vec3(medium.sigma_s_at(origin));
        });
    }
}

/// Lights of every kind that is no surface, and a picture of `size` texels if it has any.
fn lit(size: [u32; 2]) -> CompiledScene {
    let numbers = Counter::new(3);
    let texels = (0..size[0] * size[1]).map(|i| {
        // Rows that are black, and texels of very different brightness.
        let x = if i / size[0].max(1) % 3 == 1 { 0.0 } else { numbers.unit(0, i, 0) };
        [x, x * x * 30.0, 0.2 * x]
    });
    let (s, c) = (0.6, 0.8);
    let to_world = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]];
    let image = (size[0] > 0).then(|| EnvironmentImage {
        width: size[0],
        height: size[1],
        texels: texels.collect(),
        to_world,
    });
    let mut lights = vec![LightDesc::Environment(EnvironmentDesc { radiance: [1.0, 0.5, 2.0], image })];
    if size[0] != 5 {
        let position = [0.5, 3.0, 0.0];
        lights.push(LightDesc::Environment(EnvironmentDesc::uniform([0.1, 0.2, 0.3])));
        lights.push(LightDesc::Point { position, intensity: [3.0, 2.0, 1.0] });
        lights.push(LightDesc::Directional { direction: [0.3, -1.0, 0.2], irradiance: [1.0, 2.0, 3.0] });
        lights.push(LightDesc::Spot {
            position,
            direction: [0.0, -1.0, 0.1],
            intensity: [9.0, 8.0, 7.0],
            cone_deg: 40.0,
            falloff_deg: 20.0,
        });
    }
    room(SceneDesc { lights, ..SceneDesc::default() })
}

fn put_light(w: &mut Words, s: Option<LightSample>, from: &SurfacePoint, ng: Vec3) {
    let Some(s) = s else { return };
    w.word(1);
    for v in [s.wi, s.contribution, s.point, s.normal] {
        w.vec3(v);
    }
    w.float(s.pdf);
    w.float(s.extent);
    w.word(u32::from(s.distant));
    let ray = light::shadow_ray(&s, from, ng);
    w.vec3(ray.origin);
    w.vec3(ray.direction);
    w.float(ray.t_max);
}

#[test]
fn lights_of_a_scene_are_cores() {
    let text = ARENA.to_string()
        + "
fn twin() {
    find_scene();
    let p = triple();
    let ng = triple();
    let direction = triple();
    let extent = float();
    let pick = word();
    let u = word();
    let v = word();
    let pdf = float();
    let share = float();
    put3(light_escaped(direction, pdf, share));
    let s = light_sample_lights(p, vec3(pick, u, v));
    if !s.found { return; }
    put_word(1u);
    put3(s.wi);
    put3(s.contribution);
    put3(s.point);
    put3(s.normal);
    put(s.pdf);
    put(s.extent);
    put_word(u32(s.distant));
    let ray = light_shadow_ray(s, SurfacePoint(p, extent), ng);
    put3(ray.origin);
    put3(ray.direction);
    put(ray.t_max);
}
";
    for size in [[0, 0], [1, 1], [2, 2], [5, 7], [64, 32]] {
        let scene = lit(size);
        let constants = arena(&scene);
        compare(
            &format!("lights {size:?}"),
            ("light", &text),
            FEATURES,
            [15, 26],
            &constants,
            |d, item, out| {
                let (p, ng) = (d.vec3(-2.0, 2.0), d.direction());
                let axes = [Vec3::Y, -Vec3::Y, -Vec3::Z, Vec3::X, Vec3::Z];
                let direction = axes.get(d.below(24) as usize).copied().unwrap_or_else(|| d.direction());
                let extent = d.unit();
                let words = [d.word(), d.word(), d.word()];
                let (pdf, share) = (if d.below(4) == 0 { 0.0 } else { d.unit() * 4.0 }, d.unit());
                for v in [p, ng, direction] {
                    item.vec3(v);
                }
                item.float(extent);
                for x in words {
                    item.word(x);
                }
                item.float(pdf);
                item.float(share);
                out.vec3(light::escaped(&scene, direction, pdf, share));
                let s = light::sample_lights(&scene, p, words);
                put_light(out, s, &SurfacePoint { position: p, extent }, ng);
            },
        );
    }
}

#[test]
fn photons_of_a_picture_are_cores() {
    let text = ARENA.to_string()
        + "
fn twin() {
    find_scene();
    let sphere = vec4(triple(), float());
    let place = pair();
    let e = emit_picture(sphere, vec4(place, pair()));
    put3(e.ray.origin);
    put3(e.ray.direction);
    put3(e.flux);
}
";
    let scene = lit([64, 32]);
    let index = scene.environment_map.as_ref().unwrap().light as usize;
    compare("photons", ("light::emit", &text), FEATURES, [8, 9], &arena(&scene), |d, item, out| {
        let u = [d.unit(), d.unit(), d.unit(), d.unit()];
        let sphere = scene.bounding_sphere();
        item.vec3(sphere.0);
        item.float(sphere.1);
        for x in u {
            item.float(x);
        }
        let (e, _) = emit::emit_entry(&scene, index, sphere, u);
        out.vec3(e.ray.origin);
        out.vec3(e.ray.direction);
        out.vec3(e.flux);
    });
}

#[test]
fn cameras_look_back_as_in_core() {
    for lens_radius in [0.0, 0.25] {
        let camera = Camera {
            position: [0.1, 0.2, 0.3],
            lens_radius,
            forward: [0.6, 0.0, 0.8],
            focus_distance: 4.0,
            right: [0.4, 0.0, -0.3],
            width: 640,
            up: [0.0, 0.375, 0.0],
            height: 480,
        };
        let text = "
fn twin() {
    let position = constant_triple();
    let lens_radius = constant_float();
    let forward = constant_triple();
    let focus_distance = constant_float();
    let right = constant_triple();
    let width = constant_word();
    let up = constant_triple();
    let height = constant_word();
    let camera = Camera(position, lens_radius, forward, focus_distance, right, width, up, height);
    let lens = camera_sample_lens(camera, pair());
    let p = triple();
    put3(lens);
    put(camera_pdf_solid_angle(camera, math_normalize_or(p - lens, vec3(0.0f))));
    let pixel = camera_pixel(camera, lens, p);
    put_word(u32(pixel.found));
    put_word(pixel.x);
    put_word(pixel.y);
}
";
        let constants: &[u32] = bytemuck::cast_slice(std::slice::from_ref(&camera));
        let name = format!("camera {lens_radius}");
        compare(&name, ("sensor", text), FEATURES, [5, 7], constants, |d, item, out| {
            let (u, p) = ([d.unit(), d.unit()], d.vec3(-1.0, 5.0));
            item.float(u[0]);
            item.float(u[1]);
            item.vec3(p);
            let lens = camera.sample_lens(u);
            out.vec3(lens);
            out.float(camera.pdf_solid_angle(etendue_core::math::normalize_or(p - lens, Vec3::ZERO)));
            if let Some([x, y]) = camera.pixel(lens, p) {
                out.word(1);
                out.word(x);
                out.word(y);
            }
        });
    }
}

#[test]
fn checkers_are_cores() {
    let text = "
fn scene_word(i: u32) -> u32 { return constants[i]; }
fn scene_float(i: u32) -> f32 { return bitcast<f32>(constants[i]); }
fn texel(i: u32) -> u32 { return 0u; }
struct SceneOffsets { srgb_decode: u32 }
var<private> scene_at: SceneOffsets;
fn twin() { put3(bitmap_checker_color(0u, pair())); }
";
    let checker = CheckerRecord { colors: [[0.1, 0.2, 0.3], [0.7, 0.8, 0.9]], repeat: [3.0, 0.7] };
    let constants: &[u32] = bytemuck::cast_slice(std::slice::from_ref(&checker));
    compare("checkers", ("scene::bitmap", text), FEATURES, [2, 3], constants, |d, item, out| {
        let uv = [d.range(-2.0, 2.0), d.range(-2.0, 2.0)];
        item.float(uv[0]);
        item.float(uv[1]);
        out.vec3(checker.color(uv));
    });
}
