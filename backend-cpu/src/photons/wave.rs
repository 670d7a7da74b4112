//! Photons of a replicate that walk together, put in order before each scattering.
//!
//! In order along a Hilbert curve photon r of n takes the point (r / n, u_r) with u_r the r-th point of a fresh scrambled Sobol' set: neighbours in space take
//! directions that complement each other, at every bounce (array-RQMC). Roulette is systematic in the same order: the chances are added up, and a
//! photon survives where the sum passes a whole number. Chances are 32-bit integers, so that sums of parts of the order are exact.

use super::starts::first_landing;
use super::sums::Part;
use super::{Meter, Shared, TASK};
use crate::simd::widest;
use etendue_core::geometry::{HilbertGrid, Hit};
use etendue_core::sampling::numbers::Numbers;
use etendue_core::transport::photon::{
    Photon, PhotonFlight, PhotonTracer, Replicate, WALK_GROUP, WAVE, Way, chance_count, survivor_factor,
};
use rayon::prelude::*;
use rdst::RadixSort;
use std::ops::Range;

/// A photon that has landed.
type Landed<W> = (Photon<W>, Hit);
/// A photon that would leave, with its chance to in units of 2^-32.
type Leaving<W> = (Photon<W>, u32);

/// A part of the order, the first of rank `rank`.
#[derive(Clone, Copy)]
struct Ordered<'a, W> {
    landed: &'a [Landed<W>],
    order: &'a [u64],
    rank: usize,
}

/// Photons that are fetched together.
const FETCH: usize = 32;

widest! {
    /// The first landings of a range of photons, in order; and the rays that they took.
    fn start[W: Way](
        flight: &PhotonFlight<'_, W>,
        shared: &Shared<'_>,
        replicate: &Replicate,
        photons: Range<u32>,
    ) -> (Vec<Landed<W>>, u64) {
        let (mut landed, mut rays) = (Vec::with_capacity(photons.len()), 0);
        for index in photons {
            landed.extend(first_landing(flight, shared, replicate, index, &mut rays));
        }
        (landed, rays)
    }
}

widest! {
    /// Registers and scatters photons.
    fn scatter[W: Way, const L: bool, const T: bool, const S: bool](
        tracer: &PhotonTracer<'_, W, L, T, S>,
        shared: &Shared<'_>,
        part: Ordered<'_, W>,
        numbers: &Numbers,
        group: u32,
        sums: &mut Part,
    ) -> (Vec<Leaving<W>>, u64) {
        let Ordered { landed, order, rank } = part;
        let (mut leaving, mut hits) = (Vec::with_capacity(order.len()), 0);
        let mut near: Vec<Landed<W>> = Vec::with_capacity(FETCH);
        for (i, _) in order.iter().enumerate() {
            if i % FETCH == 0 {
                // They lie anywhere in memory: fetched in a row, they come while others are still on their way.
                near.clear();
                near.extend(order[i..].iter().take(FETCH).map(|key| landed[*key as u32 as usize]));
            }
            let (mut photon, hit) = near[i % FETCH];
            let Some((surface, arrival)) = tracer.land(&photon, &hit) else { continue };
            if let Some(a) = arrival {
                hits += 1;
                shared.register(&hit, &a, sums);
            }
            let [u, v, lobe, _] = numbers.with_index((rank + i) as u32).group4(group);
            let chance = chance_count(tracer.scatter(&mut photon, &surface, [u, v], lobe));
            if chance > 0 {
                leaving.push((photon, chance));
            }
        }
        (leaving, hits)
    }
}

widest! {
    /// The survivors of photons before which the chances add up to `before`, where they land; and the rays that they took.
    fn fly[W: Way](
        flight: &PhotonFlight<'_, W>,
        shared: &Shared<'_>,
        random: &Numbers,
        leaving: &[Leaving<W>],
        before: u64,
    ) -> (Vec<Landed<W>>, u64) {
        let (mut landed, mut rays, mut sum) = (Vec::with_capacity(leaving.len()), 0, before);
        for (photon, chance) in leaving {
            let next = sum + u64::from(*chance);
            let survives = next >> 32 != sum >> 32;
            sum = next;
            if !survives {
                continue;
            }
            let mut photon = *photon;
            photon.flux *= survivor_factor(*chance);
            let hit = flight.fly(shared.tree, &mut photon, random, &mut rays);
            landed.extend(hit.map(|hit| (photon, hit)));
        }
        (landed, rays)
    }
}

