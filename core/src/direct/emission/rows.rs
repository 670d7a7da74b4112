//! Integrals over a piece from its edges alone.
//!
//! By Green's theorem the integral of f over a piece is that of `F dy` along its edges, F being the integral of f along
//! the row from a fixed column. F of a bilinear filter is a quadratic in a cell and a sum over the cells before it; the
//! sums are tabulated. So a piece over N texels costs about sqrt(N) and is exact all the same, where a summed-area table
//! (Crow 1984) is exact for boxes only.
//!
//! Tables and sums are in f64: differences of sums along rows would leave f32 few digits. This is host-side set-up, no
//! kernel; the kernel is the scan.

use super::VertexAlbedo;
use super::frame::MAX_SPAN;
use super::texels::Texels;
use crate::math::Vec3;
use alloc::vec::Vec;

/// Columns between two tabulated sums: what lies between is added up anew. 48 bytes per 16 texels.
const STEP: usize = 16;
/// Three channels of the sum, then three of the first moment.
type Sum = [f64; 6];

/// Sums along the rows of a bitmap, of its bilinear filter and of its first moment.
#[derive(Clone, Debug)]
pub struct RowSums {
    size: [u32; 2],
    /// Tabulated sums per row; the last is that of the whole row.
    stride: usize,
    sums: Vec<Sum>,
}

fn floor(x: f64) -> i64 {
    let t = x as i64;
    if t as f64 > x { t - 1 } else { t }
}

fn periods(x: i64, n: u32) -> (i64, u32) {
    (x.div_euclid(i64::from(n)), x.rem_euclid(i64::from(n)) as u32)
}

/// Adds to the sums, or takes from them (`sign`), the cell from texel `x` (albedo `a`) to the next (`b`).
#[inline(always)]
fn step(sum: &mut Sum, x: f64, a: [f64; 3], b: [f64; 3], sign: f64) {
    for c in 0..3 {
        let mean = 0.5 * (a[c] + b[c]);
        sum[c] += sign * mean;
        sum[3 + c] += sign * (x * mean + (a[c] + 2.0 * b[c]) * (1.0 / 6.0));
    }
}

/// Two rows of cells above each other, along which an edge walks.
struct Pair {
    x: i64,
    y: i64,
    upper: Cell,
    lower: Cell,
}

/// A row's integral over a cell: the sums up to the cell, and the two texels.
#[derive(Clone, Copy)]
struct Cell {
    before: Sum,
    from: [f64; 3],
    rise: [f64; 3],
}

/// The piece over the grid of texel centres, in f64: all exact but the shift of the origin.
struct Piece {
    /// Column and row of the vertices, from the texel centre (0, 0) of some period.
    points: [[f64; 2]; 3],
}

impl Piece {
    fn new(size: [u32; 2], uv: [[f32; 2]; 3]) -> Option<Self> {
        let axis = |u: [f32; 3], n: u32| {
            let u = if u.iter().all(|x| x.is_finite()) { u.map(f64::from) } else { [0.0; 3] };
            let mut near = u[0];
            for x in [u[1], u[2]] {
                near = if x.abs() < near.abs() { x } else { near };
            }
            if near.abs() > 1e15 {
                return None;
            }
            let periods = near as i64 as f64;
            let x = u.map(|u| (u - periods) * f64::from(n) - 0.5);
            x.iter().all(|x| x.abs() <= f64::from(2.0 * MAX_SPAN)).then_some(x)
        };
        let x = axis([uv[0][0], uv[1][0], uv[2][0]], size[0])?;
        let y = axis([-uv[0][1], -uv[1][1], -uv[2][1]], size[1])?;
        Some(Self { points: [[x[0], y[0]], [x[1], y[1]], [x[2], y[2]]] })
    }
}

/// Integrals along edges: of F, of (y - y0) F, and of the first moment about x0, per channel.
#[derive(Default)]
struct Integrals {
    plain: [f64; 3],
    rows: [f64; 3],
    columns: [f64; 3],
}

impl RowSums {
    /// The sums of a bitmap: 3 bytes per texel; each texel is read twice.
    pub fn new<T: Texels + ?Sized>(texels: &T) -> Self {
        let size = texels.size();
        let stride = (size[0] as usize).div_ceil(STEP) + 1;
        let mut sums = Vec::with_capacity(stride * size[1] as usize);
        for y in 0..size[1] {
            let mut sum = [0.0; 6];
            let first = texels.texel(0, y).map(f64::from);
            let mut a = first;
            for x in 0..size[0] {
                if (x as usize).is_multiple_of(STEP) {
                    sums.push(sum);
                }
                let b = if x + 1 < size[0] { texels.texel(x + 1, y).map(f64::from) } else { first };
                step(&mut sum, f64::from(x), a, b, 1.0);
                a = b;
            }
            sums.push(sum);
        }
        Self { size, stride, sums }
    }

