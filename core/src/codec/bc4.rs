//! Blocks of 4x4 one-channel texels in 8 bytes.
