//! Inputs of every kernel: hard cases first (ends of domains, exact edges, degenerate and huge), then seeded random ones.

#![allow(clippy::disallowed_methods, reason = "inputs are made in f64 and rounded once")]

use crate::statistics::Random;
use etendue_core::kernel::Kernel;

mod bc1;
mod emission;
mod emit;
mod first_shot;
mod grid;
mod lights;
mod linear_triangle;
mod log_offset;
mod media;
mod polynomial;
mod rays;
mod subdivide;

/// One call of `Backend::map`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Batch {
    /// Words shared by the items.
    pub constants: Vec<u32>,
    /// Items, one after the other.
    pub items: Vec<u32>,
}

/// Ends of the unit interval and what lies next to its halves.
pub const HARD_UNITS: [f32; 9] = [
    0.0,
    1.0 / 16_777_216.0,
    2.0 / 16_777_216.0,
    0.25,
    0.5 - 1.0 / 16_777_216.0,
    0.5,
    0.75,
    1.0 - 2.0 / 16_777_216.0,
    1.0 - 1.0 / 16_777_216.0,
];

/// Appends floats as words.
fn put(to: &mut Vec<u32>, x: &[f32]) {
    to.extend(x.iter().map(|x| x.to_bits()));
}

fn single(items: Vec<u32>) -> Vec<Batch> {
    vec![Batch { constants: Vec::new(), items }]
}

/// All pairs of hard unit numbers, then random pairs; each with the extra floats that `extra` draws.
fn pairs(count: usize, random: &mut Random, mut extra: impl FnMut(&mut Random) -> Vec<f32>) -> Vec<u32> {
    let mut items = Vec::new();
    for u in HARD_UNITS {
        for v in HARD_UNITS {
            put(&mut items, &[u, v]);
            put(&mut items, &extra(random));
        }
    }
    for _ in 0..count {
        put(&mut items, &[random.unit(), random.unit()]);
        put(&mut items, &extra(random));
    }
    items
}

/// Directions: the axes, near them, and random ones, scaled to length 1 in f32.
fn directions(count: usize, random: &mut Random, mut extra: impl FnMut(&mut Random) -> Vec<f32>) -> Vec<u32> {
    let mut items = Vec::new();
    let mut list = Vec::new();
    for axis in 0..3 {
        for sign in [1.0_f32, -1.0] {
            let mut w = [0.0_f32; 3];
            w[axis] = sign;
            list.push(w);
            for tilt in [1e-30_f32, 1e-12, 1e-6, 3e-4, 1e-2] {
                let mut w = w;
                w[(axis + 1) % 3] = tilt;
                w[(axis + 2) % 3] = -0.5 * tilt;
                list.push(normalized(w));
            }
        }
    }
    list.extend((0..count).map(|_| random.direction()));
    for w in list {
        put(&mut items, &w);
        put(&mut items, &extra(random));
    }
    items
}

fn normalized(w: [f32; 3]) -> [f32; 3] {
    let v = w.map(f64::from);
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| (x / length) as f32)
}

/// Any finite float: uniform over the bits.
fn any_finite(random: &mut Random) -> f32 {
    loop {
        let x = f32::from_bits(random.word());
        if x.is_finite() {
            return x;
        }
    }
}

/// Every sign and edge of the f32 range, powers of two, and neighbours of one.
fn hard_floats() -> Vec<f32> {
    let mut list = vec![
        0.0,
        f32::from_bits(1),
        f32::from_bits(0x007f_ffff),
        f32::MIN_POSITIVE,
        1e-30,
        1e-10,
        0.5,
        1.0 - 1.0 / 16_777_216.0,
        1.0,
        1.0 + f32::EPSILON,
        2.0,
        3.0,
        10.0,
        1e10,
        1e30,
        f32::MAX,
    ];
    for k in (-149..128).step_by(23) {
        list.push(2.0_f64.powi(k) as f32);
    }
    list.extend(list.clone().iter().map(|x| -x));
    list
}

fn unary(
    count: usize,
    random: &mut Random,
    domain: impl Fn(f32) -> bool,
    draw: impl Fn(&mut Random) -> f32,
) -> Vec<Batch> {
    let mut items = Vec::new();
    for x in hard_floats().into_iter().filter(|x| domain(*x)) {
        put(&mut items, &[x]);
    }
    for _ in 0..count {
        let x = draw(random);
        if domain(x) {
            put(&mut items, &[x]);
        }
    }
    single(items)
}

fn binary(count: usize, random: &mut Random, draw: impl Fn(&mut Random) -> [f32; 2]) -> Vec<Batch> {
    let mut items = Vec::new();
    for _ in 0..count {
        put(&mut items, &draw(random));
    }
    single(items)
}

