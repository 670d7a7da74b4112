//! The elements of an illumination map: which numbers an arrival counts for, and with which factor.
//!
//! - [`Basis::Constant`]: irradiance is constant over each element, a triangle or an equal part of a large one; its estimate is arriving flux / area.
//! - [`Basis::Linear`]: irradiance at the nodes, the corners of those parts, linear between them. The estimate at a node v is the sum of flux times
//!   a dual function, (12 l - 3) / A_v within each part around it (l the node's barycentric there, A_v the area of all these parts): within a part these are
//!   biorthogonal to the hat functions, so that an irradiance that is linear comes out as it is, and their mean over the parts keeps that.
//!
//! Round shapes are one element each. Triangles of no more than 10^-6 of the mean area (slivers) count for a neighbour, since one photon on
//! them would weigh more than all others.

use super::lattice;
use crate::geometry::{Hit, triangle_area};
use crate::math::{self, Vec3};
use crate::scene::CompiledScene;
use alloc::collections::BTreeMap;
use alloc::vec::Vec;

/// Share of the mean area of a triangle at or below which it has no element of its own.
const SLIVER: f64 = 1e-6;
/// Most divisions of a triangle's edge.
const DIVISIONS_MAX: u32 = 256;
/// Nodes of triangles that meet at a smaller angle than this are one: 30 degrees.
const WELD_COS: f32 = 0.866;

/// What irradiance is between the numbers of a map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Basis {
    /// Constant per element.
    #[default]
    Constant,
    /// Linear between nodes.
    Linear,
}

/// Which sides of surfaces are told apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// What arrives at either side counts for the one element.
    #[default]
    Together,
    /// Each side has its elements: all fronts come first, all backs after them.
    Apart,
}

/// How a map is divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementSettings {
    /// Constant or linear.
    pub basis: Basis,
    /// Sides together or apart.
    pub sides: Sides,
    /// Longest edge of an element \[m\]: larger triangles are divided, into 256 x 256 parts at most. Infinite: none is.
    pub largest: f32,
}

impl Default for ElementSettings {
    fn default() -> Self {
        Self { basis: Basis::Constant, sides: Sides::Together, largest: f32::INFINITY }
    }
}

/// What a primitive's arrivals count for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// First element, or where its nodes begin in the list of nodes.
    pub first: u32,
    /// Divisions of its edges; 0 for what counts for element `first` alone, under either basis.
    pub divisions: u32,
}

/// The elements of one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Elements {
    settings: ElementSettings,
    places: Vec<Place>,
    /// Nodes of the lattice points of triangles, for the linear basis.
    nodes: Vec<u32>,
    /// Per element of one side \[m^2\]: its area; that of all parts around a node.
    areas: Vec<f32>,
}

/// A mesh whose faces, or vertices, are the elements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ElementMesh {
    /// Positions \[m\].
    pub positions: Vec<[f32; 3]>,
    /// Corners of each face.
    pub triangles: Vec<[u32; 3]>,
    /// Element of each face (constant basis) or vertex (linear basis).
    pub elements: Vec<u32>,
}

impl Elements {
    /// The elements of a scene; no more than 2^31 of them, large triangles staying undivided where more would be needed.
    pub fn new(scene: &CompiledScene, settings: ElementSettings) -> Self {
        let areas: Vec<f32> =
            (0..scene.primitives().count() as u32).map(|id| scene.primitive_area(id)).collect();
        let triangles = scene.triangles.len();
        let mut divisions: Vec<u32> =
            (0..triangles as u32).map(|t| divisions(scene, t, settings.largest)).collect();
        let wanted: u64 = divisions.iter().map(|n| u64::from(n * n)).sum();
        if wanted + scene.shapes.len() as u64 > 1 << 31 {
            divisions.fill(1);
        }
        let mut elements = Self { settings, places: Vec::new(), nodes: Vec::new(), areas: Vec::new() };
        match settings.basis {
            Basis::Constant => elements.constant(scene, &areas, &divisions),
            Basis::Linear => elements.linear(scene, &areas, &divisions),
        }
        for area in &areas[triangles..] {
            elements.places.push(Place { first: elements.areas.len() as u32, divisions: 0 });
            elements.areas.push(*area);
        }
        elements
    }

