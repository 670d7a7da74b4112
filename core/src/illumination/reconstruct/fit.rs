//! One scale of a reconstruction: a plane through the elements of each cell, and how far each element follows it.
//!
//! Within a cell the irradiance of element j is taken to be b x_j + u_j: x_j is 1, the place (3) and the normal (3) about their means, u_j the
//! element's own departure of variance (r M)^2, M the cell's mean. Its mean over the replicates has noise of variance k b x_j / A_j besides, k the flux \[W\] of a
//! photon there, as photons arrive independently. The best linear unbiased prediction (Henderson 1975; Robinson 1991) is then
//! b x_j + g_j (y_j - b x_j), g_j = (r M)^2 / ((r M)^2 + noise_j), with b by generalised least squares, where slopes have a prior of mean 0.
//! r is found by the method of moments, per cell, pulled to that of all; the size of slopes from the slopes themselves.

use super::super::clusters::Clustering;
use crate::math::Vec3;
use alloc::vec::Vec;

/// Numbers of a plane: the mean, the slopes along the place and along the normal, and an idle one, as eight fill registers.
const TERMS: usize = 8;
/// Slopes among them.
const SLOPES: core::ops::Range<usize> = 1..7;
/// Rounds of weights, planes, departures.
const ROUNDS: usize = 3;
/// Photons of the power usual in the scene that each cell is given on top of its own, so that its noise is known where it saw few.
const USUAL_PHOTONS: f64 = 5.0;
/// Where departures and slopes start, as a share of the mean, squared.
const START: f64 = 0.05;
/// Standard deviation of r^2 between cells, over its mean: cells differ much.
const DEPARTURE_SPREAD: f64 = 6.0;
/// Least r^2 of a cell as a share of that of all: its own elements never prove that there is none.
const DEPARTURE_MIN: f64 = 0.02;
/// Least share of an element's variance that its plane leaves, to say anything of departures.
const FREE_MIN: f64 = 1e-6;
/// Least mean of r^2.
const MEAN_DEPARTURE_MIN: f64 = 1e-5;
/// Least variance of slopes, as a share of the mean's square.
const SLOPE_MIN: f64 = 1e-4;
/// Range of a plane over its cell's mean, for the noise.
const PLANE_RANGE: [f64; 2] = [0.2, 5.0];

/// One division of the elements into cells.
pub(super) struct Scale {
    /// Elements, cell by cell.
    order: Vec<u32>,
    /// Where each cell begins in `order`; and its end.
    starts: Vec<usize>,
    /// What the planes are taken over, per entry of `order`.
    rows: Vec<[f64; TERMS]>,
}

/// What one channel of a map holds, per element.
#[derive(Default)]
pub(super) struct Seen {
    /// Mean over the replicates \[W/m^2\].
    pub(super) mean: Vec<f64>,
    /// Variance of that mean \[W^2/m^4\].
    pub(super) variance: Vec<f64>,
}

/// Sizes of elements \[m^2\].
pub(super) struct Sizes {
    /// Area that flux is spread over.
    pub(super) area: Vec<f64>,
    /// Weight in means.
    pub(super) weight: Vec<f64>,
}

/// What a scale makes of one channel, per element.
#[derive(Clone, Default)]
pub(super) struct Fit {
    /// Irradiance \[W/m^2\].
    pub(super) value: Vec<f64>,
    /// Variance of its distance to the truth \[W^2/m^4\].
    pub(super) variance: Vec<f64>,
    /// Variance of the noise of the element's own mean, by the model \[W^2/m^4\].
    pub(super) noise: Vec<f64>,
    /// By how much the value moves when the element's own mean moves by 1.
    pub(super) leverage: Vec<f64>,
}

impl Scale {
    /// The cells of voxels of edge `size` \[m\], shifted by a part of a voxel. Sides are always apart: places are near, but what they see is not.
    pub(super) fn new(clustering: &Clustering, sizes: &Sizes, size: f32, shift: Vec3) -> Self {
        let keyed = clustering.keyed(size, shift, true);
        let mut starts: Vec<usize> =
            (0..keyed.len()).filter(|i| *i == 0 || keyed[i - 1].0 != keyed[*i].0).collect();
        starts.push(keyed.len());
        let order: Vec<u32> = keyed.into_iter().map(|(_, element)| element).collect();
        let raw = |element: u32| {
            let place = &clustering.places()[element as usize];
            // Each about uniform in a range of 1: times the root of 12 its variance is 1. Normals nearest to one axis vary by half.
            let [x, y, z] = (place.position / size * 3.46).to_array().map(f64::from);
            let [u, v, w] = (place.normal * 2.0).to_array().map(f64::from);
            [1.0, x, y, z, u, v, w, 0.0]
        };
        let mut rows: Vec<[f64; TERMS]> = order.iter().map(|e| raw(*e)).collect();
        for cell in starts.windows(2) {
            let mut sum = [0.0; TERMS];
            for k in cell[0]..cell[1] {
                let w = sizes.weight[order[k] as usize];
                for (s, x) in sum.iter_mut().zip(rows[k]) {
                    *s += w * x;
                }
            }
            let centre = sum.map(|s| s / sum[0]);
            for row in &mut rows[cell[0]..cell[1]] {
                for (x, c) in row[1..].iter_mut().zip(&centre[1..]) {
                    *x -= c;
                }
            }
        }
        Self { order, starts, rows }
    }

