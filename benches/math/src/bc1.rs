//! Contenders for `bc1`.
