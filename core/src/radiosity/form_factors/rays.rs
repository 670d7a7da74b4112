//! What the rays of one patch meet.

use crate::bsdf::diffuse;
use crate::geometry::{Hit, Intersector, Ray, offset_origin};
use crate::illumination::Elements;
use crate::math::Vec3;
use crate::radiosity::patches::{NO_PATCH, Patches};
use crate::sampling::discrete::even_word;
use crate::sampling::sobol::BlockSampler;
use crate::scene::CompiledScene;
use alloc::vec::Vec;

/// Most rays of a patch.
pub const RAYS_MAX: u32 = 1 << 22;
/// What a ray met that is no patch, in the place of one's number.
pub const LOST: u32 = NO_PATCH;
/// The same of a ray that met nothing.
pub const ESCAPED: u32 = NO_PATCH - 1;
/// The same of a ray that has no place to start from.
pub const UNSENT: u32 = NO_PATCH - 2;

/// What the rays of a patch met: counts are exact, and the same however rows are shared out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Row {
    /// Patches that were met and by how many rays, in the order of patches.
    pub met: Vec<(u32, u32)>,
    /// Rays that met nothing.
    pub escaped: u32,
    /// Rays that met what is no patch.
    pub lost: u32,
    /// All rays.
    pub rays: u32,
}

impl Row {
    /// Counts what `rays` rays met, told one by one in any order: the number of a patch, [`LOST`], [`ESCAPED`] or [`UNSENT`]. `counts` has a 0 for each patch, before and after.
    #[inline(always)]
    pub fn count(rays: u32, met: impl Iterator<Item = u32>, counts: &mut [u32]) -> Self {
        let mut row = Self { rays, ..Self::default() };
        for patch in met {
            match counts.get_mut(patch as usize) {
                Some(count) => {
                    if *count == 0 {
                        row.met.push((patch, 0));
                    }
                    *count += 1;
                }
                None if patch == ESCAPED => row.escaped += 1,
                None if patch == UNSENT => {}
                None => row.lost += 1,
            }
        }
        row.met.sort_unstable();
        for (patch, count) in &mut row.met {
            *count = core::mem::take(&mut counts[*patch as usize]);
        }
        row
    }
}

/// Rays of each patch where one of mean area has about `mean`; see [`share`].
pub fn shares(patches: &Patches, mean: u32) -> Vec<u32> {
    let list = patches.list();
    let mean_area = list.iter().map(|p| f64::from(p.area)).sum::<f64>() / list.len().max(1) as f64;
    list.iter().map(|p| share(mean, p.area, mean_area as f32)).collect()
}

/// Rays of a patch, a power of two: about `mean` times its area over the mean area, since what a pair gets is the rays of both; at least an eighth of `mean`.
pub fn share(mean: u32, area: f32, mean_area: f32) -> u32 {
    let share = f64::from(area) / f64::from(mean_area).max(f64::MIN_POSITIVE);
    let wanted = f64::from(mean) * if share > 0.125 { share } else { 0.125 };
    (wanted as u32).clamp(1, RAYS_MAX).next_power_of_two()
}

/// The element side that a hit is on.
#[inline(always)]
pub(super) fn side_of(scene: &CompiledScene, elements: &Elements, ray: &Ray, hit: &Hit) -> Option<u32> {
    let front = Vec3::from_array(scene.surfaces.get(hit.primitive as usize)?.normal);
    let mut found = None;
    elements.deposit(hit, ray.direction.dot(front) <= 0.0, |element, _| found = Some(element));
    found
}

/// Traces the rays of a patch, `rays` of them, a power of two. `counts` has a 0 for each patch, before and after.
///
/// Points, one to each of equal parts of the area of the members, and directions are a scrambled Sobol' set.
#[inline(always)]
pub fn trace<I: Intersector + ?Sized>(
    scene: &CompiledScene,
    intersector: &I,
    elements: &Elements,
    patches: &Patches,
    patch: usize,
    (seed, rays): (u64, u32),
    counts: &mut [u32],
) -> Row {
    let first = BlockSampler::new(seed, patch as u32, 0, 0);
    let [shift, _] = first.bits2(1);
    let bits = rays.trailing_zeros();
    let met = |i: u32| {
        let [a, b, u, v] = first.with_index(i).group4(0);
        let Some((point, normal)) = patches.sample(scene, elements, patch, even_word(i, shift, bits), [a, b])
        else {
            return UNSENT;
        };
        let direction = diffuse::sample(normal, [u, v]);
        let ray = Ray { origin: offset_origin(&point, normal, direction), direction, t_max: f32::INFINITY };
        let Some(hit) = intersector.closest_hit(&ray) else { return ESCAPED };
        let element = side_of(scene, elements, &ray, &hit);
        element.and_then(|e| patches.of().get(e as usize).copied()).unwrap_or(LOST)
    };
    Row::count(rays, (0..rays).map(met), counts)
}
