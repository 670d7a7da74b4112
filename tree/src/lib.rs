//! Trees over a scene's primitives. obvhs builds them; sessions walk [`WideTree`], eight boxes at a time.
//!
//! Kept beside it and measured against it (`cargo bench --bench rays`): [`WalkTree`], obvhs's binary tree walked with core's
//! conservative node test, the scalar reference; and obvhs's own binary and eight-wide walks, which lose about one ray in a
//! million at edges and vertices.
//!
//! All leaves are tested by core's triangle test, so what differs between trees is only which leaves are reached.

mod obvhs_walk;
mod packed;
mod walk;
mod wide;

pub use obvhs_walk::{Bvh2Tree, CwbvhTree};
pub use packed::Effort;
pub use walk::WalkTree;
pub use wide::{Isa, Parts, RefitError, WideTree, layout};

/// The tree that sessions use.
pub type Tree = WideTree;
