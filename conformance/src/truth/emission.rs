//! The truth of the kernels of `emission`.
//!
//! Integrals over a piece are taken in its barycentric plane, between the images of the grid's lines: no polygon is
//! clipped, and a map to a line or a point is as good as any.

use super::{Answer, Expect, Words, nothing, vec};
use etendue_core::kernel::Kernel;

const U: f64 = 1.0 / 16_777_216.0;
/// Nodes and weights of Gauss's rule on [0, 1], exact to degree 5.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Visits points (x, y, barycentrics, weight) of the piece, such that weighted sums are exact integrals, in units of
/// the piece's area, of what is in each cell a polynomial of third degree in the barycentrics.
pub fn over_piece(p: [[f64; 2]; 3], mut visit: impl FnMut(f64, f64, [f64; 3], f64)) {
    let at = |b1: f64, b2: f64, k: usize| p[0][k] + b1 * (p[1][k] - p[0][k]) + b2 * (p[2][k] - p[0][k]);
    // Boundaries b1 = c + m b2, and b2 where a grid line has no b1.
    let (mut lines, mut breaks) = (vec![(0.0, 0.0), (1.0, -1.0)], vec![0.0, 1.0]);
    for k in 0..2 {
        let (low, high) = p.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v[k]), h.max(v[k])));
        let (d1, d2) = (p[1][k] - p[0][k], p[2][k] - p[0][k]);
        for i in low.floor() as i64..=high.ceil() as i64 {
            let rest = i as f64 - p[0][k];
            if d1 != 0.0 {
                lines.push((rest / d1, -d2 / d1));
            } else if d2 != 0.0 {
                breaks.push(rest / d2);
            }
        }
    }
    for (i, a) in lines.iter().enumerate() {
        for b in &lines[i + 1..] {
            if a.1 != b.1 {
                breaks.push((b.0 - a.0) / (a.1 - b.1));
            }
        }
    }
    breaks.retain(|b| (0.0..=1.0).contains(b));
    breaks.sort_by(f64::total_cmp);
    let mut ends = Vec::new();
    for pair in breaks.windows(2) {
        let width = pair[1] - pair[0];
        if width <= 0.0 {
            continue;
        }
        for (t, wt) in GAUSS {
            let b2 = pair[0] + t * width;
            ends.clear();
            ends.extend(lines.iter().map(|(c, m)| (c + m * b2).clamp(0.0, 1.0 - b2)));
            ends.sort_by(f64::total_cmp);
            for pair in ends.windows(2) {
                let length = pair[1] - pair[0];
                for (s, ws) in GAUSS {
                    let b1 = pair[0] + s * length;
                    let weight = 2.0 * wt * width * ws * length;
                    if weight > 0.0 {
                        visit(at(b1, b2, 0), at(b1, b2, 1), [1.0 - b1 - b2, b1, b2], weight);
                    }
                }
            }
        }
    }
}

/// A bitmap of the kernels' constants.
pub struct Bitmap<'a> {
    width: i64,
    height: i64,
    texels: &'a [u32],
}

impl<'a> Bitmap<'a> {
    /// Width, height, texels.
    pub fn new(constants: &'a [u32]) -> Self {
        Self { width: i64::from(constants[0]), height: i64::from(constants[1]), texels: &constants[2..] }
    }

    fn texel(&self, x: i64, y: i64) -> [f64; 3] {
        let word = self.texels[(y.rem_euclid(self.height) * self.width + x.rem_euclid(self.width)) as usize];
        [word, word >> 8, word >> 16].map(|code| {
            let s = f64::from(code & 255) / 255.0;
            if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
        })
    }

    /// The piece in texels, cells being texels or the squares between their centres.
    fn piece(&self, uv: [[f64; 2]; 3], shift: f64) -> [[f64; 2]; 3] {
        uv.map(|p| [p[0] * self.width as f64 - shift, -p[1] * self.height as f64 - shift])
    }

    /// 3/S int rho b_i dS for the three vertices, under the bilinear filter or with constant texels.
    pub fn vertex_albedo(&self, uv: [[f64; 2]; 3], filtered: bool) -> [[f64; 3]; 3] {
        let mut out = [[0.0; 3]; 3];
        over_piece(self.piece(uv, if filtered { 0.5 } else { 0.0 }), |x, y, b, weight| {
            let (i, j) = (x.floor(), y.floor());
            let (fx, fy) = (x - i, y - j);
            let (i, j) = (i as i64, j as i64);
            let parts: &[(i64, i64, f64)] = if filtered {
                &[
                    (0, 0, (1.0 - fx) * (1.0 - fy)),
                    (1, 0, fx * (1.0 - fy)),
                    (0, 1, (1.0 - fx) * fy),
                    (1, 1, fx * fy),
                ]
            } else {
                &[(0, 0, 1.0)]
            };
            for (di, dj, w) in parts {
                let rho = self.texel(i + di, j + dj);
                for k in 0..3 {
                    for c in 0..3 {
                        out[k][c] += 3.0 * weight * w * b[k] * rho[c];
                    }
                }
            }
        });
        out
    }
}

