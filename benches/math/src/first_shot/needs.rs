//! Cost by need: the same photons by the code that a scene needs and by more of it, and by one lamp and by many in its place.

use super::measure::median;
use cpu_time::ProcessTime;
use etendue::core::backend::{NoControl, PhotonJob, PhotonStart, Session, illumination_film_settings};
use etendue::core::film::Film;
use etendue::core::illumination::ElementSettings;
use etendue::core::scene::{LightDesc, SceneDesc, compile};
use etendue::core::transport::TransportCode;
use etendue::core::transport::photon::Sequence;
use etendue::cpu::{CpuBackend, CpuSession};
use std::sync::Arc;

/// Lamps in the place of one, together as bright.
const LAMPS: usize = 16;
const PHOTONS: u32 = 1 << 20;

/// One row of the table.
pub struct Row {
    /// Its name.
    pub name: &'static str,
    /// Nanoseconds per ray of a photon's start and first surface, and of the rest of its walk: medians of the turns.
    pub nanoseconds: [f64; 2],
    /// Over the first row, within each turn; the medians.
    pub ratios: [f64; 2],
}

/// The diffuse room with one lamp, cut into some in the same place.
fn room(desc: &SceneDesc, lamps: usize, code: Option<TransportCode>) -> CpuSession {
    let mut desc = desc.clone();
    desc.lights =
        vec![LightDesc::Point { position: [2.78, 4.5, 2.795], intensity: [10.0 / lamps as f32; 3] }; lamps];
    let scene = compile(&desc).expect("a scene").0;
    assert_eq!(TransportCode::of(&scene.needs), NEEDED, "the room is to be diffuse, without bitmaps");
    CpuBackend::new(Some(1))
        .expect("a backend")
        .open_session(Arc::new(scene))
        .expect("a session")
        .with_code(code.unwrap_or(NEEDED))
}

const NEEDED: TransportCode = TransportCode { lobes: false, textures: false, shading_normals: false };

/// CPU seconds and rays of photons that end at their `max_hits`-th surface.
fn trace(session: &CpuSession, max_hits: u32, largest: f32) -> (f64, u64) {
    let job = PhotonJob {
        seed: 5,
        photons: PHOTONS,
        replicates: 0..1,
        max_hits,
        start: PhotonStart::Lights { registers_direct: true, survives_first: false },
        sequence: Sequence::Sorted,
        elements: ElementSettings { largest, ..ElementSettings::default() },
    };
    let elements = session.elements(&job.elements);
    let mut film = Film::new(illumination_film_settings(session.scene(), &elements, &job).expect("light"));
    let start = ProcessTime::now();
    let stats = session.illumination(&job, &NoControl, &mut film).expect("a map");
    (start.elapsed().as_secs_f64(), stats.rays)
}

/// All rows in turns; `largest` is the longest edge of the map's elements \[m\].
pub fn table(desc: &SceneDesc, largest: f32, turns: usize) -> Vec<Row> {
    let ways = [
        ("what it needs", room(desc, 1, None)),
        ("and bitmaps", room(desc, 1, Some(TransportCode { textures: true, ..NEEDED }))),
        ("and lobes", room(desc, 1, Some(TransportCode { lobes: true, ..NEEDED }))),
        ("and interpolated normals", room(desc, 1, Some(TransportCode { shading_normals: true, ..NEEDED }))),
        ("all code", room(desc, 1, Some(TransportCode::FULL))),
        ("what it needs, again", room(desc, 1, None)),
        ("what it needs, 16 lamps", room(desc, LAMPS, None)),
    ];
    let mut times = vec![[Vec::new(), Vec::new()]; ways.len()];
    for turn in 0..=turns {
        for ((_, session), times) in ways.iter().zip(&mut times) {
            let (first, first_rays) = trace(session, 1, largest);
            let (whole, rays) = trace(session, u32::MAX, largest);
            // The first turn warms up.
            if turn > 0 {
                times[0].push(1e9 * first / first_rays as f64);
                times[1].push(1e9 * (whole - first) / (rays - first_rays) as f64);
            }
        }
    }
    let base = times[0].clone();
    ways.iter()
        .zip(times)
        .map(|((name, _), times)| {
            let ratio = |k: usize| median(times[k].iter().zip(&base[k]).map(|(a, b)| a / b).collect());
            let ratios = [ratio(0), ratio(1)];
            Row { name, nanoseconds: times.map(median), ratios }
        })
        .collect()
}
