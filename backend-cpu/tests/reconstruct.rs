//! Reconstruction of illumination maps of a small room, against many more photons.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::backend::{NoControl, PhotonJob, PhotonStart, Session, illumination_film_settings};
use etendue_core::film::Film;
use etendue_core::illumination::{Basis, Clustering, ElementSettings, Elements, Sides, reconstruct};
use etendue_core::scene::{
    LightDesc, MaterialDesc, MaterialKind, Reflectance, SceneDesc, ShapeDesc, ShapeKind, compile,
};
use etendue_core::transport::first_shot::{Subdivision, Weights};
use etendue_core::transport::photon::Sequence;
use etendue_cpu::{CpuBackend, CpuSession};
use std::sync::Arc;

/// A room of 4 m x 3 m x 4 m with two boxes in it, a point light and a spot.
fn session() -> CpuSession {
    let material = |name: &str, albedo| MaterialDesc {
        name: name.into(),
        kind: MaterialKind::Diffuse { albedo: Reflectance::flat(albedo) },
        two_sided: true,
        emission: [0.0; 3],
    };
    let shape = |min, max, material: &str| ShapeDesc {
        kind: ShapeKind::Box { min, max },
        material: material.into(),
        interior: String::new(),
        exterior: String::new(),
    };
    let desc = SceneDesc {
        shapes: vec![
            shape([0.0, 0.0, 0.0], [4.0, 3.0, 4.0], "wall"),
            shape([0.7, 0.0, 0.8], [1.6, 1.4, 1.5], "red"),
            shape([2.3, 0.0, 2.0], [3.2, 0.8, 3.1], "wall"),
        ],
        materials: vec![material("wall", [0.6, 0.55, 0.4]), material("red", [0.7, 0.15, 0.1])],
        lights: vec![
            LightDesc::Point { position: [2.1, 2.5, 1.9], intensity: [3.0, 2.5, 2.0] },
            LightDesc::Spot {
                position: [0.5, 2.7, 3.4],
                direction: [0.5, -1.0, -0.4],
                intensity: [20.0, 18.0, 16.0],
                cone_deg: 30.0,
                falloff_deg: 20.0,
            },
        ],
        ..SceneDesc::default()
    };
    CpuBackend::new(None).unwrap().open_session(Arc::new(compile(&desc).unwrap().0)).unwrap()
}

#[test]
fn error_falls_and_is_known() {
    let session = session();
    let lights = |survives_first| PhotonStart::Lights { registers_direct: false, survives_first };
    let surfaces =
        PhotonStart::Surfaces { subdivision: Subdivision::robust(Weights::EXACT), weights: Weights::EXACT };
    // The noise of nodes is anticorrelated, which the model leaves out: it states too much there.
    for (basis, sides, most) in [(Basis::Constant, Sides::Together, 1.25), (Basis::Linear, Sides::Apart, 1.5)]
    {
        let settings = ElementSettings { basis, sides, largest: 0.25 };
        let elements = Elements::new(session.scene(), settings);
        let clustering = Clustering::new(session.scene(), &elements);
        let map = |seed, bits: u32, start, sequence| {
            let job = PhotonJob {
                seed,
                photons: 1 << (bits - 4),
                replicates: 0..16,
                max_hits: u32::MAX,
                start,
                sequence,
                elements: settings,
            };
            let mut film = Film::new(illumination_film_settings(session.scene(), &elements, &job).unwrap());
            session.illumination(&job, &NoControl, &mut film).unwrap();
            film
        };
        let reference = map(77, 22, lights(true), Sequence::Sorted);
        for (bits, start, sequence) in [
            (15, lights(false), Sequence::Random),
            (18, lights(false), Sequence::Random),
            (16, surfaces, Sequence::Sorted),
        ] {
            let film = map(1, bits, start, sequence);
            let found = reconstruct(&clustering, &elements, &film).unwrap();
            // Squares over surfaces and channels: raw, found (the reference's noise taken out), stated, size; and flux of both maps.
            let (mut raw, mut after, mut stated, mut size) = (0.0, 0.0, 0.0, 0.0);
            let (mut z2, mut weights, mut flux) = (0.0, 0.0, [0.0; 2]);
            for i in 0..film.len() {
                let (w, mean, truth) = (elements.weight(i), film.mean(i), reference.mean(i));
                let noise = reference.variance(i).unwrap();
                for c in 0..3 {
                    let (x, s2) = (found.values[i][c], found.stderr[i][c].powi(2));
                    raw += w * ((mean[c] - truth[c]).powi(2) - noise[c]);
                    after += w * ((x - truth[c]).powi(2) - noise[c]);
                    stated += w * s2;
                    size += w * (truth[c].powi(2) - noise[c]);
                    if truth[c] > 0.0 {
                        z2 += w * (x - truth[c]).powi(2) / (s2 + noise[c]);
                        weights += w;
                    }
                    flux[0] += w * mean[c];
                    flux[1] += w * x;
                }
            }
            let [raw, after, stated] = [raw, after, stated].map(|x| (x / size).sqrt());
            let what = format!(
                "{basis:?} {sides:?} 2^{bits} {sequence:?}: {raw:.4} -> {after:.4}, {stated:.4} stated, z2 {:.3}, flux {:.5}",
                z2 / weights,
                flux[1] / flux[0]
            );
            assert!(after <= 0.5 * raw, "error: {what}");
            assert!(stated >= 0.8 * after && stated <= most * after, "stated: {what}");
            assert!((0.5..=2.2).contains(&(z2 / weights)), "z^2: {what}");
            assert!((flux[1] / flux[0] - 1.0).abs() <= 2e-3, "flux: {what}");
        }
    }
}
