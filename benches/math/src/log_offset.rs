//! Contenders for `log_offset`.
