//! Integrals of a bitmap over a piece in f64, from the definition and along chords: no clipping, no edges, no sums.
#![allow(dead_code, reason = "not every test uses all of it")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::direct::emission::Bitmap;
use etendue_core::sampling::counter::Counter;
use etendue_core::scene::{TextureRecord, srgb_to_linear};

pub(crate) struct Image {
    pub(crate) record: TextureRecord,
    pub(crate) texels: Vec<u32>,
    pub(crate) decode: Vec<f32>,
}

impl Image {
    pub(crate) fn new(width: u32, height: u32, texel: impl Fn(u32, u32) -> u32) -> Self {
        let texels = (0..width * height).map(|i| texel(i % width, i / width)).collect();
        let record = TextureRecord { width, height, first_texel: 0, pad: 0 };
        Self { record, texels, decode: (0..=255).map(srgb_to_linear).collect() }
    }

    pub(crate) fn noise(width: u32, height: u32, seed: u64) -> Self {
        let g = Counter::new(seed);
        Self::new(width, height, |x, y| g.bits(x, y, 0) >> 8)
    }

    pub(crate) fn bitmap(&self) -> Bitmap<'_> {
        Bitmap::try_new(&self.record, &self.texels, &self.decode).expect("a bitmap")
    }

    fn texel(&self, x: i64, y: i64) -> [f64; 3] {
        let (w, h) = (i64::from(self.record.width), i64::from(self.record.height));
        let code = self.texels[(y.rem_euclid(h) * w + x.rem_euclid(w)) as usize];
        [0, 8, 16].map(|s| f64::from(self.decode[(code >> s & 255) as usize]))
    }

    /// The albedo at column x and row y (texel boxes at integers), as the renderer filters it or constant per texel.
    fn at(&self, x: f64, y: f64, filtered: bool) -> [f64; 3] {
        if !filtered {
            return self.texel(x.floor() as i64, y.floor() as i64);
        }
        let (s, t) = (x - 0.5, y - 0.5);
        let (i, j) = (s.floor(), t.floor());
        let (fx, fy) = (s - i, t - j);
        let (i, j) = (i as i64, j as i64);
        let (a, b) = (self.texel(i, j), self.texel(i + 1, j));
        let (c, d) = (self.texel(i, j + 1), self.texel(i + 1, j + 1));
        [0, 1, 2].map(|k| (1.0 - fy) * ((1.0 - fx) * a[k] + fx * b[k]) + fy * ((1.0 - fx) * c[k] + fx * d[k]))
    }

    /// The albedo at each vertex, of a piece with some area in the bitmap: Gauss's rule over rows and along each chord,
    /// between all the places where a texel, a vertex or a crossing begins.
    pub(crate) fn truth(&self, uv: [[f32; 2]; 3], filtered: bool) -> [[f64; 3]; 3] {
        // Five points of Gauss: exact to degree 9.
        const GAUSS: [(f64, f64); 5] = [
            (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
            (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
            (0.906_179_845_938_664, 0.236_926_885_056_189_08),
        ];
        let (w, h) = (f64::from(self.record.width), f64::from(self.record.height));
        let p = uv.map(|p| [f64::from(p[0]) * w, -f64::from(p[1]) * h]);
        let shift = if filtered { 0.5 } else { 0.0 };
        let twice = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
        let bary = |x: f64, y: f64| {
            [0, 1, 2].map(|k| {
                let (q, r) = (p[(k + 1) % 3], p[(k + 2) % 3]);
                ((q[0] - x) * (r[1] - y) - (q[1] - y) * (r[0] - x)) / twice
            })
        };
        let lines = |low: f64, high: f64| {
            ((low - shift).ceil() as i64..=(high - shift).floor() as i64).map(move |i| i as f64 + shift)
        };
        let mut rows: Vec<f64> = p.iter().map(|p| p[1]).collect();
        for k in 0..3 {
            let (a, b) = (p[k], p[(k + 1) % 3]);
            rows.extend(lines(a[1].min(b[1]), a[1].max(b[1])));
            if a[0] != b[0] {
                rows.extend(
                    lines(a[0].min(b[0]), a[0].max(b[0]))
                        .map(|x| a[1] + (x - a[0]) / (b[0] - a[0]) * (b[1] - a[1])),
                );
            }
        }
        rows.sort_by(f64::total_cmp);
        let mut out = [[0.0; 3]; 3];
        for pair in rows.windows(2) {
            let (top, bottom) = (pair[0], pair[1]);
            if bottom <= top {
                continue;
            }
            for (gy, wy) in GAUSS {
                let y = 0.5 * (top + bottom) + 0.5 * (bottom - top) * gy;
                let mut ends: Vec<f64> = (0..3)
                    .filter_map(|k| {
                        let (a, b) = (p[k], p[(k + 1) % 3]);
                        let crosses = (a[1] <= y) != (b[1] <= y);
                        crosses.then(|| a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
                    })
                    .collect();
                ends.sort_by(f64::total_cmp);
                let [left, right] = ends[..] else { continue };
                let mut columns = vec![left];
                columns.extend(lines(left, right));
                columns.push(right);
                for pair in columns.windows(2) {
                    let (from, to) = (pair[0], pair[1]);
                    for (gx, wx) in &GAUSS[..] {
                        let x = 0.5 * (from + to) + 0.5 * (to - from) * gx;
                        let weight = 0.25 * (bottom - top) * (to - from) * wy * wx;
                        let (rho, b) = (self.at(x, y, filtered), bary(x, y));
                        for k in 0..3 {
                            for c in 0..3 {
                                out[k][c] += 6.0 / twice.abs() * weight * rho[c] * b[k];
                            }
                        }
                    }
                }
            }
        }
        out
    }

    /// The same for any map, also to a line or a point: the midpoint rule over `n^2` parts of the piece.
    pub(crate) fn midpoints(&self, uv: [[f32; 2]; 3], filtered: bool, n: u32) -> [[f64; 3]; 3] {
        let (w, h) = (f64::from(self.record.width), f64::from(self.record.height));
        let p = uv.map(|p| [f64::from(p[0]) * w, -f64::from(p[1]) * h]);
        let mut out = [[0.0; 3]; 3];
        for i in 0..n {
            for j in 0..n - i {
                for third in [1.0, 2.0] {
                    if third == 2.0 && i + j + 1 >= n {
                        continue;
                    }
                    let b1 = (f64::from(i) + third / 3.0) / f64::from(n);
                    let b2 = (f64::from(j) + third / 3.0) / f64::from(n);
                    let b = [1.0 - b1 - b2, b1, b2];
                    let at = [0, 1].map(|k| (0..3).map(|v| b[v] * p[v][k]).sum::<f64>());
                    let rho = self.at(at[0], at[1], filtered);
                    for k in 0..3 {
                        for c in 0..3 {
                            out[k][c] += 3.0 * b[k] * rho[c] / f64::from(n * n);
                        }
                    }
                }
            }
        }
        out
    }
}

/// A piece of about `size` texels across, anywhere within a few periods, turned and flipped.
pub(crate) fn piece(g: &Counter, n: u32, image: &Image, size: f64) -> [[f32; 2]; 3] {
    let unit = |d: u32| f64::from(g.unit(5, n, d));
    let place = [3.0 * unit(0) - 1.5, 3.0 * unit(1) - 1.5];
    let scale = [size / f64::from(image.record.width), size / f64::from(image.record.height)];
    [0, 1, 2].map(|k| [0, 1].map(|a| (place[a] + (unit(2 + 2 * k + a as u32) - 0.5) * scale[a]) as f32))
}
