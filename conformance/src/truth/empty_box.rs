//! Form factors of an empty box, in closed form: a dense operator whose rows sum to one.
//!
//! Two rectangles with sides along the axes, parallel or perpendicular, at any place: the double area integral of
//! cos cos' / (pi r^2) has a closed form, a sum over the 16 pairs of limits (J. R. Howell, A Catalog of Radiation Heat
//! Transfer Configuration Factors, C-13 and C-15; J. R. Ehlert and T. F. Smith, "View factors for perpendicular and
//! parallel rectangular plates", 1993).

use std::f64::consts::PI;

/// The interval that a rectangle spans along one axis.
type Span = [f64; 2];

/// Patches of a box without anything in it, and the form factors between them.
#[derive(Clone, Debug)]
pub struct EmptyBox {
    /// Area of each patch \[m^2\].
    pub areas: Vec<f64>,
    /// Centre of each patch \[m\].
    pub centres: Vec<[f64; 3]>,
    /// Unit normal of each patch, inward.
    pub normals: Vec<[f64; 3]>,
    /// `form_factors[i * n + j]` = F(i, j), from patch i to patch j.
    pub form_factors: Vec<f64>,
}

impl EmptyBox {
    /// A box of the given edges \[m\], each face cut into `cells` x `cells` patches: n = 6 cells^2.
    ///
    /// Order: faces -x, +x, -y, +y, -z, +z; in a face row by row. Accuracy of an entry about 1e-9 at 16 cells.
    pub fn new(edges: [f64; 3], cells: usize) -> Self {
        struct Patch {
            axis: usize,
            at: f64,
            spans: [Span; 3],
        }
        let mut patches = Vec::new();
        let mut this =
            Self { areas: Vec::new(), centres: Vec::new(), normals: Vec::new(), form_factors: Vec::new() };
        for face in 0..6 {
            let axis = face / 2;
            let at = if face % 2 == 0 { 0.0 } else { edges[axis] };
            let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
            for i in 0..cells * cells {
                let span = |k: usize, c: usize| {
                    [edges[k] * c as f64 / cells as f64, edges[k] * (c + 1) as f64 / cells as f64]
                };
                let mut spans = [[at, at]; 3];
                (spans[a], spans[b]) = (span(a, i % cells), span(b, i / cells));
                this.areas.push((spans[a][1] - spans[a][0]) * (spans[b][1] - spans[b][0]));
                this.centres.push(spans.map(|s| 0.5 * (s[0] + s[1])));
                let mut normal = [0.0; 3];
                normal[axis] = if face % 2 == 0 { 1.0 } else { -1.0 };
                this.normals.push(normal);
                patches.push(Patch { axis, at, spans });
            }
        }
        for p in &patches {
            for q in &patches {
                let f = if p.axis == q.axis {
                    if p.at == q.at {
                        0.0
                    } else {
                        let (a, b) = ((p.axis + 1) % 3, (p.axis + 2) % 3);
                        parallel([p.spans[a], p.spans[b]], [q.spans[a], q.spans[b]], (p.at - q.at).abs())
                    }
                } else {
                    // The axis that both contain.
                    let common = 3 - p.axis - q.axis;
                    let away = |s: Span, wall: f64| {
                        let d = [(s[0] - wall).abs(), (s[1] - wall).abs()];
                        [d[0].min(d[1]), d[0].max(d[1])]
                    };
                    perpendicular(
                        p.spans[common],
                        away(p.spans[q.axis], q.at),
                        q.spans[common],
                        away(q.spans[p.axis], p.at),
                    )
                };
                this.form_factors.push(f);
            }
        }
        this
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.areas.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.areas.is_empty()
    }
}

