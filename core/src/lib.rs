//! The exact math of etendue: light transport as scalar functions over slices.
//!
//! `no_std` + `alloc` (the feature `std` only makes square roots cheaper), no unsafe code, no I/O, no threads. Backends schedule these functions or twin them on other
//! devices; the conformance suite holds the twins to the same answers. Kernels are f32 built from `+ - * / sqrt` and
//! the polynomials of [`math`], so that every IEEE machine gives the same bits.
//!
//! Data flows one way: [`scene::SceneDesc`] -> [`scene::compile`] -> [`scene::CompiledScene`] ->
//! [`backend::Backend::open`] -> [`backend::Session`] -> job -> [`film::Film`].
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;
#[cfg(any(test, feature = "std"))]
extern crate std;

pub mod backend;
pub mod bsdf;
pub mod codec;
pub mod direct;
pub mod film;
pub mod geometry;
pub mod illumination;
pub mod kernel;
pub mod light;
pub mod math;
pub mod medium;
pub mod radiosity;
pub mod sampling;
pub mod scene;
pub mod sensor;
pub mod tone;
pub mod transport;
