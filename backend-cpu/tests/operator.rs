//! Patches, form factors and relighting on rooms whose light is known.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod rooms;

use etendue_core::backend::{BackendError, Control, FormFactorJob, NoControl, Session};
use etendue_core::radiosity::form_factors::{FormFactors, assemble, balance};
use etendue_core::radiosity::order;
use etendue_core::radiosity::patches::{NO_PATCH, PatchMap, PatchSettings};
use etendue_core::radiosity::relight::{Portable, Relighter, Workspace};
use etendue_core::radiosity::tiles::{Kind, Rates, SIDE};
use etendue_core::scene::{MaterialKind, Reflectance, SceneDesc, ShapeKind};
use etendue_cpu::CpuSession;
use rooms::{diffuse, furniture, lamp, point, room, session, shape, wall};
use std::ops::ControlFlow;

fn patches(session: &CpuSession, count: u32) -> PatchMap {
    let map = session.patches(&PatchSettings { count, seed: 1 }).unwrap();
    let order = order::kd(map.patches.list(), SIDE);
    PatchMap { patches: map.patches.reordered(&order), ..map }
}

fn counted(session: &CpuSession, map: &PatchMap, rays: u32) -> FormFactors {
    let job = FormFactorJob { seed: 2, rays, patches: 0..map.patches.len() as u32 };
    let rows = session.form_factors(map, &job, &NoControl).unwrap();
    assemble(&map.patches.areas(), &rows).unwrap()
}

#[test]
fn patches_of_a_room_are_its_inner_walls() {
    let mut desc = room([0.5, 0.4, 0.3], [0.0; 3]);
    point(&mut desc);
    let session = session(&desc, None);
    let map = patches(&session, 300);
    let n = map.patches.len();
    assert!((150..=450).contains(&n), "{n}");
    let area: f64 = map.patches.list().iter().map(|p| f64::from(p.area)).sum();
    assert!((area - 24.0).abs() < 1e-4, "the outsides, which nothing lights, are not among them: {area}");
    for patch in map.patches.list() {
        // Fronts face inward: against the place.
        let inward: f32 = (0..3).map(|k| patch.position[k] * patch.normal[k]).sum();
        assert!((inward + 1.0).abs() < 1e-4, "{patch:?}");
        assert!(patch.albedo.iter().zip([0.5, 0.4, 0.3]).all(|(a, b)| (a - b).abs() < 1e-6));
    }
    for (element, patch) in map.patches.of().iter().enumerate().filter(|(_, p)| **p != NO_PATCH) {
        assert!(map.patches.members(*patch as usize).contains(&(element as u32)));
    }
}

#[test]
fn a_closed_room_has_the_light_of_the_closed_form() {
    for rho in [0.0_f32, 0.5, 0.9, 0.99] {
        let mut desc = room([rho; 3], [0.0; 3]);
        point(&mut desc);
        let session = session(&desc, None);
        let map = patches(&session, 200);
        let mut form_factors = counted(&session, &map, 1024);
        let targets = form_factors.targets();
        assert!(targets.iter().all(|t| *t == 1.0), "nothing leaves a closed room");
        let report = balance(&mut form_factors, &targets, 60);
        assert!(report.after < 1e-6, "{report:?}");
        let n = map.patches.len();
        let albedo = vec![[rho; 3]; n];
        let relighter = Relighter::encode(&form_factors, &albedo, Rates::Uniform(Kind::F32)).unwrap();
        let relighter = session.with_coarse(relighter, Rates::Uniform(Kind::F32)).unwrap();
        let mut indirect = vec![[0.0; 3]; n];
        let mut room = Workspace::default();
        session.relight(&relighter, (&vec![[1.0; 3]; n], &[]), &mut indirect, 8, &mut room).unwrap();
        // Direct irradiance 1 everywhere: rho + rho^2 + ...
        let truth = f64::from(rho) / (1.0 - f64::from(rho));
        for e in indirect.as_flattened() {
            assert!(
                (f64::from(*e) - truth).abs() <= 1e-5 * (truth + 1.0) / (1.0 - f64::from(rho)).max(0.05),
                "{rho}: {e}, {truth}"
            );
        }
        // By few bits, with factors that keep the sums of rows.
        let few = Relighter::encode(&form_factors, &albedo, Rates::Uniform(Kind::Bits3)).unwrap();
        let few = session.with_coarse(few, Rates::Uniform(Kind::Bits8)).unwrap();
        session.relight(&few, (&vec![[1.0; 3]; n], &[]), &mut indirect, 8, &mut room).unwrap();
        let mean = indirect.iter().map(|e| f64::from(e[0])).sum::<f64>() / n as f64;
        assert!((mean - truth).abs() <= 2e-3 * truth, "{rho}: {mean}, {truth}");
    }
}

