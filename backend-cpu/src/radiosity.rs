//! Patches and form factors over a pool of threads, and relighting in wide registers.
//!
//! A bake has parts that no device is faster at, or that take little of its time ([`Radiosity`]): backends with a device run them here.

use crate::linear::Linear;
use crate::simd::widest;
use crate::stripes;
use crate::tree::Tree;
#[cfg(doc)]
use etendue_core::backend::Session;
use etendue_core::backend::{BackendError, Control, FormFactorJob};
use etendue_core::geometry::Intersector;
use etendue_core::illumination::{Clustering, Elements};
use etendue_core::radiosity::form_factors::near::{self, NearPair, NearSettings};
use etendue_core::radiosity::form_factors::reach::{self, From, Walks};
use etendue_core::radiosity::form_factors::{Row, rays};
use etendue_core::radiosity::patches::{PatchMap, PatchSettings, Patches};
use etendue_core::radiosity::relight::{Products, Symmetric};
use etendue_core::radiosity::tiles::{
    self, Curve, Kind, Planes, RateCurves, SIDE, STRIPE_ROWS, Scratch, TileError, Tiles, add_columns,
    tile_rows,
};
use etendue_core::radiosity::transfer::{self, PatchGrid, Transfer};
use etendue_core::sampling::numbers::Numbers;
use etendue_core::scene::{CompiledScene, NO_INDEX};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Walks for each element, and the least and most of all.
const WALKS_PER_ELEMENT: u64 = 4;
const WALKS: [u64; 2] = [1 << 14, 1 << 21];
/// Walks from inside of which so few leave have found a crack: what is outside is not lit through it.
const CRACK: f64 = 1.0 / 256.0;
/// A surface so near before another, in sides of an element, covers it.
const NEAR: f32 = 0.5;
/// Walks of one task.
const TASK: u32 = 1 << 10;
/// Replicate of the walks from infinity; that of the others is 0.
const FROM_INFINITY: u32 = 1;
/// Replicate of what looks around itself.
const LOOK: u32 = 2;

widest! {
    /// Walks of a range; how many left the scene.
    fn walks(ground: (&CompiledScene, &Tree, &Elements), from: From, numbers: &Numbers, range: std::ops::Range<u32>, reached: &[AtomicBool]) -> u32 {
        let (scene, tree, elements) = ground;
        let mut left = 0;
        for i in range {
            left += u32::from(reach::walk(scene, tree, elements, from, &numbers.with_index(i), |element| {
                reached[element as usize].store(true, Ordering::Relaxed);
            }));
        }
        left
    }
}

widest! {
    fn look(ground: (&CompiledScene, &Tree, &Elements), place: (u32, u32), numbers: &Numbers, met: &[bool]) -> [u32; 3] {
        let (scene, tree, elements) = ground;
        reach::look(scene, tree, elements, place, numbers, |e| met[e as usize])
    }
}

/// Who takes walks: each element side that one meets is marked, and those that leave the scene are counted.
pub type Walker<'a> = &'a dyn Fn(&Walks, &[AtomicBool]) -> Result<u32, BackendError>;

/// The element sides that light can get to.
fn reached(
    linear: &Linear,
    (scene, tree): (&CompiledScene, &Tree),
    elements: &Elements,
    seed: u64,
    walker: Walker<'_>,
) -> Result<Vec<bool>, BackendError> {
    let reached: Vec<AtomicBool> = (0..elements.count()).map(|_| AtomicBool::new(false)).collect();
    let count = (elements.count() as u64 * WALKS_PER_ELEMENT).clamp(WALKS[0], WALKS[1]) as u32;
    let run =
        |from: From, replicate: u32| walker(&Walks { from, numbers: (seed, replicate), count }, &reached);
    let inside = reach::has_inside(scene);
    let left = if inside { run(From::Inside, 0)? } else { 0 };
    // What leaves can come in the same way.
    let infinity = !inside || f64::from(left) > CRACK * f64::from(count) || reach::has_infinity(scene);
    if infinity {
        run(From::Infinity, FROM_INFINITY)?;
    }
    let met: Vec<bool> = reached.into_iter().map(AtomicBool::into_inner).collect();
    // Walks are few: what they have missed among what they met looks around itself.
    let near = Clustering::new(scene, elements).by_size(elements.settings().largest);
    let mut around = vec![false; near.count];
    for (element, cluster) in near.of.iter().enumerate() {
        if let Some(around) = around.get_mut(*cluster as usize) {
            *around |= met[element];
        }
    }
    let among = |element: usize| {
        near.of.get(element).is_some_and(|c| around.get(*c as usize).copied().unwrap_or(false))
    };
    let (owners, numbers) = (elements.owners(), Numbers::sobol(seed, LOOK));
    let reached = linear.install(|| {
        (0..met.len())
            .into_par_iter()
            .map(|element| {
                if met[element] || !(infinity || among(element)) {
                    return met[element];
                }
                let place = (element as u32, owners[element % owners.len()]);
                let numbers = numbers.with_index(element as u32);
                let [known, other, sky] = look((scene, tree, elements), place, &numbers, &met);
                (infinity && sky > 0) || (among(element) && known > other)
            })
            .collect()
    });
    Ok(reached)
}

