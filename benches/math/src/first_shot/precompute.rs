//! What it costs to know where light arrives: the density of starts against plain direct light at the corners.

use cpu_time::ProcessTime;
use etendue::core::backend::Session;
use etendue::core::direct::irradiance::from_light;
use etendue::core::geometry::{Intersector, hit_point_with};
use etendue::core::math::Vec3;
use etendue::core::scene::CompiledScene;
use etendue::core::transport::first_shot::{Subdivision, Weights};
use etendue::cpu::{CpuBackend, CpuSession};
use std::collections::HashSet;
use std::sync::Arc;

/// Direct light at corners: seconds of the pass over all corners of all triangles, and how many of them are at different places or face differently.
fn corners(session: &CpuSession) -> (f64, u64) {
    let (scene, tree) = (session.scene(), session.tree());
    let start = ProcessTime::now();
    let (mut rays, mut sum) = (0, 0.0);
    for (t, surface) in scene.surfaces.iter().enumerate().take(scene.triangles.len()) {
        let v = scene.primitives().vertices(t as u32).expect("a triangle");
        for b in [[0.99 + 0.01 / 3.0, 0.01 / 3.0], [0.01 / 3.0, 0.99 + 0.01 / 3.0], [0.01 / 3.0; 2]] {
            let point = hit_point_with(v, b[0], b[1], surface.sliver);
            for light in &scene.lights {
                let Some((e, ray)) = from_light(light, &point, Vec3::from_array(surface.normal)) else {
                    continue;
                };
                rays += 1;
                if !tree.occluded(&ray) {
                    sum += e.x;
                }
            }
        }
    }
    std::hint::black_box(sum);
    (start.elapsed().as_secs_f64(), rays)
}

/// One row of the table.
pub struct Row {
    /// Its name.
    pub name: &'static str,
    /// CPU seconds, the median of the turns.
    pub seconds: f64,
    /// Over the pass over corners, within each turn; the median.
    pub ratio: f64,
    /// Shadow rays.
    pub rays: u64,
    /// (Piece, light) pairs.
    pub pairs: usize,
    /// What they take.
    pub megabytes: f64,
    /// Share of the flux that survives its first hit, by the pairs.
    pub survival: f64,
}

fn median(mut v: Vec<f64>) -> f64 {
    v.sort_by(f64::total_cmp);
    v[v.len() / 2]
}

/// Corners of different position and normal.
pub fn unique_corners(scene: &CompiledScene) -> usize {
    let mut set = HashSet::new();
    for (t, corners) in scene.triangles.iter().enumerate() {
        for c in corners {
            set.insert((
                scene.positions[*c as usize].map(f32::to_bits),
                scene.surfaces[t].normal.map(f32::to_bits),
            ));
        }
    }
    set.len()
}

/// All contenders in turns.
pub fn table(scene: &Arc<CompiledScene>, turns: usize) -> Vec<Row> {
    let open =
        || CpuBackend::new(Some(1)).expect("a backend").open_session(scene.clone()).expect("a session");
    let session = open();
    let ways = [
        ("corners", None),
        ("none", Some(Subdivision::None)),
        ("published", Some(Subdivision::published())),
        ("robust, exact", Some(Subdivision::robust(Weights::EXACT))),
        ("robust, density", Some(Subdivision::robust(Weights::Density))),
    ];
    let mut times = vec![Vec::new(); ways.len()];
    let mut rows: Vec<Row> = Vec::new();
    for turn in 0..turns {
        for (k, (name, way)) in ways.iter().enumerate() {
            let mut row =
                Row { name, seconds: 0.0, ratio: 0.0, rays: 0, pairs: 0, megabytes: 0.0, survival: 0.0 };
            let seconds = match way {
                None => {
                    let (seconds, rays) = corners(&session);
                    row.rays = rays;
                    seconds
                }
                Some(subdivision) => {
                    let start = ProcessTime::now();
                    let (shot, rays) =
                        session.make_first_shot(subdivision, Weights::EXACT).expect("a density");
                    let seconds = start.elapsed().as_secs_f64();
                    row.rays = rays;
                    (row.pairs, row.megabytes, row.survival) =
                        (shot.pairs(), shot.bytes() as f64 * 1e-6, shot.survival());
                    seconds
                }
            };
            times[k].push(seconds);
            if turn == 0 {
                rows.push(row);
            }
        }
    }
    for (row, t) in rows.iter_mut().zip(&times) {
        row.seconds = median(t.clone());
        row.ratio = median(t.iter().zip(&times[0]).map(|(a, b)| a / b).collect());
    }
    rows
}
