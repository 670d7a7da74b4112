//! Light after any number of bounces, for new lights: what an operator is for.
//!
//! Unknowns are radiosities B \[W/m^2\] of n patches, B = B0 + R F B, with B0 = R E_direct + emission and R the albedos, which may be changed at any time. Wanted is the
//! indirect irradiance E = F B.
//!
//! Form factors come in [`Tiles`] of S = A^1/2 F A^-1/2, and one factor d per patch on both sides sets the sums of rows right that few bits have moved: F B = out S (in B) with
//! in = d A^1/2 and out = d A^-1/2.
//!
//! **Two levels.** A plain pass, B <- B0 + R F B, leaves a part of the error that falls with each pass by about the albedo only. Here each pass also solves for what is left on
//! clusters of eight patches, where the inverse is small enough to be known: with r = B0 + R F B - B,
//!
//! ```text
//! B <- B + r + R P Gc Q r,   Gc = Fc (I - Rc Fc)^-1,   Fc = Q F P,   Rc = Q R P
//! ```
//!
//! P gives a cluster's irradiance to its patches, to each in proportion to what it sees of others, w, the sum of its row of F; Q is the mean that belongs to it, with weights a w / Ac, Ac = sum of a w^2 (Q P = 1), and Rc the mean of R w.
//! (Alike to all, as in a closed room where w is 1, total light is five times as far off in open scenes.) The first B is B0 + R P Gc Q B0, which needs no pass and takes a third of the error away. Each pass gives E = F B + P Gc Q r, the clusters' share of all that was still to come.
//! What clusters cannot hold of r, (1 - P Q) r, goes once more through the few pairs of patches that see most of each other, F(i, j) F(j, i) > 0.05^2, and what clusters
//! cannot hold of that is added to E: light caught between surfaces near each other, of which a pass alone lets little out. The operator in front of r stays symmetric.
//! Where surfaces face each other closely a pass would overshoot, and makes only a part of its change ([`Relighter::damping`]).
//!
//! It is one fixed linear map of E_direct: no test of convergence, the same time for all lights.

mod coarse;
mod near;
mod passes;
#[cfg(test)]
mod tests;
mod view;
pub mod weights;

pub use coarse::{Coarse, CoarseError, CoarseParts};
pub use near::Pair;
pub use view::{CoarseView, View};

use super::form_factors::FormFactors;
use super::identity::Identity;
use super::operator::OperatorError;
pub use super::polynomial::Portable;

use super::polynomial::Multiply;
use super::tiles::{Planes, Rates, SIDE, Scratch, TileError, Tiles, encode, tile_rows};
use crate::backend::BackendError;
use crate::math;
use alloc::vec::Vec;
use core::fmt;
use near::Near;

/// Steps of balancing the sums of rows of tiles.
const BALANCE_STEPS: u32 = 16;
/// No factor of a patch leaves these.
const FACTORS: [f64; 2] = [0.5, 2.0];

/// Does the products; the bits are the same for each.
pub trait Products {
    /// y = S x; see [`Tiles::apply`].
    fn apply<const C: usize>(
        &self,
        tiles: &Tiles,
        x: &[Planes<C>],
        y: &mut [Planes<C>],
        scratch: &mut Scratch<C>,
    ) where
        Self: Sized;
}

impl Products for Portable {
    fn apply<const C: usize>(
        &self,
        tiles: &Tiles,
        x: &[Planes<C>],
        y: &mut [Planes<C>],
        scratch: &mut Scratch<C>,
    ) {
        tiles.apply(x, y, scratch);
    }
}

/// Why there is no operator, or no light of one.
#[derive(Clone, Debug, PartialEq)]
pub enum RelightError {
    /// Numbers per patch of another length.
    WrongLength {
        /// Which.
        slice: &'static str,
        /// Numbers found.
        found: usize,
        /// Patches.
        expected: usize,
    },
    /// A number out of its range.
    BadValue {
        /// Which.
        slice: &'static str,
        /// Patch.
        patch: usize,
        /// The number.
        value: f32,
    },
    /// Tiles that make no operator.
    Tiles(TileError),
    /// Clusters that have no inverse.
    Coarse(CoarseError),
    /// A backend that has no room for it, or whose device failed.
    Backend(BackendError),
}

