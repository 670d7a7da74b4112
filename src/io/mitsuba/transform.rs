//! Transforms: their parts apply in the order in which they are written.

use etendue_core::math;

use super::tree::Element;
use super::values::Object;
use crate::io::error::{LoadError, quoted};

/// How far a transform may be from turning and even scaling and still be taken as such, relative to the scale.
const TOLERANCE: f64 = 1e-4;

/// A 4 x 4 matrix by rows, for columns of coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transform(pub(super) [[f64; 4]; 4]);

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn length(a: [f64; 3]) -> f64 {
    // Scaled, so that squares neither overflow nor vanish.
    let largest = a.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let b = a.map(|x| x / largest);
    largest * math::sqrt64(dot(b, b))
}

/// The direction of a vector; `None` where it has none.
pub(super) fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let l = length(a);
    (l > 0.0 && l.is_finite()).then(|| a.map(|x| x / l))
}

impl Transform {
    pub(super) const IDENTITY: Self =
        Self([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]);

    fn linear(m: [[f64; 3]; 3]) -> Self {
        let row = |i: usize| [m[i][0], m[i][1], m[i][2], 0.0];
        Self([row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]])
    }

    /// The columns are the images of the axes, then that of the origin.
    pub(super) fn columns(c: [[f64; 3]; 4]) -> Self {
        let row = |i: usize| [c[0][i], c[1][i], c[2][i], c[3][i]];
        Self([row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]])
    }

    /// First `other`, then `self`.
    pub(super) fn after(&self, other: &Self) -> Self {
        let mut out = [[0.0; 4]; 4];
        for (i, row) in out.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value = (0..4).map(|k| self.0[i][k] * other.0[k][j]).sum();
            }
        }
        Self(out)
    }

    pub(super) fn column(&self, j: usize) -> [f64; 3] {
        [self.0[0][j], self.0[1][j], self.0[2][j]]
    }

    pub(super) fn point(&self, p: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| dot([self.0[i][0], self.0[i][1], self.0[i][2]], p) + self.0[i][3])
    }

    /// Of the linear part; negative mirrors.
    pub(super) fn determinant(&self) -> f64 {
        dot(cross(self.column(0), self.column(1)), self.column(2))
    }

    /// The factor of a transform that turns, mirrors and scales evenly; `None` for any other.
    pub(super) fn even_scale(&self) -> Option<f64> {
        let axes = [0, 1, 2].map(|j| self.column(j));
        let scale = length(axes[0]);
        let close = |a: f64, b: f64| (a - b).abs() <= TOLERANCE * b;
        let even = axes.iter().all(|a| close(length(*a), scale));
        let square = [(0, 1), (1, 2), (2, 0)]
            .iter()
            .all(|&(i, j)| dot(axes[i], axes[j]).abs() <= TOLERANCE * length(axes[i]) * length(axes[j]));
        (scale > 0.0 && scale.is_finite() && even && square).then_some(scale)
    }

    /// The first three rows of an affine transform that does not flatten space.
    pub(super) fn affine(&self, of: &Object<'_>) -> Result<[[f32; 4]; 3], LoadError> {
        let d = self.determinant();
        let rows = [0, 1, 2].map(|i| self.0[i].map(|x| x as f32));
        if d == 0.0 || !d.is_finite() || rows.iter().flatten().any(|x| !x.is_finite()) {
            return Err(of.error("a to_world that flattens space", "a transform that can be undone"));
        }
        Ok(rows)
    }

    /// Reads a `<transform>`.
    pub(super) fn read<'t>(of: &Object<'t>, element: &'t Element) -> Result<Self, LoadError> {
        let mut out = Self::IDENTITY;
        for &child in &element.children {
            let step = &of.tree.elements[child];
            out = Self::step(of, step)?.after(&out);
        }
        if out.0.iter().flatten().any(|x| !(*x as f32).is_finite()) {
            return Err(of.error_at(element, "numbers that overflow", "a finite transform"));
        }
        Ok(out)
    }

    fn step<'t>(of: &Object<'t>, step: &'t Element) -> Result<Self, LoadError> {
        match step.tag.as_str() {
            "translate" => {
                let t = of.xyz(step, Some(0.0))?;
                Ok(Self::columns([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], t]))
            }
            "scale" => {
                let [x, y, z] = of.xyz(step, Some(1.0))?;
                Ok(Self::linear([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]))
            }
            "rotate" => {
                let axis = of.xyz(step, Some(0.0))?;
                let Some(axis) = unit(axis) else {
                    return Err(of.error_at(step, "no axis", "an axis: x, y and z, not all 0"));
                };
                let Some(angle) = step.attribute("angle") else {
                    return Err(of.error_at(step, "no angle", "angle=\"degrees\""));
                };
                let [angle] = of.numbers(step, angle)?[..] else {
                    return Err(of.error_at(step, quoted(angle), "one angle in degrees"));
                };
                Ok(rotation(axis, angle))
            }
            "matrix" => {
                let text = step.attribute("value").unwrap_or_default();
                let m = of.numbers(step, text)?;
                match m.len() {
                    9 => Ok(Self::linear([0, 1, 2].map(|i| [m[3 * i], m[3 * i + 1], m[3 * i + 2]]))),
                    16 if m[12..] == [0.0, 0.0, 0.0, 1.0] => {
                        Ok(Self([0, 1, 2, 3].map(|i| [m[4 * i], m[4 * i + 1], m[4 * i + 2], m[4 * i + 3]])))
                    }
                    16 => {
                        let found = format!("the last row {:?}", &m[12..]);
                        Err(of.error_at(step, found, "0 0 0 1 (an affine transform, row by row)"))
                    }
                    n => Err(of.error_at(step, format!("{n} numbers"), "16 numbers, or 9")),
                }
            }
            "lookat" => look_at(of, step),
            other => {
                let found = format!("<{other}>");
                Err(of.error_at(step, found, "translate, rotate, scale, matrix or lookat"))
            }
        }
    }
}

