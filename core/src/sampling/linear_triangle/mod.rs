//! Points of linear density over a triangle.
mod robust;

/// Sample.
pub fn sample(weights: [f32; 3], u: [f32; 2]) -> [f32; 3] { robust::sample(weights, u) }
/// Distance.
pub fn apex_distance(weights: [f32; 3], u: f32) -> (usize, [f32; 2]) {
    let r = robust::rotated(weights);
    (if r.first { 0 } else if r.second { 1 } else { 2 }, robust::distance(r.w, robust::unit(u)))
}
