//! Trees over a scene's primitives. obvhs builds them; three ways of walking are kept and measured against each other
//! (`cargo bench -p etendue-cpu --bench rays`): obvhs's own binary and eight-wide walks, and [`WalkTree`], which walks
//! obvhs's binary tree with core's conservative node test and therefore loses no ray at edges and vertices.
//!
//! All leaves are tested by core's triangle test, so what differs between trees is only which leaves are reached.

mod obvhs_walk;
mod packed;
mod walk;
mod wide;

pub use obvhs_walk::{Bvh2Tree, CwbvhTree};
pub use walk::WalkTree;
pub use wide::{Isa, WideTree, layout};

/// The tree that sessions use.
pub type Tree = WideTree;