#[test]
fn two_squares_see_each_other_as_the_catalogue_says() {
    // J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, C-11 and C-14 with unit sides.
    let side = |center: [f32; 3], u: [f32; 3], v: [f32; 3]| shape(ShapeKind::Rectangle { center, u, v }, "m");
    let floor = side([0.0; 3], [0.0, 0.0, 0.5], [0.5, 0.0, 0.0]);
    let opposed = side([0.0, 1.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5]);
    let upright = side([-0.5, 0.5, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]);
    for (other, truth) in [(opposed, 0.199_824_895_698_4), (upright, 0.200_043_776_075_4)] {
        let desc = SceneDesc {
            shapes: vec![floor.clone(), other],
            materials: vec![diffuse("m", [0.5; 3], [0.0; 3])],
            ..SceneDesc::default()
        };
        let session = session(&desc, None);
        let map = patches(&session, 64);
        let form_factors = counted(&session, &map, 1 << 13);
        // The floor's upper side to all that lies elsewhere.
        let (mut flux, mut area) = (0.0, 0.0);
        for (i, p) in map.patches.list().iter().enumerate() {
            if p.normal[1] > 0.5 && p.position[1].abs() < 1e-3 {
                area += f64::from(p.area);
                flux += (0..map.patches.len()).map(|j| f64::from(form_factors.flux(i, j))).sum::<f64>();
            }
        }
        assert!((area - 1.0).abs() < 1e-5, "{area}");
        assert!((flux / truth - 1.0).abs() < 4e-3, "{flux}, {truth}");
    }
}

#[test]
fn the_same_bits_for_any_number_of_threads_and_any_split() {
    let mut desc = room([0.6, 0.5, 0.4], [0.0; 3]);
    lamp(&mut desc);
    desc.shapes.push(shape(ShapeKind::Box { min: [-0.7, -0.99, -0.1], max: [-0.2, -0.3, 0.5] }, "x+"));
    let made = |threads: usize| {
        let session = session(&desc, Some(threads));
        let map = patches(&session, 700);
        let job = |patches| FormFactorJob { seed: 2, rays: 64, patches };
        let n = map.patches.len() as u32;
        let rows = session.form_factors(&map, &job(0..n), &NoControl).unwrap();
        let mut split = session.form_factors(&map, &job(0..n / 3), &NoControl).unwrap();
        split.extend(session.form_factors(&map, &job(n / 3..n + 9), &NoControl).unwrap());
        assert_eq!(rows, split);
        let form_factors = assemble(&map.patches.areas(), &rows).unwrap();
        let albedo: Vec<[f32; 3]> = map.patches.list().iter().map(|p| p.albedo).collect();
        let relighter = Relighter::encode(&form_factors, &albedo, Rates::Cheapest { lambda: 1e-6 }).unwrap();
        let relighter = session.with_coarse(relighter, Rates::Uniform(Kind::Bits8)).unwrap();
        let mut direct = vec![[0.0; 3]; n as usize];
        direct[17] = [1.0, 2.0, 3.0];
        let (mut found, mut plain) = (direct.clone(), direct.clone());
        session.relight(&relighter, (&direct, &[]), &mut found, 3, &mut Workspace::default()).unwrap();
        relighter.relight(&Portable, (&direct, &[]), &mut plain, 3, &mut Workspace::default()).unwrap();
        assert_eq!(found, plain, "threads and wide registers change nothing");
        (map.patches, rows, found, session.transfer(&patches(&session, 700)).unwrap())
    };
    let one = made(1);
    assert!(one.2.iter().flatten().all(|x| x.is_finite()));
    println!(
        "LEAST {:?} MOST {:?}",
        one.2.iter().flatten().fold(9.0_f32, |m, x| m.min(*x)),
        one.2.iter().flatten().fold(0.0_f32, |m, x| m.max(*x))
    );
    assert!(one == made(2) && one == made(5));
}