/// The patches of a scene, of what was reached.
fn patches(
    linear: &Linear,
    (scene, tree): (&CompiledScene, &Tree),
    elements: Arc<Elements>,
    settings: &PatchSettings,
    reached: &[bool],
) -> PatchMap {
    let clustering = Clustering::new(scene, &elements);
    let clustering = clustering.retain(|element| reached[element]);
    let near = NEAR * elements.settings().largest;
    // Primitives of all elements, once: each element asks for one.
    let owners = elements.owners();
    let kind = |(element, place): (usize, _)| {
        let primitive = owners.get(element % owners.len().max(1)).copied().unwrap_or(NO_INDEX);
        reach::kind(scene, tree, &elements, (element as u32, primitive, place), near)
    };
    let kinds: Vec<u8> = linear.install(|| clustering.places().par_iter().enumerate().map(kind).collect());
    let clusters = clustering.apart(kinds).by_count(settings.count as usize);
    let patches = Patches::new(scene, &elements, &clusters);
    PatchMap { elements, patches }
}

widest! {
    fn trace(ground: (&CompiledScene, &Tree, &PatchMap), patch: usize, rays: (u64, u32), counts: &mut [u32]) -> Row {
        let (scene, tree, map) = ground;
        rays::trace(scene, tree, &map.elements, &map.patches, patch, rays, counts)
    }
}

widest! {
    fn near_pair(ground: (&CompiledScene, &Tree, &PatchMap), pair: [u32; 2], settings: &NearSettings) -> NearPair {
        let (scene, tree, map) = ground;
        near::measure(scene, tree, (&map.elements, &map.patches), pair, settings)
    }
}

widest! {
    fn curve_row(symmetric: &Symmetric<'_>, row: usize) -> Vec<Curve> {
        tiles::curve_row(symmetric.len(), row, |i, j| symmetric.entry(i, j))
    }
}

widest! {
    fn encode_row(symmetric: &Symmetric<'_>, row: usize, want: &(dyn Fn(usize, usize) -> Kind + Sync)) -> (Vec<u8>, Vec<u8>) {
        tiles::encode_row(symmetric.len(), row, |column| want(row, column), |i, j| symmetric.entry(i, j))
    }
}

/// What of a bake runs on threads: all of it but relighting, which is [`Linear`]'s.
#[derive(Clone, Debug, Default)]
pub struct Radiosity {
    linear: Linear,
}

/// A job in many parts over the pool's threads, in order; where the control cancels, the rest of them are left out.
fn in_parts<T: Send, R: Send + Default>(
    linear: &Linear,
    parts: impl IndexedParallelIterator<Item = T>,
    control: &dyn Control,
    room: impl Fn() -> Vec<u32> + Sync + Send,
    part: impl Fn(&mut Vec<u32>, T) -> R + Sync + Send,
) -> Result<Vec<R>, BackendError> {
    let (done, stopped) = (AtomicU64::new(0), AtomicBool::new(false));
    let all = parts.len() as u64;
    let run = |room: &mut Vec<u32>, given: T| {
        if stopped.load(Ordering::Relaxed) {
            return R::default();
        }
        let found = part(room, given);
        if control.advance(done.fetch_add(1, Ordering::Relaxed) + 1, all).is_break() {
            stopped.store(true, Ordering::Relaxed);
        }
        found
    };
    let found = linear.install(|| parts.map_init(room, run).collect());
    if stopped.into_inner() { Err(BackendError::Cancelled) } else { Ok(found) }
}

impl Radiosity {
    /// On the threads of `linear`.
    pub fn on(linear: Linear) -> Self {
        Self { linear }
    }