    fn constant(&mut self, scene: &CompiledScene, areas: &[f32], divisions: &[u32]) {
        let hosts = hosts_of_slivers(scene, &areas[..divisions.len()]);
        for (t, n) in divisions.iter().enumerate() {
            self.places.push(Place { first: self.areas.len() as u32, divisions: *n });
            if hosts.contains_key(&(t as u32)) {
                continue;
            }
            let parts = n * n;
            self.areas.extend((0..parts).map(|_| areas[t] / parts as f32));
        }
        for (sliver, host) in hosts {
            let first = self.places[host as usize].first;
            self.places[sliver as usize] = Place { first, divisions: 0 };
            self.areas[first as usize] += areas[sliver as usize];
        }
    }

    fn linear(&mut self, scene: &CompiledScene, areas: &[f32], divisions: &[u32]) {
        // Nodes by position, each with the normal of the first triangle there.
        let mut known: BTreeMap<[u32; 3], Vec<(Vec3, u32)>> = BTreeMap::new();
        for (t, n) in divisions.iter().enumerate() {
            let first = self.nodes.len() as u32;
            self.places.push(Place { first, divisions: *n });
            let normal = Vec3::from_array(scene.surfaces[t].normal);
            let Some(v) = scene.primitives().vertices(t as u32) else { continue };
            for [b1, b2] in lattice::point_barys(*n) {
                let p = position(v, b1, b2);
                // Zero has two signs.
                let key = (p + Vec3::ZERO).to_array().map(f32::to_bits);
                let here = known.entry(key).or_default();
                let node = match here.iter().find(|(m, _)| m.dot(normal) >= WELD_COS) {
                    Some((_, node)) => *node,
                    None => {
                        let node = self.areas.len() as u32;
                        here.push((normal, node));
                        self.areas.push(0.0);
                        node
                    }
                };
                self.nodes.push(node);
            }
            let part = areas[t] / (n * n) as f32;
            for corners in lattice::cells(*n) {
                for c in corners {
                    self.areas[self.nodes[(first + c) as usize] as usize] += part;
                }
            }
        }
    }

    /// How the map is divided.
    pub fn settings(&self) -> &ElementSettings {
        &self.settings
    }

    /// What [`Self::deposit`] reads, for a device: the place of each primitive, and the nodes of the lattice points of triangles.
    pub fn parts(&self) -> (&[Place], &[u32]) {
        (&self.places, &self.nodes)
    }

    /// Elements of one side.
    pub fn per_side(&self) -> usize {
        self.areas.len()
    }

    /// All elements.
    pub fn count(&self) -> usize {
        match self.settings.sides {
            Sides::Together => self.areas.len(),
            Sides::Apart => 2 * self.areas.len(),
        }
    }

    /// Area over which an element's flux is spread \[m^2\]; 0 beyond the last.
    #[inline]
    pub fn area(&self, element: usize) -> f32 {
        self.areas.get(element % self.areas.len().max(1)).copied().unwrap_or(0.0)
    }

    /// What an element counts for in a mean over the surfaces \[m^2\]: its area, or a third of that of the parts around a node.
    pub fn weight(&self, element: usize) -> f64 {
        let area = f64::from(self.area(element));
        if self.settings.basis == Basis::Linear { area / 3.0 } else { area }
    }

    /// The elements for which flux that arrives at a hit counts, each with its factor. The place of a hit on an unknown primitive is none.
    #[inline]
    pub fn deposit(&self, hit: &Hit, from_front: bool, mut add: impl FnMut(u32, f32)) {
        let Some(place) = self.places.get(hit.primitive as usize) else { return };
        let side =
            if from_front || self.settings.sides == Sides::Together { 0 } else { self.areas.len() as u32 };
        match (self.settings.basis, place.divisions) {
            (_, 0) | (Basis::Constant, 1) => add(side + place.first, 1.0),
            (Basis::Constant, n) => add(side + place.first + lattice::cell(n, hit.b1, hit.b2).index, 1.0),
            (Basis::Linear, n) => {
                let cell = lattice::cell(n, hit.b1, hit.b2);
                for (corner, l) in cell.corners.into_iter().zip(cell.bary) {
                    if let Some(node) = self.nodes.get((place.first + corner) as usize) {
                        add(side + node, 12.0 * l - 3.0);
                    }
                }
            }
        }
    }

