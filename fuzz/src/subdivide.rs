//! Target `subdivide`.

/// Checks one input.
pub fn subdivide(_bytes: &[u8]) {}