/// Form factor from the rectangle `from` to the parallel rectangle `to` at distance `z`; spans along the same two axes.
pub fn parallel(from: [Span; 2], to: [Span; 2], z: f64) -> f64 {
    let g = |x: f64, y: f64| {
        let (u, v) = ((x * x + z * z).sqrt(), (y * y + z * z).sqrt());
        (y * u * (y / u).atan() + x * v * (x / v).atan() - 0.5 * z * z * (x * x + y * y + z * z).ln())
            / (2.0 * PI)
    };
    sum_over_limits(|i, j, k, l| g(from[0][i] - to[0][k], from[1][j] - to[1][l]), area(from))
}

/// Form factor between rectangles in two walls that meet at a right angle: `y` along the common edge, `x` the distance of
/// `from` from that edge, `eta` and `xi` likewise of `to`.
pub fn perpendicular(y: Span, x: Span, eta: Span, xi: Span) -> f64 {
    let g = |x: f64, y: f64, eta: f64, xi: f64| {
        let (d, s) = (y - eta, x * x + xi * xi);
        let c = s.sqrt();
        // Both terms tend to 0 where the corners meet.
        let first = if c > 0.0 { d * c * (d / c).atan() } else { 0.0 };
        let second = if s + d * d > 0.0 { 0.25 * (s - d * d) * (s + d * d).ln() } else { 0.0 };
        (first - second) / (2.0 * PI)
    };
    sum_over_limits(|i, j, k, l| g(x[i], y[j], eta[k], xi[l]), area([x, y]))
}

fn area(spans: [Span; 2]) -> f64 {
    (spans[0][1] - spans[0][0]) * (spans[1][1] - spans[1][0])
}

/// The sum over the two limits of four integrals, signed, over the area.
fn sum_over_limits(g: impl Fn(usize, usize, usize, usize) -> f64, area: f64) -> f64 {
    let mut sum = 0.0;
    for n in 0..16_usize {
        let [i, j, k, l] = [n & 1, n >> 1 & 1, n >> 2 & 1, n >> 3];
        let sign = if (i + j + k + l) % 2 == 0 { 1.0 } else { -1.0 };
        sum += sign * g(i, j, k, l);
    }
    sum / area
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn howells_values() {
        // Howell C-11 and C-14, evaluated from their own closed forms.
        let near = |a: f64, b: f64| assert!((a - b).abs() <= 1e-12, "{a} is not {b}");
        near(parallel([[0.0, 1.0]; 2], [[0.0, 1.0]; 2], 1.0), 0.199_824_895_698_387_38);
        near(parallel([[0.0, 1.0], [0.0, 2.0]], [[0.0, 1.0], [0.0, 2.0]], 1.0), 0.285_875_384_850_714_73);
        near(parallel([[0.0, 3.0], [0.0, 0.5]], [[0.0, 3.0], [0.0, 0.5]], 0.7), 0.272_126_105_084_718_5);
        near(perpendicular([0.0, 1.0], [0.0, 1.0], [0.0, 1.0], [0.0, 1.0]), 0.200_043_776_075_403_16);
        near(perpendicular([0.0, 1.0], [0.0, 2.0], [0.0, 1.0], [0.0, 3.0]), 0.161_694_014_333_027_57);
        near(perpendicular([0.0, 2.0], [0.0, 1.0], [0.0, 2.0], [0.0, 0.5]), 0.166_855_394_973_300_43);
    }

    #[test]
    fn rows_sum_to_one_and_areas_are_reciprocal() {
        let b = EmptyBox::new([1.0, 1.5, 0.7], 4);
        let n = b.len();
        for i in 0..n {
            let sum: f64 = b.form_factors[i * n..][..n].iter().sum();
            assert!((sum - 1.0).abs() <= 1e-10, "row {i} sums to {sum}");
            for j in 0..n {
                let (ij, ji) =
                    (b.areas[i] * b.form_factors[i * n + j], b.areas[j] * b.form_factors[j * n + i]);
                assert!((ij - ji).abs() <= 1e-12, "{i} {j}");
                assert!(b.form_factors[i * n + j] >= -1e-12);
            }
        }
    }
}
