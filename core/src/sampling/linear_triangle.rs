//! Points of linear density over a triangle.