    /// Number of cells.
    pub(super) fn cells(&self) -> usize {
        self.starts.len() - 1
    }

    /// Elements of each cell.
    pub(super) fn members(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|cell| &self.order[cell[0]..cell[1]])
    }

    /// Planes and departures of one channel; `photon` is the flux of a photon that is usual in the scene \[W\], above 0.
    /// Elements outside all cells keep what they have.
    pub(super) fn fit(&self, sizes: &Sizes, seen: &Seen, photon: f64) -> Fit {
        let mut work = self.start(sizes, seen, photon);
        for _ in 0..ROUNDS {
            let mut sums = Sums::default();
            for (cell, span) in work.cells.iter_mut().zip(self.starts.windows(2)) {
                let span = span[0]..span[1];
                cell.round(
                    &self.rows[span.clone()],
                    &mut work.entries[span],
                    work.departure,
                    work.slope,
                    &mut sums,
                );
            }
            work.departure = (sums.excess / sums.scale.max(f64::MIN_POSITIVE)).max(MEAN_DEPARTURE_MIN);
            work.slope = (sums.slopes / sums.squares.max(f64::MIN_POSITIVE)).max(SLOPE_MIN);
            for cell in &mut work.cells {
                cell.update(work.departure);
            }
        }
        let mut fit = Fit {
            value: seen.mean.clone(),
            variance: seen.variance.clone(),
            noise: seen.variance.clone(),
            leverage: alloc::vec![1.0; seen.mean.len()],
        };
        for (entry, element) in work.entries.iter().zip(&self.order) {
            let i = *element as usize;
            let gain = 1.0 - entry.noise * entry.precision;
            fit.value[i] = entry.plane + gain * (entry.mean - entry.plane);
            fit.variance[i] = gain * entry.noise + (1.0 - gain) * (1.0 - gain) * entry.plane_variance;
            fit.noise[i] = entry.noise;
            fit.leverage[i] = gain + (1.0 - gain) * (entry.plane_variance * entry.precision).min(1.0);
        }
        fit
    }

    fn start(&self, sizes: &Sizes, seen: &Seen, photon: f64) -> Work {
        let mut entries = Vec::with_capacity(self.order.len());
        let mut cells = Vec::with_capacity(self.cells());
        for members in self.members() {
            let (mut weight, mut flux, mut square) = (0.0, 0.0, 0.0);
            for i in members.iter().map(|e| *e as usize) {
                let w = sizes.weight[i];
                weight += w;
                flux += w * seen.mean[i];
                square += w * sizes.area[i] * seen.variance[i];
            }
            // Exact weights may make a sum of flux negative; one photon more keeps the mean above 0.
            let flux = f64::max(flux, 0.0);
            let mean = (flux + photon) / weight;
            let power = (square + USUAL_PHOTONS * photon * photon) / (flux + USUAL_PHOTONS * photon);
            cells.push(Cell { weight, mean, power, departure: START, excess: 0.0, scale: 0.0, free2: 0.0 });
            entries.extend(members.iter().map(|e| {
                let i = *e as usize;
                Entry {
                    area: sizes.area[i],
                    weight: sizes.weight[i],
                    mean: seen.mean[i],
                    plane: mean,
                    ..Entry::default()
                }
            }));
        }
        Work { entries, cells, departure: START, slope: START }
    }
}

/// State of a fit.
struct Work {
    entries: Vec<Entry>,
    cells: Vec<Cell>,
    /// Mean of r^2 over cells.
    departure: f64,
    /// Variance of slopes over the mean's square.
    slope: f64,
}

/// One element of a cell.
#[derive(Clone, Copy, Default)]
struct Entry {
    area: f64,
    weight: f64,
    mean: f64,
    /// What the plane says.
    plane: f64,
    /// Variance of that.
    plane_variance: f64,
    /// Variance of the noise of the mean.
    noise: f64,
    /// 1 / variance of the mean about the plane, of departure and noise.
    precision: f64,
}

/// Sums of a round over all cells.
#[derive(Default)]
struct Sums {
    excess: f64,
    scale: f64,
    slopes: f64,
    squares: f64,
}

