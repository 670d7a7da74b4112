//! Form factors between surfaces against closed forms, by pairs and by rays; rooms whose light is known; scenes that are hard.
//!
//! Truths: J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors (numbers of factors as given); polygons are those of P. Schroeder and P. Hanrahan, On the Form
//! Factor between Two Polygons (1993), their values by quadrature of 48 x 48 Gauss points.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod rooms;

use etendue_core::backend::{FormFactorJob, NoControl, Session};
use etendue_core::radiosity::form_factors::near::{NearPair, NearSettings, near_pairs};
use etendue_core::radiosity::form_factors::{FormFactors, assemble, assemble_with, balance};
use etendue_core::radiosity::patches::{Patch, PatchMap, PatchSettings};
use etendue_core::radiosity::relight::{Portable, Relighter, Workspace};
use etendue_core::radiosity::tiles::{Kind, Rates};
use etendue_core::scene::{LightDesc, MeshDesc, SceneDesc};
use etendue_cpu::CpuSession;
use rooms::{point, room, session};
use std::f64::consts::PI;

type P = [f64; 3];

/// Unobstructed and obstructed pairs, relative.
const OPEN: f64 = 1e-3;
const OBSTRUCTED: f64 = 1e-2;
/// What rays may be off by, in standard errors.
const SIGMAS: f64 = 4.0;

/// Which patches are of a surface.
#[derive(Clone, Copy, Debug)]
enum Surface {
    /// Of a plane through a point with this normal; of both sides or of that alone.
    Plane(P, P, bool),
    /// Of a ball.
    Ball(P, f64),
}

impl Surface {
    fn has(&self, p: &Patch) -> bool {
        let away = |at: P| -> P { std::array::from_fn(|k| f64::from(p.position[k]) - at[k]) };
        let dot = |a: P, b: P| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        match self {
            Self::Plane(at, n, both) => {
                let length = dot(*n, *n).sqrt();
                let cos = dot(p.normal.map(f64::from), *n) / length;
                (dot(away(*at), *n) / length).abs() < 1e-4 && if *both { cos.abs() > 0.5 } else { cos > 0.5 }
            }
            Self::Ball(at, radius) => dot(away(*at), away(*at)).sqrt() < 1.01 * radius,
        }
    }
}

/// Convex polygons as fans.
fn mesh(polygons: &[Vec<P>]) -> MeshDesc {
    let mut mesh = MeshDesc { name: "m".into(), ..MeshDesc::default() };
    for polygon in polygons {
        let base = mesh.positions.len() as u32;
        mesh.positions.extend(polygon.iter().map(|p| p.map(|x| x as f32)));
        mesh.triangles.extend((2..polygon.len() as u32).map(|k| [base, base + k - 1, base + k]));
    }
    mesh
}

fn scene(polygons: &[Vec<P>]) -> SceneDesc {
    SceneDesc { meshes: vec![mesh(polygons)], ..SceneDesc::default() }
}

fn rectangle(at: P, u: P, v: P) -> Vec<P> {
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
        .map(|[a, b]| std::array::from_fn(|k| at[k] + a * u[k] + b * v[k]))
        .to_vec()
}

fn patches(session: &CpuSession, count: u32) -> PatchMap {
    session.patches(&PatchSettings { count, seed: 1 }).unwrap()
}

fn job(map: &PatchMap, rays: u32) -> FormFactorJob {
    FormFactorJob { seed: 2, rays, patches: 0..map.patches.len() as u32 }
}

fn counted(session: &CpuSession, map: &PatchMap, rays: u32) -> FormFactors {
    let rows = session.form_factors(map, &job(map, rays), &NoControl).unwrap();
    assemble(&map.patches.areas(), &rows).unwrap()
}

fn near(session: &CpuSession, map: &PatchMap, pairs: &[[u32; 2]], points: u32) -> Vec<NearPair> {
    session.near_form_factors(map, pairs, &NearSettings { seed: 5, points }, &NoControl).unwrap()
}

fn all_pairs(map: &PatchMap) -> Vec<[u32; 2]> {
    near_pairs(&map.patches, f32::INFINITY)
}

/// The form factor from one surface to another, by pairs and by rays, each with its standard error; and the area that sends.
struct Found {
    near: [f64; 2],
    rays: [f64; 2],
    area: f64,
}