    /// Mean albedo of the whole bitmap, the same for texels and for their filter.
    pub fn mean(&self) -> Vec3 {
        let mut mean = [0.0; 3];
        for row in self.sums.chunks_exact(self.stride) {
            for (m, s) in mean.iter_mut().zip(&row[self.stride - 1]) {
                *m += s;
            }
        }
        let texels = f64::from(self.size[0]) * f64::from(self.size[1]);
        Vec3::from_array(mean.map(|m| (m / texels) as f32))
    }

    /// The cell of column `x` in row `y`, both counted through all periods.
    fn cell<T: Texels + ?Sized>(&self, texels: &T, x: i64, y: i64) -> Cell {
        let (period, column) = periods(x, self.size[0]);
        let (_, row) = periods(y, self.size[1]);
        let line = &self.sums[row as usize * self.stride..][..self.stride];
        let mut before = line[column as usize / STEP];
        let next = |x: u32| texels.texel(if x + 1 < self.size[0] { x + 1 } else { 0 }, row).map(f64::from);
        let mut at = column - column % STEP as u32;
        let mut from = texels.texel(at, row).map(f64::from);
        while at < column {
            let to = next(at);
            step(&mut before, f64::from(at), from, to, 1.0);
            from = to;
            at += 1;
        }
        let to = next(column);
        if period != 0 {
            let (n, k) = (f64::from(self.size[0]), period as f64);
            let whole = line[self.stride - 1];
            for c in 0..3 {
                // The moment of k periods, and that of the rest moved by k periods.
                before[3 + c] += k * whole[3 + c] + n * whole[c] * (0.5 * k * (k - 1.0)) + k * n * before[c];
                before[c] += k * whole[c];
            }
        }
        Cell { before, from, rise: [0, 1, 2].map(|c| to[c] - from[c]) }
    }

    /// The cell beside one of column `x` in row `y`, to the right or to the left.
    #[inline]
    fn beside<T: Texels + ?Sized>(&self, texels: &T, cell: &Cell, x: i64, y: i64, right: bool) -> Cell {
        let texel =
            |x: i64| texels.texel(periods(x, self.size[0]).1, periods(y, self.size[1]).1).map(f64::from);
        let mut before = cell.before;
        let (from, to) = if right {
            let middle = [0, 1, 2].map(|c| cell.from[c] + cell.rise[c]);
            step(&mut before, x as f64, cell.from, middle, 1.0);
            (middle, texel(x + 2))
        } else {
            let new = texel(x - 1);
            step(&mut before, (x - 1) as f64, new, cell.from, -1.0);
            (new, cell.from)
        };
        Cell { before, from, rise: [0, 1, 2].map(|c| to[c] - from[c]) }
    }

    /// The cells of column `x` in rows `y` and `y + 1`, from those of the stretch before where they are neighbours.
    #[inline]
    fn pair<T: Texels + ?Sized>(&self, texels: &T, last: Option<Pair>, x: i64, y: i64) -> Pair {
        match last {
            Some(p) if p.y == y && (p.x - x).abs() == 1 => {
                let right = x > p.x;
                let upper = self.beside(texels, &p.upper, p.x, y, right);
                Pair { x, y, upper, lower: self.beside(texels, &p.lower, p.x, y + 1, right) }
            }
            Some(p) if p.x == x && p.y + 1 == y => {
                Pair { x, y, upper: p.lower, lower: self.cell(texels, x, y + 1) }
            }
            Some(p) if p.x == x && p.y - 1 == y => {
                Pair { x, y, upper: self.cell(texels, x, y), lower: p.upper }
            }
            _ => Pair { x, y, upper: self.cell(texels, x, y), lower: self.cell(texels, x, y + 1) },
        }
    }

    /// Adds the integrals along the edge from `p` to `q`.
    fn edge<T: Texels + ?Sized>(
        &self,
        texels: &T,
        p: [f64; 2],
        q: [f64; 2],
        origin: [f64; 2],
        out: &mut Integrals,
    ) {
        let d = [q[0] - p[0], q[1] - p[1]];
        if d[1] == 0.0 {
            return;
        }
        // The next line that the edge crosses on each axis, and where.
        let step = d.map(|d| if d < 0.0 { -1.0 } else { 1.0 });
        let mut line = [0, 1].map(|k| {
            let low = floor(p[k]) as f64;
            if d[k] > 0.0 {
                low + 1.0
            } else if low < p[k] {
                low
            } else {
                low - 1.0
            }
        });
        let crossing = |line: f64, k: usize| if d[k] == 0.0 { f64::INFINITY } else { (line - p[k]) / d[k] };
        let mut next = [crossing(line[0], 0), crossing(line[1], 1)];
        let (mut from, mut pair) = (0.0_f64, None);
        while from < 1.0 {
            let to = if next[0] < next[1] { next[0] } else { next[1] };
            let to = if to < 1.0 { to } else { 1.0 };
            if to > from {
                let middle = 0.5 * (from + to);
                let (x, y) = (floor(p[0] + middle * d[0]), floor(p[1] + middle * d[1]));
                let here = self.pair(texels, pair, x, y);
                stretch(&here, p, d, [from, to], origin, out);
                pair = Some(here);
            }
            for k in 0..2 {
                if next[k] <= to {
                    line[k] += step[k];
                    next[k] = crossing(line[k], k);
                }
            }
            from = to;
        }
    }