/// Exponents of lobes: 0, below 1, common, huge.
fn exponent(random: &mut Random) -> f32 {
    match random.below(6) {
        0 => 0.0,
        1 => random.range(0.0, 2.0) as f32,
        2 => 1.0,
        3 => 1e4,
        _ => random.log_range(1.0, 1e3),
    }
}

/// 1 - cos of half-angles: the sphere, the hemisphere, the sun, the smallest.
fn cone_size(random: &mut Random) -> f32 {
    match random.below(6) {
        0 => 2.0,
        1 => 1.0,
        2 => 1.1e-5,
        3 => 1e-30,
        _ => random.log_range(1e-12, 2.0),
    }
}

/// Inputs of a kernel: the hard cases and about `count` random items.
pub fn inputs(kernel: Kernel, count: usize) -> Vec<Batch> {
    use Kernel as K;
    // Each kernel has its own stream, named by its place in the list.
    let place = Kernel::ALL.iter().position(|k| *k == kernel).unwrap_or(0) as u64;
    let mut random = Random::new(0x5eed_0000 + (place << 32));
    let r = &mut random;
    let none = |_: &mut Random| Vec::new();
    let positive = |x: f32| x > 0.0;
    match kernel {
        K::Ln | K::Log2 => unary(count, r, positive, |r| {
            if r.below(2) == 0 { any_finite(r).abs() } else { r.log_range(0.25, 4.0) }
        }),
        K::Sqrt => unary(count, r, |x| x >= 0.0, |r| any_finite(r).abs()),
        K::Cbrt => unary(count, r, |_| true, any_finite),
        K::Exp => unary(count, r, |x| x.abs() <= 104.0, |r| r.range(-104.0, 89.0) as f32),
        K::Exp2 => unary(count, r, |x| x.abs() <= 151.0, |r| r.range(-150.0, 129.0) as f32),
        K::SinCos => unary(
            count,
            r,
            |x| x.abs() <= 3216.0,
            |r| {
                if r.below(2) == 0 { r.range(-8.0, 8.0) as f32 } else { r.range(-3216.0, 3216.0) as f32 }
            },
        ),
        K::Acos | K::Asin => unary(
            count,
            r,
            |x| x.abs() <= 1.0,
            |r| {
                if r.below(4) == 0 { 1.0 - r.log_range(1e-7, 1.0) } else { r.range(-1.0, 1.0) as f32 }
            },
        ),
        K::Pow => binary(count, r, |r| match r.below(3) {
            0 => {
                let y = r.log_range(1e-3, 1e5);
                [(-r.range(0.0, 80.0) / f64::from(y)).exp() as f32, y]
            }
            1 => [r.log_range(1e-20, 1e20), r.range(-1.8, 1.8) as f32],
            _ => [r.unit().max(1e-7), r.range(0.0, 5.0) as f32],
        }),
        K::Atan2 => binary(count, r, |r| {
            if r.below(2) == 0 {
                [r.range(-10.0, 10.0) as f32, r.range(-10.0, 10.0) as f32]
            } else {
                [any_finite(r), any_finite(r)]
            }
        }),
        K::NormalizeOr => {
            let mut items = Vec::new();
            let hard = [[0.0; 3], [1e-45, 0.0, 0.0], [f32::MAX; 3], [1e-30, 1e-31, 0.0], [3e38, -3e38, 1.0]];
            for v in hard {
                put(&mut items, &v);
                put(&mut items, &[0.0, 0.0, 1.0]);
            }
            for _ in 0..count {
                let scale = f64::from(r.log_range(1e-36, 1e36));
                put(&mut items, &r.direction().map(|x| (f64::from(x) * scale) as f32));
                put(&mut items, &[0.0, 0.0, 1.0]);
            }
            single(items)
        }
        K::OrthonormalBasis
        | K::PdfSphere
        | K::InvertSphere
        | K::PdfHemisphere
        | K::InvertHemisphere
        | K::PdfCosineHemisphere => single(directions(count, r, none)),
        // Their domain is the upper half.
        K::InvertCosineHemisphere => {
            let items = directions(count, r, none);
            let upper = items.chunks(3).filter(|w| f32::from_bits(w[2]) > 0.0).flatten().copied();
            single(upper.collect())
        }
        K::PdfCone | K::InvertCone => {
            let mut items = directions(count / 2, r, |r| vec![cone_size(r)]);
            // Directions within their cone, too.
            for _ in 0..count / 2 {
                let size = cone_size(r);
                let h = r.range(0.0, 1.0) * f64::from(size);
                let (s, c) = (2.0 * std::f64::consts::PI * r.range(0.0, 1.0)).sin_cos();
                let sin = (h * (2.0 - h)).sqrt();
                put(&mut items, &[(c * sin) as f32, (s * sin) as f32, (1.0 - h) as f32, size]);
            }
            single(items)
        }
        K::PdfPowerCosine | K::InvertPowerCosine => {
            let mut items = directions(count / 2, r, |r| vec![exponent(r)]);
            for _ in 0..count / 2 {
                let n = exponent(r);
                let t = -(1.0 - r.range(0.0, 1.0)).ln() / (f64::from(n) + 1.0);
                let (s, c) = (2.0 * std::f64::consts::PI * r.range(0.0, 1.0)).sin_cos();
                let sin = (-(-2.0 * t).exp_m1()).sqrt();
                put(&mut items, &[(c * sin) as f32, (s * sin) as f32, (-t).exp() as f32, n]);
            }
            single(items)
        }
        K::SampleSphere
        | K::SampleHemisphere
        | K::SampleCosineHemisphere
        | K::SampleDisk
        | K::SampleTriangle => single(pairs(count, r, none)),
        K::SampleCone => single(pairs(count, r, |r| vec![cone_size(r)])),
        K::SamplePowerCosine => single(pairs(count, r, |r| vec![exponent(r)])),
        K::PdfDisk | K::InvertDisk => {
            let mut items = Vec::new();
            for x in
                [[0.0, 0.0], [1.0, 0.0], [0.0, -1.0], [1e-30, -1e-30], [0.5, 0.5], [-0.5, 0.5], [2.0, 0.0]]
            {
                if kernel == K::PdfDisk || x[0] < 1.5 {
                    put(&mut items, &x);
                }
            }
            for _ in 0..count {
                let (rho, phi) = (r.range(0.0, 1.0).sqrt(), r.range(0.0, 2.0 * std::f64::consts::PI));
                put(&mut items, &[(rho * phi.cos()) as f32, (rho * phi.sin()) as f32]);
            }
            single(items)
        }
        K::InvertTriangle => binary_triangle(count, r),
        K::PdfTriangle | K::PdfParallelogram => {
            let mut items = Vec::new();
            put(&mut items, &[0.0; 6]);
            for _ in 0..count {
                let scale = f64::from(r.log_range(1e-6, 1e6));
                for _ in 0..2 {
                    put(&mut items, &r.direction().map(|x| (f64::from(x) * scale) as f32));
                }
            }
            single(items)
        }
        K::SampleParallelogram | K::InvertParallelogram => parallelograms(kernel, count, r),
        K::U32ToUnit => {
            let mut items =
                vec![0, 1, 255, 256, u32::MAX, u32::MAX - 127, u32::MAX - 128, u32::MAX - 255, 1 << 31];
            items.extend((0..count).map(|_| r.word()));
            single(items)
        }
        K::CounterBits4 | K::SobolBits4 | K::SobolSet => integer_streams(kernel, count, r),
        K::CdfPick | K::CdfPmf => distributions(kernel, count, r),
        K::EvenWord => first_shot::words(count, r),
        K::Triangle | K::Slab | K::RoundShape | K::OffsetOrigin => single(rays::items(kernel, count, r)),
        K::EvalDiffuse
        | K::PdfDiffuse
        | K::SampleDiffuse
        | K::EvalPhong
        | K::PdfPhong
        | K::SamplePhong
        | K::FacetsDensity
        | K::FacetsMasking
        | K::PdfVisible
        | K::SampleVisible
        | K::EvalLobes
        | K::PdfLobes
        | K::SampleLobes => single(lights::scattering(kernel, count, r)),
        K::EvalPhase | K::SamplePhase | K::Transmittance | K::FresnelDielectric | K::FresnelConductor => {
            single(media::items(kernel, count, r))
        }
        K::SampleLight | K::PdfLight => lights::lights(kernel, count, r),
        K::PowerHeuristic => {
            let mut items = Vec::new();
            for a in [0.0, 1e-40, 1e-38, 1.0, 1e20, f32::MAX] {
                for b in [0.0, 1e-40, 1e-38, 1.0, 1e20, f32::MAX] {
                    put(&mut items, &[a, b]);
                }
            }
            for _ in 0..count {
                let a = r.log_range(1e-10, 1e10);
                put(&mut items, &[a, a * r.log_range(1e-4, 1e4)]);
            }
            single(items)
        }
        K::CameraRay => lights::cameras(count, r),
        K::ToneDisplay => lights::tones(count, r),
        K::SrgbDecode => single((0..=255).collect()),
        K::SampleBitmap => lights::bitmaps(count, r),
        _ => match kernel.module() {
            "linear_triangle" => linear_triangle::inputs(kernel, count, r),
            "emission" => emission::inputs(kernel, count, r),
            "subdivide" => subdivide::inputs(kernel, count, r),
            "log_offset" => log_offset::inputs(kernel, count, r),
            "bc1" | "bc4" => bc1::inputs(kernel, count, r),
            "polynomial" => polynomial::inputs(kernel, count, r),
            "first_shot" => first_shot::inputs(kernel, count, r),
            "emit" => emit::inputs(kernel, count, r),
            "grid" => grid::inputs(kernel, count, r),
            _ => Vec::new(),
        },
    }
}

