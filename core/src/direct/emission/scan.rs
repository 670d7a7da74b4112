//! Visiting the texels that a piece covers.

use super::VertexAlbedo;
use super::cut;
use super::frame::{Frame, Touched, touched};
use super::texels::Texels;
use crate::math::{self, Compensated, Vec3};

/// `x` of `0..2n` within one period.
#[inline(always)]
fn wrap(x: u32, n: u32) -> u32 {
    if x < n { x } else { x % n }
}

/// Nine sums and the brightest value met, per channel.
struct Sums {
    total: [[Compensated<f32>; 3]; 3],
    row: [[f32; 3]; 3],
    at: u32,
    brightest: [f32; 3],
}

impl Sums {
    fn new() -> Self {
        Self { total: [[Compensated::default(); 3]; 3], row: [[0.0; 3]; 3], at: 0, brightest: [0.0; 3] }
    }

    /// Rows are summed plainly, and then into a compensated total.
    #[inline(always)]
    fn enter(&mut self, row: u32) {
        if row != self.at {
            self.close();
            self.at = row;
        }
    }

    #[inline]
    fn close(&mut self) {
        for (total, row) in self.total.iter_mut().flatten().zip(self.row.iter().flatten()) {
            total.add(*row);
        }
        self.row = [[0.0; 3]; 3];
    }

    #[inline(always)]
    fn add(&mut self, weights: [f32; 3], color: [f32; 3]) {
        for (row, weight) in self.row.iter_mut().zip(weights) {
            for (x, c) in row.iter_mut().zip(color) {
                *x += weight * c;
            }
        }
        if weights[0] + weights[1] + weights[2] > 0.0 {
            for (b, c) in self.brightest.iter_mut().zip(color) {
                *b = math::max(*b, c);
            }
        }
    }

    /// The means: three times the integrals, and no more than the brightest texel.
    fn finish(mut self) -> VertexAlbedo {
        self.close();
        let mean = |k: usize, c: usize| math::min(self.total[k][c].value() * 3.0, self.brightest[c]);
        VertexAlbedo { at: [0, 1, 2].map(|k| Vec3::new(mean(k, 0), mean(k, 1), mean(k, 2))) }
    }
}

/// Albedo of a piece under the renderer's bilinear, repeating filter: its exact integral, cell by cell.
///
/// `uv` at the three vertices, any floats (an axis with one that is not finite counts as 0, as in the sampler);
/// flipped, repeating and degenerate pieces included: of a piece whose map is a line or a point it is the mean along
/// it. `None` where the piece meets more than `max_cells` cells (by [`covered_estimate`](super::covered_estimate)'s
/// bound, which is also the bound on time).
///
/// Accuracy: within 2^-20 of the brightest texel covered for pieces up to 2^12 cells, and 2^-20 of it times the longest edge over the
/// least height (in texels): how wide a long sliver is, f32 coordinates say no better. For a
/// piece squeezed to a line the second term is 2^-24 times its length in texels. Measured in `tests/emission_texture.rs`. Order of the sums: rows from the top, columns from the left.
pub fn scan<T: Texels + ?Sized>(texels: &T, uv: [[f32; 2]; 3], max_cells: f32) -> Option<VertexAlbedo> {
    let size = texels.size();
    let frame = Frame::new(size, uv, 0.5).filter(|f| f.cells() <= max_cells)?;
    let mut sums = Sums::new();
    cut::cells(frame.points, |column, row, part| {
        sums.enter(row);
        let weights = part.bilinear([column as f32, row as f32]);
        let (x, y) = (wrap(frame.base[0] + column, size[0]), wrap(frame.base[1] + row, size[1]));
        let (x1, y1) = (wrap(x + 1, size[0]), wrap(y + 1, size[1]));
        sums.add(weights[0], texels.texel(x, y));
        sums.add(weights[1], texels.texel(x1, y));
        sums.add(weights[2], texels.texel(x, y1));
        sums.add(weights[3], texels.texel(x1, y1));
    });
    Some(sums.finish())
}

/// As [`scan`] with texels of constant albedo: the sum over texels of the area of the exact overlap times the albedo,
/// taken at the overlap's centroid for the irradiance. What Kopylov calls the scan of the covering texels.
///
/// It is not what the renderer's filter shows: see the module.
pub fn scan_texels<T: Texels + ?Sized>(
    texels: &T,
    uv: [[f32; 2]; 3],
    max_cells: f32,
) -> Option<VertexAlbedo> {
    let size = texels.size();
    let frame = Frame::new(size, uv, 0.0).filter(|f| f.cells() <= max_cells)?;
    let mut sums = Sums::new();
    cut::cells(frame.points, |column, row, part| {
        sums.enter(row);
        let (x, y) = (wrap(frame.base[0] + column, size[0]), wrap(frame.base[1] + row, size[1]));
        sums.add(part.constant(), texels.texel(x, y));
    });
    Some(sums.finish())
}

