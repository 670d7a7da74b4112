//! Contenders for `subdivide`.