fn between(desc: &SceneDesc, (count, points): (u32, u32), from: Surface, to: Surface) -> Found {
    let session = session(desc, None);
    let map = patches(&session, count);
    let list = map.patches.list();
    let of = |s: Surface| -> Vec<usize> { (0..list.len()).filter(|i| s.has(&list[*i])).collect() };
    let (from, to) = (of(from), of(to));
    assert!(!from.is_empty() && !to.is_empty());
    let pairs: Vec<[u32; 2]> = from.iter().flat_map(|i| to.iter().map(|j| [*i as u32, *j as u32])).collect();
    let area: f64 = from.iter().map(|i| f64::from(list[*i].area)).sum();
    let mut found = Found { near: [0.0; 2], rays: [0.0; 2], area };
    for pair in near(&session, &map, &pairs, points) {
        found.near[0] += pair.flux / area;
        found.near[1] += (pair.stderr / area).powi(2);
    }
    let rows = session.form_factors(&map, &job(&map, 1 << 13), &NoControl).unwrap();
    let counted = assemble(&map.patches.areas(), &rows).unwrap();
    let density = |i: usize| f64::from(rows[i].rays) / f64::from(list[i].area);
    for (i, j) in pairs.iter().map(|[i, j]| (*i as usize, *j as usize)) {
        let flux = f64::from(counted.flux(i, j));
        found.rays[0] += flux / area;
        found.rays[1] += flux / (density(i) + density(j)) / (area * area);
    }
    for value in [&mut found.near, &mut found.rays] {
        value[1] = value[1].sqrt();
    }
    found
}

#[track_caller]
fn check(
    what: &str,
    desc: &SceneDesc,
    effort: (u32, u32),
    (from, to): (Surface, Surface),
    truth: f64,
    tolerance: f64,
) {
    let found = between(desc, effort, from, to);
    let [near, rays] = [found.near, found.rays];
    println!(
        "{what}: {truth:.6}; pairs {:+.2e} +- {:.1e}, rays {:+.2e} +- {:.1e}, relative; area {:.5}",
        near[0] / truth - 1.0,
        near[1] / truth,
        rays[0] / truth - 1.0,
        rays[1] / truth,
        found.area,
    );
    assert!((near[0] / truth - 1.0).abs() <= tolerance, "{what}: {near:?} by pairs, {truth}");
    // Half a per mille for surfaces that facets stand for.
    assert!((rays[0] - truth).abs() <= SIGMAS * rays[1] + 5e-4 * truth, "{what}: {rays:?} by rays, {truth}");
}

const Z: P = [0.0, 0.0, 1.0];

#[test]
fn rectangles_see_each_other_as_the_catalogue_says() {
    // C-11: a x b at distance c.
    for (a, b, c, truth) in [
        (1.0, 1.0, 1.0, 0.199_824_895_698_387_38),
        (1.0, 2.0, 1.0, 0.285_875_384_850_714_73),
        (2.0, 2.0, 1.0, 0.415_253_283_577_146_75),
        (1.0, 1.0, 0.1, 0.826_994_522_397_256_6),
        (1.0, 1.0, 10.0, 0.003_162_056_838_757_601_5),
        (3.0, 0.5, 0.7, 0.272_126_105_084_718_5),
    ] {
        let (u, v) = ([a, 0.0, 0.0], [0.0, b, 0.0]);
        let desc = scene(&[rectangle([0.0; 3], u, v), rectangle([0.0, 0.0, c], u, v)]);
        let ends = (Surface::Plane([0.0; 3], Z, false), Surface::Plane([0.0, 0.0, c], Z, true));
        check(&format!("C-11 {a} x {b} at {c}"), &desc, (32, 256), ends, truth, OPEN);
    }
    // C-14: from l x w to l x h with a common edge l.
    for (l, w, h, there, back) in [
        (1.0, 1.0, 1.0, 0.200_043_776_075_403_16, 0.200_043_776_075_403_16),
        (1.0, 2.0, 3.0, 0.161_694_014_333_027_57, 0.107_796_009_555_351_72),
        (2.0, 1.0, 0.5, 0.166_855_394_973_300_43, 0.333_710_789_946_600_86),
        (1.0, 0.1, 1.0, 0.432_513_694_006_858_6, 0.043_251_369_400_685_86),
    ] {
        let desc = scene(&[
            rectangle([0.0; 3], [w, 0.0, 0.0], [0.0, l, 0.0]),
            rectangle([0.0; 3], [0.0, l, 0.0], [0.0, 0.0, h]),
        ]);
        let (floor, wall) =
            (Surface::Plane([0.0; 3], Z, false), Surface::Plane([0.0; 3], [1.0, 0.0, 0.0], false));
        check(&format!("C-14 {l} x {w} to {h}"), &desc, (32, 1024), (floor, wall), there, OPEN);
        check(&format!("C-14 {l} x {h} to {w}"), &desc, (32, 1024), (wall, floor), back, OPEN);
    }
}