    /// The patches of a scene; `elements` are those of [`PatchSettings::elements`]. See [`Session::patches`].
    ///
    /// # Errors
    /// [`BackendError::SceneNeeds`] where surfaces are not all diffuse triangles.
    pub fn patches(
        &self,
        (scene, tree): (&CompiledScene, &Tree),
        elements: Arc<Elements>,
        settings: &PatchSettings,
    ) -> Result<PatchMap, BackendError> {
        let walker =
            |of: &Walks, reached: &[AtomicBool]| Ok(self.walk((scene, tree, &elements), of, reached));
        self.patches_by((scene, tree), elements.clone(), settings, &walker)
    }

    /// The same with somebody else to take the walks that find what light can get to: most rays of patches are theirs. `walker` marks each element side that one meets and
    /// says how many left the scene.
    ///
    /// # Errors
    /// As [`Self::patches`], and the walker's.
    pub fn patches_by(
        &self,
        (scene, tree): (&CompiledScene, &Tree),
        elements: Arc<Elements>,
        settings: &PatchSettings,
        walker: Walker<'_>,
    ) -> Result<PatchMap, BackendError> {
        BackendError::unless_covered("radiosity", beyond_patches(scene))?;
        let reached = reached(&self.linear, (scene, tree), &elements, settings.seed, walker)?;
        Ok(patches(&self.linear, (scene, tree), elements, settings, &reached))
    }

    /// Takes walks and marks each element side that one meets; how many left the scene.
    pub fn walk(
        &self,
        ground: (&CompiledScene, &Tree, &Elements),
        of: &Walks,
        reached: &[AtomicBool],
    ) -> u32 {
        let numbers = Numbers::sobol(of.numbers.0, of.numbers.1);
        let task = |t: u32| walks(ground, of.from, &numbers, t * TASK..of.count.min((t + 1) * TASK), reached);
        self.linear.install(|| (0..of.count.div_ceil(TASK)).into_par_iter().map(task).sum())
    }

    /// The rows of a job. See [`Session::form_factors`].
    ///
    /// # Errors
    /// [`BackendError::Cancelled`].
    pub fn form_factors(
        &self,
        (scene, tree): (&CompiledScene, &Tree),
        map: &PatchMap,
        job: &FormFactorJob,
        control: &dyn Control,
    ) -> Result<Vec<Row>, BackendError> {
        let n = map.patches.len();
        let shares = rays::shares(&map.patches, job.rays);
        let end = (job.patches.end as usize).min(n);
        let patches = ((job.patches.start as usize).min(end)..end).into_par_iter().with_max_len(16);
        let part = |counts: &mut Vec<u32>, patch: usize| {
            trace((scene, tree, map), patch, (job.seed, shares[patch]), counts)
        };
        in_parts(&self.linear, patches, control, || vec![0_u32; n], part)
    }

    /// Form factors of pairs. See [`Session::near_form_factors`].
    ///
    /// # Errors
    /// [`BackendError::Cancelled`].
    pub fn near_form_factors(
        &self,
        (scene, tree): (&CompiledScene, &Tree),
        map: &PatchMap,
        pairs: &[[u32; 2]],
        settings: &NearSettings,
        control: &dyn Control,
    ) -> Result<Vec<NearPair>, BackendError> {
        let part = |_: &mut Vec<u32>, pair: &[u32; 2]| near_pair((scene, tree, map), *pair, settings);
        in_parts(&self.linear, pairs.par_iter(), control, Vec::new, part)
    }

    /// Weights of patches for all elements. See [`Session::transfer`].
    pub fn transfer(&self, (scene, tree): (&CompiledScene, &Tree), map: &PatchMap) -> Transfer {
        let (grid, places) = (PatchGrid::new(map), transfer::places(scene, map));
        let lists = self.linear.install(|| {
            (0..map.elements.count())
                .into_par_iter()
                .map(|element| match Transfer::place(map, &places, element) {
                    Some(place) => grid.weights(map, place, |ray| tree.occluded(ray)),
                    None => Vec::new(),
                })
                .collect()
        });
        Transfer::new(lists)
    }

    /// What tiles lose. See [`Session::rate_curves`].
    pub fn rate_curves(&self, symmetric: &Symmetric<'_>) -> RateCurves {
        let rows = (0..tile_rows(symmetric.len())).into_par_iter().with_max_len(8);
        RateCurves::new(self.linear.install(|| rows.map(|row| curve_row(symmetric, row)).collect()))
    }

