//! Target `bc1`.

/// Checks one input.
pub fn bc1(_bytes: &[u8]) {}
