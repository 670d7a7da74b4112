//! What the benches share: rivals behind one shape, inputs, and interleaved timing.
pub mod bc1;
pub mod draw;
pub mod emission;
pub mod figure;
pub mod first_shot;
pub mod linear_triangle;
pub mod log_offset;
pub mod operator;
pub mod polynomial;
pub mod subdivide;
pub mod timing;
