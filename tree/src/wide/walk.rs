//! The walk: nearest child first for the closest hit, in the order of the slots for any hit.

use super::fit::Fit;
use super::floats::{Eight, Floats};
use super::lanes::{BlockHits, BoxTest, Lanes};
use super::layout::{Block, KIND_SHIFT, LANES, LEAF, Node, PLACE, SHAPE, WIDTH};
use core::mem::MaybeUninit;
use etendue_core::geometry::{Hit, PreparedRay, RoundShape, intersect_shape};

/// Entries of the stack. A tree of depth d needs at most 7 (d - 1) + 8; [`super::build`] sees to it that this is enough.
pub(super) const STACK: usize = 320;
/// Largest depth of nodes that the stack holds.
pub(super) const MAX_DEPTH: usize = (STACK - WIDTH) / (WIDTH - 1);

/// What a walk reads.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub(super) nodes: &'a [Node],
    pub(super) blocks: &'a [Block],
    pub(super) shapes: &'a [RoundShape],
    /// Number of the first round shape in the scene.
    pub(super) first_shape: u32,
    /// Child word of the root.
    pub(super) root: u32,
    /// Which rays may be walked with fused box tests.
    pub(super) fit: Fit,
}

/// Distance and child word in one number: the distance is not negative, so that integers order entries by it.
#[inline(always)]
pub(super) fn entry(distance: f32, child: u32) -> u64 {
    u64::from(distance.to_bits()) << 32 | u64::from(child)
}

#[inline(always)]
fn sort2(a: u64, b: u64) -> (u64, u64) {
    (a.min(b), a.max(b))
}

/// Room for a stack of fixed size that is not cleared for every ray. Aligned, so that the compiler aligns what it keeps beside it.
#[repr(align(64))]
pub(super) struct Room<T>([MaybeUninit<T>; STACK]);

impl<T: Copy> Room<T> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self([const { MaybeUninit::uninit() }; STACK])
    }
}

/// A stack; what does not fit is dropped, which the build rules out.
pub(super) struct Stack<'a, T> {
    /// The first `len` are written.
    entries: &'a mut [MaybeUninit<T>; STACK],
    len: usize,
}

impl<'a, T: Copy> Stack<'a, T> {
    #[inline(always)]
    pub(super) fn new(room: &'a mut Room<T>) -> Self {
        Self { entries: &mut room.0, len: 0 }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, e: T) {
        debug_assert!(self.len < STACK, "the build checks the depth");
        if let Some(slot) = self.entries.get_mut(self.len) {
            slot.write(e);
            self.len += 1;
        }
    }

    /// Pushes the first `count` of what `write` puts at the front of the free space.
    #[inline(always)]
    fn push_all(&mut self, count: usize, write: impl FnOnce(&mut [MaybeUninit<T>; WIDTH])) {
        debug_assert!(self.len + WIDTH <= STACK, "the build checks the depth");
        if let Some(free) = self.entries.get_mut(self.len..).and_then(|free| free.first_chunk_mut()) {
            write(free);
            self.len += count;
        }
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<T> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: `len` counts writes, and it was above this place.
        #[expect(unsafe_code, reason = "clearing the stack for every ray costs a tenth of its time")]
        self.entries.get(self.len).map(|e| unsafe { e.assume_init() })
    }
}

/// The child words and entries of the set bits, nearest returned, the others pushed so that the nearest is on top.
#[inline(always)]
fn descend(node: &Node, Eight(entries): &Eight, mut mask: u32, stack: &mut Stack<'_, u64>) -> u32 {
    if mask & (mask - 1) == 0 {
        // Its entry is not waited for.
        return node.child[mask.trailing_zeros() as usize & (WIDTH - 1)];
    }
    let mut next = || {
        let slot = mask.trailing_zeros() as usize & (WIDTH - 1);
        mask &= mask.wrapping_sub(1);
        (entry(entries[slot], node.child[slot]), mask)
    };
    let (a, _) = next();
    let (b, rest) = next();
    let (a, b) = sort2(a, b);
    if rest == 0 {
        stack.push(b);
        return a as u32;
    }
    let (c, rest) = next();
    if rest == 0 {
        let (b, c) = sort2(b, c);
        let (a, b) = sort2(a, b);
        stack.push(c);
        stack.push(b);
        return a as u32;
    }
    let (d, rest) = next();
    let (c, d) = sort2(c, d);
    let (a, c) = sort2(a, c);
    let (b, d) = sort2(b, d);
    let (b, c) = sort2(b, c);
    if rest == 0 {
        stack.push(d);
        stack.push(c);
        stack.push(b);
        return a as u32;
    }
    // More than four: each is inserted into the sorted list.
    let mut sorted = [a, b, c, d, 0, 0, 0, 0];
    let mut count = 4;
    loop {
        let (e, rest) = next();
        let mut at = count & (WIDTH - 1);
        while at > 0 && sorted[at - 1] > e {
            sorted[at] = sorted[at - 1];
            at -= 1;
        }
        sorted[at] = e;
        count += 1;
        if rest == 0 {
            break;
        }
    }
    for e in sorted[1..count.min(WIDTH)].iter().rev() {
        stack.push(*e);
    }
    sorted[0] as u32
}

