//! Blocks of 4x4 RGB texels in 8 bytes.
