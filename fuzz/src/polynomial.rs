//! Target `polynomial`.

/// Checks one input.
pub fn polynomial(_bytes: &[u8]) {}
