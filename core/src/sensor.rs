//! The camera: from a pixel to a ray.
//!
//! The image plane lies one unit along the axis; right = forward x up, rows run downwards, the pixel filter is a box.
//! What a pixel measures is the mean radiance \[W m^-2 sr^-1\] over its box and over the lens.

use crate::geometry::Ray;
use crate::math::{self, PI, Vec3};
use crate::sampling::warp;
use crate::scene::{CameraDesc, SceneError};
use alloc::string::ToString;
use bytemuck::{Pod, Zeroable};

/// Largest width or height of an image in pixels.
pub const MAX_RESOLUTION: u32 = 32768;

/// A pinhole or thin-lens camera, ready to make rays.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Camera {
    /// Centre of the lens \[m\].
    pub position: [f32; 3],
    /// Radius of the lens \[m\]; 0 is a pinhole.
    pub lens_radius: f32,
    /// Unit vector along the axis.
    pub forward: [f32; 3],
    /// Distance along the axis that is in focus \[m\].
    pub focus_distance: f32,
    /// Unit vector to the right of the image times half the width of the image plane.
    pub right: [f32; 3],
    /// Width in pixels.
    pub width: u32,
    /// Unit vector to the top of the image times half the height of the image plane.
    pub up: [f32; 3],
    /// Height in pixels.
    pub height: u32,
}

impl Camera {
    /// Checks a description and derives the frame.
    ///
    /// # Errors
    /// Names the field: something not finite, a view of no direction, an `up` along it, a field of view outside
    /// (0, 180) degrees, a resolution of 0 or above [`MAX_RESOLUTION`].
    pub fn try_new(desc: &CameraDesc) -> Result<Self, SceneError> {
        let check = |field: &'static str, values: &[f32]| {
            if values.iter().all(|v| v.is_finite()) {
                Ok(())
            } else {
                Err(SceneError::NotFinite { place: "camera".to_string(), field })
            }
        };
        let range = |field: &'static str, value: f32, expected: &'static str| SceneError::OutOfRange {
            place: "camera".to_string(),
            field,
            value,
            expected,
        };
        check("position", &desc.position)?;
        check("look_at", &desc.look_at)?;
        check("up", &desc.up)?;
        check("fov", &[desc.fov_x_deg])?;
        check("lens_radius", &[desc.lens_radius])?;
        let axis = Vec3::from_array(desc.look_at) - Vec3::from_array(desc.position);
        let forward = math::normalize_or(axis, Vec3::ZERO);
        if forward == Vec3::ZERO {
            return Err(range("look_at", 0.0, "a point away from `position`"));
        }
        let right = math::normalize_or(
            forward.cross(math::normalize_or(Vec3::from_array(desc.up), Vec3::ZERO)),
            Vec3::ZERO,
        );
        if right == Vec3::ZERO {
            return Err(range("up", 0.0, "a direction that is not along the view"));
        }
        if desc.fov_x_deg <= 0.0 || desc.fov_x_deg >= 180.0 {
            return Err(range("fov_x_deg", desc.fov_x_deg, "an angle in (0, 180) degrees"));
        }
        if desc.lens_radius < 0.0 {
            return Err(range("lens_radius", desc.lens_radius, "a number not below 0"));
        }
        if desc.lens_radius > 0.0 {
            check("focus_distance", &[desc.focus_distance])?;
            if desc.focus_distance <= 0.0 {
                return Err(range("focus_distance", desc.focus_distance, "a number above 0"));
            }
        }
        let [width, height] = desc.resolution;
        for side in desc.resolution {
            if side == 0 || side > MAX_RESOLUTION {
                return Err(range("resolution", side as f32, "1 to 32768 pixels a side"));
            }
        }
        let (sin, cos) = math::sin_cos(desc.fov_x_deg * (PI / 360.0));
        let half_width = sin / cos;
        let half_height = half_width * (height as f32 / width as f32);
        let up = right.cross(forward);
        Ok(Self {
            position: desc.position,
            lens_radius: desc.lens_radius,
            forward: forward.to_array(),
            focus_distance: desc.focus_distance,
            right: (right * half_width).to_array(),
            width,
            up: (up * half_height).to_array(),
            height,
        })
    }

    /// The same view with another resolution; the horizontal field of view stays.
    pub fn with_resolution(mut self, width: u32, height: u32) -> Self {
        let (width, height) = (width.clamp(1, MAX_RESOLUTION), height.clamp(1, MAX_RESOLUTION));
        let change = (height as f32 / width as f32) / (self.height as f32 / self.width as f32);
        self.up = (Vec3::from_array(self.up) * change).to_array();
        self.width = width;
        self.height = height;
        self
    }

    /// A ray of unit direction through pixel (x, y) at `u` within its box and at `lens` on the lens.
    #[inline]
    pub fn sample_ray(&self, x: u32, y: u32, u: [f32; 2], lens: [f32; 2]) -> Ray {
        let sx = 2.0 * ((x as f32 + u[0]) / self.width as f32) - 1.0;
        let sy = 1.0 - 2.0 * ((y as f32 + u[1]) / self.height as f32);
        let forward = Vec3::from_array(self.forward);
        let toward = forward + Vec3::from_array(self.right) * sx + Vec3::from_array(self.up) * sy;
        let position = Vec3::from_array(self.position);
        if self.lens_radius > 0.0 {
            let [dx, dy] = warp::sample_disk(lens);
            let right = math::normalize_or(Vec3::from_array(self.right), Vec3::ZERO);
            let up = math::normalize_or(Vec3::from_array(self.up), Vec3::ZERO);
            let shift = (right * dx + up * dy) * self.lens_radius;
            let direction = math::normalize_or(toward * self.focus_distance - shift, Vec3::ZERO);
            return Ray { origin: position + shift, direction, t_max: f32::MAX };
        }
        Ray { origin: position, direction: math::normalize_or(toward, Vec3::ZERO), t_max: f32::MAX }
    }
}

