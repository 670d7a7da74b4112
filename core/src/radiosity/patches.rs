//! Patches: the surfaces of a scene as a few thousand parts between which light is a matrix.
//!
//! A patch is a set of elements ([`crate::illumination::Elements`], sides apart) that lie in one voxel and face alike
//! ([`crate::illumination::Clusters`]): what faces the other way is another patch, so that the two sides of a thin wall, and walls back to back in one
//! voxel, never share light. Elements that no light can reach (the insides of solids) belong to no patch.
//!
//! Quantities per patch: area \[m^2\], the mean of place and normal by area, albedo, and what the surface itself emits (radiosity, \[W/m^2\]).

use crate::geometry::{Hit, SurfacePoint, hit_point_with, interpolate};
use crate::illumination::{Basis, Clusters, ElementSettings, Elements, NO_CLUSTER, Sides};
use crate::math::{self, PI, Vec3};
use crate::sampling::discrete::{IntegerCdf, pick_in};
use crate::scene::{CompiledScene, NO_INDEX, material_flags};
use crate::transport::albedo_at;
use alloc::sync::Arc;
use alloc::vec::Vec;

/// "No patch": of elements that no light reaches.
pub const NO_PATCH: u32 = NO_CLUSTER;

/// Points at which an element with a bitmap is looked at.
const TEXTURE_POINTS: u32 = 16;
/// Area of the square whose side is the longest edge of an element, over that of a patch.
const PARTS_OF_PATCH: f64 = 0.5;

/// A part of a scene's surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Patch {
    /// Area \[m^2\], positive.
    pub area: f32,
    /// Mean place \[m\].
    pub position: [f32; 3],
    /// Mean unit normal of the side that receives; zero where normals cancel.
    pub normal: [f32; 3],
    /// Mean albedo.
    pub albedo: [f32; 3],
    /// Mean radiosity of the surface itself \[W/m^2\].
    pub emission: [f32; 3],
}

/// The patches of a scene, and which elements are theirs.
#[derive(Clone, Debug, PartialEq)]
pub struct Patches {
    patches: Vec<Patch>,
    of: Vec<u32>,
    /// Members of patch p are at `first[p] .. first[p + 1]`.
    first: Vec<u32>,
    members: Vec<u32>,
    /// Primitive of each member.
    primitives: Vec<u32>,
    /// Each patch's distribution of area over its members, in the words of [`pick_in`].
    cumulative: Vec<u32>,
}

/// Of what patches are made, for those who lay them down elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct Parts<'a> {
    /// Patch of each element, or [`NO_PATCH`].
    pub of: &'a [u32],
    /// Members of patch p are at `first[p] .. first[p + 1]`.
    pub first: &'a [u32],
    /// Elements, patch by patch.
    pub members: &'a [u32],
    /// Primitive of each member.
    pub primitives: &'a [u32],
    /// Each patch's distribution of area over its members, in the words of [`pick_in`].
    pub cumulative: &'a [u32],
}

/// Patches together with the elements that they are made of.
#[derive(Clone, Debug)]
pub struct PatchMap {
    /// The scene's surfaces in small parts, sides apart.
    pub elements: Arc<Elements>,
    /// Patches of them.
    pub patches: Patches,
}

/// A triangle of a patch: one element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MemberTriangle {
    /// Its corners \[m\].
    pub vertices: [Vec3; 3],
    /// Unit normal of the side that receives.
    pub normal: Vec3,
    /// Corners of the whole triangle that it is a part of \[m\].
    pub whole: [Vec3; 3],
    /// By how much that one's extent counts more because it is thin, as [`crate::geometry::sliver_factor`].
    pub sliver: f32,
}

impl MemberTriangle {
    /// The extent of a point on it, as that of a [`SurfacePoint`] \[m\].
    #[inline]
    pub fn reach(&self, point: Vec3) -> f32 {
        let farthest = self.whole.into_iter().fold(0.0_f32, |m, v| m.max((v - point).dot(v - point)));
        math::sqrt(farthest) * self.sliver
    }
}

/// How a scene becomes patches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchSettings {
    /// About how many patches.
    pub count: u32,
    /// Seed of the walks that find what light reaches.
    pub seed: u64,
}

