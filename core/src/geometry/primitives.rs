//! The primitives of a scene by number, the query interface, and the oracle that tries them all.

use super::ray::{Aabb, PreparedRay, Ray};
use super::shape::{RoundShape, bounds, intersect_shape};
use super::triangle::{intersect_triangle, triangle_bounds};
use crate::math::Vec3;

/// Number of a primitive: triangles first, then round shapes.
pub type PrimitiveId = u32;
/// The number that no primitive has.
pub const NO_PRIMITIVE: PrimitiveId = u32::MAX;

/// Where a ray first meets the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter, within `[0, t_max]`, in units of `|direction|`.
    pub t: f32,
    /// Which primitive.
    pub primitive: PrimitiveId,
    /// Barycentric of vertex 1, in `[0, 1]`; 0 for round shapes.
    pub b1: f32,
    /// Barycentric of vertex 2, in `[0, 1]`, `b1 + b2 <= 1` in f32; 0 for round shapes.
    pub b2: f32,
}

impl Hit {
    /// Whether `self` comes before `other`: smaller `t`, then lower primitive number. The order in which
    /// primitives are tried must not matter, so every search uses this rule.
    #[inline(always)]
    pub fn before(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.primitive < other.primitive)
    }
}

/// Answers ray queries against one fixed set of primitives.
///
/// All implementations over the same primitives must agree bit for bit (see the module's doc).
pub trait Intersector {
    /// The hit with the smallest `t` in `[0, t_max]`; among equals the lowest primitive number.
    fn closest_hit(&self, ray: &Ray) -> Option<Hit>;

    /// Whether anything is hit within `[0, t_max]`: exactly `closest_hit(ray).is_some()`.
    fn occluded(&self, ray: &Ray) -> bool;

    /// [`Self::closest_hit`] for each ray; the longer of the two slices is not looked at beyond the shorter.
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest_hit(ray);
        }
    }

    /// [`Self::occluded`] for each ray; the longer of the two slices is not looked at beyond the shorter.
    fn occluded_each(&self, rays: &[Ray], occluded: &mut [bool]) {
        for (ray, out) in rays.iter().zip(occluded) {
            *out = self.occluded(ray);
        }
    }
}

/// Borrowed primitives: triangle `i` has number `i`, round shape `j` has number `triangles.len() + j`.
///
/// A triangle that names a vertex out of range is a primitive that nothing hits, with an empty box.
#[derive(Clone, Copy, Debug, Default)]
pub struct Primitives<'a> {
    /// Vertex positions, metres.
    pub positions: &'a [[f32; 3]],
    /// Vertex numbers of each triangle.
    pub triangles: &'a [[u32; 3]],
    /// Spheres and disks.
    pub shapes: &'a [RoundShape],
}

impl Primitives<'_> {
    /// How many primitives there are.
    #[inline]
    pub fn count(&self) -> usize {
        self.triangles.len() + self.shapes.len()
    }

    /// The vertices of a triangle; `None` for a round shape or a number out of range.
    #[inline]
    pub fn vertices(&self, id: PrimitiveId) -> Option<[Vec3; 3]> {
        let [i, j, k] = *self.triangles.get(id as usize)?;
        Some([
            Vec3::from_array(*self.positions.get(i as usize)?),
            Vec3::from_array(*self.positions.get(j as usize)?),
            Vec3::from_array(*self.positions.get(k as usize)?),
        ])
    }

    /// The round shape of that number; `None` for a triangle or a number out of range.
    #[inline]
    pub fn shape(&self, id: PrimitiveId) -> Option<&RoundShape> {
        self.shapes.get((id as usize).checked_sub(self.triangles.len())?)
    }

    /// Tests one primitive; a number out of range is a miss.
    #[inline]
    pub fn intersect(&self, id: PrimitiveId, ray: &PreparedRay, t_max: f32) -> Option<Hit> {
        if let Some(shape) = self.shape(id) {
            let t = intersect_shape(ray, shape, t_max)?;
            return Some(Hit { t, primitive: id, b1: 0.0, b2: 0.0 });
        }
        let hit = intersect_triangle(ray, self.vertices(id)?, t_max)?;
        Some(Hit { t: hit.t, primitive: id, b1: hit.b1, b2: hit.b2 })
    }

    /// The box that the primitive's own test uses: exact for triangles, conservative for shapes, empty for a
    /// number out of range.
    pub fn bounds(&self, id: PrimitiveId) -> Aabb {
        if let Some(shape) = self.shape(id) {
            return bounds(shape);
        }
        self.vertices(id).map_or(Aabb::EMPTY, triangle_bounds)
    }
}

/// Tries every primitive in turn: slow, obviously right, the oracle for every tree.
#[derive(Clone, Copy, Debug, Default)]
pub struct BruteForce<'a> {
    /// What is tested.
    pub primitives: Primitives<'a>,
}

impl Intersector for BruteForce<'_> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let prepared = PreparedRay::new(ray);
        let mut best: Option<Hit> = None;
        for id in 0..self.primitives.count() {
            // Each primitive sees the whole ray: the oracle does not rely on shrinking intervals.
            if let Some(hit) = self.primitives.intersect(id as PrimitiveId, &prepared, ray.t_max)
                && best.is_none_or(|b| hit.before(&b))
            {
                best = Some(hit);
            }
        }
        best
    }

    fn occluded(&self, ray: &Ray) -> bool {
        let prepared = PreparedRay::new(ray);
        (0..self.primitives.count())
            .any(|id| self.primitives.intersect(id as PrimitiveId, &prepared, ray.t_max).is_some())
    }
}
