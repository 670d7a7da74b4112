//! What must not change: scale, place, the split of a job, its repetition.

use crate::analytic::{self, Estimator, cases, compiled, render};
use crate::scenes::cases::{Case, Measure};
use crate::scenes::transformed;
use crate::suite::Level;
use crate::trios::Finding;
use etendue_core::backend::{Backend, BackendError, PathJob, Probe};
use etendue_core::film::Film;

/// Cases that are rendered at other scales and places: every kind of light and of shape among them.
const MOVED: [&str; 7] = [
    "integrating_sphere_eccentric",
    "concentric_spheres_near",
    "furnace_cube",
    "disk_light",
    "triangle_light",
    "sphere_light_3",
    "light_choice",
];

/// Scale, shift \[m\] after it, and relative error that the rounding of the moved coordinates may add.
const TRANSFORMS: [(f32, f32, f64); 3] = [
    (1e-3, 0.0, 2e-5),
    (1e3, 0.0, 2e-5),
    // At 10^5 m a coordinate is known to 4 mm, 4e-6 of the scene: a scene as large as that is what can be moved there.
    (1e3, 1e5, 2e-4),
];

fn moved(case: &Case, scale: f32, shift: f32, rounding: f64) -> Case {
    let shift = [shift, -shift, 0.5 * shift];
    let probe =
        |p: &Probe| Probe { position: [0, 1, 2].map(|k| p.position[k] * scale + shift[k]), normal: p.normal };
    let mut out = case.clone();
    out.scene = transformed(&case.scene, scale, shift);
    out.measure = match &case.measure {
        Measure::Probes(list) => Measure::Probes(list.iter().map(probe).collect()),
        Measure::ProbeMean(list) => Measure::ProbeMean(list.iter().map(probe).collect()),
        other => other.clone(),
    };
    out.rounding = out.rounding.max(rounding);
    // Three transforms of each case: half the precision of the case itself will do.
    out.samples = (out.samples / 4).max(32);
    out
}

/// All invariances.
///
/// # Errors
/// The backend's own.
pub fn check(backend: &dyn Backend, level: Level) -> Result<Vec<Finding>, BackendError> {
    let mut out = Vec::new();
    let all = cases();
    for case in all.iter().filter(|c| MOVED.contains(&c.name.as_str())) {
        for (scale, shift, rounding) in TRANSFORMS {
            let name = format!("invariance/{}/scale_{scale:e}_shift_{shift:e}", case.name);
            let found =
                analytic::check(backend, Estimator::Path, &moved(case, scale, shift, rounding), level)?;
            out.extend(found.into_iter().map(|(_, passed, detail)| (name.clone(), passed, detail)));
        }
    }
    for name in ["white_furnace", "concentric_spheres_near"] {
        if let Some(case) = all.iter().find(|c| c.name == name) {
            out.push(split(backend, case)?);
        }
    }
    out.push(no_edges(backend, &all[0])?);
    Ok(out)
}

/// Blocks 0..4 and 4..8, merged in either order, against 0..8, twice; bit for bit.
fn split(backend: &dyn Backend, case: &Case) -> Result<Finding, BackendError> {
    let scene = compiled(&case.scene)?;
    let probes = match &case.measure {
        Measure::Probes(p) | Measure::ProbeMean(p) => Some(p.as_slice()),
        _ => None,
    };
    let film = |blocks: std::ops::Range<u32>| -> Result<Film, BackendError> {
        render(
            backend,
            Estimator::Path,
            &scene,
            probes,
            &PathJob { seed: 11, block_length: 16, blocks, max_depth: case.max_depth },
        )
    };
    let (whole, again) = (film(0..8)?, film(0..8)?);
    let (first, second) = (film(0..4)?, film(4..8)?);
    let mut forward = first.clone();
    forward.merge(&second)?;
    let mut backward = second;
    backward.merge(&first)?;
    let lit = (0..whole.len()).any(|i| whole.mean(i)[0] > 0.0);
    let passed = whole == again && whole == forward && whole == backward && lit;
    let detail = format!(
        "repeated {}, forwards {}, backwards {}, not black {lit}",
        whole == again,
        whole == forward,
        whole == backward
    );
    Ok((format!("invariance/{}/blocks", case.name), passed, detail))
}

/// Without an edge nothing is seen.
fn no_edges(backend: &dyn Backend, case: &Case) -> Result<Finding, BackendError> {
    let scene = compiled(&case.scene)?;
    let Measure::Probes(probes) = &case.measure else {
        return Ok(("invariance/max_depth_0".into(), false, "the first case has no probes".into()));
    };
    let job = PathJob { seed: 1, block_length: 16, blocks: 0..2, max_depth: 0 };
    let film = render(backend, Estimator::Path, &scene, Some(probes), &job)?;
    let dark = (0..film.len()).all(|i| film.mean(i) == [0.0; 3]);
    Ok(("invariance/max_depth_0".into(), dark, format!("black: {dark}")))
}
