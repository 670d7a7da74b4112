//! Coarser levels of a bitmap: means and brightest texels.

use super::VertexAlbedo;
use super::frame::{Frame, Touched, touched};
use super::scan::{FILTER_ROUNDING, scan_texels};
use super::texels::Texels;
use crate::math::{self, Vec3};
use alloc::vec::Vec;

/// Texels that [`Pyramid::brightest`] reads along an axis.
const BOUND_TEXELS: u64 = 4;

/// One level: half the sides of the one below, rounded down, down to 1.
#[derive(Clone, Debug)]
struct Level {
    size: [u32; 2],
    mean: Vec<[f32; 3]>,
    brightest: Vec<[f32; 3]>,
}

impl Texels for Level {
    fn size(&self) -> [u32; 2] {
        self.size
    }
    fn texel(&self, x: u32, y: u32) -> [f32; 3] {
        self.mean.get((y * self.size[0] + x) as usize).copied().unwrap_or([0.0; 3])
    }
}

/// Means and brightest texels of ever coarser grids over one bitmap.
///
/// A texel of a level covers its part of the period exactly, sides that are no powers of two included: the mean is
/// weighted by overlaps, so that each level has the bitmap's mean; the brightest is over all that it overlaps.
/// Memory: 8 bytes per texel of the bitmap.
#[derive(Clone, Debug)]
pub struct Pyramid {
    size: [u32; 2],
    levels: Vec<Level>,
}

/// Texels of a side of `n` under texel `k` of a side of `m <= n`: the first, the one after the last, and the bounds.
fn under(k: u32, m: u32, n: u32) -> (u32, u32, f64, f64) {
    let scaled = |k: u32| u64::from(k) * u64::from(n);
    let (low, high) = (scaled(k), scaled(k + 1));
    let m64 = u64::from(m);
    let bound = |x: u64| x as f64 / f64::from(m);
    ((low / m64) as u32, high.div_ceil(m64) as u32, bound(low), bound(high))
}

impl Pyramid {
    /// The levels of a bitmap.
    pub fn new<T: Texels + ?Sized>(texels: &T) -> Self {
        let size = texels.size();
        let mut levels: Vec<Level> = Vec::new();
        loop {
            let fine = levels.last().map_or(size, |l| l.size);
            if fine == [1, 1] && !levels.is_empty() {
                break;
            }
            let next = match levels.last() {
                None => reduce(size, |x, y| (texels.texel(x, y), texels.texel(x, y))),
                Some(l) => {
                    let at = |x: u32, y: u32| (y * l.size[0] + x) as usize;
                    reduce(l.size, |x, y| (l.mean[at(x, y)], l.brightest[at(x, y)]))
                }
            };
            levels.push(next);
        }
        Self { size, levels }
    }

    /// The brightest texel of the bitmap, per channel.
    pub fn brightest_texel(&self) -> Vec3 {
        self.levels.last().map_or(Vec3::ZERO, |l| Vec3::from_array(l.brightest[0]))
    }

    /// An upper bound, per channel, of every sample of the bitmap over the piece: as
    /// [`brightest_in`](super::brightest_in), and never below it, but from at most 16 texels of a coarser level.
    pub fn brightest(&self, uv: [[f32; 2]; 3]) -> Vec3 {
        let columns = touched([uv[0][0], uv[1][0], uv[2][0]], self.size[0]);
        let rows = touched([-uv[0][1], -uv[1][1], -uv[2][1]], self.size[1]);
        let range = |t: Touched, n: u32, m: u32| {
            let last = u64::from(t.first) + u64::from(t.count.max(1)) - 1;
            let low = u64::from(t.first) * u64::from(m) / u64::from(n);
            (low, (last * u64::from(m) / u64::from(n) - low + 1).min(u64::from(m)))
        };
        for level in &self.levels {
            let (x, nx) = range(columns, self.size[0], level.size[0]);
            let (y, ny) = range(rows, self.size[1], level.size[1]);
            if nx <= BOUND_TEXELS && ny <= BOUND_TEXELS {
                let mut brightest = [0.0; 3];
                for j in y..y + ny {
                    for i in x..x + nx {
                        let (w, h) = (u64::from(level.size[0]), u64::from(level.size[1]));
                        let texel = level.brightest[((j % h) * w + i % w) as usize];
                        for (b, c) in brightest.iter_mut().zip(texel) {
                            *b = math::max(*b, c);
                        }
                    }
                }
                return Vec3::from_array(brightest.map(|b| b * FILTER_ROUNDING));
            }
        }
        self.brightest_texel() * FILTER_ROUNDING
    }

    /// Albedo of a piece from the finest coarser level of which it meets at most `max_texels`, by
    /// [`scan_texels`] there. The last level is the mean of the bitmap, used for whatever is too wide.
    ///
    /// Error: the contrast within a coarse texel along the piece's edges; not a bound on either side.
    pub fn coarse(&self, uv: [[f32; 2]; 3], max_texels: f32) -> VertexAlbedo {
        for level in &self.levels {
            let fits = Frame::new(level.size, uv, 0.0).is_some_and(|f| f.cells() <= max_texels);
            if let Some(albedo) = fits.then(|| scan_texels(level, uv, max_texels)).flatten() {
                return albedo;
            }
        }
        VertexAlbedo::uniform(self.levels.last().map_or(Vec3::ZERO, |l| Vec3::from_array(l.mean[0])))
    }
}

/// The next level above one of `size` whose texels `at` gives as (mean, brightest).
fn reduce(size: [u32; 2], at: impl Fn(u32, u32) -> ([f32; 3], [f32; 3])) -> Level {
    let next = size.map(|n| (n / 2).max(1));
    let texels = next[0] as usize * next[1] as usize;
    let mut level =
        Level { size: next, mean: Vec::with_capacity(texels), brightest: Vec::with_capacity(texels) };
    let overlap = |i: u32, low: f64, high: f64| {
        let (from, to) = (f64::from(i).max(low), f64::from(i + 1).min(high));
        (to - from).max(0.0)
    };
    for y in 0..next[1] {
        let (y0, y1, top, bottom) = under(y, next[1], size[1]);
        for x in 0..next[0] {
            let (x0, x1, left, right) = under(x, next[0], size[0]);
            let (mut sum, mut brightest) = ([0.0_f64; 3], [0.0_f32; 3]);
            for j in y0..y1 {
                for i in x0..x1 {
                    let weight = overlap(j, top, bottom) * overlap(i, left, right);
                    let (mean, peak) = at(i, j);
                    for c in 0..3 {
                        sum[c] += weight * f64::from(mean[c]);
                        brightest[c] = math::max(brightest[c], peak[c]);
                    }
                }
            }
            let area = (bottom - top) * (right - left);
            level.mean.push(sum.map(|s| (s / area) as f32));
            level.brightest.push(brightest);
        }
    }
    level
}
