//! Target `log_offset`.

/// Checks one input.
pub fn log_offset(_bytes: &[u8]) {}
