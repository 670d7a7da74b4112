//! Contenders for `emission`.