    /// The irradiance at a hit by a map's numbers, one per element: a weighted mean of at most three.
    #[inline]
    pub fn read(&self, values: &[[f32; 3]], hit: &Hit, from_front: bool) -> Vec3 {
        let Some(place) = self.places.get(hit.primitive as usize) else { return Vec3::ZERO };
        let side =
            if from_front || self.settings.sides == Sides::Together { 0 } else { self.areas.len() as u32 };
        let value = |i: u32| values.get((side + i) as usize).copied().map_or(Vec3::ZERO, Vec3::from_array);
        match (self.settings.basis, place.divisions) {
            (_, 0) | (Basis::Constant, 1) => value(place.first),
            (Basis::Constant, n) => value(place.first + lattice::cell(n, hit.b1, hit.b2).index),
            (Basis::Linear, n) => {
                let cell = lattice::cell(n, hit.b1, hit.b2);
                let mut sum = Vec3::ZERO;
                for (corner, l) in cell.corners.into_iter().zip(cell.bary) {
                    if let Some(node) = self.nodes.get((place.first + corner) as usize) {
                        sum += value(*node) * l;
                    }
                }
                sum
            }
        }
    }

    /// Irradiance \[W/m^2\] per element from sums of flux times factor \[W\].
    pub fn irradiance(&self, element: usize, flux: [f64; 3]) -> [f64; 3] {
        let area = f64::from(self.area(element));
        flux.map(|f| if area > 0.0 { f / area } else { 0.0 })
    }

    /// Divisions of a primitive: equal parts of a triangle's area.
    pub fn cells(&self, primitive: u32) -> u32 {
        self.places.get(primitive as usize).map_or(0, |p| p.divisions.max(1) * p.divisions.max(1))
    }

    /// Barycentrics on its triangle of a point of a division, from those on the division, of vertices 1 and 2.
    pub(crate) fn in_cell(&self, primitive: u32, cell: u32, local: [f32; 2]) -> [f32; 2] {
        let n = self.places.get(primitive as usize).map_or(1, |p| p.divisions.max(1));
        if n == 1 { local } else { lattice::in_cell(n, cell, local) }
    }

    /// The mesh on which the map can be written. Its elements are those of the fronts; round shapes have no faces.
    pub fn mesh(&self, scene: &CompiledScene) -> ElementMesh {
        let undivided = self.places[..scene.triangles.len()].iter().all(|p| p.divisions <= 1);
        let mut mesh = ElementMesh::default();
        let constant = self.settings.basis == Basis::Constant;
        if undivided && constant {
            mesh.positions.clone_from(&scene.positions);
            mesh.triangles.clone_from(&scene.triangles);
            mesh.elements = self.places[..scene.triangles.len()].iter().map(|p| p.first).collect();
            return mesh;
        }
        for (t, place) in self.places[..scene.triangles.len()].iter().enumerate() {
            let Some(v) = scene.primitives().vertices(t as u32) else { continue };
            let (n, base) = (place.divisions.max(1), mesh.positions.len() as u32);
            for (k, [b1, b2]) in lattice::point_barys(n).enumerate() {
                mesh.positions.push(position(v, b1, b2).to_array());
                if !constant {
                    mesh.elements.push(self.nodes[place.first as usize + k]);
                }
            }
            for (k, corners) in lattice::cells(n).enumerate() {
                mesh.triangles.push(corners.map(|c| base + c));
                if constant {
                    mesh.elements.push(place.first + k as u32);
                }
            }
        }
        mesh
    }
}

/// A point of a triangle; the corners come out as they are, whatever the lattice, so that neighbours' nodes meet.
fn position(v: [Vec3; 3], b1: f32, b2: f32) -> Vec3 {
    match (b1, b2) {
        (0.0, 0.0) => v[0],
        (1.0, 0.0) => v[1],
        (0.0, 1.0) => v[2],
        _ => v[0] + (v[1] - v[0]) * b1 + (v[2] - v[0]) * b2,
    }
}

