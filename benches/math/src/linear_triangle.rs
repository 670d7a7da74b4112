//! Contenders for `linear_triangle`.