#[test]
fn polygons_see_each_other_as_quadrature_says() {
    let square = rectangle([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let tall = rectangle([0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
    for (name, sender, other, normal, truth) in [
        (
            "upright",
            square,
            vec![[2.0, 0.5, 1.0], [2.0, 0.5, 2.0], [2.0, 2.0, 2.0], [2.0, 2.0, 1.0]],
            [1.0, 0.0, 0.0],
            0.039_507_760_775_813_17,
        ),
        (
            "parallel",
            tall,
            vec![[0.5, 1.0, 1.5], [0.5, 3.0, 1.5], [1.5, 3.0, 1.5], [1.5, 1.0, 1.5]],
            Z,
            0.115_354_567_863_175_87,
        ),
        (
            "triangles",
            vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            vec![[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0]],
            Z,
            0.115_049_228_149_610_15,
        ),
        (
            "oblique triangles",
            vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            vec![[1.0, 1.0, 0.4], [0.2, 1.4, 1.9], [-1.0, 0.1, 1.2]],
            // (p1 - p0) x (p2 - p0).
            [0.4 * 0.8 - 1.5 * -0.9, 1.5 * -2.0 - -0.8 * 0.8, -0.8 * -0.9 - 0.4 * -2.0],
            0.044_916_481_909_482_775,
        ),
    ] {
        let at = other[0];
        let ends = (Surface::Plane([0.0; 3], Z, false), Surface::Plane(at, normal, true));
        check(name, &scene(&[sender, other]), (32, 512), ends, truth, OPEN);
    }
}

/// A regular polygon with the area of a disk about the z axis.
fn disk(radius: f64, z: f64) -> Vec<P> {
    const SIDES: u32 = 48;
    let step = 2.0 * PI / f64::from(SIDES);
    let r = radius * (step / step.sin()).sqrt();
    (0..SIDES).map(|k| (f64::from(k) * step).sin_cos()).map(|(s, c)| [r * c, r * s, z]).collect()
}

/// 80 triangles about the origin, with the symmetry of an icosahedron.
fn ball(radius: f64) -> Vec<Vec<P>> {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners: Vec<P> = Vec::new();
    for a in [-1.0, 1.0] {
        for b in [-g, g] {
            corners.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]]);
        }
    }
    let squared = |a: P, b: P| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>();
    let near = |i: usize, j: usize| (squared(corners[i], corners[j]) - 4.0).abs() < 1e-9;
    let onto = |p: P| {
        let length = squared(p, [0.0; 3]).sqrt();
        p.map(|x| radius * x / length)
    };
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in 0..i {
            for k in 0..j {
                if !(near(i, j) && near(j, k) && near(i, k)) {
                    continue;
                }
                let [a, b, c] = [corners[i], corners[j], corners[k]];
                let middle = |a: P, b: P| -> P { std::array::from_fn(|k| 0.5 * (a[k] + b[k])) };
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                for t in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                    let [p, q, r] = t.map(onto);
                    // Counter-clockwise from outside.
                    let volume = p[0] * (q[1] * r[2] - q[2] * r[1])
                        + p[1] * (q[2] * r[0] - q[0] * r[2])
                        + p[2] * (q[0] * r[1] - q[1] * r[0]);
                    faces.push(if volume > 0.0 { vec![p, q, r] } else { vec![p, r, q] });
                }
            }
        }
    }
    faces
}