/// The other way: from a place to the pixel that sees it.
impl Camera {
    /// Area of the image on the plane one unit along the axis.
    #[inline]
    fn film_area(&self) -> f32 {
        let (right, up) = (Vec3::from_array(self.right), Vec3::from_array(self.up));
        4.0 * math::sqrt(right.dot(right) * up.dot(up))
    }

    /// Density per solid angle of the directions of [`Self::sample_ray`] from a point of the lens, over all pixels together; `direction` is a unit vector into the image.
    #[inline]
    pub fn pdf_solid_angle(&self, direction: Vec3) -> f32 {
        let cos = direction.dot(Vec3::from_array(self.forward));
        if cos > 0.0 { 1.0 / (self.film_area() * (cos * cos * cos)) } else { 0.0 }
    }

    /// A point of the lens: its centre where it is a pinhole.
    #[inline]
    pub fn sample_lens(&self, u: [f32; 2]) -> Vec3 {
        let position = Vec3::from_array(self.position);
        if self.lens_radius <= 0.0 {
            return position;
        }
        let [dx, dy] = warp::sample_disk(u);
        let right = math::normalize_or(Vec3::from_array(self.right), Vec3::ZERO);
        let up = math::normalize_or(Vec3::from_array(self.up), Vec3::ZERO);
        position + (right * dx + up * dy) * self.lens_radius
    }

