//! Scenes and jobs of the tests of photons.

#![allow(dead_code, reason = "each test takes what it needs")]

use etendue_conformance::analytic::compiled;
use etendue_conformance::golden;
use etendue_conformance::scenes::{cases, diffuse, environment, material, point_light, room, shape, sphere};
use etendue_core::backend::{
    BackendError, Control, PhotonJob, PhotonStart, Probe, illumination_film_settings,
};
use etendue_core::direct::irradiance::place_on;
use etendue_core::film::Film;
use etendue_core::illumination::{Basis, ElementSettings, Elements, Sides};
use etendue_core::scene::{
    CompiledScene, LightDesc, MaterialKind, MediumDesc, Reflectance, SceneDesc, ShapeDesc, ShapeKind,
};
use etendue_core::transport::photon::Sequence;
use etendue_wgpu::Step;
use std::ops::{ControlFlow, Range};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// A room with a ball, a disk, a mirror and a lamp, under lights of each kind.
pub(crate) fn furnished() -> SceneDesc {
    let disk = ShapeKind::Disk { center: [0.3, -0.4, 0.1], radius: 0.4, normal: [0.2, 0.1, 0.9] };
    let lamp = ShapeKind::Rectangle { center: [0.2, 0.1, 0.9], u: [0.0, 0.2, 0.0], v: [0.3, 0.0, 0.0] };
    let mirror = ShapeKind::Rectangle { center: [-0.9, 0.1, 0.2], u: [0.0, 0.4, 0.0], v: [0.0, 0.0, 0.5] };
    SceneDesc {
        meshes: vec![room([0.0; 3], 1.0, "wall")],
        shapes: vec![
            sphere([-0.4, 0.3, -0.5], 0.35, "wall"),
            shape(disk, "dark"),
            shape(lamp, "lamp"),
            shape(mirror, "mirror"),
        ],
        materials: vec![
            diffuse("wall", 0.6, 0.0),
            diffuse("dark", 0.2, 0.0),
            diffuse("lamp", 0.1, 2.0),
            material("mirror", MaterialKind::Mirror { albedo: Reflectance::flat([0.9; 3]) }, 0.0),
        ],
        lights: vec![
            point_light([0.1, 0.2, 0.5], 1.0),
            LightDesc::Spot {
                position: [-0.5, -0.5, 0.9],
                direction: [0.4, 0.6, -1.0],
                intensity: [5.0, 2.0, 0.1],
                cone_deg: 50.0,
                falloff_deg: 20.0,
            },
            LightDesc::Directional { direction: [0.3, -0.2, -1.0], irradiance: [0.7, 0.8, 0.9] },
            environment(0.2),
        ],
        ..SceneDesc::default()
    }
}

/// Triangles of diffuse surfaces alone, under a lamp and lights of each kind: the least code of all.
pub(crate) fn plain() -> SceneDesc {
    let mut desc = furnished();
    desc.shapes.retain(|s| s.material == "lamp");
    desc.materials.retain(|m| m.name != "mirror");
    desc
}

/// The same full of fog, with a ball of glass and a pane.
pub(crate) fn foggy() -> SceneDesc {
    let mut desc = plain();
    let glass = MaterialKind::Dielectric { ior: [1.5; 3], schlick: false };
    let film = MaterialKind::ThinFilm { reflect: [0.1, 0.1, 0.3], transmit: [0.8, 0.6, 0.2] };
    desc.materials.extend([
        material("none", MaterialKind::Null, 0.0),
        material("glass", glass, 0.0),
        material("film", film, 0.0),
    ]);
    let fog = ShapeDesc {
        interior: "fog".into(),
        ..shape(ShapeKind::Box { min: [-1.0; 3], max: [1.0; 3] }, "none")
    };
    let pane = ShapeKind::Rectangle { center: [0.2, 0.1, 0.3], u: [0.0, 0.5, 0.0], v: [0.6, 0.0, 0.0] };
    desc.shapes.extend([fog, shape(pane, "film"), sphere([-0.4, 0.3, -0.5], 0.35, "glass")]);
    desc.media.push(MediumDesc::new("fog", [0.02, 0.05, 0.1], [0.3, 0.2, 0.4], 0.3));
    desc
}

/// The scenes of the suite in which photons have something to do.
pub(crate) fn scenes() -> Vec<(String, Arc<CompiledScene>)> {
    let mut all = vec![("furnished".to_string(), scene(&furnished()))];
    all.extend(golden::scenes().into_iter().map(|g| (g.name.to_string(), scene(&g.scene))));
    all.extend(cases::cases().into_iter().map(|c| (c.name.to_string(), scene(&c.scene))));
    all.retain(|(_, s)| {
        s.needs.beyond_photons().is_none() && etendue_core::transport::photon::LightPlan::new(s).is_ok()
    });
    all
}

/// The scene of this name.
pub(crate) fn named(name: &str) -> Arc<CompiledScene> {
    scenes().into_iter().find(|(n, _)| n == name).unwrap().1
}

/// A dozen probes on surfaces, some on their backs; light passes null boundaries and glass, where there is nothing to read.
pub(crate) fn probes(scene: &CompiledScene) -> Vec<Probe> {
    let probe = |p: u32| {
        if scene.material_of(p).is_passage() {
            return None;
        }
        let (at, n) = place_on(scene, p, [0.31, 0.47])?;
        let n = if p.is_multiple_of(3) { -n } else { n };
        Some(Probe { position: at.to_array(), normal: n.to_array() })
    };
    (0..scene.primitives().count() as u32).filter_map(probe).take(12).collect()
}

pub(crate) fn scene(desc: &SceneDesc) -> Arc<CompiledScene> {
    compiled(desc).unwrap()
}

/// Linear elements of a third of the scene with sides apart.
pub(crate) fn elements(scene: &CompiledScene) -> ElementSettings {
    let extent = (scene.bounds.hi - scene.bounds.lo).max_element();
    ElementSettings { basis: Basis::Linear, sides: Sides::Apart, largest: 0.3 * extent }
}

pub(crate) fn job(scene: &CompiledScene, sequence: Sequence, replicates: Range<u32>) -> PhotonJob {
    PhotonJob {
        seed: 0x1234_5678_9abc,
        photons: 1 << 10,
        replicates,
        max_hits: u32::MAX,
        start: PhotonStart::Lights { registers_direct: true, survives_first: false },
        sequence,
        elements: elements(scene),
    }
}

pub(crate) fn film(scene: &CompiledScene, job: &PhotonJob) -> Film {
    let elements = Elements::new(scene, job.elements);
    Film::new(illumination_film_settings(scene, &elements, job).unwrap())
}

/// Cancels after some calls.
pub(crate) struct After(AtomicU32);

impl After {
    pub(crate) fn calls(calls: u32) -> Self {
        Self(calls.into())
    }
}

impl Control for After {
    fn advance(&self, done: u64, total: u64) -> ControlFlow<()> {
        assert!(done <= total);
        let left = self.0.fetch_sub(1, Ordering::Relaxed);
        if left <= 1 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Takes all steps of a task without ever waiting, and checks that its progress never goes back; how far it came.
pub(crate) fn never_wait(mut step: impl FnMut() -> Result<Step, BackendError>) -> u64 {
    let (mut last, mut working) = (0, 0_u64);
    loop {
        match step().unwrap() {
            Step::Working => working += 1,
            Step::Progress { done, total } => {
                assert!(done >= last && done <= total);
                last = done;
            }
            Step::Done => break,
        }
    }
    assert!(working > 0);
    last
}