#[test]
fn disks_and_balls_see_each_other_as_the_catalogue_says() {
    // C-41: coaxial disks. Facets of equal area stand for them; round shapes have no patches.
    for (r1, r2, h, truth) in [
        (1.0, 1.0, 1.0, 0.381_966_011_250_105_15),
        (1.0, 2.0, 1.0, 0.763_932_022_500_210_3),
        (0.5, 1.0, 2.0, 0.192_235_935_955_848_62),
    ] {
        let ends = (Surface::Plane([0.0; 3], Z, false), Surface::Plane([0.0, 0.0, h], Z, true));
        check(
            &format!("C-41 {r1}, {r2} at {h}"),
            &scene(&[disk(r1, 0.0), disk(r2, h)]),
            (32, 256),
            ends,
            truth,
            OPEN,
        );
    }
    // From a ball to a disk or rectangle about its axis: any ball, so that a small one of facets does.
    for (h, r, truth) in [
        (1.0, 1.0, 0.146_446_609_406_726_24),
        (2.0, 1.0, 0.052_786_404_500_042_06),
        (0.5, 3.0, 0.417_800_506_347_321_35),
    ] {
        let mut polygons = ball(0.05);
        polygons.push(disk(r, h));
        let ends = (Surface::Ball([0.0; 3], 0.05), Surface::Plane([0.0, 0.0, h], Z, true));
        check(&format!("ball to disk {r} at {h}"), &scene(&polygons), (32, 256), ends, truth, OPEN);
    }
    for (a, b, d, truth) in
        [(1.0, 1.0, 1.0, 0.064_094_216_848_974_93), (2.0, 1.0, 0.5, 0.217_952_891_575_512_54)]
    {
        let mut polygons = ball(0.05);
        polygons.push(rectangle([-0.5 * a, -0.5 * b, d], [a, 0.0, 0.0], [0.0, b, 0.0]));
        let ends = (Surface::Ball([0.0; 3], 0.05), Surface::Plane([0.0, 0.0, d], Z, true));
        check(
            &format!("ball to rectangle {a} x {b} at {d}"),
            &scene(&polygons),
            (32, 256),
            ends,
            truth,
            OPEN,
        );
    }
}

/// Between unit squares at distance 1 with a square of half the side halfway in one corner: midpoints, 40 of them a side.
fn behind_a_square() -> f64 {
    const N: usize = 40;
    let at = |k: usize| (k as f64 + 0.5) / N as f64;
    let mut sum = 0.0;
    for i in 0..N.pow(4) {
        let [x, y, u, v] = [i % N, i / N % N, i / (N * N) % N, i / (N * N * N)].map(at);
        let hidden = 0.5 * (x + u) < 0.5 && 0.5 * (y + v) < 0.5;
        let squared = 1.0 + (x - u).powi(2) + (y - v).powi(2);
        sum += if hidden { 0.0 } else { 1.0 / (PI * squared * squared) };
    }
    sum / (N as f64).powi(4)
}

#[test]
fn what_stands_between_is_in_the_way() {
    let (u, v) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let ends = (Surface::Plane([0.0; 3], Z, false), Surface::Plane([0.0, 0.0, 1.0], Z, true));
    let squares = [rectangle([0.0; 3], u, v), rectangle([0.0, 0.0, 1.0], u, v)];
    // A wall from one to the other through their middles: each half sees its half, C-11 of 0.5 x 1 at 1.
    let (x, y) = (0.5_f64, 1.0_f64);
    let (x1, y1) = (x.hypot(1.0), y.hypot(1.0));
    let half = 2.0 / (PI * x * y)
        * ((x1 * y1 / (1.0 + x * x + y * y).sqrt()).ln()
            + x * y1 * (x / y1).atan()
            + y * x1 * (y / x1).atan()
            - x * x.atan()
            - y * y.atan());
    let mut polygons = squares.to_vec();
    polygons.push(rectangle([0.5, 0.0, 0.0], v, Z));
    check("a wall between", &scene(&polygons), (64, 256), ends, half, OBSTRUCTED);
    let mut polygons = squares.to_vec();
    polygons.push(rectangle([0.0, 0.0, 0.5], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]));
    check("a square between", &scene(&polygons), (64, 256), ends, behind_a_square(), OBSTRUCTED);
}

