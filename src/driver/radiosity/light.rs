//! The light of a scene by its operator: on patches, on elements, in images and at probes.

use super::{BakeError, Clock, Light, Operator, Rooms};
use crate::driver::{Outcome, Settings, Watcher, direct_irradiance, drive, even, first_job};
use etendue_core::backend::{self, BackendError, GivenMap, Probe, Session};
use etendue_core::film::Film;
use etendue_core::math::PI;

/// Irradiance on patches \[W/m^2\] that no patch has sent: that of lights without size, and of the sky.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchLight {
    /// From lights without size.
    pub direct: Light,
    /// From the sky.
    pub sky: Light,
    /// From lights without size, on elements.
    pub elements: Light,
}

/// The light of the session's scene on the patches of an operator.
///
/// # Errors
/// As [`Session::direct_irradiance`].
pub fn patch_light(
    session: &dyn Session,
    operator: &Operator,
    seed: u64,
    watcher: &dyn Watcher,
) -> Result<PatchLight, BackendError> {
    let map = &operator.map;
    let n = map.patches.len();
    let mut sums = vec![[0.0_f64; 3]; n];
    let outcome = direct_irradiance(session, seed, map.elements.settings(), watcher)?;
    if outcome.cancelled {
        return Err(BackendError::Cancelled);
    }
    for (patch, (sum, seen)) in sums.iter_mut().zip(&operator.seen).enumerate() {
        let mut area = 0.0;
        for element in map.patches.members(patch) {
            let weight = map.elements.weight(*element as usize);
            let value = outcome.film.mean(*element as usize);
            area += weight;
            *sum = [0, 1, 2].map(|c| sum[c] + weight * value[c]);
        }
        // What is covered has no light, and no part in the mean.
        *sum = sum.map(|s| s / (area * f64::from(*seen)).max(f64::MIN_POSITIVE));
    }
    let environment = session.scene().environment;
    let sky = operator.escaped.iter().map(|e| environment.map(|l| e * PI * l)).collect();
    let narrow = |v: [f64; 3]| v.map(|x| x as f32);
    let elements = (0..map.elements.count()).map(|e| narrow(outcome.film.mean(e))).collect();
    Ok(PatchLight { direct: sums.into_iter().map(narrow).collect(), sky, elements })
}

/// Indirect irradiance on patches for their light: what patches send each other, emission of surfaces included.
///
/// # Errors
/// Of numbers that do not fit.
pub fn relight(
    session: &dyn Session,
    operator: &Operator,
    light: &PatchLight,
    rooms: &mut Rooms,
) -> Result<Light, BakeError> {
    let direct: Light =
        light.direct.iter().zip(&light.sky).map(|(d, s)| [0, 1, 2].map(|c| d[c] + s[c])).collect();
    let emission: Light = operator.map.patches.list().iter().map(|p| p.emission).collect();
    let mut indirect = vec![[0.0; 3]; direct.len()];
    operator.transport.relight(session, (&direct, &emission), &mut indirect, operator.passes, rooms)?;
    Ok(indirect)
}

/// A map to read or to gather from: all irradiance on elements but the direct light of lights without size.
///
/// # Errors
/// As [`Session::transfer`].
pub fn radiosity_map(
    session: &dyn Session,
    operator: &Operator,
    light: &PatchLight,
    indirect: &[[f32; 3]],
) -> Result<Light, BackendError> {
    let all: Light = indirect.iter().zip(&light.sky).map(|(i, s)| [0, 1, 2].map(|c| i[c] + s[c])).collect();
    Ok(session.transfer(&operator.map)?.apply(&all))
}

/// All light of an operator's scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Relit {
    /// What no patch has sent.
    pub light: PatchLight,
    /// Indirect irradiance on patches \[W/m^2\].
    pub indirect: Light,
    /// On elements: all but the direct light of lights without size.
    pub values: Light,
    /// Seconds by stage.
    pub stages: Vec<(&'static str, f64)>,
}

/// The light of the session's scene, all bounces, on its elements.
///
/// # Errors
/// [`BakeError`]; being stopped is one ([`BackendError::Cancelled`]).
pub fn relit(
    session: &dyn Session,
    operator: &Operator,
    seed: u64,
    watcher: &dyn Watcher,
) -> Result<Relit, BakeError> {
    let mut clock = Clock::new();
    let light = patch_light(session, operator, seed, watcher)?;
    clock.done("direct");
    let indirect = relight(session, operator, &light, &mut Rooms::default())?;
    clock.done("relight");
    let values = radiosity_map(session, operator, &light, &indirect)?;
    clock.done("transfer");
    Ok(Relit { light, indirect, values, stages: clock.stages })
}

/// An image from a map.
///
/// # Errors
/// As [`Session::map_image`]; being stopped is no error.
pub fn map_image(
    session: &dyn Session,
    settings: &Settings,
    map: &GivenMap<'_>,
    watcher: &dyn Watcher,
) -> Result<Outcome, BackendError> {
    let first = first_job(settings);
    let film = Film::new(backend::image_film_settings(session.scene(), &first)?);
    drive(film, first, settings.budget, watcher, &even, |job, control, film| {
        session.map_image(job, map, control, film)
    })
}

/// The irradiance at probes from a map.
///
/// # Errors
/// As [`Session::map_probes`]; being stopped is no error.
pub fn map_probes(
    session: &dyn Session,
    probes: &[Probe],
    settings: &Settings,
    map: &GivenMap<'_>,
    watcher: &dyn Watcher,
) -> Result<Outcome, BackendError> {
    let first = first_job(settings);
    let film = Film::new(backend::probe_film_settings(session.scene(), &first, probes.len()));
    drive(film, first, settings.budget, watcher, &even, |job, control, film| {
        session.map_probes(job, map, probes, control, film)
    })
}