    /// As [`scan`](super::scan), from the edges: `texels` must be those that the sums are of.
    ///
    /// `None` where the edges meet more than `max_cells` cells, where the piece is too thin or too small to gain by it
    /// (less than a cell, or than a sixteenth of the cells on its edges: [`scan`](super::scan) costs no more there and
    /// loses no digits), or where the bitmap has another size. Accuracy: one rounding to f32, and 1e-10 of the
    /// brightest texel.
    pub fn vertex_albedo<T: Texels + ?Sized>(
        &self,
        texels: &T,
        uv: [[f32; 2]; 3],
        max_cells: f32,
    ) -> Option<VertexAlbedo> {
        if texels.size() != self.size {
            return None;
        }
        let [a, b, c] = Piece::new(self.size, uv)?.points;
        let (e, f) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
        let twice = e[0] * f[1] - e[1] * f[0];
        let length = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).abs() + (p[1] - q[1]).abs() + 3.0;
        let edge_cells = length(a, b) + length(b, c) + length(c, a);
        let area = 0.5 * twice.abs();
        if area < 1.0 || area * 16.0 < edge_cells || edge_cells > f64::from(max_cells) {
            return None;
        }
        let origin = [0, 1].map(|k| (a[k] + b[k] + c[k]) / 3.0);
        let mut sums = Integrals::default();
        for (p, q) in [(a, b), (b, c), (c, a)] {
            self.edge(texels, p, q, origin, &mut sums);
        }
        // b_k = 1/3 + s_k (x - x0) + t_k (y - y0) about the centroid; the gradient is the opposite edge turned.
        let at = [(b, c), (c, a), (a, b)].map(|(p, q)| {
            let (s, t) = ((p[1] - q[1]) / twice, (q[0] - p[0]) / twice);
            let of = |c: usize| {
                let integral = sums.plain[c] / 3.0 + s * sums.columns[c] + t * sums.rows[c];
                // Three times the mean; an integral that rounding leaves below zero is zero.
                let mean = 6.0 * integral / twice;
                if mean > 0.0 { (if mean < 1.0 { mean } else { 1.0 }) as f32 } else { 0.0 }
            };
            Vec3::new(of(0), of(1), of(2))
        });
        Some(VertexAlbedo { at })
    }
}

/// Adds the integrals over a stretch of an edge, all in one cell: polynomials of degree 4, by the three points of
/// Gauss, exact to degree 5.
#[inline]
fn stretch(
    pair: &Pair,
    p: [f64; 2],
    d: [f64; 2],
    [from, to]: [f64; 2],
    origin: [f64; 2],
    out: &mut Integrals,
) {
    const ROOT: f64 = 0.387_298_334_620_741_7; // sqrt(3/5) / 2
    let middle = 0.5 * (from + to);
    let (column, row) = (pair.x as f64, pair.y as f64);
    let dy = (to - from) * d[1];
    for (offset, weight) in [(-ROOT, 5.0 / 18.0), (0.0, 8.0 / 18.0), (ROOT, 5.0 / 18.0)] {
        let t = middle + offset * (to - from);
        let (fx, fy) = (p[0] + t * d[0] - column, p[1] + t * d[1] - row);
        let height = row + fy - origin[1];
        let half = 0.5 * fx * fx;
        let third = fx * fx * fx * (1.0 / 3.0);
        let w = weight * dy;
        for c in 0..3 {
            let of = |cell: &Cell| {
                let here = cell.from[c] * fx + cell.rise[c] * half;
                let moment = cell.from[c] * half + cell.rise[c] * third;
                (cell.before[c] + here, cell.before[3 + c] + column * here + moment)
            };
            let (a, b) = (of(&pair.upper), of(&pair.lower));
            let sum = a.0 + fy * (b.0 - a.0);
            let moment = a.1 + fy * (b.1 - a.1);
            out.plain[c] += w * sum;
            out.rows[c] += w * height * sum;
            out.columns[c] += w * (moment - origin[0] * sum);
        }
    }
}