fn binary_triangle(count: usize, r: &mut Random) -> Vec<Batch> {
    let mut items = Vec::new();
    for b in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.5, 0.5, 0.0], [0.25, 0.25, 0.5]] {
        put(&mut items, &b);
    }
    for _ in 0..count {
        let (a, b) = (r.range(0.0, 1.0).sqrt(), r.range(0.0, 1.0));
        put(&mut items, &[(1.0 - a) as f32, (a * b) as f32, (a * (1.0 - b)) as f32]);
    }
    single(items)
}

fn parallelograms(kernel: Kernel, count: usize, r: &mut Random) -> Vec<Batch> {
    let mut out = Vec::new();
    for _ in 0..16 {
        let scale = f64::from(r.log_range(1e-3, 1e3));
        let draw = |r: &mut Random| r.direction().map(|x| (f64::from(x) * scale) as f32);
        let (origin, e0, e1) = (draw(r), draw(r), draw(r));
        let mut constants = Vec::new();
        for v in [origin, e0, e1] {
            put(&mut constants, &v);
        }
        let mut items = pairs(count / 16, r, |_| Vec::new());
        if kernel == Kernel::InvertParallelogram {
            let mut points = Vec::new();
            for u in items.chunks(2) {
                let [s, t] = [u[0], u[1]].map(|w| f64::from(f32::from_bits(w)));
                let p = [0, 1, 2]
                    .map(|i| (f64::from(origin[i]) + s * f64::from(e0[i]) + t * f64::from(e1[i])) as f32);
                put(&mut points, &p);
            }
            items = points;
        }
        out.push(Batch { constants, items });
    }
    out
}