impl PatchSettings {
    /// What patches are put together from: elements a few times smaller, sides apart.
    pub fn elements(&self, scene: &CompiledScene) -> ElementSettings {
        // Four elements on a square of this side, two right triangles whose longest edge it must cover.
        let area = scene.area() * PARTS_OF_PATCH / f64::from(self.count.max(1));
        ElementSettings { basis: Basis::Constant, sides: Sides::Apart, largest: math::sqrt64(area) as f32 }
    }
}

impl Patches {
    /// From clusters of elements of the constant basis with sides apart. Clusters without area become no patch.
    pub fn new(scene: &CompiledScene, elements: &Elements, clusters: &Clusters) -> Self {
        let owners = elements.owners();
        let places = elements.element_places(scene);
        let mut lists: Vec<Vec<u32>> = alloc::vec![Vec::new(); clusters.count];
        for (element, cluster) in clusters.of.iter().enumerate() {
            let has_points = owners.get(element % owners.len().max(1)).is_some_and(|o| *o != NO_INDEX);
            if elements.area(element) > 0.0
                && has_points
                && let Some(list) = lists.get_mut(*cluster as usize)
            {
                list.push(element as u32);
            }
        }
        let mut made = Self {
            patches: Vec::new(),
            of: alloc::vec![NO_PATCH; elements.count()],
            first: alloc::vec![0],
            members: Vec::new(),
            primitives: Vec::new(),
            cumulative: Vec::new(),
        };
        for list in lists {
            let areas: Vec<f32> = list.iter().map(|e| elements.area(*e as usize)).collect();
            let Ok(cdf) = IntegerCdf::try_new(&areas) else { continue };
            let mut sums = Sums::default();
            for element in &list {
                let index = *element as usize;
                let primitive = owners[index % owners.len()];
                let (albedo, emission) = surface(scene, elements, *element, primitive);
                sums.add(
                    f64::from(elements.area(index)),
                    places[index].position,
                    places[index].normal,
                    albedo,
                    emission,
                );
                made.of[index] = made.patches.len() as u32;
                made.primitives.push(primitive);
            }
            made.members.extend(&list);
            made.cumulative.extend(cdf.cumulative());
            made.first.push(made.members.len() as u32);
            made.patches.push(sums.patch());
        }
        made
    }

    /// The patches.
    pub fn list(&self) -> &[Patch] {
        &self.patches
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.patches.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.patches.is_empty()
    }

    /// Patch of each element, or [`NO_PATCH`].
    pub fn of(&self) -> &[u32] {
        &self.of
    }

