//! What each target checks. Parsers: any bytes give a value or an error, never a panic or a hang.
//! Kernels: a tree agrees with the oracle, a distribution sums to one, a warp stays in its domain and inverts.
#![forbid(unsafe_code)]

mod bc1;
mod emission;
mod kernels;
mod linear_triangle;
mod log_offset;
mod operator_file;
mod parsers;
mod polynomial;
mod subdivide;

pub use bc1::bc1;
pub use emission::emission;
pub use kernels::{discrete, geometry, warps};
pub use linear_triangle::linear_triangle;
pub use log_offset::log_offset;
pub use operator_file::operator_file;
pub use parsers::{exr, mitsuba, mtl, obj, ply, points, scene};
pub use polynomial::polynomial;
pub use subdivide::subdivide;

/// A target: its name and what it does with one input.
pub type Target = (&'static str, fn(&[u8]));

/// All targets, by the name of their binary and of their folder in `seeds`.
pub const TARGETS: [Target; 17] = [
    ("scene", scene),
    ("mitsuba", mitsuba),
    ("obj", obj),
    ("mtl", mtl),
    ("ply", ply),
    ("exr", exr),
    ("points", points),
    ("operator_file", operator_file),
    ("discrete", discrete),
    ("geometry", geometry),
    ("warps", warps),
    ("linear_triangle", linear_triangle),
    ("emission", emission),
    ("subdivide", subdivide),
    ("log_offset", log_offset),
    ("bc1", bc1),
    ("polynomial", polynomial),
];
