//! A camera for a file that has none.

use etendue_core::scene::{CameraDesc, MeshDesc};

/// Field of view of a framed camera, both ways \[degrees\].
const FOV_DEG: f32 = 40.0;
/// The tangent of half of that.
const TAN_HALF_FOV: f64 = 0.363_970_234_266_202_4;

/// Looks along -z at the centre of the bounding box, from so far in front of its nearest face that the face
/// fills 1/1.05 of the picture in the wider direction; up is +y.
pub(crate) fn frame(mesh: &MeshDesc) -> CameraDesc {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for p in mesh.triangles.iter().flatten().filter_map(|&i| mesh.positions.get(i as usize)) {
        for k in 0..3 {
            low[k] = low[k].min(f64::from(p[k]));
            high[k] = high[k].max(f64::from(p[k]));
        }
    }
    if low[0] > high[0] {
        (low, high) = ([-0.5; 3], [0.5; 3]);
    }
    let center = [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]));
    let half = [0, 1, 2].map(|k| 0.5 * (high[k] - low[k]));
    let mut distance = 1.05 * half[0].max(half[1]) / TAN_HALF_FOV;
    if distance == 0.0 {
        distance = 1.0;
    }
    let largest = center.iter().fold(distance + half[2], |m, c| m.max(c.abs()));
    // Where f32 has few digits left between camera and centre, stand back until it has some.
    let away = (half[2] + distance).max(largest * 1e-5);
    let position = [center[0], center[1], center[2] + away].map(|x| x as f32);
    CameraDesc {
        position,
        look_at: center.map(|x| x as f32),
        up: [0.0, 1.0, 0.0],
        fov_x_deg: FOV_DEG,
        resolution: [256, 256],
        lens_radius: 0.0,
        focus_distance: 0.0,
        medium: String::new(),
    }
}
