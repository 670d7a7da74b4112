//! Adaptive subdivision of a lit triangle.