#[test]
fn rows_of_a_cube_by_pairs_alone_sum_to_one() {
    let mut desc = room([0.5; 3], [0.0; 3]);
    point(&mut desc);
    let session = session(&desc, Some(1));
    let map = patches(&session, 24);
    let n = map.patches.len();
    let pairs = all_pairs(&map);
    assert_eq!(pairs.len(), n * (n + 1) / 2);
    let found = near(&session, &map, &pairs, 256);
    // Each the other way around, by other numbers of threads: the same bits.
    let turned: Vec<[u32; 2]> = pairs.iter().map(|[i, j]| [*j, *i]).collect();
    for threads in [2, 5] {
        let again = near(&rooms::session(&desc, Some(threads)), &map, &turned, 256);
        assert!(found.iter().zip(&again).all(|(a, b)| a.flux == b.flux && a.stderr == b.stderr));
    }
    let list = map.patches.list();
    for pair in &found {
        let [p, q] = pair.patches.map(|p| list[p as usize].normal);
        let coplanar = (0..3).map(|k| p[k] * q[k]).sum::<f32>() > 0.9;
        assert!(if coplanar { pair.flux == 0.0 && pair.stderr == 0.0 } else { pair.flux > 0.0 }, "{pair:?}");
    }
    let rows = session.form_factors(&map, &job(&map, 256), &NoControl).unwrap();
    let form_factors = assemble_with(&map.patches.areas(), &rows, &found).unwrap();
    let by_rays = assemble(&map.patches.areas(), &rows).unwrap();
    for (i, sum) in form_factors.row_sums().iter().enumerate() {
        assert!((sum - 1.0).abs() < 5e-3, "row {i}: {sum}");
        assert!(form_factors.stderr[i] < by_rays.stderr[i]);
    }
    for (truth, opposite) in [(0.199_824_895_698_387_38, true), (0.200_043_776_075_403_16, false)] {
        let (mut flux, mut area) = (0.0, 0.0);
        for (i, p) in list.iter().enumerate().filter(|(_, p)| p.normal[1] > 0.5) {
            area += f64::from(p.area);
            for (j, q) in list.iter().enumerate() {
                if if opposite { q.normal[1] < -0.5 } else { q.normal[0] > 0.5 } {
                    flux += f64::from(form_factors.flux(i, j));
                }
            }
        }
        assert!((flux / area / truth - 1.0).abs() < OPEN, "{} {truth}", flux / area);
    }
}

fn exact_rows(session: &CpuSession, map: &PatchMap, rays: u32) -> FormFactors {
    let mut form_factors = counted(session, map, rays);
    let targets = form_factors.targets();
    balance(&mut form_factors, &targets, 100);
    form_factors
}

/// P. Shirley, Time complexity of Monte-Carlo radiosity (1991): light that is the same everywhere in a closed room.
#[test]
fn closed_rooms_have_their_light_after_each_bounce_and_after_all() {
    let mut desc = room([0.5; 3], [0.0; 3]);
    point(&mut desc);
    let session = session(&desc, None);
    let map = patches(&session, 150);
    let n = map.patches.len();
    let form_factors = exact_rows(&session, &map, 1024);
    for rho in [0.0_f32, 0.2, 0.5, 0.8, 0.9, 0.95, 0.99] {
        let relighter =
            Relighter::encode(&form_factors, &vec![[rho; 3]; n], Rates::Uniform(Kind::F32)).unwrap();
        let relighter = session.with_coarse(relighter, Rates::Uniform(Kind::F32)).unwrap();
        let wide = f64::from(rho);
        let (mut radiosity, mut arriving) = (vec![[1.0_f32; 3]; n], vec![[0.0_f32; 3]; n]);
        for bounces in 1..=10 {
            relighter.bounce(&Portable, &radiosity, &mut arriving).unwrap();
            for (b, e) in radiosity.as_flattened_mut().iter_mut().zip(arriving.as_flattened()) {
                *b = 1.0 + rho * e;
            }
            let truth = (1.0 - wide.powi(bounces + 1)) / (1.0 - wide);
            for b in radiosity.as_flattened() {
                assert!((f64::from(*b) / truth - 1.0).abs() < 1e-5, "{rho}, {bounces} bounces: {b}, {truth}");
            }
        }
        let emission = vec![[1.0; 3]; n];
        let mut indirect = vec![[0.0; 3]; n];
        session
            .relight(
                &relighter,
                (&vec![[0.0; 3]; n], &emission),
                &mut indirect,
                12,
                &mut Workspace::default(),
            )
            .unwrap();
        let truth = 1.0 / (1.0 - wide);
        let worst =
            indirect.as_flattened().iter().map(|e| (f64::from(*e) / truth - 1.0).abs()).fold(0.0, f64::max);
        println!("rho {rho}: off by {worst:.2e} after all bounces");
        assert!(worst < 1e-5, "{rho}: {worst}");
    }
}

