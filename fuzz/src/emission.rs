//! Target `emission`.

/// Checks one input.
pub fn emission(_bytes: &[u8]) {}
