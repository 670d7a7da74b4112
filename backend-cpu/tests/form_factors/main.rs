//! Form factors between surfaces against closed forms, by pairs and by rays; in [`hard`], rooms whose light is known and scenes that are hard.
//!
//! Truths: J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors (numbers of factors as given); polygons are those of P. Schroeder and P. Hanrahan, On the Form
//! Factor between Two Polygons (1993), their values by quadrature of 48 x 48 Gauss points.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod hard;
#[path = "../rooms/mod.rs"]
mod rooms;

use etendue_core::backend::{FormFactorJob, NoControl, Session};
use etendue_core::illumination::ElementPlace;
use etendue_core::radiosity::form_factors::near::{NearPair, NearSettings, near_pairs};
use etendue_core::radiosity::form_factors::{FormFactors, assemble, assemble_with};
use etendue_core::radiosity::patches::{PatchMap, PatchSettings};
use etendue_core::scene::{MeshDesc, SceneDesc};
use etendue_cpu::CpuSession;
use rooms::{point, room, session};
use std::f64::consts::PI;

type P = [f64; 3];

/// Unobstructed and obstructed pairs, relative.
const OPEN: f64 = 1e-3;
const OBSTRUCTED: f64 = 1e-2;
/// What rays may be off by, in standard errors.
const SIGMAS: f64 = 4.0;

/// What lies in a plane through a point with this normal; both sides, or that alone.
#[derive(Clone, Copy, Debug)]
struct Plane(P, P, bool);

impl Plane {
    fn has(&self, place: &ElementPlace) -> bool {
        let Self(from, n, both) = *self;
        let dot = |a: P, b: P| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let [at, normal] = [place.position, place.normal].map(|v| v.to_array().map(f64::from));
        let away: P = std::array::from_fn(|k| at[k] - from[k]);
        let length = dot(n, n).sqrt();
        let cos = dot(normal, n) / length;
        (dot(away, n) / length).abs() < 1e-4 && if both { cos.abs() > 0.9 } else { cos > 0.9 }
    }

    /// The patches of the surface; no patch may be of two surfaces.
    fn patches(&self, session: &CpuSession, map: &PatchMap) -> Vec<usize> {
        let places = map.elements.element_places(session.scene());
        let mine = |patch: &usize| {
            let members = map.patches.members(*patch);
            let on = members.iter().filter(|e| self.has(&places[**e as usize])).count();
            assert!(on == 0 || on == members.len(), "too few patches: one is of two surfaces");
            on > 0
        };
        let found: Vec<usize> = (0..map.patches.len()).filter(mine).collect();
        assert!(!found.is_empty());
        found
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

fn between(desc: &SceneDesc, (count, points): (u32, u32), from: Plane, to: Plane) -> Found {
    let session = session(desc, None);
    let map = patches(&session, count);
    let list = map.patches.list();
    let [from, to] = [from, to].map(|s| s.patches(&session, &map));
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
    (from, to): (Plane, Plane),
    truth: f64,
    tolerance: f64,
) -> Found {
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
    found
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
        let ends = (Plane([0.0; 3], Z, false), Plane([0.0, 0.0, c], Z, true));
        let effort = if c < 0.5 { (500, 16) } else { (48, 512) };
        check(&format!("C-11 {a} x {b} at {c}"), &desc, effort, ends, truth, OPEN);
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
        let (floor, wall) = (Plane([0.0; 3], Z, false), Plane([0.0; 3], [1.0, 0.0, 0.0], false));
        let found = check(&format!("C-14 {l} x {w} to {h}"), &desc, (48, 1024), (floor, wall), there, OPEN);
        // A_1 F_12 = A_2 F_21.
        let turned = found.near[0] * found.area / (l * h);
        assert!((turned / back - 1.0).abs() <= OPEN, "{turned} {back}");
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
        let ends = (Plane([0.0; 3], Z, false), Plane(at, normal, true));
        check(name, &scene(&[sender, other]), (100, 128), ends, truth, OPEN);
    }
}

/// A regular polygon with the area of a disk about the z axis.
fn disk(radius: f64, z: f64) -> Vec<P> {
    const SIDES: u32 = 48;
    let step = 2.0 * PI / f64::from(SIDES);
    let r = radius * (step / step.sin()).sqrt();
    (0..SIDES).map(|k| (f64::from(k) * step).sin_cos()).map(|(s, c)| [r * c, r * s, z]).collect()
}

#[test]
fn disks_see_each_other_as_the_catalogue_says() {
    // C-41: coaxial disks. Facets of equal area stand for them; round shapes have no patches. Balls are left out: one of facets is right for the catalogue's only where it is small,
    // and then its inside shares voxels, and with them patches, with its outside.
    for (r1, r2, h, truth) in [
        (1.0, 1.0, 1.0, 0.381_966_011_250_105_15),
        (1.0, 2.0, 1.0, 0.763_932_022_500_210_3),
        (0.5, 1.0, 2.0, 0.192_235_935_955_848_62),
    ] {
        let ends = (Plane([0.0; 3], Z, false), Plane([0.0, 0.0, h], Z, true));
        check(
            &format!("C-41 {r1}, {r2} at {h}"),
            &scene(&[disk(r1, 0.0), disk(r2, h)]),
            (100, 64),
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
        // On the square's edge, half.
        let behind = |s: f64| if (s - 1.0).abs() < 1e-9 { 0.5 } else { f64::from(u8::from(s < 1.0)) };
        let squared = 1.0 + (x - u).powi(2) + (y - v).powi(2);
        sum += (1.0 - behind(x + u) * behind(y + v)) / (PI * squared * squared);
    }
    sum / (N as f64).powi(4)
}

#[test]
fn what_stands_between_is_in_the_way() {
    let (u, v) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let ends = (Plane([0.0; 3], Z, false), Plane([0.0, 0.0, 1.0], Z, true));
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
    let found = near(&session, &map, &pairs, 1024);
    // Each the other way around, by other numbers of threads: the same bits.
    let turned: Vec<[u32; 2]> = pairs.iter().map(|[i, j]| [*j, *i]).collect();
    for threads in [2, 5] {
        let again = near(&rooms::session(&desc, Some(threads)), &map, &turned, 1024);
        assert!(found.iter().zip(&again).all(|(a, b)| a.flux == b.flux && a.stderr == b.stderr));
    }
    let list = map.patches.list();
    for pair in &found {
        let [p, q] = pair.patches.map(|p| list[p as usize].normal);
        let coplanar = (0..3).map(|k| p[k] * q[k]).sum::<f32>() > 0.9;
        assert!(if coplanar { pair.flux == 0.0 && pair.stderr == 0.0 } else { pair.flux > 0.0 }, "{pair:?}");
    }
    let rows = session.form_factors(&map, &job(&map, 1024), &NoControl).unwrap();
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