/// Indirect irradiance of all bounces by Gauss-Seidel in f64.
fn solved(f: &FormFactors, rho: &[f64], direct: &[f64]) -> Vec<f64> {
    let n = f.len();
    let mut b: Vec<f64> = (0..n).map(|i| rho[i] * direct[i]).collect();
    let row = |b: &[f64], i: usize| {
        (0..n).map(|j| f64::from(f.flux(i, j)) * b[j]).sum::<f64>() / f64::from(f.areas[i])
    };
    for _ in 0..30_000 {
        let mut moved = 0.0_f64;
        for i in 0..n {
            let next = rho[i] * (direct[i] + row(&b, i));
            moved = moved.max((next - b[i]).abs());
            b[i] = next;
        }
        if moved < 1e-12 {
            break;
        }
    }
    (0..n).map(|i| row(&b, i)).collect()
}

fn plain(session: &CpuSession, f: &FormFactors, rho: &[f64], direct: &[f64], passes: u32) -> Vec<f64> {
    let albedo: Vec<[f32; 3]> = rho.iter().map(|r| [*r as f32; 3]).collect();
    let direct: Vec<[f32; 3]> = direct.iter().map(|e| [*e as f32; 3]).collect();
    let relighter = Relighter::encode(f, &albedo, Rates::Uniform(Kind::F32)).unwrap();
    let mut indirect = vec![[0.0; 3]; f.len()];
    session.relight(&relighter, (&direct, &[]), &mut indirect, passes, &mut Workspace::default()).unwrap();
    indirect.iter().map(|e| f64::from(e[0])).collect()
}

#[test]
fn black_and_nearly_white_walls_and_light_on_one_patch_alone() {
    let mut desc = room([0.5; 3], [0.0; 3]);
    point(&mut desc);
    let session = session(&desc, None);
    let map = patches(&session, 60);
    let n = map.patches.len();
    let f = exact_rows(&session, &map, 2048);
    let mut direct = vec![0.0; n];
    direct[n / 2] = 5.0;
    // A black wall beside white ones.
    let rho: Vec<f64> =
        map.patches.list().iter().map(|p| if p.normal[0] > 0.5 { 0.0 } else { 0.999 }).collect();
    let (found, truth) = (plain(&session, &f, &rho, &direct, 400), solved(&f, &rho, &direct));
    for (x, t) in found.iter().zip(&truth) {
        assert!((x / t - 1.0).abs() < 1e-4, "{x} {t}");
    }
    // White all around: the light of one patch a thousand times over.
    let albedo = vec![[0.999; 3]; n];
    let two = Relighter::encode(&f, &albedo, Rates::Uniform(Kind::F32)).unwrap();
    let two = session.with_coarse(two, Rates::Uniform(Kind::F32)).unwrap();
    let lit: Vec<[f32; 3]> = direct.iter().map(|e| [*e as f32; 3]).collect();
    let mut indirect = vec![[0.0; 3]; n];
    session.relight(&two, (&lit, &[]), &mut indirect, 12, &mut Workspace::default()).unwrap();
    let flux = |e: &dyn Fn(usize) -> f64| (0..n).map(|i| f64::from(f.areas[i]) * e(i)).sum::<f64>();
    let ratio = flux(&|i| f64::from(indirect[i][0])) / flux(&|i| direct[i]);
    assert!((ratio / 999.0 - 1.0).abs() < 2e-3, "{ratio}");
    // Black all around: once, and no more.
    let once = plain(&session, &f, &vec![0.0; n], &direct, 5);
    assert!(once.iter().all(|e| *e == 0.0));
}