/// What a filter's roundings may add to the brightest texel.
pub(super) const FILTER_ROUNDING: f32 = 1.0 + 4.0 / 16_777_216.0;

/// An upper bound, per channel, of every sample of the bitmap over the piece, the rounding of the renderer's own
/// coordinates and filter included: the brightest texel of the box around the piece, times 1 + 2^-22.
///
/// Reads each texel of the box, at most the bitmap once; [`Pyramid::brightest`](super::Pyramid::brightest) reads 16.
pub fn brightest_in<T: Texels + ?Sized>(texels: &T, uv: [[f32; 2]; 3]) -> Vec3 {
    let size = texels.size();
    let columns = touched([uv[0][0], uv[1][0], uv[2][0]], size[0]);
    let rows = touched([-uv[0][1], -uv[1][1], -uv[2][1]], size[1]);
    let mut brightest = [0.0; 3];
    for row in each(rows, size[1]) {
        for column in each(columns, size[0]) {
            for (b, c) in brightest.iter_mut().zip(texels.texel(column, row)) {
                *b = math::max(*b, c);
            }
        }
    }
    Vec3::from_array(brightest.map(|b| b * FILTER_ROUNDING))
}

#[inline]
fn each(t: Touched, n: u32) -> impl Iterator<Item = u32> {
    (0..t.count).map(move |i| wrap(t.first + i, n))
}

/// Albedo from samples at fixed points: the centroids of `divisions^2` equal parts of the piece, each an exact
/// bilinear sample. For pieces over too many texels to follow; the cost is the number of points, whatever the piece.
///
/// Error: that of a regular rule of so many points; nothing is promised for textures that repeat in step with it.
pub fn sample_points<T: Texels + ?Sized>(texels: &T, uv: [[f32; 2]; 3], divisions: u32) -> VertexAlbedo {
    let n = divisions.clamp(1, 1024);
    let size = texels.size();
    let step = 1.0 / (3.0 * n as f32);
    let mut sums = Sums::new();
    // Centroids of the upright parts at thirds (3i + 1, 3j + 1), of the turned ones at (3i + 2, 3j + 2).
    for i in 0..n {
        sums.enter(i);
        for j in 0..n - i {
            for third in [1, 2] {
                if i + j + third > n {
                    continue;
                }
                let (b1, b2) = ((3 * i + third) as f32 * step, (3 * j + third) as f32 * step);
                let b = [math::max(1.0 - b1 - b2, 0.0), b1, b2];
                let at = [0, 1].map(|k| {
                    let x = b[0] * uv[0][k] + b[1] * uv[1][k] + b[2] * uv[2][k];
                    if x.is_finite() { x } else { 0.0 }
                });
                let color = bilinear(texels, size, at);
                sums.add(b, color);
            }
        }
    }
    sums.close();
    // The weights of a vertex add up to n^2 / 3 but for rounding.
    let scale = 3.0 / (n * n) as f32;
    let mean = |k: usize, c: usize| math::min(sums.total[k][c].value() * scale, sums.brightest[c]);
    VertexAlbedo { at: [0, 1, 2].map(|k| Vec3::new(mean(k, 0), mean(k, 1), mean(k, 2))) }
}

/// One bilinear sample; as [`sample_bitmap`](crate::scene::sample_bitmap).
fn bilinear<T: Texels + ?Sized>(texels: &T, size: [u32; 2], uv: [f32; 2]) -> [f32; 3] {
    let axis = |u: f32, n: u32| {
        let s = (u - math::floor(u)) * n as f32 - 0.5;
        let cell = math::floor(s);
        let lower = if cell < 0.0 { n - 1 } else { (cell as u32).min(n - 1) };
        (lower, wrap(lower + 1, n), s - cell)
    };
    let (x0, x1, fx) = axis(uv[0], size[0]);
    let (y0, y1, fy) = axis(-uv[1], size[1]);
    let (a, b, c, d) =
        (texels.texel(x0, y0), texels.texel(x1, y0), texels.texel(x0, y1), texels.texel(x1, y1));
    [0, 1, 2].map(|i| {
        let (top, low) = (a[i] * (1.0 - fx) + b[i] * fx, c[i] * (1.0 - fx) + d[i] * fx);
        top * (1.0 - fy) + low * fy
    })
}
