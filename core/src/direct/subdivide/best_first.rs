//! The part with the largest expected error first.

use super::criterion::{Criterion, Irradiance};
use super::shape::Frame;
use super::walk::{Cut, Job, Look, Part};
use super::{End, Limits, Piece, Summary, Workspace, whole};
use crate::math::{self, Vec3};

#[derive(Clone, Copy, Debug)]
enum State {
    /// Not looked into: its error is what the part above let expect.
    Unseen,
    /// To be cut so, when its turn comes.
    Cut(Cut),
    /// A piece.
    Done(End),
}

/// A slot of the buffer of [`refine`]; afterwards a piece.
#[derive(Clone, Copy, Debug)]
pub struct Node<S> {
    part: Part<S>,
    state: State,
    /// The larger comes first: error sqrt(area), whose square is its part in the squared error; negative when done.
    priority: f32,
    /// Of equal ones the earlier made comes first.
    order: u32,
}

impl<S: Irradiance> Default for Node<S> {
    fn default() -> Self {
        Self {
            part: super::root([S::DARK; 3]),
            state: State::Done(End::Degenerate),
            priority: DONE,
            order: 0,
        }
    }
}

impl<S: Copy> Node<S> {
    /// The piece in this slot.
    #[must_use]
    pub fn piece(&self) -> Piece<S> {
        let end = match self.state {
            State::Done(end) => end,
            State::Unseen | State::Cut(_) => End::Budget,
        };
        Piece::new(self.part, end)
    }

    fn before(&self, other: &Self) -> bool {
        self.priority > other.priority || (self.priority == other.priority && self.order < other.order)
    }
}

const DONE: f32 = -1.0;

/// error sqrt(fraction), which is finite or infinite, never NaN.
fn priority(error: f32, fraction: f32) -> f32 {
    error * math::sqrt_clamped(fraction)
}

/// Lets the root of the heap down to its place.
fn settle_root<S: Copy>(heap: &mut [Node<S>]) {
    let mut at = 0;
    loop {
        let (left, right) = (2 * at + 1, 2 * at + 2);
        let mut first = at;
        for child in [left, right] {
            if child < heap.len() && heap[child].before(&heap[first]) {
                first = child;
            }
        }
        if first == at {
            return;
        }
        heap.swap(at, first);
        at = first;
    }
}

/// Lets the last node of the heap up to its place.
fn lift_last<S: Copy>(heap: &mut [Node<S>]) {
    let mut at = heap.len().saturating_sub(1);
    while at > 0 {
        let parent = (at - 1) / 2;
        if !heap[at].before(&heap[parent]) {
            return;
        }
        heap.swap(at, parent);
        at = parent;
    }
}

/// Cuts a triangle into at most as many pieces as `buffer` has slots and `limits` allow: always the part next whose expected error has the largest
/// part in the squared error of the triangle. The first [`Summary::pieces`] slots hold the pieces, in an order that the job alone fixes.
///
/// A part is sampled only when its turn comes; until then the part above tells what to expect of it. What did not get its turn ends as
/// [`End::Budget`]. With an empty buffer there are no pieces. `irradiance` as for [`Workspace::subdivide`]; of `work` only the remembered samples are used.
pub fn refine<S: Irradiance, C: Criterion>(
    corners: [Vec3; 3],
    criterion: &C,
    limits: &Limits,
    work: &mut Workspace<S>,
    buffer: &mut [Node<S>],
    mut irradiance: impl FnMut([f32; 3]) -> S,
) -> Summary {
    let cache = &mut work.cache;
    cache.begin();
    let capacity = buffer.len().min(limits.budget.max(1) as usize);
    let buffer = &mut buffer[..capacity];
    let Some(first) = buffer.first_mut() else { return Summary::default() };
    let frame = Frame::new(corners);
    let part = whole(cache, &mut irradiance);
    *first = Node { part, state: State::Unseen, priority: f32::INFINITY, order: 0 };
    if frame.degenerate {
        first.state = State::Done(End::Degenerate);
        return Summary { pieces: 1, samples: cache.taken };
    }
    let job = Job::new(frame, criterion, limits);
    let (mut n, mut made) = (1, 1_u32);
    while n < capacity {
        let top = buffer[0];
        match top.state {
            State::Done(_) => break,
            State::Unseen => {
                let (state, priority) = match job.look(&top.part, cache, &mut irradiance) {
                    Look::Done(end) => (State::Done(end), DONE),
                    Look::Cut { error, cut } => (State::Cut(cut), priority(error, top.part.fraction)),
                };
                buffer[0] = Node { state, priority, ..top };
                settle_root(&mut buffer[..n]);
            }
            State::Cut(cut) => {
                let count = cut.split.count();
                if n - 1 + count > capacity {
                    break;
                }
                let parts = job.pieces(&top.part, cut, cache, &mut irradiance);
                for (i, part) in parts[..count].iter().enumerate() {
                    let priority = priority(part.rest, part.fraction);
                    let node = Node { part: *part, state: State::Unseen, priority, order: made };
                    made = made.wrapping_add(1);
                    if i == 0 {
                        buffer[0] = node;
                        settle_root(&mut buffer[..n]);
                    } else {
                        buffer[n] = node;
                        n += 1;
                        lift_last(&mut buffer[..n]);
                    }
                }
            }
        }
    }
    Summary { pieces: n as u32, samples: cache.taken }
}