    /// Tiles of the kinds wanted. See [`Session::tiles`].
    ///
    /// # Errors
    /// Too many patches.
    pub fn tiles(
        &self,
        symmetric: &Symmetric<'_>,
        want: &(dyn Fn(usize, usize) -> Kind + Sync),
    ) -> Result<Tiles, TileError> {
        let rows = (0..tile_rows(symmetric.len())).into_par_iter().with_max_len(8);
        let rows: Vec<_> = self.linear.install(|| rows.map(|row| encode_row(symmetric, row, want)).collect());
        tiles::join_rows(symmetric.len(), rows)
    }

    /// What products and blocks are made with.
    pub fn linear(&self) -> &Linear {
        &self.linear
    }
}

/// What a scene needs and patches do not have.
fn beyond_patches(scene: &CompiledScene) -> Option<String> {
    let needs = &scene.needs;
    needs.beyond_surfaces().or_else(|| {
        let list = [
            (needs.mirrors && !needs.plastic, "mirrors"),
            (needs.glossy, "Phong lobes"),
            (needs.rough, "rough metals"),
            (needs.plastic, "plastic"),
            (needs.round_shapes, "spheres and disks"),
            (needs.environment_image, "a picture of the environment"),
        ];
        list.into_iter().find(|l| l.0).map(|l| l.1.into())
    })
}

widest! {
    sixteen:
    fn stripe[const C: usize](tiles: &Tiles, first: usize, x: &[Planes<C>], y: &mut [Planes<C>], columns: &mut [Planes<C>]) {
        columns.as_flattened_mut().as_flattened_mut().fill(0.0);
        tiles.stripe(first, x, y, columns);
    }
}

widest! {
    fn add[const C: usize](y: &mut [Planes<C>], columns: &[Planes<C>]) {
        add_columns(y, columns);
    }
}

impl Products for Linear {
    fn apply<const C: usize>(
        &self,
        tiles: &Tiles,
        x: &[Planes<C>],
        y: &mut [Planes<C>],
        scratch: &mut Scratch<C>,
    ) {
        let rows = tile_rows(tiles.len()).min(y.len());
        let work = |first: usize, y: &mut [Planes<C>], columns: &mut [Planes<C>]| {
            stripe(tiles, first, x, y, columns);
        };
        let room = (&mut y[..rows], &mut scratch.columns);
        stripes::half(self, (STRIPE_ROWS, [[0.0; SIDE]; C]), room, work, add::<C>);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::tests::MOST;
    use etendue_core::radiosity::tiles::{Rates, encode};
    use etendue_core::sampling::counter::Counter;

    #[test]
    fn registers_of_every_width_give_the_same_bits() {
        let (n, numbers) = (701, Counter::new(4));
        let entry = |i: usize, j: usize| {
            let u = numbers.unit(i as u32, j as u32, 0);
            if (i / 24 + j / 24).is_multiple_of(3) {
                0.0
            } else {
                u * u * u / (1 + (i / 8 + j / 8) % 5) as f32
            }
        };
        let rows = tile_rows(n);
        let x: Vec<Planes<3>> = (0..rows as u32)
            .map(|i| [0, 1, 2].map(|c| std::array::from_fn(|k| numbers.unit(i, 8 * c + k as u32, 1))))
            .collect();
        let mut kinds = vec![Rates::Cheapest { lambda: 1e-4 }, Rates::Cheapest { lambda: 1e-6 }];
        kinds.extend(Kind::ALL.map(Rates::Uniform));
        for rates in kinds {
            let tiles = encode(n, rates, entry).unwrap();
            let mut truth = vec![Planes::<3>::default(); rows];
            tiles.apply(&x, &mut truth, &mut Scratch::default());
            for most in [1, 8, 16] {
                for threads in [1, 2] {
                    MOST.set(most);
                    let mut y = vec![Planes::<3>::default(); rows];
                    let linear = Linear::new(Some(threads)).unwrap();
                    linear.apply(&tiles, &x, &mut y, &mut Scratch::default());
                    assert_eq!(y, truth, "{rates:?} {most} {threads}");
                    let red: Vec<Planes<1>> = x.iter().map(|x| [x[0]]).collect();
                    let mut one = vec![Planes::<1>::default(); rows];
                    linear.apply(&tiles, &red, &mut one, &mut Scratch::default());
                    assert!(one.iter().zip(&truth).all(|(one, all)| one[0] == all[0]), "{rates:?} {most}");
                }
            }
        }
        MOST.set(16);
    }
}