impl fmt::Display for RelightError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WrongLength { slice, found, expected } => {
                write!(f, "{found} numbers of {slice}, expected {expected}")
            }
            Self::BadValue { slice, patch, value } => write!(f, "{slice} of patch {patch} is {value}"),
            Self::Tiles(e) => e.fmt(f),
            Self::Coarse(e) => e.fmt(f),
            Self::Backend(e) => e.fmt(f),
        }
    }
}

impl core::error::Error for RelightError {}

impl From<BackendError> for RelightError {
    fn from(e: BackendError) -> Self {
        Self::Backend(e)
    }
}

impl From<TileError> for RelightError {
    fn from(e: TileError) -> Self {
        Self::Tiles(e)
    }
}

impl From<OperatorError> for RelightError {
    fn from(e: OperatorError) -> Self {
        Self::Coarse(CoarseError::Operator(e))
    }
}

/// What relights: form factors in tiles, and what else a pass needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Relighter {
    tiles: Tiles,
    areas: Vec<f32>,
    /// d per patch.
    factors: Vec<f32>,
    into: Vec<[f32; SIDE]>,
    out: Vec<[f32; SIDE]>,
    albedo: Vec<Planes<3>>,
    coarse: Option<Coarse>,
    near: Near,
    /// Weights of passes; see [`weights`].
    weights: Vec<f32>,
    /// What part of its change a pass makes: less than 1 where it would overshoot.
    damping: f32,
    identity: Identity,
}

/// Room for a relighting: none is asked for while it runs.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    start: Vec<Planes<3>>,
    radiosity: Vec<Planes<3>>,
    rest: Vec<Planes<3>>,
    last: Vec<Planes<3>>,
    sum: Vec<Planes<3>>,
    x: Vec<Planes<3>>,
    y: Vec<Planes<3>>,
    scratch: Scratch<3>,
    coarse: coarse::Room,
}

/// Numbers per patch in runs of eight, zeros beyond the last.
fn blocks(values: impl ExactSizeIterator<Item = f32>) -> Vec<[f32; SIDE]> {
    let mut blocks = alloc::vec![[0.0; SIDE]; tile_rows(values.len())];
    for (i, x) in values.enumerate() {
        blocks[i / SIDE][i % SIDE] = x;
    }
    blocks
}

/// The same for three channels.
fn planes(values: &[[f32; 3]]) -> Vec<Planes<3>> {
    let mut planes = alloc::vec![Planes::<3>::default(); tile_rows(values.len())];
    fill(&mut planes, values);
    planes
}

fn fill(planes: &mut [Planes<3>], values: &[[f32; 3]]) {
    for (i, value) in values.iter().enumerate() {
        for c in 0..3 {
            planes[i / SIDE][c][i % SIDE] = value[c];
        }
    }
}

/// Adds what clusters give to their patches: P, by runs of eight.
fn add_sent(y: &mut [Planes<3>], sent: &[Planes<3>], spread: &[[f32; SIDE]]) {
    for (row, (y, spread)) in y.iter_mut().zip(spread).enumerate() {
        for (y, sent) in y.iter_mut().zip(&sent[row / SIDE]) {
            let e = sent[row % SIDE];
            for k in 0..SIDE {
                y[k] += spread[k] * e;
            }
        }
    }
}

fn check_len(slice: &'static str, found: usize, expected: usize) -> Result<(), RelightError> {
    if found == expected { Ok(()) } else { Err(RelightError::WrongLength { slice, found, expected }) }
}