fn integer_streams(kernel: Kernel, count: usize, r: &mut Random) -> Vec<Batch> {
    let mut out = Vec::new();
    for seed in [[0, 0], [1, 0], [u32::MAX, u32::MAX], [r.word(), r.word()]] {
        let mut items = Vec::new();
        let hard = [0, 1, 2, 3, 63, 64, 0xffff, 0x8000_0000, u32::MAX];
        for i in 0..count / 4 {
            let word = |r: &mut Random| {
                if i < 200 { hard[r.below(9) as usize] } else { r.word() }
            };
            match kernel {
                Kernel::CounterBits4 => items.extend([word(r), word(r), word(r)]),
                Kernel::SobolBits4 => items.extend([word(r), word(r), word(r), word(r) >> 3]),
                // Most dimensions are those of which the truth holds direction numbers.
                _ => {
                    let d = if i % 8 > 0 { 64 * r.below(3) + r.below(10) } else { r.below(200) };
                    items.extend([word(r), d]);
                }
            }
        }
        out.push(Batch { constants: seed.to_vec(), items });
    }
    out
}

fn distributions(kernel: Kernel, count: usize, r: &mut Random) -> Vec<Batch> {
    // One entry; two halves; entries without counts at the start and within; one count at either end; many; more than 16 bits of them, as pieces are.
    let mut tables: Vec<Vec<u32>> = vec![
        vec![0],
        vec![0, 1 << 31],
        vec![0, 0, 7, 7, 7, 1 << 30],
        vec![0, 1, u32::MAX],
        (0..1000).map(|i| i * 4_294_967).collect(),
        (0..70_000).map(|i| i / 3 * 3 * 61_000).collect(),
    ];
    let mut random: Vec<u32> = (0..77).map(|_| r.word()).collect();
    random.sort_unstable();
    random[0] = 0;
    tables.push(random);
    let mut out = Vec::new();
    for constants in tables {
        let mut items: Vec<u32> = vec![0, 1, u32::MAX, u32::MAX - 1, 1 << 31];
        if kernel == Kernel::CdfPick {
            for c in constants.iter().take(200).chain(constants.iter().rev().take(20)) {
                items.extend([c.saturating_sub(1), *c, c.saturating_add(1)]);
            }
            items.extend((0..count / 6).map(|_| r.word()));
        } else {
            items.extend(0..constants.len() as u32 + 3);
        }
        out.push(Batch { constants, items });
    }
    out
}