/// Divisions of a triangle's edges for none to be longer than `largest`.
fn divisions(scene: &CompiledScene, triangle: u32, largest: f32) -> u32 {
    let Some([a, b, c]) = scene.primitives().vertices(triangle) else { return 1 };
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    if largest.is_nan() || largest <= 0.0 || longest.is_nan() || longest <= largest {
        return 1;
    }
    (math::ceil(longest / largest) as u32).clamp(1, DIVISIONS_MAX)
}

/// Slivers with the triangle whose element they count for: of those that share a vertex the largest that faces alike, or the largest at all.
/// Slivers that meet slivers alone keep their element.
fn hosts_of_slivers(scene: &CompiledScene, areas: &[f32]) -> BTreeMap<u32, u32> {
    let mean = areas.iter().map(|a| f64::from(*a)).sum::<f64>() / areas.len().max(1) as f64;
    let small = |t: u32| f64::from(areas[t as usize]) <= SLIVER * mean;
    let slivers: Vec<u32> = (0..areas.len() as u32).filter(|t| small(*t)).collect();
    if slivers.is_empty() {
        return BTreeMap::new();
    }
    let key = |p: u32| {
        let p = Vec3::from_array(scene.positions.get(p as usize).copied().unwrap_or([f32::NAN; 3]));
        (p + Vec3::ZERO).to_array().map(f32::to_bits)
    };
    let mut around: BTreeMap<[u32; 3], Vec<u32>> = BTreeMap::new();
    for t in &slivers {
        for p in scene.triangles[*t as usize] {
            around.insert(key(p), Vec::new());
        }
    }
    for t in (0..areas.len() as u32).filter(|t| !small(*t)) {
        for p in scene.triangles[t as usize] {
            if let Some(list) = around.get_mut(&key(p)) {
                list.push(t);
            }
        }
    }
    let normal = |t: u32| Vec3::from_array(scene.surfaces[t as usize].normal);
    let mut hosts = BTreeMap::new();
    for t in slivers {
        let neighbours =
            scene.triangles[t as usize].into_iter().flat_map(|p| around[&key(p)].iter().copied());
        let rank = |h: &u32| (normal(*h).dot(normal(t)).abs() > 0.5, areas[*h as usize]);
        let best = neighbours.max_by(|a, b| {
            let (a, b) = ((rank(a), core::cmp::Reverse(*a)), (rank(b), core::cmp::Reverse(*b)));
            a.partial_cmp(&b).unwrap_or(core::cmp::Ordering::Equal)
        });
        if let Some(host) = best {
            hosts.insert(t, host);
        }
    }
    hosts
}

/// A place on an element and the normal of its side: the centroid of a part, or a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementPlace {
    /// Where \[m\].
    pub position: Vec3,
    /// Unit normal of the side; zero for spheres, which have none in the mean.
    pub normal: Vec3,
}

impl Elements {
    /// A point of an element of the constant basis from two numbers in [0, 1), and the unit normal of its side; `None` for the linear basis, round shapes and elements
    /// beyond the last. Uniform but for slivers that count for the element.
    pub fn point_on(&self, scene: &CompiledScene, element: usize, u: [f32; 2]) -> Option<(Vec3, Vec3)> {
        if self.settings.basis == Basis::Linear || element >= self.count() {
            return None;
        }
        let index = (element % self.areas.len()) as u32;
        // Slivers have no divisions of their own.
        let own =
            |p: &Place| p.divisions > 0 && p.first <= index && index < p.first + p.divisions * p.divisions;
        let primitive = self.places.iter().position(own)? as u32;
        let [b1, b2] = self.bary_on(primitive, element as u32, u);
        let n = Vec3::from_array(scene.surfaces[primitive as usize].normal);
        let v = scene.primitives().vertices(primitive)?;
        Some((position(v, b1, b2), if self.is_back(element as u32) { -n } else { n }))
    }

