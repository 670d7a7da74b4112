//! Photons that walk one by one.

use super::Shared;
use super::starts::first_landing;
use super::sums::Part;
use crate::simd::widest;
use etendue_core::transport::photon::{PhotonFlight, PhotonTracer, Replicate, WALK_GROUP, Way};
use std::ops::Range;

widest! {
    /// Photons of a range of a replicate; the rays that they took and the arrivals that count.
    pub(super) fn walk[W: Way, const L: bool, const T: bool, const S: bool](
        photons: (&PhotonTracer<'_, W, L, T, S>, &PhotonFlight<'_, W>),
        shared: &Shared<'_>,
        replicate: &Replicate,
        range: Range<u32>,
        sums: &mut Part,
    ) -> [u64; 2] {
        let (mut rays, mut hits) = (0, 0);
        let (tracer, flight) = photons;
        for index in range {
            let Some((mut photon, mut hit)) = first_landing(flight, shared, replicate, index, &mut rays) else { continue };
            let numbers = replicate.numbers.with_index(index);
            while let Some((surface, arrival)) = tracer.land(&photon, &hit) {
                if let Some(a) = arrival {
                    hits += 1;
                    shared.register(&hit, &a, sums);
                }
                let [u, v, lobe, survive] = numbers.group4(WALK_GROUP.wrapping_add(photon.hits));
                let chance = tracer.scatter(&mut photon, &surface, [u, v], lobe);
                if survive >= chance {
                    break;
                }
                photon.flux /= chance;
                match flight.fly(shared.tree, &mut photon, &replicate.random, &mut rays) {
                    Some(next) => hit = next,
                    None => break,
                }
            }
        }
        [rays, hits]
    }
}
