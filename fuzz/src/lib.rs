//! What each target checks. Parsers: any bytes give a value or an error, never a panic or a hang.
//! Kernels: a tree agrees with the oracle, a distribution sums to one, a warp stays in its domain and inverts.
#![forbid(unsafe_code)]

mod kernels;
mod parsers;

pub use kernels::{discrete, geometry, warps};
pub use parsers::{exr, mtl, obj, ply, points, scene};

/// A target: its name and what it does with one input.
pub type Target = (&'static str, fn(&[u8]));

/// All targets, by the name of their binary and of their folder in `seeds`.
pub const TARGETS: [Target; 9] = [
    ("scene", scene),
    ("obj", obj),
    ("mtl", mtl),
    ("ply", ply),
    ("exr", exr),
    ("points", points),
    ("discrete", discrete),
    ("geometry", geometry),
    ("warps", warps),
];