/// About a unit axis by an angle in degrees.
fn rotation(axis: [f64; 3], degrees: f64) -> Transform {
    // Quarter turns exactly, as nobody means the rounding of their radians.
    let turn = degrees % 360.0;
    let quarters = turn / 90.0;
    let (sin, cos) = match [0, 1, 2, 3].into_iter().find(|k| {
        let k = f64::from(*k);
        quarters == k || quarters == k - 4.0
    }) {
        Some(k) => [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][k as usize],
        None => {
            let (s, c) = math::sin_cos((turn as f32).to_radians());
            (f64::from(s), f64::from(c))
        }
    };
    let [x, y, z] = axis;
    let d = 1.0 - cos;
    Transform::linear([
        [x * x * d + cos, x * y * d - z * sin, x * z * d + y * sin],
        [y * x * d + z * sin, y * y * d + cos, y * z * d - x * sin],
        [z * x * d - y * sin, z * y * d + x * sin, z * z * d + cos],
    ])
}

/// Looks along +z of its own axes, +x is on the left and +y up.
fn look_at<'t>(of: &Object<'t>, step: &'t Element) -> Result<Transform, LoadError> {
    let read = |name: &'static str| -> Result<Option<[f64; 3]>, LoadError> {
        let Some(text) = step.attribute(name) else { return Ok(None) };
        match of.numbers(step, text)?[..] {
            [x, y, z] => Ok(Some([x, y, z])),
            _ => Err(of.error_at(step, format!("{name} {}", quoted(text)), "three numbers")),
        }
    };
    let (Some(origin), Some(target)) = (read("origin")?, read("target")?) else {
        return Err(of.error_at(step, "something missing", "origin, target and up"));
    };
    let Some(forward) = unit([0, 1, 2].map(|i| target[i] - origin[i])) else {
        return Err(of.error_at(step, "a target that is the origin", "another point"));
    };
    let up = match read("up")?.filter(|up| *up != [0.0; 3]) {
        Some(up) => up,
        // Any will do: the axis that is farthest from where it looks.
        None => {
            let least = (0..3).min_by(|i, j| forward[*i].abs().total_cmp(&forward[*j].abs())).unwrap_or(0);
            let mut up = [0.0; 3];
            up[least] = 1.0;
            up
        }
    };
    let Some(left) = unit(cross(up, forward)).filter(|l| length(*l).is_finite()) else {
        return Err(of.error_at(step, "an up along the view", "another direction"));
    };
    Ok(Transform::columns([left, cross(forward, left), forward, origin]))
}
