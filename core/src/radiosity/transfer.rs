//! From patches back to surfaces: smooth along a wall, and never through one.
//!
//! An element takes the mean of the patches around it, by weights (1 - d^2 / r^2)^2 of the distance d of their centres, its own patch included. Others must face alike, lie in its plane within a
//! part of r, and be seen from the element: a short ray just above the surface finds walls between. What faces another way is never mixed, so that corners stay corners.

use super::patches::{NO_PATCH, PatchMap};
use crate::geometry::{Ray, SurfacePoint, offset_origin};
use crate::math::{self, Vec3};
use crate::scene::CompiledScene;
use alloc::collections::BTreeMap;
use alloc::vec::Vec;

/// Radius of a patch's weight, in sides of a square of the mean area.
const RADIUS: f32 = 1.6;
/// Least cosine between normals that are mixed.
const ALIKE: f32 = 0.9;
/// Farthest distance to the element's plane, in radii.
const OFF_PLANE: f32 = 0.2;
/// Most patches of an element.
const MOST: usize = 12;

/// Weights of patches for each element.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Transfer {
    first: Vec<u32>,
    weights: Vec<(u32, f32)>,
}

/// Patches by the cell of a grid in which their centres lie.
pub struct PatchGrid {
    size: f32,
    cells: BTreeMap<[i32; 3], Vec<u32>>,
}

impl PatchGrid {
    /// Of the patches of a map.
    pub fn new(map: &PatchMap) -> Self {
        let list = map.patches.list();
        let area = list.iter().map(|p| f64::from(p.area)).sum::<f64>() / list.len().max(1) as f64;
        let size = (RADIUS * math::sqrt64(area) as f32).max(f32::MIN_POSITIVE);
        let mut grid = Self { size, cells: BTreeMap::new() };
        for (i, patch) in list.iter().enumerate() {
            grid.cells.entry(grid.cell(Vec3::from_array(patch.position))).or_default().push(i as u32);
        }
        grid
    }

    fn cell(&self, p: Vec3) -> [i32; 3] {
        (p / self.size).to_array().map(|x| math::floor(x) as i32)
    }

    /// Weights for an element at a place, of a patch of its own; `hidden` is asked whether something lies on a ray.
    pub fn weights(
        &self,
        map: &PatchMap,
        (position, normal, own): (Vec3, Vec3, u32),
        hidden: impl Fn(&Ray) -> bool,
    ) -> Vec<(u32, f32)> {
        let mut found: Vec<(u32, f32)> = Vec::new();
        let [x, y, z] = self.cell(position);
        let near = |c: i32| c.saturating_sub(1)..=c.saturating_add(1);
        for cell in near(x).flat_map(|x| near(y).flat_map(move |y| near(z).map(move |z| [x, y, z]))) {
            for index in self.cells.get(&cell).into_iter().flatten() {
                let Some(patch) = map.patches.list().get(*index as usize) else { continue };
                let apart = Vec3::from_array(patch.position) - position;
                let t = 1.0 - apart.dot(apart) / (self.size * self.size);
                let alike = *index == own
                    || (Vec3::from_array(patch.normal).dot(normal) >= ALIKE
                        && apart.dot(normal).abs() <= OFF_PLANE * self.size);
                if t > 0.0 && alike {
                    found.push((*index, t * t));
                }
            }
        }
        // The heaviest first, so that rays are spent on these.
        found.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        found.truncate(MOST);
        let lift = normal * (0.02 * self.size);
        found.retain(|(index, _)| {
            if *index == own {
                return true;
            }
            let to = Vec3::from_array(map.patches.list()[*index as usize].position) + lift;
            let point = SurfacePoint { position: position + lift, extent: self.size };
            let origin = offset_origin(&point, normal, normal);
            !hidden(&Ray { origin, direction: to - origin, t_max: 1.0 })
        });
        if found.is_empty() {
            found.push((own, 1.0));
        }
        let sum: f32 = found.iter().map(|f| f.1).sum();
        found.iter_mut().for_each(|f| f.1 /= sum);
        found
    }
}

impl Transfer {
    /// From each element's weights, in the order of elements.
    pub fn new(lists: Vec<Vec<(u32, f32)>>) -> Self {
        let mut made = Self { first: alloc::vec![0], weights: Vec::new() };
        for list in lists {
            made.weights.extend(list);
            made.first.push(made.weights.len() as u32);
        }
        made
    }

    /// What one element's weights are to be found for: its place, normal and patch; `None` for elements of no patch.
    pub fn place(
        map: &PatchMap,
        places: &[crate::illumination::ElementPlace],
        element: usize,
    ) -> Option<(Vec3, Vec3, u32)> {
        let own = *map.patches.of().get(element)?;
        let place = places.get(element)?;
        (own != NO_PATCH).then_some((place.position, place.normal, own))
    }

    /// Numbers per element from numbers per patch; 0 for elements of no patch.
    pub fn apply(&self, values: &[[f32; 3]]) -> Vec<[f32; 3]> {
        self.first
            .windows(2)
            .map(|w| {
                let mut sum = [0.0; 3];
                for (patch, weight) in &self.weights[w[0] as usize..w[1] as usize] {
                    let value = values.get(*patch as usize).copied().unwrap_or([0.0; 3]);
                    sum = [0, 1, 2].map(|c| sum[c] + weight * value[c]);
                }
                sum
            })
            .collect()
    }

    /// How many elements there are.
    pub fn len(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Places of all elements, for [`Transfer::place`].
pub fn places(scene: &CompiledScene, map: &PatchMap) -> Vec<crate::illumination::ElementPlace> {
    map.elements.element_places(scene)
}
