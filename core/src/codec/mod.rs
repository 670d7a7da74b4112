//! Codecs of the transport operator: what turns rows of numbers into few bytes and back.
//!
//! - [`log_offset`]: numbers in (0, 1] as 8-bit codes of their logarithm.
//! - [`bc1`], [`bc4`]: blocks of 4x4 texels of three channels or one in 8 bytes.

pub mod bc1;
pub mod bc4;
pub mod log_offset;
