//! Clusters: elements that are near each other and face alike, taken together.

use super::{ElementPlace, Elements, Sides};
use crate::math::{self, Vec3};
use crate::scene::CompiledScene;
use alloc::vec::Vec;

/// Share of the mean area of a cluster below which it is joined to another.
const SMALL: f64 = 0.01;
/// "No cluster": of elements without area.
pub const NO_CLUSTER: u32 = u32::MAX;
/// Layers of a voxel's edge where they are told apart, and where they begin: not where planes are likely to lie.
const LAYERS: f32 = 4.0;
const LAYER_START: f32 = 4.37;
const LAYER_BITS: u32 = 3;
/// Bits of a voxel's number along an axis, and of what elements of a cluster have alike: kind, axis, direction.
const CELL_BITS: u32 = 18;
const LIKE_BITS: u32 = 7;
/// Steps by which the size of voxels is found for a number of clusters.
const STEPS: usize = 40;

/// A division of the elements of a map into clusters: those whose places lie in the same cubic voxel and whose normals are nearest to the same axis (and
/// direction along it, where sides are apart), of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Clusters {
    /// Cluster of each element, or [`NO_CLUSTER`].
    pub of: Vec<u32>,
    /// How many there are.
    pub count: usize,
    /// Edge of the voxels \[m\].
    pub size: f32,
}

/// Layer of an element in its voxel: how far its plane is from the voxel's centre. Planes are not cut by it, however they lie.
fn layer(cell: Vec3, normal: Vec3) -> u64 {
    let centre = Vec3::from_array(cell.to_array().map(|x| math::floor(x) + 0.5));
    u64::from((LAYERS * (cell - centre).dot(normal) + LAYER_START) as u32).min((1 << LAYER_BITS) - 1)
}

/// What clusters are made of: where elements are, for any number of divisions.
#[derive(Clone, Debug)]
pub struct Clustering {
    places: Vec<ElementPlace>,
    weights: Vec<f64>,
    used: Vec<bool>,
    /// What elements of different kinds must not share, 4 bits of it; empty: all are of one kind.
    kinds: Vec<u8>,
    low: Vec3,
    extent: f32,
    signed: bool,
}

impl Clustering {
    /// Of all elements with an area.
    pub fn new(scene: &CompiledScene, elements: &Elements) -> Self {
        let places = elements.element_places(scene);
        let weights: Vec<f64> = (0..elements.count()).map(|i| elements.weight(i)).collect();
        let used = weights.iter().map(|w| *w > 0.0).collect();
        let extent = (scene.bounds.hi - scene.bounds.lo).max_element().max(f32::MIN_POSITIVE);
        let signed = elements.settings().sides == Sides::Apart;
        Self { places, weights, used, kinds: Vec::new(), low: scene.bounds.lo, extent, signed }
    }

    /// Leaves out the elements for which `keep` is false: those that nothing lights, say.
    #[must_use]
    pub fn retain(mut self, keep: impl Fn(usize) -> bool) -> Self {
        for (i, used) in self.used.iter_mut().enumerate() {
            *used &= keep(i);
        }
        self
    }

    /// Keeps elements of different kinds apart, one of 16 per element; and such as lie in different layers of a voxel, along
    /// their normals, so that a floor and the roof above it are not one.
    #[must_use]
    pub fn apart(mut self, kinds: Vec<u8>) -> Self {
        self.kinds = kinds;
        self
    }

    /// Where elements are.
    pub fn places(&self) -> &[ElementPlace] {
        &self.places
    }

    /// Edge of a cube that holds all places \[m\].
    pub(super) fn extent(&self) -> f32 {
        self.extent
    }

    fn key(&self, i: usize, size: f32, shift: Vec3, signed: bool) -> u64 {
        let p = &self.places[i];
        let n = p.normal.to_array();
        let axis = (0..3).fold(0, |best, k| if n[k].abs() > n[best].abs() { k } else { best });
        let cell = (p.position - self.low) / size + shift;
        let number = cell.to_array().map(|x| u64::from(x as u32).min((1 << CELL_BITS) - 1));
        let side = u64::from(signed && n[axis] < 0.0);
        let kind = u64::from(self.kinds.get(i).copied().unwrap_or(0) & 15);
        let layer = if self.kinds.is_empty() { 0 } else { layer(cell, p.normal) };
        let place = number[0] << (2 * CELL_BITS) | number[1] << CELL_BITS | number[2];
        (place << LAYER_BITS | layer) << LIKE_BITS | kind << 3 | (axis as u64) << 1 | side
    }

    /// Elements in the order of their cells, each with its cell's key: voxels of edge `size` \[m\] shifted by `shift` (in voxels), and the axis nearest
    /// to the normal, with its direction where `signed`.
    pub(super) fn keyed(&self, size: f32, shift: Vec3, signed: bool) -> Vec<(u64, u32)> {
        let used = (0..self.places.len()).filter(|i| self.used[*i]);
        let mut keyed: Vec<(u64, u32)> = used.map(|i| (self.key(i, size, shift, signed), i as u32)).collect();
        keyed.sort_unstable();
        keyed
    }

