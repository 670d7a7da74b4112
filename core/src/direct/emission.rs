//! Emission coefficients of (piece, light) pairs.