fn check(slice: &'static str, values: &[[f32; 3]], good: impl Fn(f32) -> bool) -> Result<(), RelightError> {
    match values.as_flattened().iter().position(|x| !good(*x)) {
        Some(at) => Err(RelightError::BadValue { slice, patch: at / 3, value: values.as_flattened()[at] }),
        None => Ok(()),
    }
}

/// S of form factors: what tiles store.
#[derive(Clone, Debug)]
pub struct Symmetric<'a> {
    form_factors: &'a FormFactors,
    roots: Vec<f64>,
}

impl<'a> Symmetric<'a> {
    /// Of these form factors.
    pub fn new(form_factors: &'a FormFactors) -> Self {
        let roots = form_factors.areas.iter().map(|a| 1.0 / math::sqrt64(f64::from(*a))).collect();
        Self { form_factors, roots }
    }

    /// How many patches there are.
    pub fn len(&self) -> usize {
        self.roots.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.roots.is_empty()
    }

    /// S(i, j).
    #[inline(always)]
    pub fn entry(&self, i: usize, j: usize) -> f32 {
        (f64::from(self.form_factors.flux(i, j)) * (self.roots[i] * self.roots[j])) as f32
    }
}

impl Relighter {
    /// Encodes form factors, whose patches must be in an order of their own ([`super::order::kd`]); see [`Self::new`] for the rest.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn encode(
        form_factors: &FormFactors,
        albedo: &[[f32; 3]],
        rates: Rates,
    ) -> Result<Self, RelightError> {
        let symmetric = Symmetric::new(form_factors);
        let tiles = encode(form_factors.len(), rates, |i, j| symmetric.entry(i, j))?;
        Self::of(form_factors, albedo, tiles)
    }

    /// From tiles of these form factors.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of(form_factors: &FormFactors, albedo: &[[f32; 3]], tiles: Tiles) -> Result<Self, RelightError> {
        let factors = energy(&tiles, &form_factors.areas, &form_factors.row_sums());
        Self::new(tiles, form_factors.areas.clone(), factors, albedo)
    }

    /// From tiles of S, areas \[m^2\], a factor per patch ([`energy`]) and albedos in \[0, 1\]. Without clusters until [`Self::with_coarse`].
    ///
    /// # Errors
    /// [`RelightError`].
    pub fn new(
        tiles: Tiles,
        areas: Vec<f32>,
        factors: Vec<f32>,
        albedo: &[[f32; 3]],
    ) -> Result<Self, RelightError> {
        let n = tiles.len();
        check_len("areas", areas.len(), n)?;
        check_len("factors", factors.len(), n)?;
        check_len("albedo", albedo.len(), n)?;
        for (slice, values) in [("area", &areas), ("factor", &factors)] {
            if let Some(patch) = values.iter().position(|x| !x.is_finite() || *x <= 0.0) {
                return Err(RelightError::BadValue { slice, patch, value: values[patch] });
            }
        }
        check("albedo", albedo, |x| (0.0..=1.0).contains(&x))?;
        let roots: Vec<f32> = areas.iter().map(|a| math::sqrt(*a)).collect();
        let into = blocks(roots.iter().zip(&factors).map(|(r, d)| d * r));
        let out = blocks(roots.iter().zip(&factors).map(|(r, d)| d / r));
        Ok(Self {
            tiles,
            areas,
            factors,
            into,
            out,
            albedo: planes(albedo),
            coarse: None,
            near: Near::default(),
            weights: Vec::new(),
            damping: 1.0,
            identity: Identity::fresh(),
        })
    }

    /// With the second level, its inverse in tiles of these rates.
    ///
    /// # Errors
    /// When light does not die out between clusters: all closed in and white.
    pub fn with_coarse<M: Multiply + Products>(
        mut self,
        multiply: &M,
        rates: Rates,
    ) -> Result<Self, RelightError> {
        self.identity = Identity::fresh();
        let albedo = self.albedo_list();
        let spread = self.row_sums();
        let clusters = self.clusters(&spread);
        self.coarse = Some(Coarse::new(multiply, &clusters, (&self.areas, &spread), &albedo, rates)?);
        self.near = Near::of(&self);
        Ok(self.settled(multiply))
    }

    /// With the second level of another relighter of the same patches, in tiles of these rates: that of form factors in more bits serves these as well.
    ///
    /// # Errors
    /// Another number of patches.
    pub fn with_coarse_of(mut self, other: &Self, rates: Rates) -> Result<Self, RelightError> {
        check_len("patches", other.len(), self.len())?;
        self.identity = Identity::fresh();
        self.coarse = other.coarse.as_ref().map(|c| c.encoded(rates)).transpose()?;
        self.near = if self.coarse.is_some() { Near::of(&self) } else { Near::default() };
        self.damping = other.damping;
        Ok(self)
    }

    /// With weights for as many passes as there are weights ([`weights::fit`]); relighting in another number of passes weights none. They fit
    /// albedos not far from those they were found for.
    ///
    /// # Errors
    /// A weight that is not finite.
    pub fn with_weights(mut self, weights: Vec<f32>) -> Result<Self, RelightError> {
        if let Some(patch) = weights.iter().position(|w| !w.is_finite()) {
            return Err(RelightError::BadValue { slice: "weight", patch, value: weights[patch] });
        }
        self.identity = Identity::fresh();
        self.weights = weights;
        Ok(self)
    }

    /// Without the second level: plain bounces.
    #[must_use]
    pub fn without_coarse(mut self) -> Self {
        self.identity = Identity::fresh();
        self.coarse = None;
        self.near = Near::default();
        self.damping = 1.0;
        self
    }

    /// With a second level that was made before; see [`Self::coarse_parts`].
    ///
    /// # Errors
    /// When its parts are not of as many clusters and patches as there are, or out of their range.
    pub fn with_coarse_parts(mut self, parts: CoarseParts) -> Result<Self, RelightError> {
        let CoarseParts { tiles, rates, spread, damping } = parts;
        if !(damping > 0.0 && damping <= 1.0) {
            return Err(RelightError::BadValue { slice: "damping", patch: 0, value: damping });
        }
        self.identity = Identity::fresh();
        self.coarse = Some(Coarse::from_tiles(tiles, (&self.areas, &spread), rates)?);
        self.near = Near::of(&self);
        self.damping = damping;
        Ok(self)
    }

    /// The second level, if there is one, as a file has it.
    pub fn coarse_parts(&self) -> Option<CoarseParts> {
        let coarse = self.coarse.as_ref()?;
        let spread = coarse.spread().as_flattened().iter().take(self.len()).copied().collect();
        Some(CoarseParts {
            tiles: coarse.tiles().clone(),
            rates: coarse.rates(),
            spread,
            damping: self.damping,
        })
    }

    /// Sums of rows of F as the tiles have it, as far as they are sums of shares: what a patch sees of others.
    fn row_sums(&self) -> Vec<f32> {
        let mut sums = alloc::vec![0.0_f64; self.len()];
        self.tiles.for_each(|i, j, s| {
            let flux = self.flux(i, j, s);
            sums[i] += flux;
            if i != j {
                sums[j] += flux;
            }
        });
        sums.iter().zip(&self.areas).map(|(sum, a)| math::min((sum / f64::from(*a)) as f32, 1.0)).collect()
    }

    /// A F(i, j) \[m^2\] of S(i, j).
    fn flux(&self, i: usize, j: usize, s: f32) -> f64 {
        f64::from(s) * f64::from(self.into[i / SIDE][i % SIDE]) * f64::from(self.into[j / SIDE][j % SIDE])
    }

    /// w A F w between runs of eight patches \[m^2\], as the tiles have it: lower half, packed.
    fn clusters(&self, spread: &[f32]) -> Vec<f64> {
        let m = tile_rows(self.len());
        let mut half = alloc::vec![0.0_f64; m * (m + 1) / 2];
        self.tiles.for_each(|i, j, s| {
            let flux = self.flux(i, j, s) * f64::from(spread[i]) * f64::from(spread[j]);
            let (row, column) = (i / SIDE, j / SIDE);
            // Both halves of a tile on the diagonal.
            let times = if row == column && i != j { 2.0 } else { 1.0 };
            half[row * (row + 1) / 2 + column] += times * flux;
        });
        half
    }

    /// The tiles.
    pub fn tiles(&self) -> &Tiles {
        &self.tiles
    }

    /// Areas \[m^2\].
    pub fn areas(&self) -> &[f32] {
        &self.areas
    }

    /// Factors of the patches.
    pub fn factors(&self) -> &[f32] {
        &self.factors
    }

    /// The second level, if there is one.
    pub fn coarse(&self) -> Option<&Coarse> {
        self.coarse.as_ref()
    }

    /// What part of its change a pass makes.
    pub fn damping(&self) -> f32 {
        self.damping
    }

    /// Weights of passes.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// How many patches there are.
    pub fn len(&self) -> usize {
        self.areas.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.areas.is_empty()
    }

    /// Albedos.
    pub fn albedo_list(&self) -> Vec<[f32; 3]> {
        (0..self.len()).map(|i| [0, 1, 2].map(|c| self.albedo[i / SIDE][c][i % SIDE])).collect()
    }

    /// Changes the albedos; the second level is made anew.
    ///
    /// # Errors
    /// A wrong number of them, or one that is not in \[0, 1\]; as [`Self::with_coarse`].
    pub fn set_albedo<M: Multiply + Products>(
        &mut self,
        multiply: &M,
        albedo: &[[f32; 3]],
    ) -> Result<(), RelightError> {
        check_len("albedo", albedo.len(), self.len())?;
        check("albedo", albedo, |x| (0.0..=1.0).contains(&x))?;
        self.identity = Identity::fresh();
        self.albedo = planes(albedo);
        if let Some(coarse) = &self.coarse {
            let rates = coarse.rates();
            let spread = self.row_sums();
            let clusters = self.clusters(&spread);
            self.coarse = Some(Coarse::new(multiply, &clusters, (&self.areas, &spread), albedo, rates)?);
            *self = self.clone().settled(multiply);
        }
        Ok(())
    }

    /// Bytes of everything a relighting reads: tiles, the clusters' inverses, a factor, an area and an albedo per patch.
    pub fn bytes(&self) -> usize {
        self.tiles.bytes()
            + self.coarse.as_ref().map_or(0, Coarse::bytes)
            + self.near.bytes()
            + self.len() * (4 + 4 + 12)
    }
}

/// A factor per patch for the sums of rows of F to be `targets`, as far as factors in \[1/2, 2\] can: what few bits lose of the energy is put back where it was lost.
pub fn energy(tiles: &Tiles, areas: &[f32], targets: &[f64]) -> Vec<f32> {
    let n = tiles.len().min(areas.len()).min(targets.len());
    let roots: Vec<f64> = areas.iter().map(|a| math::sqrt64(f64::from(*a))).collect();
    let mut factors = alloc::vec![1.0_f64; n];
    for _ in 0..BALANCE_STEPS {
        let mut sums = alloc::vec![0.0_f64; n];
        tiles.for_each(|i, j, s| {
            sums[i] += f64::from(s) * roots[j] * factors[j];
            if i != j {
                sums[j] += f64::from(s) * roots[i] * factors[i];
            }
        });
        for i in 0..n {
            let sum = factors[i] * sums[i] / roots[i];
            if sum > 0.0 && targets[i] > 0.0 {
                factors[i] = (factors[i] * math::sqrt64(targets[i] / sum)).clamp(FACTORS[0], FACTORS[1]);
            }
        }
    }
    factors.into_iter().map(|d| d as f32).collect()
}
