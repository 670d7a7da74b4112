//! Weights of strategies that could have made the same path, by ratios of their densities.
//!
//! A path of k edges has vertices x_0 (on the light) to x_k (the sensor's). Strategy s takes the first s of them from the light and the rest from the sensor. Its density is
//! p_s = Pi_{i < s} l_i Pi_{i >= s} e_i, l_i the density per area (in media per volume) of x_i as the light's walk draws it and e_i as the sensor's does, both with the chance to fly as far. So
//! p_{s-1} / p_s = e_{s-1} / l_{s-1}: a product of ratios walks from any strategy to any other. What is summed is a power of them (Veach 1997, eq. 8.12 and section 10.2).
//!
//! A scattering by a mirror or a smooth boundary has no density: its delta stands in both l and e and counts as 1, and strategies that would connect to it are closed.
//! Only what a vertex and the one before it say enters, so the sums are carried along both walks and each weight takes a few operations, however long the path is.

/// How strategies share a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Heuristic {
    /// p_s^2 / sum p_i^2.
    #[default]
    Power,
    /// p_s / sum p_i.
    Balance,
    /// p_s / sum p_i over the strategies of at least this part of the largest density; 0 below it.
    Cutoff(f32),
}

/// Part of the largest density below which the cutoff heuristic leaves a strategy out (Veach 1997, section 9.2.3).
pub const CUTOFF: f32 = 0.1;

/// Largest sum of ratios: beyond it a weight is nothing.
const SUM_MAX: f32 = 1e36;
/// Largest ratio.
const RATIO_MAX: f32 = 1e18;

/// Nothing infinite, and nothing that is no number.
#[inline(always)]
fn at_most(x: f32, most: f32) -> f32 {
    if x < most { x } else { most }
}

impl Heuristic {
    /// The power of a ratio that is summed.
    #[inline(always)]
    pub(super) fn of(self, ratio: f32) -> f32 {
        let ratio = at_most(ratio, RATIO_MAX);
        if self == Self::Power { ratio * ratio } else { ratio }
    }
}

/// What a weight needs to know of a vertex and those before it on the same walk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Chain {
    /// Density of the vertex as its walk drew it, per area or volume (per solid angle at infinity).
    pub pdf: f32,
    /// What the density of a direction back from here is multiplied by for the density of the vertex before, over that vertex's `pdf`.
    pub back: f32,
    /// The strategy that leaves this vertex to the other walk, as far as it depends on the one before: 0 where that one scatters without a density; else 1, or for the
    /// vertex next to a light how much likelier light sampling draws the place on it than emission does.
    pub open: f32,
    /// Sum over the strategies that leave the vertex before this one to the other walk, and more; over that which leaves just this one.
    pub sum: f32,
}

impl Chain {
    /// The vertex after this one.
    ///
    /// `left`: densities of the direction it was left by, and of the direction back, given that; `None` without a density. `here` and `there`: what turns a density of directions at
    /// the other end into one of the vertex: cosine (or extinction) over the squared distance, times the chance to fly as far.
    #[inline(always)]
    pub(super) fn next(&self, heuristic: Heuristic, left: Option<[f32; 2]>, here: f32, there: f32) -> Self {
        let [forward, backward] = left.unwrap_or([1.0; 2]);
        let before = heuristic.of(backward * self.back) * self.sum;
        let opens = left.is_some();
        Self {
            pdf: forward * there,
            back: at_most(here / self.pdf, RATIO_MAX),
            open: if opens { 1.0 } else { 0.0 },
            sum: at_most(if opens { heuristic.of(self.open) + before } else { before }, SUM_MAX),
        }
    }

    /// Sum over all strategies that leave this vertex to the other walk, over that which leaves it none.
    /// `forward`: density of the vertex as the other walk would draw it; `backward`: density of the direction back from here if light came from there.
    #[inline(always)]
    pub(super) fn others(&self, heuristic: Heuristic, forward: f32, backward: f32) -> f32 {
        let inner = heuristic.of(self.open) + heuristic.of(backward * self.back) * self.sum;
        at_most(heuristic.of(forward / self.pdf) * inner, SUM_MAX)
    }
}

/// Most vertices of one walk. A walk survives a scattering with a chance of at most 0.95, so that one in 10^11 would be longer; it ends here.
pub const VERTICES_MAX: usize = 512;

/// What the cutoff heuristic has to know of a walk: it lists all strategies. Other heuristics leave it empty.
#[derive(Clone, Copy, Debug)]
pub(super) struct Links {
    /// Of vertex i: its density as the other walk would draw it over its own, known once the second vertex after it is.
    ratio: [f32; VERTICES_MAX],
    /// Of vertex i: [`Chain::open`], or 0 where it scatters without a density.
    open: [f32; VERTICES_MAX],
}

impl Links {
    pub(super) const EMPTY: Self = Self { ratio: [0.0; VERTICES_MAX], open: [0.0; VERTICES_MAX] };

    /// Notes how vertex `index` was left (see [`Chain::next`]).
    pub(super) fn leave(&mut self, index: usize, chain: &Chain, left: Option<[f32; 2]>) {
        let backward = left.map_or(1.0, |l| l[1]);
        if index > 0 {
            self.ratio[index - 1] = at_most(backward * chain.back, RATIO_MAX);
        }
        self.open[index] = if left.is_some() { chain.open } else { 0.0 };
    }
}

/// One end of a connection.
pub(super) struct End<'a> {
    pub chain: &'a Chain,
    /// See [`Chain::others`].
    pub forward: f32,
    pub backward: f32,
    /// Number of the vertex in its walk, and that walk.
    pub index: usize,
    pub links: &'a Links,
}

impl End<'_> {
    /// Calls `each` with the relative density of each strategy that leaves vertices of this walk to the other. `pass`: chance to fly along the connection.
    fn list(&self, pass: f32, each: &mut impl FnMut(f32)) {
        let mut product = at_most(self.forward / self.chain.pdf, RATIO_MAX) * pass;
        each(product * self.chain.open);
        for i in (0..self.index).rev() {
            let last = i + 1 == self.index;
            product *=
                if last { at_most(self.backward * self.chain.back, RATIO_MAX) } else { self.links.ratio[i] };
            product = at_most(product, SUM_MAX);
            each(product * self.links.open[i]);
        }
    }
}

/// Weight of a strategy; `pass` is the chance to fly along its connection.
#[inline(always)]
pub(super) fn weigh(heuristic: Heuristic, pass: f32, ends: [Option<End<'_>>; 2]) -> f32 {
    if let Heuristic::Cutoff(part) = heuristic {
        return list_and_weigh(part, pass, &ends);
    }
    let others = ends.iter().flatten().map(|e| e.chain.others(heuristic, e.forward, e.backward));
    let sum: f32 = others.sum();
    1.0 / (1.0 + heuristic.of(pass) * sum)
}

/// See [`Heuristic::Cutoff`].
fn list_and_weigh(part: f32, pass: f32, ends: &[Option<End<'_>>; 2]) -> f32 {
    let (mut largest, mut sum) = (1.0_f32, 1.0);
    ends.iter().flatten().for_each(|e| e.list(pass, &mut |p| largest = largest.max(p)));
    let least = part * largest;
    if least > 1.0 {
        return 0.0;
    }
    ends.iter().flatten().for_each(|e| e.list(pass, &mut |p| sum += if p >= least { p } else { 0.0 }));
    1.0 / sum
}