/// First block and number of blocks of a leaf word.
#[inline(always)]
pub(super) fn blocks_of(word: u32) -> (usize, usize) {
    ((word & PLACE) as usize, (word >> KIND_SHIFT & 7) as usize + 1)
}

#[inline(always)]
fn is_shape(word: u32) -> bool {
    word >> KIND_SHIFT & 7 == SHAPE
}

/// The hit with the smallest t, then the lowest number.
#[inline(always)]
pub(super) fn closest<F: Floats, B: BoxTest<F>>(
    view: View<'_>,
    prepared: &PreparedRay,
    t_max: f32,
) -> Option<Hit> {
    let lanes = Lanes::<F, B>::new(prepared);
    let mut best: Option<Hit> = None;
    let mut t_max = t_max;
    if t_max.is_nan() || t_max < 0.0 {
        return None;
    }
    let mut room = Room::new();
    let mut stack = Stack::new(&mut room);
    let mut entries = Eight::default();
    let mut hits = BlockHits::default();
    let mut word = view.root;
    loop {
        if word & LEAF == 0 {
            if let Some(node) = view.nodes.get(word as usize) {
                let (enter, mask) = lanes.node(node, t_max);
                if mask != 0 {
                    enter.store(&mut entries);
                    word = descend(node, &entries, mask, &mut stack);
                    continue;
                }
            }
        } else if is_shape(word) {
            if let Some(hit) = shape_hit(view, word, prepared, t_max)
                && best.is_none_or(|b| hit.before(&b))
            {
                best = Some(hit);
                t_max = hit.t;
            }
        } else {
            let (first, count) = blocks_of(word);
            for block in view.blocks.get(first..first + count).unwrap_or(&[]) {
                let mut mask = lanes.block(block, t_max, &mut hits);
                while mask != 0 {
                    let lane = mask.trailing_zeros() as usize & (LANES - 1);
                    mask &= mask - 1;
                    let hit = Hit {
                        t: hits.t.0[lane],
                        primitive: block.id[lane],
                        b1: hits.b1.0[lane],
                        b2: hits.b2.0[lane],
                    };
                    if best.is_none_or(|b| hit.before(&b)) {
                        best = Some(hit);
                        t_max = hit.t;
                    }
                }
            }
        }
        loop {
            let Some(e) = stack.pop() else { return best };
            // Never skipped when equal: the lower number may lie there.
            if (e >> 32) as u32 <= (t_max * B::SLACK).to_bits() {
                word = e as u32;
                break;
            }
        }
    }
}

/// Whether anything is hit.
#[inline(always)]
pub(super) fn any<F: Floats, B: BoxTest<F>>(view: View<'_>, prepared: &PreparedRay, t_max: f32) -> bool {
    let lanes = Lanes::<F, B>::new(prepared);
    if t_max.is_nan() || t_max < 0.0 {
        return false;
    }
    let mut room = Room::<u32>::new();
    let mut stack = Stack::new(&mut room);
    let mut hits = BlockHits::default();
    let mut word = view.root;
    loop {
        if word & LEAF == 0 {
            if let Some(node) = view.nodes.get(word as usize) {
                let (_, mut mask) = lanes.node(node, t_max);
                if mask != 0 {
                    // The lowest slot at once, the others wait; leaves have the lowest slots.
                    let first = mask.trailing_zeros() as usize & (WIDTH - 1);
                    mask &= mask - 1;
                    // Without a loop: how often it would run is as good as random.
                    stack.push_all(mask.count_ones() as usize, |free| F::gather(&node.child, mask, free));
                    word = node.child[first];
                    continue;
                }
            }
        } else if is_shape(word) {
            if shape_hit(view, word, prepared, t_max).is_some() {
                return true;
            }
        } else {
            let (first, count) = blocks_of(word);
            for block in view.blocks.get(first..first + count).unwrap_or(&[]) {
                if lanes.block(block, t_max, &mut hits) != 0 {
                    return true;
                }
            }
        }
        match stack.pop() {
            Some(next) => word = next,
            None => return false,
        }
    }
}

#[inline(never)]
pub(super) fn shape_hit(view: View<'_>, word: u32, ray: &PreparedRay, t_max: f32) -> Option<Hit> {
    let place = word & PLACE;
    let t = intersect_shape(ray, view.shapes.get(place as usize)?, t_max)?;
    Some(Hit { t, primitive: view.first_shape + place, b1: 0.0, b2: 0.0 })
}
