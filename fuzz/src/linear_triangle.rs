//! Target `linear_triangle`.

/// Checks one input.
pub fn linear_triangle(_bytes: &[u8]) {}