    /// The pixel (x, y) whose rays from a point of the lens pass through `p`; `None` beside the image and behind the camera.
    #[inline]
    pub fn pixel(&self, lens: Vec3, p: Vec3) -> Option<[u32; 2]> {
        let to = p - lens;
        let along = to.dot(Vec3::from_array(self.forward));
        if along.is_nan() || along <= 0.0 {
            return None;
        }
        // From the centre of the lens to where the ray crosses the plane that is in focus, at one unit along the axis.
        let toward = if self.lens_radius > 0.0 {
            let shift = lens - Vec3::from_array(self.position);
            to / along + shift / self.focus_distance
        } else {
            to / along
        };
        let (right, up) = (Vec3::from_array(self.right), Vec3::from_array(self.up));
        let column = (toward.dot(right) / right.dot(right) + 1.0) * (0.5 * self.width as f32);
        let row = (1.0 - toward.dot(up) / up.dot(up)) * (0.5 * self.height as f32);
        let within = column >= 0.0 && row >= 0.0 && column < self.width as f32 && row < self.height as f32;
        within.then_some([column as u32, row as u32])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::String;

    fn desc() -> CameraDesc {
        CameraDesc {
            position: [1.0, 2.0, 3.0],
            look_at: [1.0, 2.0, 13.0],
            up: [0.0, 1.0, 0.0],
            fov_x_deg: 90.0,
            resolution: [200, 100],
            lens_radius: 0.0,
            focus_distance: 1.0,
            medium: String::new(),
        }
    }

    #[test]
    fn corners_of_the_image_are_where_the_field_of_view_says() {
        let camera = Camera::try_new(&desc()).unwrap();
        // Looking along +z with +y up, right is forward x up = -x.
        let left_top = camera.sample_ray(0, 0, [0.0, 0.0], [0.0; 2]).direction;
        let expected = Vec3::new(1.0, 0.5, 1.0).normalize();
        assert!((left_top - expected).length() <= 3e-7, "{left_top}");
        let centre = camera.sample_ray(100, 50, [0.0, 0.0], [0.0; 2]).direction;
        assert!((centre - Vec3::Z).length() <= 3e-7, "{centre}");
    }

    #[test]
    fn lens_rays_meet_in_the_focal_plane() {
        let mut d = desc();
        d.lens_radius = 0.3;
        d.focus_distance = 4.0;
        let camera = Camera::try_new(&d).unwrap();
        let pinhole = Camera::try_new(&desc()).unwrap().sample_ray(37, 81, [0.2, 0.9], [0.0; 2]);
        let meet = pinhole.origin + pinhole.direction * (4.0 / pinhole.direction.z);
        for lens in [[0.0, 0.0], [0.9, 0.1], [0.3, 0.7], [0.99, 0.99]] {
            let r = camera.sample_ray(37, 81, [0.2, 0.9], lens);
            let at = r.origin + r.direction * ((meet.z - r.origin.z) / r.direction.z);
            assert!((at - meet).length() <= 4e-6, "{at} against {meet}");
        }
    }

    #[test]
    fn pixels_are_found_again_and_directions_have_their_density() {
        for lens_radius in [0.0, 0.3] {
            let mut d = desc();
            (d.lens_radius, d.focus_distance) = (lens_radius, 4.0);
            let camera = Camera::try_new(&d).unwrap();
            for i in 0..2000_u32 {
                let n = |k: u32| ((i * 4 + k).wrapping_mul(2_654_435_761) >> 8) as f32 / 16_777_216.0;
                let (x, y) = ((n(0) * 200.0) as u32, (n(1) * 100.0) as u32);
                let u = [0.02 + 0.96 * n(2), 0.02 + 0.96 * n(3)];
                let ray = camera.sample_ray(x, y, u, [n(1), n(3)]);
                assert!((camera.sample_lens([n(1), n(3)]) - ray.origin).length() < 1e-6);
                let p = ray.origin + ray.direction * (0.5 + 9.0 * n(0));
                assert_eq!(camera.pixel(ray.origin, p), Some([x, y]), "{lens_radius} {u:?}");
                assert_eq!(camera.pixel(ray.origin, ray.origin - ray.direction), None);
            }
            // Its integral over the image: cells of the plane at one unit, each of solid angle area cos^3.
            let (mut sum, steps) = (0.0, 64);
            for i in 0..steps * steps {
                let at = |k: u32| (k as f32 + 0.5) / steps as f32 * 2.0 - 1.0;
                let toward = Vec3::Z + Vec3::X * at(i % steps) + Vec3::Y * (0.5 * at(i / steps));
                let cos = 1.0 / toward.length();
                let solid_angle = cos * cos * cos * 2.0 / (steps * steps) as f32;
                sum += camera.pdf_solid_angle(toward * cos) * solid_angle;
            }
            assert!((sum - 1.0).abs() < 1e-3, "{sum}");
            assert_eq!(camera.pdf_solid_angle(-Vec3::Z), 0.0);
        }
    }

    #[test]
    fn bad_cameras_are_refused_by_field() {
        let field = |change: fn(&mut CameraDesc)| {
            let mut d = desc();
            change(&mut d);
            match Camera::try_new(&d) {
                Err(SceneError::OutOfRange { field, .. } | SceneError::NotFinite { field, .. }) => field,
                other => panic!("{other:?}"),
            }
        };
        assert_eq!(field(|d| d.look_at = d.position), "look_at");
        assert_eq!(field(|d| d.up = [0.0, 0.0, 1.0]), "up");
        assert_eq!(field(|d| d.fov_x_deg = 180.0), "fov_x_deg");
        assert_eq!(field(|d| d.resolution = [0, 4]), "resolution");
        assert_eq!(field(|d| d.lens_radius = f32::NAN), "lens_radius");
        assert_eq!(field(|d| (d.lens_radius, d.focus_distance) = (1.0, 0.0)), "focus_distance");
    }
}