    /// What they are made of.
    pub fn parts(&self) -> Parts<'_> {
        Parts {
            of: &self.of,
            first: &self.first,
            members: &self.members,
            primitives: &self.primitives,
            cumulative: &self.cumulative,
        }
    }

    /// Areas \[m^2\].
    pub fn areas(&self) -> Vec<f32> {
        self.patches.iter().map(|p| p.area).collect()
    }

    /// Elements of a patch; none beyond the last.
    pub fn members(&self, patch: usize) -> &[u32] {
        match (self.first.get(patch), self.first.get(patch + 1)) {
            (Some(a), Some(b)) => &self.members[*a as usize..*b as usize],
            _ => &[],
        }
    }

    /// The same patches in another order: patch i of the result is patch `order[i]` of this one. `order` must be a permutation, or nothing changes.
    #[must_use]
    pub fn reordered(&self, order: &[u32]) -> Self {
        let n = self.len();
        let mut places = alloc::vec![NO_PATCH; n];
        for (new, old) in order.iter().enumerate() {
            if let Some(place) = places.get_mut(*old as usize) {
                *place = new as u32;
            }
        }
        if order.len() != n || places.contains(&NO_PATCH) {
            return self.clone();
        }
        let mut made = Self {
            patches: order.iter().map(|p| self.patches[*p as usize]).collect(),
            of: self.of.iter().map(|p| places.get(*p as usize).copied().unwrap_or(NO_PATCH)).collect(),
            first: alloc::vec![0],
            members: Vec::with_capacity(self.members.len()),
            primitives: Vec::with_capacity(self.members.len()),
            cumulative: Vec::with_capacity(self.members.len()),
        };
        for old in order {
            let range = self.first[*old as usize] as usize..self.first[*old as usize + 1] as usize;
            made.members.extend(&self.members[range.clone()]);
            made.primitives.extend(&self.primitives[range.clone()]);
            made.cumulative.extend(&self.cumulative[range]);
            made.first.push(made.members.len() as u32);
        }
        made
    }

    /// A uniform point of a patch, with the unit normal of its side there: `pick` chooses the member, `u` the place on it. `None` beyond the last patch.
    #[inline]
    pub fn sample(
        &self,
        scene: &CompiledScene,
        elements: &Elements,
        patch: usize,
        pick: u32,
        u: [f32; 2],
    ) -> Option<(SurfacePoint, Vec3)> {
        let range = *self.first.get(patch)? as usize..*self.first.get(patch + 1)? as usize;
        let member = range.start + pick_in(self.cumulative.get(range)?, pick).index as usize;
        let (element, primitive) = (*self.members.get(member)?, *self.primitives.get(member)?);
        let [b1, b2] = elements.bary_on(primitive, element, u);
        let record = scene.surfaces.get(primitive as usize)?;
        let point = hit_point_with(scene.primitives().vertices(primitive)?, b1, b2, record.sliver);
        let front = Vec3::from_array(record.normal);
        Some((point, if elements.is_back(element) { -front } else { front }))
    }

    /// The triangles of a patch, one for each member; those of slivers that count for a member are left out. None beyond the last patch.
    pub fn triangles<'a>(
        &'a self,
        scene: &'a CompiledScene,
        elements: &'a Elements,
        patch: usize,
    ) -> impl Iterator<Item = MemberTriangle> + 'a {
        let range = match (self.first.get(patch), self.first.get(patch + 1)) {
            (Some(a), Some(b)) => *a as usize..*b as usize,
            _ => 0..0,
        };
        self.members[range.clone()].iter().zip(&self.primitives[range]).filter_map(|(element, primitive)| {
            let whole = scene.primitives().vertices(*primitive)?;
            let record = scene.surfaces.get(*primitive as usize)?;
            let front = Vec3::from_array(record.normal);
            Some(MemberTriangle {
                vertices: elements
                    .corners_on(*primitive, *element)
                    .map(|[b1, b2]| interpolate(whole, b1, b2)),
                normal: if elements.is_back(*element) { -front } else { front },
                whole,
                sliver: record.sliver,
            })
        })
    }

    /// Numbers per patch as numbers per element; 0 for elements of no patch.
    pub fn spread(&self, values: &[[f32; 3]]) -> Vec<[f32; 3]> {
        self.of.iter().map(|p| values.get(*p as usize).copied().unwrap_or([0.0; 3])).collect()
    }
}

/// Albedo, and radiosity of its own, of a side of an element.
fn surface(scene: &CompiledScene, elements: &Elements, element: u32, primitive: u32) -> (Vec3, Vec3) {
    let material = scene.material_of(primitive);
    let back = elements.is_back(element);
    let emission =
        match scene.surfaces.get(primitive as usize).and_then(|s| scene.lights.get(s.light as usize)) {
            Some(light) if !back => Vec3::from_array(light.radiance) * PI,
            _ => Vec3::ZERO,
        };
    if back && material.flags & material_flags::TWO_SIDED == 0 {
        return (Vec3::ZERO, emission);
    }
    let points = if !material.is_textured() { 1 } else { TEXTURE_POINTS };
    let mut albedo = Vec3::ZERO;
    for i in 0..points {
        // The R2 points of M. Roberts (2018): the powers of the root of x^3 = x + 1.
        let u = [0.754_877_7, 0.569_840_3].map(|a: f32| {
            let x = 0.5 + a * i as f32;
            x - math::floor(x)
        });
        let [b1, b2] = elements.bary_on(primitive, element, u);
        albedo += albedo_at(scene, &Hit { t: 0.0, primitive, b1, b2 });
    }
    (albedo / points as f32, emission)
}

/// Sums of a patch, by area.
#[derive(Default)]
struct Sums {
    area: f64,
    vectors: [[f64; 3]; 4],
}

impl Sums {
    fn add(&mut self, area: f64, position: Vec3, normal: Vec3, albedo: Vec3, emission: Vec3) {
        self.area += area;
        for (sum, vector) in self.vectors.iter_mut().zip([position, normal, albedo, emission]) {
            for (s, x) in sum.iter_mut().zip(vector.to_array()) {
                *s += area * f64::from(x);
            }
        }
    }

    fn patch(&self) -> Patch {
        let [position, normal, albedo, emission] = self.vectors.map(|v| v.map(|s| (s / self.area) as f32));
        let normal = math::normalize_or(Vec3::from_array(normal), Vec3::ZERO).to_array();
        Patch { area: self.area as f32, position, normal, albedo, emission }
    }
}