#[test]
fn an_open_room_of_white_walls_under_a_white_sky_cannot_be_seen() {
    let mut desc = room([1.0; 3], [0.0; 3]);
    desc.shapes.retain(|s| s.material != "y+");
    desc.lights.push(LightDesc::Environment { radiance: [1.0; 3] });
    let session = session(&desc, None);
    let map = patches(&session, 100);
    let f = exact_rows(&session, &map, 2048);
    let n = f.len();
    let sky: Vec<f64> = f.escaped.iter().map(|e| PI * f64::from(*e)).collect();
    let white = plain(&session, &f, &vec![1.0; n], &sky, 600);
    for i in 0..n {
        assert!(((white[i] + sky[i]) / PI - 1.0).abs() < 1e-3, "{i}: {} + {}", white[i], sky[i]);
    }
    let rho: Vec<f64> = (0..n).map(|i| [0.0, 0.3, 0.8][i % 3]).collect();
    let (found, truth) = (plain(&session, &f, &rho, &sky, 100), solved(&f, &rho, &sky));
    for i in 0..n {
        assert!((found[i] - truth[i]).abs() < 1e-5 * PI && found[i] + sky[i] < PI, "{i}");
    }
}

#[test]
fn patches_that_see_nothing_or_one_other_alone() {
    // A floor by itself: its parts share edges and a plane; and a triangle, which is two patches.
    let floor = scene(&[rectangle([0.3, -0.2, 0.1], [1.0, 0.2, 0.3], [-0.2, 1.1, 0.4])]);
    let triangle = scene(&[vec![[0.1, 0.2, 0.3], [1.1, 0.3, 0.2], [0.4, 1.2, 0.9]]]);
    for (desc, count) in [(floor, 30), (triangle, 1)] {
        let session = session(&desc, None);
        let map = patches(&session, count);
        let n = map.patches.len();
        assert!(if count == 1 { n == 2 } else { n > 10 }, "{n}");
        assert!(near(&session, &map, &all_pairs(&map), 64).iter().all(|p| p.flux == 0.0));
        let f = counted(&session, &map, 512);
        assert!(f.half.iter().all(|x| *x == 0.0) && f.escaped.iter().all(|e| *e == 1.0));
        assert!(plain(&session, &f, &vec![0.9; n], &vec![1.0; n], 3).iter().all(|e| *e == 0.0));
    }
    // Two triangles face to face: inner sides see each other alone, outer sides nothing.
    let lower = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let upper: Vec<P> = lower.iter().map(|p: &P| [p[0], p[1], 0.2]).collect();
    let session = session(&scene(&[lower, upper]), None);
    let map = patches(&session, 1);
    let list = map.patches.list();
    assert_eq!(list.len(), 4);
    let inner: Vec<usize> =
        (0..4).filter(|i| (list[*i].position[2] < 0.1) == (list[*i].normal[2] > 0.0)).collect();
    let f = counted(&session, &map, 4096);
    let pairs = near(&session, &map, &all_pairs(&map), 512);
    let seen = pairs.iter().find(|p| p.flux > 0.0).unwrap();
    for pair in &pairs {
        let both =
            pair.patches.iter().all(|p| inner.contains(&(*p as usize))) && pair.patches[0] != pair.patches[1];
        let [i, j] = pair.patches.map(|p| p as usize);
        assert_eq!([pair.flux > 0.0, f.flux(i, j) > 0.0], [both; 2], "{pair:?}");
    }
    let rho = vec![0.5; 4];
    let mut direct = vec![0.0; 4];
    direct[inner[0]] = 2.0;
    let mut exact = f.clone();
    let [i, j] = [inner[0].max(inner[1]), inner[0].min(inner[1])];
    exact.half[i * (i + 1) / 2 + j] = seen.flux as f32;
    let share = seen.flux / 0.5;
    let found = plain(&session, &exact, &rho, &direct, 60);
    // 1 sends 1, gets back what of it returns, and so on.
    let truth = share / (1.0 - 0.25 * share * share);
    assert!((found[inner[1]] / truth - 1.0).abs() < 1e-5, "{found:?} {truth}");
    assert!((found[inner[0]] / (0.5 * share * truth) - 1.0).abs() < 1e-5, "{found:?}");
}
