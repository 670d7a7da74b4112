//! Samples that neighbours share.

use super::bary::Bary;
use super::criterion::Irradiance;

/// Slots of the cache: 2^8.
const BITS: u32 = 8;
const SLOTS: usize = 1 << BITS;

#[derive(Clone, Copy)]
struct Slot<S> {
    /// Which triangle the sample is of; 0 for none.
    epoch: u32,
    point: Bary,
    value: S,
}

/// Remembers samples by their exact place. A place has one slot, and the last sample there stays: corners and midpoints of neighbours are
/// asked for soon after each other, so that nearly all are found. Whether one is found changes the count of samples, never a piece.
#[derive(Clone)]
pub(super) struct Cache<S> {
    slots: [Slot<S>; SLOTS],
    epoch: u32,
    /// Samples taken since the triangle began.
    pub(super) taken: u32,
}

impl<S: Irradiance> Cache<S> {
    pub(super) fn new() -> Self {
        let empty = Slot { epoch: 0, point: Bary::CORNERS[0], value: S::DARK };
        Self { slots: [empty; SLOTS], epoch: 0, taken: 0 }
    }

    /// Forgets everything.
    pub(super) fn begin(&mut self) {
        self.taken = 0;
        self.epoch = self.epoch.wrapping_add(1);
        if self.epoch == 0 {
            // After 2^32 triangles the oldest marks would look new.
            *self = Self::new();
            self.epoch = 1;
        }
    }

    /// The sample at a point, bounded; taken by `irradiance` if it is not remembered.
    #[inline]
    pub(super) fn sample(&mut self, point: Bary, irradiance: &mut impl FnMut([f32; 3]) -> S) -> S {
        let [_, b1, b2] = point.steps();
        // Multiplicative hashing of both coordinates; the high bits are the good ones.
        let hash = b1.wrapping_mul(0x9E37_79B1).wrapping_add(b2.wrapping_mul(0x85EB_CA77));
        let hash = (hash ^ hash >> 15).wrapping_mul(0x2C1B_3C6D) >> (32 - BITS);
        let slot = &mut self.slots[hash as usize];
        if slot.epoch != self.epoch || slot.point != point {
            self.taken = self.taken.saturating_add(1);
            *slot = Slot { epoch: self.epoch, point, value: irradiance(point.to_f32()).bounded() };
        }
        slot.value
    }
}
