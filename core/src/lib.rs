//! The exact math of etendue.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod geometry;
pub mod math;
pub mod sampling;
pub mod scene;
pub mod tone;