pub(super) fn truth(kernel: Kernel, constants: &[u32], r: &mut Words<'_>) -> Answer {
    match kernel {
        Kernel::EmissionCoefficient => coefficient(r),
        Kernel::EmissionOverlap => overlap(points(r)),
        Kernel::EmissionScan => scanned(&Bitmap::new(constants), points(r), true),
        Kernel::EmissionScanTexels => scanned(&Bitmap::new(constants), points(r), false),
        Kernel::EmissionBrightest => brightest(&Bitmap::new(constants), points(r)),
        _ => Answer::Undecided,
    }
}

fn points(r: &mut Words<'_>) -> [[f64; 2]; 3] {
    [0; 3].map(|_| [r.real(), r.real()])
}

fn coefficient(r: &mut Words<'_>) -> Answer {
    let [a, b, c] = [r.vec3(), r.vec3(), r.vec3()];
    let area = 0.5 * vec::length(vec::cross(vec::sub(b, a), vec::sub(c, a)));
    let albedo = r.vec3();
    let light = [r.vec3(), r.vec3(), r.vec3()];
    let mut out: Vec<Expect> = (0..3)
        .map(|k| Expect::Ulp(albedo[k] * area * (light[0][k] + light[1][k] + light[2][k]) / 3.0))
        .collect();
    out.push(Expect::Ulp(area));
    Answer::Is(out)
}

/// Least and greatest on an axis.
fn extent(p: [[f64; 2]; 3], k: usize) -> (f64, f64) {
    p.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v[k]), h.max(v[k])))
}

fn overlap(p: [[f64; 2]; 3]) -> Answer {
    let (mut share, mut bary) = (0.0, [0.0; 3]);
    over_piece(p, |x, y, b, weight| {
        if (0.0..1.0).contains(&x) && (0.0..1.0).contains(&y) {
            share += weight;
            for k in 0..3 {
                bary[k] += weight * b[k];
            }
        }
    });
    // A line moved by the rounding of a coordinate moves the share by that over the extent.
    let mut scale = 1.0;
    for k in 0..2 {
        let (low, high) = extent(p, k);
        let size = low.abs().max(high.abs());
        if high > low {
            scale += size / (high - low);
        } else if (low - low.round()).abs() <= U * size.max(1.0) {
            // The whole triangle is on the border of two cells.
            return Answer::Undecided;
        }
    }
    let mut out = vec![Expect::Scaled(share, scale)];
    for b in bary {
        out.push(if share > 1e-3 * scale {
            Expect::Scaled(b / share, scale / share)
        } else {
            Expect::Finite
        });
    }
    Answer::Is(out)
}

fn scanned(bitmap: &Bitmap<'_>, uv: [[f64; 2]; 3], filtered: bool) -> Answer {
    let p = bitmap.piece(uv, 0.0);
    let d = |i: usize, j: usize, k: usize| p[i][k] - p[j][k];
    let area = 0.5 * (d(1, 0, 0) * d(2, 0, 1) - d(1, 0, 1) * d(2, 0, 0)).abs();
    let edges: f64 =
        [(0, 1), (1, 2), (2, 0)].iter().map(|(i, j)| d(*i, *j, 0).abs() + d(*i, *j, 1).abs()).sum();
    let cells = area + edges + 9.0;
    if (cells / 4096.0 - 1.0).abs() < 1e-3 {
        return Answer::Undecided;
    }
    if cells > 4096.0 {
        return nothing(10);
    }
    let mut scale = 1.0;
    if !filtered {
        // Where texels end, the rounding of a coordinate counts over the piece's extent.
        for k in 0..2 {
            let (low, high) = extent(p, k);
            if high > low {
                scale += 1.0 / (high - low);
            } else if (low - low.round()).abs() <= 4.0 * U * low.abs().max(1.0) {
                return Answer::Undecided;
            }
        }
    }
    let albedo = bitmap.vertex_albedo(uv, filtered);
    let mut out = vec![Expect::Word(1)];
    out.extend(albedo.iter().flatten().map(|a| Expect::Scaled(*a, scale)));
    Answer::Is(out)
}

/// The largest texel that a bilinear sample in the box around the piece can read, boxes between two margins.
fn brightest(bitmap: &Bitmap<'_>, uv: [[f64; 2]; 3]) -> Answer {
    let sides = [bitmap.width, bitmap.height];
    let turned = uv.map(|p| [p[0], -p[1]]);
    let of = |margin: f64| {
        let range = |k: usize| {
            let n = sides[k] as f64;
            let (low, high) = extent(turned, k);
            let slack = margin * (1.0 + low.abs().max(high.abs())) * n / 1_048_576.0;
            let first = (low * n - 0.5 - slack).floor() as i64;
            let last = (high * n - 0.5 + slack).floor() as i64 + 1;
            first..=last.min(first + sides[k] - 1)
        };
        let mut largest = [0.0_f64; 3];
        for y in range(1) {
            for x in range(0) {
                for (l, t) in largest.iter_mut().zip(bitmap.texel(x, y)) {
                    *l = l.max(t);
                }
            }
        }
        largest
    };
    let (least, most) = (of(0.0), of(2.0));
    if least == most {
        Answer::Is(least.map(|b| Expect::Ulp(b * (1.0 + 4.0 * U))).to_vec())
    } else {
        Answer::Undecided
    }
}