/// Photons in order along the curve: their numbers in the low words.
fn order<W: Way>(grid: &HilbertGrid, landed: &[Landed<W>]) -> Vec<u64> {
    let mut keys: Vec<u64> = landed
        .par_iter()
        .enumerate()
        .map(|(i, (photon, hit))| {
            let p = photon.ray.origin + photon.ray.direction * hit.t;
            u64::from(grid.index(p)) << 32 | i as u64
        })
        .collect();
    keys.radix_sort_unstable();
    keys
}

/// Walks all photons of a replicate, some waves of them; only a part where the meter says stop.
pub(super) fn walk<W: Way, const L: bool, const T: bool, const S: bool>(
    tracers: (&PhotonTracer<'_, W, L, T, S>, &PhotonFlight<'_, W>),
    shared: &Shared<'_>,
    replicate: &Replicate,
    meter: &Meter<'_>,
) {
    let photons = shared.job.photons;
    for first in (0..photons).step_by(WAVE as usize) {
        walk_wave(tracers, shared, replicate, first..photons.min(first.saturating_add(WAVE)), meter);
    }
}

fn walk_wave<W: Way, const L: bool, const T: bool, const S: bool>(
    (tracer, flight): (&PhotonTracer<'_, W, L, T, S>, &PhotonFlight<'_, W>),
    shared: &Shared<'_>,
    replicate: &Replicate,
    photons: Range<u32>,
    meter: &Meter<'_>,
) {
    let grid = HilbertGrid::new(&shared.scene.bounds);
    let tasks: Vec<Range<u32>> =
        photons.clone().step_by(TASK as usize).map(|t| t..photons.end.min(t + TASK)).collect();
    let parts: Vec<_> = tasks
        .into_par_iter()
        .map(|range| {
            if meter.stopped() {
                return Vec::new();
            }
            let (landed, rays) = start(flight, shared, replicate, range);
            meter.count(rays, 0, 0);
            landed
        })
        .collect();
    let mut landed: Vec<Landed<W>> = parts.concat();
    let mut alive = photons.len();
    for bounce in 0.. {
        // Whoever is gone counts as done.
        meter.count(0, 0, (alive - landed.len()) as u64);
        alive = landed.len();
        if landed.is_empty() || meter.stopped() {
            return;
        }
        let keys = order(&grid, &landed);
        let group = WALK_GROUP.wrapping_add(bounce);
        let parts: Vec<Vec<Leaving<W>>> = keys
            .par_chunks(TASK as usize)
            .enumerate()
            .map(|(chunk, keys)| {
                let part = Ordered {
                    landed: &landed,
                    order: keys,
                    rank: photons.start as usize + chunk * TASK as usize,
                };
                let (leaving, hits) =
                    scatter(tracer, shared, part, &replicate.numbers, group, &mut shared.sums.mine());
                meter.count(0, hits, 0);
                leaving
            })
            .collect();
        let mut sum = u64::from(replicate.roulette_offset(photons.start, bounce));
        let parts: Vec<(Vec<Leaving<W>>, u64)> = parts
            .into_iter()
            .map(|part| {
                let before = sum;
                sum += part.iter().map(|p| u64::from(p.1)).sum::<u64>();
                (part, before)
            })
            .collect();
        let parts: Vec<Vec<Landed<W>>> = parts
            .into_par_iter()
            .map(|(leaving, before)| {
                if meter.stopped() {
                    return Vec::new();
                }
                let (landed, rays) = fly(flight, shared, &replicate.random, &leaving, before);
                meter.count(rays, 0, 0);
                landed
            })
            .collect();
        landed = parts.concat();
    }
}
