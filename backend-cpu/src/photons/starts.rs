//! Starts of photons: the density over lit surfaces, made in parallel, and a photon up to where it has landed.

use super::Shared;
use crate::tree::Tree;
use etendue_core::direct::subdivide::Workspace;
use etendue_core::geometry::{Hit, Intersector};
use etendue_core::scene::{CompiledScene, NO_INDEX};
use etendue_core::transport::first_shot::{
    FirstShot, FirstShotError, LitPiece, Start, StartPlan, Subdivision, Weights,
};
use etendue_core::transport::photon::{LightPlan, Photon, PhotonFlight, Replicate, START_GROUP, Way};
use etendue_core::transport::volume::LightMedia;
use rayon::prelude::*;

/// The density of starts on surfaces, and the shadow rays it took, on the threads of the pool that the caller is in. The same for any number of them.
///
/// # Errors
/// [`FirstShotError`].
pub fn first_shot(
    scene: &CompiledScene,
    (tree, media): (&Tree, &LightMedia),
    subdivision: &Subdivision,
    weights: Weights,
) -> Result<(FirstShot, u64), FirstShotError> {
    let plan = StartPlan::new(scene, media, *subdivision)?;
    let parts: Vec<(Vec<LitPiece>, u64)> = (0..plan.tasks())
        .into_par_iter()
        .map_init(Workspace::new, |workspace, task| plan.task(tree, task, workspace))
        .collect();
    let rays = parts.iter().map(|p| p.1).sum();
    let mut pieces = Vec::with_capacity(parts.iter().map(|p| p.0.len()).sum());
    for (mut part, _) in parts {
        pieces.append(&mut part);
    }
    Ok((FirstShot::new(&plan, pieces, weights)?, rays))
}

/// Where photons start.
#[derive(Clone, Copy)]
pub(super) enum Source<'a> {
    Lights { plan: &'a LightPlan, registers_direct: bool, survives_first: bool },
    Surfaces(&'a FirstShot),
}

/// Photon `index` of a replicate where it first meets a surface, and the rays that this took. `None` where it meets none.
#[inline(always)]
pub(super) fn first_landing<W: Way>(
    flight: &PhotonFlight<'_, W>,
    shared: &Shared<'_>,
    replicate: &Replicate,
    index: u32,
    rays: &mut u64,
) -> Option<(Photon<W>, Hit)> {
    let numbers = replicate.numbers.with_index(index);
    let u = numbers.group4(START_GROUP);
    let fly = |photon: Photon, light: u32, rays: &mut u64| {
        let mut photon = flight.begin(shared.tree, photon, (light, index), &replicate.random);
        let hit = flight.fly(shared.tree, &mut photon, &replicate.random, rays)?;
        Some((photon, hit))
    };
    match shared.source {
        Source::Lights { plan, registers_direct, survives_first } => {
            let pick = if plan.has_choice() { replicate.pick(index, &numbers) } else { 0 };
            let (photon, light) = plan.start(shared.scene, pick, u, registers_direct);
            fly(Photon { survives_first, ..photon }, light, rays)
        }
        Source::Surfaces(shot) => match shot.start(shared.scene, replicate.pick(index, &numbers), u)? {
            Start::Flies(photon, light) => {
                let (mut photon, hit) = fly(photon, light, rays)?;
                if photon.light != NO_INDEX {
                    shot.weigh(shared.scene, &mut photon, &hit);
                }
                Some((photon, hit))
            }
            Start::Lands { photon, hit, look } if W::VOLUME => {
                let photon = flight.land_straight(shared.tree, photon, &hit, (&look?, index), rays);
                (photon.flux != etendue_core::math::Vec3::ZERO).then_some((photon, hit))
            }
            Start::Lands { mut photon, hit, look } => {
                if let Some(look) = look {
                    *rays += 1;
                    photon.flux *= look.factor(shared.tree.occluded(&look.ray));
                }
                (photon.flux != etendue_core::math::Vec3::ZERO).then_some((photon.along(W::default()), hit))
            }
        },
    }
}
