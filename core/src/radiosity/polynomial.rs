//! Sums of powers of a transport operator.