#[test]
fn light_is_not_carried_through_a_wall() {
    // Two cells side by side with a thin wall between; what lies on one side must not show on the other.
    let mut desc = room([0.5; 3], [0.0; 3]);
    point(&mut desc);
    desc.shapes.push(shape(
        ShapeKind::Rectangle { center: [0.13, 0.0, 0.0], u: [0.0, 1.0, 0.0], v: [0.0, 0.0, 1.0] },
        "x+",
    ));
    desc.lights
        .push(etendue_core::scene::LightDesc::Point { position: [0.6, 0.0, 0.0], intensity: [1.0; 3] });
    let session = session(&desc, None);
    let map = patches(&session, 600);
    let values: Vec<[f32; 3]> = map
        .patches
        .list()
        .iter()
        .map(|p| {
            if p.position[0] > 0.13 || (p.position[0] > 0.12 && p.normal[0] > 0.5) {
                [1.0; 3]
            } else {
                [0.0; 3]
            }
        })
        .collect();
    let spread = session.transfer(&map).unwrap().apply(&values);
    let places = map.elements.element_places(session.scene());
    let mut dark = 0;
    for (element, place) in places.iter().enumerate() {
        let patch = map.patches.of()[element];
        if patch == NO_PATCH {
            continue;
        }
        let own = values[patch as usize][0];
        // Patches of floor and ceiling may lie under the wall; elements of patches on the dark side stay dark.
        if own == 0.0
            && map.patches.members(patch as usize).iter().all(|e| places[*e as usize].position.x < 0.1)
            && place.normal.x.abs() < 0.5
        {
            assert!(spread[element][0] < 1e-6, "{place:?} {}", spread[element][0]);
            dark += 1;
        }
    }
    assert!(dark > 100, "{dark}");
}

#[test]
fn what_is_not_diffuse_is_refused_and_jobs_can_be_stopped() {
    struct Stop;
    impl Control for Stop {
        fn advance(&self, _: u64, _: u64) -> ControlFlow<()> {
            ControlFlow::Break(())
        }
    }
    let mut desc = room([0.5; 3], [0.0; 3]);
    point(&mut desc);
    let plain = session(&desc, None);
    let map = patches(&plain, 50);
    let job = FormFactorJob { seed: 0, rays: 16, patches: 0..50 };
    assert_eq!(plain.form_factors(&map, &job, &Stop), Err(BackendError::Cancelled));
    let settings = PatchSettings { count: 50, seed: 0 };
    let mut mirrors = desc.clone();
    wall(&mut mirrors, "x+", MaterialKind::Mirror { albedo: Reflectance::flat([0.9; 3]) });
    let mut round = desc;
    furniture(&mut round);
    for (desc, missing) in [(mirrors, "mirrors"), (round, "spheres and disks")] {
        let refused = session(&desc, None).patches(&settings);
        assert!(
            matches!(&refused, Err(BackendError::SceneNeeds { missing: m, .. }) if m == missing),
            "{refused:?}"
        );
    }
}
