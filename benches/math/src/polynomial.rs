//! Contenders for `polynomial`.