struct Cell {
    /// Sum of its elements' weights.
    weight: f64,
    /// Mean irradiance, above 0.
    mean: f64,
    /// Flux of its photons \[W\].
    power: f64,
    /// r^2.
    departure: f64,
    /// Weighted squares about the plane beyond what noise explains, and what they would be for r = 1.
    excess: f64,
    scale: f64,
    /// Sum of the squares of the weights of what is free to depart.
    free2: f64,
}

impl Cell {
    fn round(
        &mut self,
        rows: &[[f64; TERMS]],
        entries: &mut [Entry],
        departure: f64,
        slope: f64,
        sums: &mut Sums,
    ) {
        let mean2 = self.mean * self.mean;
        let mut normal = [[0.0; TERMS]; TERMS];
        let mut right = [0.0; TERMS];
        for (row, entry) in rows.iter().zip(entries.iter_mut()) {
            let range = PLANE_RANGE.map(|r| r * self.mean);
            entry.noise = self.power * entry.plane.max(range[0]).min(range[1]) / entry.area;
            entry.precision = 1.0 / (self.departure * mean2 + entry.noise);
            let a = row.map(|x| entry.precision * x);
            for (sums, a) in normal.iter_mut().zip(a) {
                for (sum, x) in sums.iter_mut().zip(row) {
                    *sum += a * x;
                }
            }
            for (sum, a) in right.iter_mut().zip(a) {
                *sum += a * entry.mean;
            }
        }
        let unit = normal[0][0];
        let ridge = 1.0 / (slope * mean2 * unit) + 1e-12;
        for (i, row) in normal.iter_mut().enumerate() {
            *row = row.map(|x| x / unit);
            row[i] += if i > 0 { ridge } else { 0.0 };
        }
        invert(&mut normal);
        let covariance = normal.map(|row| row.map(|x| x / unit));
        let plane = times(&covariance, &right);
        (self.excess, self.scale, self.free2) = (0.0, 0.0, 0.0);
        for (row, entry) in rows.iter().zip(entries.iter_mut()) {
            entry.plane = dot(&plane, row);
            entry.plane_variance = dot(&times(&covariance, row), row);
            let rest = entry.mean - entry.plane;
            // The weights do not depend on this cell's own r: they would feed on themselves.
            let q = entry.weight / (departure * mean2 + entry.noise);
            // The plane follows the element by its leverage; what is left of the variance, departure and noise alike, is `free`.
            let free = 1.0 - entry.plane_variance * entry.precision;
            let free = if free > FREE_MIN { free } else { 0.0 };
            self.excess += q * (rest * rest - free * entry.noise);
            self.scale += q * free * mean2;
            self.free2 += entry.weight * free * entry.weight * free;
        }
        sums.excess += self.excess * mean2;
        sums.scale += self.scale * mean2;
        let slopes = SLOPES.map(|i| plane[i] * plane[i] + covariance[i][i]).sum::<f64>();
        sums.slopes += self.weight * slopes / SLOPES.len() as f64;
        sums.squares += self.weight * mean2;
    }

    /// r^2 of the cell from its own excess, of standard error sqrt(2 `free2`) / `scale`, and from that of all cells.
    fn update(&mut self, departure: f64) {
        let own = if self.free2 > 0.0 { self.scale * self.scale / (2.0 * self.free2) } else { 0.0 };
        let spread = DEPARTURE_SPREAD * departure;
        let prior = 1.0 / (spread * spread);
        let found = if self.scale > 0.0 { self.excess / self.scale } else { departure };
        let mean = (prior * departure + own * found) / (prior + own);
        self.departure = mean.max(DEPARTURE_MIN * departure);
    }
}

fn dot(a: &[f64; TERMS], b: &[f64; TERMS]) -> f64 {
    let mut p = *a;
    for (x, y) in p.iter_mut().zip(b) {
        *x *= y;
    }
    ((p[0] + p[1]) + (p[2] + p[3])) + ((p[4] + p[5]) + (p[6] + p[7]))
}

/// A symmetric matrix times a vector.
fn times(m: &[[f64; TERMS]; TERMS], v: &[f64; TERMS]) -> [f64; TERMS] {
    let mut out = [0.0; TERMS];
    for (row, x) in m.iter().zip(v) {
        for (o, y) in out.iter_mut().zip(row) {
            *o += x * y;
        }
    }
    out
}

/// Inverse of a positive definite matrix in its place, by elimination: no pivots are needed there.
fn invert(m: &mut [[f64; TERMS]; TERMS]) {
    for p in 0..TERMS {
        let pivot = 1.0 / m[p][p].max(1e-14);
        m[p][p] = 1.0;
        m[p] = m[p].map(|x| x * pivot);
        let row = m[p];
        for (i, other) in m.iter_mut().enumerate() {
            if i == p {
                continue;
            }
            let factor = other[p];
            other[p] = 0.0;
            for (x, r) in other.iter_mut().zip(row) {
                *x -= factor * r;
            }
        }
    }
}
