//! Rooms whose light is known after each bounce, and scenes that are hard.

use super::rooms::{point, room, session};
use super::{P, all_pairs, counted, near, patches, rectangle, scene};
use etendue_core::backend::Session;
use etendue_core::radiosity::form_factors::{FormFactors, balance};
use etendue_core::radiosity::patches::PatchMap;
use etendue_core::radiosity::relight::{Portable, Relighter, Workspace};
use etendue_core::radiosity::tiles::{Kind, Rates};
use etendue_core::scene::{EnvironmentDesc, LightDesc};
use etendue_cpu::CpuSession;
use std::f64::consts::PI;

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
    desc.lights.push(LightDesc::Environment(EnvironmentDesc::uniform([1.0; 3])));
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
        let all = found[i] + sky[i];
        assert!((found[i] - truth[i]).abs() < 1e-5 * PI && all <= PI * (1.0 + 1e-5), "{i}: {all}");
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
    let upper: Vec<P> = lower.iter().map(|p: &P| [p[0], p[1], 1.5]).collect();
    let session = session(&scene(&[lower, upper]), None);
    let map = patches(&session, 4);
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