    /// The clusters of voxels of edge `size` \[m\], numbered in the order of their first elements.
    pub fn by_size(&self, size: f32) -> Clusters {
        let keyed = self.keyed(size, Vec3::ZERO, self.signed);
        let mut of = alloc::vec![NO_CLUSTER; self.places.len()];
        let mut count = 0;
        for (i, (key, element)) in keyed.iter().enumerate() {
            if i > 0 && keyed[i - 1].0 != *key {
                count += 1;
            }
            of[*element as usize] = count;
        }
        let count = if keyed.is_empty() { 0 } else { count as usize + 1 };
        Clusters { of, count, size }
    }

    /// About `count` clusters, none much smaller than the mean: a hundredth of its area would hardly ever see a photon.
    pub fn by_count(&self, count: usize) -> Clusters {
        // The number falls with the size, though not evenly.
        let (mut small, mut large) = (self.extent / 4096.0, 2.0 * self.extent);
        let mut best = self.by_size(large);
        for _ in 0..STEPS {
            let size = math::sqrt(small * large);
            let found = self.by_size(size);
            if found.count > count {
                small = size;
            } else {
                large = size;
            }
            if found.count.abs_diff(count) < best.count.abs_diff(count) {
                best = found;
            }
            if best.count == count || large / small < 1.001 {
                break;
            }
        }
        self.join_small(best)
    }

    /// Joins clusters of less than [`SMALL`] of the mean area to the nearest one that is larger, faces alike and is of the same kind.
    fn join_small(&self, mut clusters: Clusters) -> Clusters {
        let mut area = alloc::vec![0.0_f64; clusters.count];
        let mut centre = alloc::vec![Vec3::ZERO; clusters.count];
        let mut like = alloc::vec![0_u64; clusters.count];
        for (i, c) in clusters.of.iter().enumerate().filter(|(_, c)| **c != NO_CLUSTER) {
            let c = *c as usize;
            area[c] += self.weights[i];
            centre[c] += self.places[i].position * self.weights[i] as f32;
            like[c] = self.key(i, clusters.size, Vec3::ZERO, self.signed) & ((1 << LIKE_BITS) - 1);
        }
        let least = SMALL * area.iter().sum::<f64>() / clusters.count.max(1) as f64;
        for (c, a) in centre.iter_mut().zip(&area) {
            *c /= (*a as f32).max(f32::MIN_POSITIVE);
        }
        let host = |c: usize| {
            let apart = |o: usize| (centre[o] - centre[c]).dot(centre[o] - centre[c]);
            let nearest = (0..clusters.count)
                .filter(|o| area[*o] >= least && like[*o] == like[c])
                .min_by(|a, b| apart(*a).total_cmp(&apart(*b)));
            if area[c] < least { nearest.unwrap_or(c) } else { c }
        };
        let hosts: Vec<usize> = (0..clusters.count).map(host).collect();
        // Those that are left, in their order.
        let mut numbers = alloc::vec![NO_CLUSTER; clusters.count];
        let mut count = 0;
        for (c, _) in hosts.iter().enumerate().filter(|(c, h)| *c == **h) {
            numbers[c] = count;
            count += 1;
        }
        for c in clusters.of.iter_mut().filter(|c| **c != NO_CLUSTER) {
            *c = numbers[hosts[*c as usize]];
        }
        clusters.count = count as usize;
        clusters
    }
}

impl Clusters {
    /// Means over clusters of numbers per element, weighted; and the sum of the weights of each.
    pub fn means(
        &self,
        weight: impl Fn(usize) -> f64,
        value: impl Fn(usize) -> [f64; 3],
    ) -> Vec<([f64; 3], f64)> {
        let mut sums = alloc::vec![([0.0_f64; 3], 0.0_f64); self.count];
        for (i, cluster) in self.of.iter().enumerate().filter(|(_, c)| **c != NO_CLUSTER) {
            let (w, v) = (weight(i), value(i));
            let (sum, weights) = &mut sums[*cluster as usize];
            *weights += w;
            for (s, x) in sum.iter_mut().zip(v) {
                *s += w * x;
            }
        }
        for (sum, weights) in &mut sums {
            let w = weights.max(f64::MIN_POSITIVE);
            *sum = sum.map(|s| s / w);
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::counter::Counter;

    #[test]
    fn layers_of_a_voxel_follow_planes_however_they_lie() {
        let numbers = Counter::new(11);
        let number = |i: u32, k: u32| numbers.unit(i, k, 0);
        for i in 0..500 {
            let normal = math::normalize_or(
                Vec3::new(number(i, 0) - 0.5, number(i, 1) - 0.5, number(i, 2) - 0.5),
                Vec3::X,
            );
            let corner = Vec3::new(3.0, 700.0, 12.0);
            let at = corner + Vec3::new(number(i, 3), number(i, 4), number(i, 5));
            // Other points of the plane in the same voxel, and a plane half an edge above.
            let along = normal.any_orthonormal_vector();
            for step in [-0.3, -0.1, 0.1, 0.3] {
                let other = at + along * step;
                let same_voxel =
                    (other - corner).min_element() >= 0.0 && (other - corner).max_element() < 1.0;
                let offset = LAYERS * (at - corner - Vec3::splat(0.5)).dot(normal) + LAYER_START;
                // Rounding decides next to a border.
                if same_voxel && (offset - math::floor(offset) - 0.5).abs() < 0.49 {
                    assert_eq!(layer(at, normal), layer(other, normal), "{i} {step}");
                }
            }
            let above = at + normal * 0.5;
            if (above - corner).min_element() >= 0.0 && (above - corner).max_element() < 1.0 {
                assert!(layer(above, normal) > layer(at, normal), "{i}");
            }
        }
    }
}