    /// Whether an element is of the back side of its surface.
    #[inline]
    pub fn is_back(&self, element: u32) -> bool {
        element as usize >= self.areas.len()
    }

    /// Barycentrics of vertices 1 and 2 on a triangle of a point of one of its elements (of either side) of the constant basis, from two numbers in [0, 1). Elements that are not
    /// the triangle's count as its first.
    #[inline]
    pub fn bary_on(&self, primitive: u32, element: u32, u: [f32; 2]) -> [f32; 2] {
        let [_, l1, l2] = crate::sampling::warp::sample_triangle(u);
        self.in_cell(primitive, self.cell_of(primitive, element), [l1, l2])
    }

    #[inline]
    fn cell_of(&self, primitive: u32, element: u32) -> u32 {
        let first = self.places.get(primitive as usize).map_or(0, |p| p.first);
        let index = if self.is_back(element) { element - self.areas.len() as u32 } else { element };
        index.checked_sub(first).filter(|c| *c < self.cells(primitive)).unwrap_or(0)
    }

    /// Corners of one of a triangle's elements (of either side) of the constant basis, as barycentrics of the triangle's vertices 1 and 2, in the triangle's own turn. Elements that
    /// are not the triangle's count as its first.
    pub fn corners_on(&self, primitive: u32, element: u32) -> [[f32; 2]; 3] {
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
            .map(|local| self.in_cell(primitive, self.cell_of(primitive, element), local))
    }

    /// The triangle of each element of one side, slivers that count for another's element aside; [`NO_INDEX`](crate::scene::NO_INDEX) for those of round shapes and under the linear basis.
    pub fn owners(&self) -> Vec<u32> {
        let mut owners = alloc::vec![crate::scene::NO_INDEX; self.areas.len()];
        if self.settings.basis == Basis::Linear {
            return owners;
        }
        for (t, place) in self.places.iter().enumerate().filter(|(_, p)| p.divisions > 0) {
            let parts = (place.divisions * place.divisions) as usize;
            owners[place.first as usize..][..parts].fill(t as u32);
        }
        owners
    }

    /// Where each element is, in the order of elements.
    pub fn element_places(&self, scene: &CompiledScene) -> Vec<ElementPlace> {
        let mut places =
            alloc::vec![ElementPlace { position: Vec3::ZERO, normal: Vec3::ZERO }; self.areas.len()];
        let mut largest = alloc::vec![-1.0_f32; self.areas.len()];
        for (t, place) in self.places.iter().enumerate() {
            let Some(v) = scene.primitives().vertices(t as u32) else {
                if let Some(shape) = scene.primitives().shape(t as u32) {
                    let (position, normal) = (Vec3::from_array(shape.center), Vec3::from_array(shape.normal));
                    places[place.first as usize] = ElementPlace { position, normal };
                }
                continue;
            };
            let normal = Vec3::from_array(scene.surfaces[t].normal);
            let area = triangle_area(v);
            let barys: Vec<[f32; 2]> = lattice::point_barys(place.divisions.max(1)).collect();
            let mut set = |element: u32, position: Vec3| {
                // Of all that count for an element the largest says where it is.
                if area > largest[element as usize] {
                    largest[element as usize] = area;
                    places[element as usize] = ElementPlace { position, normal };
                }
            };
            match self.settings.basis {
                Basis::Constant => {
                    for (k, corners) in lattice::cells(place.divisions.max(1)).enumerate() {
                        let at = corners.map(|c| barys[c as usize]);
                        let [b1, b2] = [0, 1].map(|k| (at[0][k] + at[1][k] + at[2][k]) / 3.0);
                        set(place.first + k as u32, position(v, b1, b2));
                    }
                }
                Basis::Linear => {
                    for (k, [b1, b2]) in barys.into_iter().enumerate() {
                        set(self.nodes[place.first as usize + k], position(v, b1, b2));
                    }
                }
            }
        }
        if self.settings.sides == Sides::Apart {
            let backs: Vec<_> = places.iter().map(|p| ElementPlace { normal: -p.normal, ..*p }).collect();
            places.extend(backs);
        }
        places
    }
}
