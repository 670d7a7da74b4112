//! Maps of photons in media and behind surfaces that light passes, against paths.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod rooms;

use etendue_core::backend::{GatherJob, PathJob, PhotonStart};
use etendue_core::scene::{GridDesc, MaterialKind, MediumDesc, Roughness, SceneDesc, ShapeDesc, ShapeKind};
use etendue_core::transport::first_shot::{Subdivision, Weights};
use etendue_core::transport::photon::Sequence;
use rooms::agree::{Truth, check, check_image_by_both_ends};
use rooms::{JOB, diffuse, gather_probes, lamp, made_of, on_walls, point, room, session, shape, spot};

fn filled(kind: ShapeKind, material: &str, interior: &str) -> ShapeDesc {
    ShapeDesc { interior: interior.into(), ..shape(kind, material) }
}

const WHOLE: ShapeKind = ShapeKind::Box { min: [-1.0; 3], max: [1.0; 3] };

/// A room full of a coloured fog up to its walls, with a lamp, a point and a spot.
fn foggy() -> SceneDesc {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    lamp(&mut desc);
    point(&mut desc);
    spot(&mut desc);
    desc.materials.push(made_of("none", MaterialKind::Null));
    desc.media.push(MediumDesc::new("fog", [0.05, 0.1, 0.02], [0.4, 0.3, 0.6], 0.4));
    desc.shapes.push(filled(WHOLE, "none", "fog"));
    desc
}

/// However photons start and in whatever order they walk; and without a gather, where elements show their means.
#[test]
fn fog_up_to_the_walls() {
    let truth = Truth::by_paths(&foggy());
    let job = GatherJob { photons: 1 << 15, ..JOB };
    truth.check("fog", &job, 0.01);
    truth.check("one by one", &GatherJob { sequence: Sequence::Sobol, ..job.clone() }, 0.01);
    for weights in [Weights::EXACT, Weights::Density] {
        let start = PhotonStart::Surfaces { subdivision: Subdivision::robust(weights), weights };
        truth.check(&format!("{weights:?}"), &GatherJob { start, ..job.clone() }, 0.01);
    }
    truth.check_image("read", &GatherJob { photons: 1 << 16, gather: false, ..JOB }, 0.04);
}

/// A cloud on a grid and a ball of dense fog that glows, lit from without.
#[test]
fn clouds_and_fog_lit_from_without() {
    let mut desc = foggy();
    desc.shapes.pop();
    let (min, max) = ([-0.6, -0.8, -0.5], [0.3, 0.1, 0.6]);
    let to_world: [[f32; 4]; 3] = std::array::from_fn(|i| {
        let mut row = [0.0, 0.0, 0.0, min[i]];
        row[i] = max[i] - min[i];
        row
    });
    let values = vec![0.2, 1.0, 0.0, 2.0, 0.5, 0.1, 1.5, 0.3, 0.7, 0.0, 0.4, 2.5];
    desc.media[0].density = Some(GridDesc { size: [3, 2, 2], channels: 1, values, to_world });
    desc.shapes.push(filled(ShapeKind::Box { min, max }, "none", "fog"));
    let dense = MediumDesc::new("dense", [0.5; 3], [2.0, 4.0, 3.0], -0.3);
    desc.media.push(MediumDesc { emission: [2.0, 1.0, 0.5], ..dense });
    desc.shapes.push(filled(ShapeKind::Sphere { center: [0.6, 0.4, -0.2], radius: 0.25 }, "none", "dense"));
    check("clouds", &desc, &GatherJob { photons: 1 << 15, ..JOB });
}

/// What light without size sends through glass only photons and walks from both ends find; at a point, not even these: what arrives there is weighed in `illumination_media`.
#[test]
fn glass_and_panes_agree_with_paths_from_both_ends() {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    lamp(&mut desc);
    point(&mut desc);
    desc.materials.push(made_of("glass", MaterialKind::Dielectric { ior: [1.4, 1.5, 1.6], schlick: false }));
    desc.materials.push(made_of("plate", MaterialKind::ThinDielectric { ior: [1.5; 3], schlick: false }));
    let film = MaterialKind::ThinFilm { reflect: [0.1, 0.2, 0.3], transmit: [0.8, 0.5, 0.2] };
    desc.materials.push(made_of("film", film));
    let rectangle = |center, u, v| ShapeKind::Rectangle { center, u, v };
    desc.shapes.push(shape(ShapeKind::Sphere { center: [0.3, -0.5, 0.3], radius: 0.35 }, "glass"));
    desc.shapes.push(shape(rectangle([-0.4, 0.1, 0.3], [0.4, 0.0, 0.0], [0.0, 0.0, 0.4]), "film"));
    desc.shapes.push(shape(rectangle([0.5, 0.3, 0.0], [0.0, 0.4, 0.0], [0.0, 0.0, 0.5]), "plate"));
    check_image_by_both_ends("glass", &desc, &GatherJob { photons: 1 << 16, ..JOB }, 0.02);
}

/// Finishes that send light on to both sides, in a fog and with another within.
#[test]
fn rough_glass_and_films_that_scatter_in_fog() {
    let mut desc = foggy();
    desc.lights.clear();
    let ior = [1.5; 3];
    let glass = MaterialKind::RoughDielectric { ior, schlick: false, roughness: Roughness::Ggx(0.3) };
    desc.materials.push(made_of("frosted", glass));
    let film = MaterialKind::ScatteringFilm { reflect: [0.3, 0.2, 0.4], transmit: [0.5, 0.6, 0.4] };
    desc.materials.push(made_of("paper", film));
    desc.materials.push(diffuse("grey", [0.5; 3], [0.0; 3]));
    desc.media.push(MediumDesc::new("ink", [0.3, 0.1, 0.0], [0.5, 1.0, 0.2], 0.0));
    desc.shapes.push(filled(
        ShapeKind::Box { min: [-0.7, -0.9, -0.1], max: [-0.2, -0.3, 0.5] },
        "frosted",
        "ink",
    ));
    let paper = ShapeKind::Rectangle { center: [0.4, -0.2, 0.3], u: [0.3, 0.1, 0.0], v: [0.0, 0.2, 0.3] };
    desc.shapes.push(shape(paper, "paper"));
    check("finishes", &desc, &GatherJob { photons: 1 << 15, ..JOB });
}

#[test]
fn bits_depend_on_neither_threads_nor_splits() {
    let desc = foggy();
    let (one, three) = (session(&desc, Some(1)), session(&desc, Some(3)));
    let probes = on_walls();
    for sequence in [Sequence::Sorted, Sequence::Sobol] {
        let weights = Weights::EXACT;
        let start = PhotonStart::Surfaces { subdivision: Subdivision::robust(weights), weights };
        for start in [JOB.start, start] {
            let of = |blocks: std::ops::Range<u32>| GatherJob {
                path: PathJob { blocks, block_length: 4, ..JOB.path },
                photons: 1 << 11,
                sequence,
                start,
                ..JOB
            };
            let film = gather_probes(&one, &of(0..8), &probes);
            assert!(gather_probes(&three, &of(0..8), &probes) == film, "{sequence:?}");
            let mut late = gather_probes(&three, &of(4..8), &probes);
            late.merge(&gather_probes(&one, &of(0..4), &probes)).unwrap();
            assert!(late == film, "{sequence:?}");
        }
    }
}
