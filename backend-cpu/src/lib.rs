//! Etendue.
