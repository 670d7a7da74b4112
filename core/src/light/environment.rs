//! A picture of everything at infinity.
//!
//! Quantity: radiance \[W m^-2 sr^-1\] per channel of a direction. In the picture's own axes a unit direction (x, y, z) has longitude phi = atan2(x, -z), which is 0 towards -z and grows to the
//! right, and polar angle theta from +y. Texel column i has its centre at phi = 2 pi ((i + 1/2) / width - 1/2), so that the middle of the picture looks along -z; row j has its centre
//! at theta = pi j / (height - 1): the first row is +y itself, the last -y. Between the centres radiance is bilinear in these angles, round the seam too. (A picture of one row is the same at all
//! theta.) This is what Mitsuba 3's `envmap` does, but that its axes are turned by half a turn about y: there the left edge looks along -z.
//!
//! Directions are drawn cell by cell, a cell being what lies between four centres: a row by integer probabilities, then a column within it, in proportion to the mean of the four texels times the
//! cell's solid angle; within a cell all directions are alike. So the density is nowhere 0 where there is radiance, and bounded at the poles.

use crate::math::{self, PI, TAU, Vec3};
use crate::sampling::discrete::{IntegerCdf, WeightError, pick_in, pmf_in};
use alloc::vec::Vec;

/// A direction that was drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentSample {
    /// Unit vector towards the light.
    pub wi: Vec3,
    /// Radiance that comes from there \[W m^-2 sr^-1\].
    pub radiance: Vec3,
    /// Density per solid angle.
    pub pdf: f32,
}

/// A picture of an environment, with its distribution.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentMap {
    /// Columns of texels.
    pub width: u32,
    /// Rows of texels.
    pub height: u32,
    /// Radiance \[W m^-2 sr^-1\], row by row, top row first.
    pub texels: Vec<[f32; 3]>,
    /// Rotation from the picture's axes to the world's, by rows.
    pub to_world: [[f32; 3]; 3],
    /// Index of its light among the scene's lights.
    pub light: u32,
    /// Probability of that light to be picked.
    pub light_pmf: f32,
    /// Distribution of rows of cells: counts before each (see [`crate::sampling::discrete`]).
    pub rows: Vec<u32>,
    /// Where the run of each row of cells begins in `columns`, and where the last one ends.
    pub starts: Vec<u32>,
    /// Distributions of the columns within each row of cells.
    pub columns: Vec<u32>,
}

/// Place of a direction among the cells.
#[derive(Clone, Copy)]
struct Place {
    column: u32,
    row: u32,
    right: f32,
    down: f32,
}

/// A random word of 24 known bits, the other 8 from a hash.
fn widen(u: f32, salt: u32) -> u32 {
    (((u * 16_777_216.0) as u32) << 8) | (crate::sampling::counter::hash_u32(salt) & 255)
}

impl EnvironmentMap {
    /// From texels that are finite and not negative, width * height of them and at least one, and a rotation.
    ///
    /// # Errors
    /// When no texel has radiance.
    pub(crate) fn try_new(
        (width, height): (u32, u32),
        texels: Vec<[f32; 3]>,
        to_world: [[f32; 3]; 3],
    ) -> Result<Self, WeightError> {
        let mut map = Self {
            width,
            height,
            texels,
            to_world,
            light: 0,
            light_pmf: 1.0,
            rows: Vec::new(),
            starts: alloc::vec![0],
            columns: Vec::new(),
        };
        let mut sums = Vec::new();
        let mut weights = alloc::vec![0.0_f64; width as usize];
        for row in 0..map.cell_rows() {
            for (column, slot) in weights.iter_mut().enumerate() {
                let corners = map.corners(column as u32, row);
                *slot = corners.iter().flatten().map(|x| f64::from(*x)).sum();
            }
            let sum: f64 = weights.iter().sum();
            sums.push(sum * f64::from(map.height_of(row)));
            if sum > 0.0 {
                map.columns.extend(IntegerCdf::try_new_f64(&weights)?.cumulative());
            }
            map.starts.push(map.columns.len() as u32);
        }
        map.rows = IntegerCdf::try_new_f64(&sums)?.cumulative().to_vec();
        Ok(map)
    }

    /// Rows of cells, at least one.
    #[inline]
    fn cell_rows(&self) -> u32 {
        self.height.max(2) - 1
    }

    /// Polar angle where a row of cells begins.
    #[inline]
    fn theta(&self, row: u32) -> f32 {
        PI * (row as f32 / self.cell_rows() as f32)
    }

    /// cos theta at the top of a row of cells less that at its bottom.
    #[inline]
    fn height_of(&self, row: u32) -> f32 {
        let (a, b) = (self.theta(row), self.theta(row + 1));
        2.0 * math::sin(0.5 * (a + b)) * math::sin(0.5 * (b - a))
    }

    #[inline]
    fn solid_angle(&self, row: u32) -> f32 {
        TAU / self.width as f32 * self.height_of(row)
    }

    /// Texels at the corners of a cell: two above, two below.
    #[inline]
    fn corners(&self, column: u32, row: u32) -> [[f32; 3]; 4] {
        let next = if column + 1 < self.width { column + 1 } else { 0 };
        let below = (row + 1).min(self.height - 1);
        let at = |x: u32, y: u32| self.texels[(y as usize) * self.width as usize + x as usize];
        [at(column, row), at(next, row), at(column, below), at(next, below)]
    }

    /// Where a unit direction lies.
    #[inline]
    fn place(&self, direction: Vec3) -> Place {
        let m = self.to_world.map(Vec3::from_array);
        // The transpose takes it back.
        let d = m[0] * direction.x + m[1] * direction.y + m[2] * direction.z;
        let u = math::atan2(d.x, -d.z) / TAU + 0.5;
        let x = u * self.width as f32 - 0.5;
        let low = math::floor(x);
        let mut column = low as i32;
        if column < 0 {
            column += self.width as i32;
        }
        let theta = math::atan2(math::sqrt(d.x * d.x + d.z * d.z), d.y);
        let y = theta / PI * self.cell_rows() as f32;
        let row = (y as u32).min(self.cell_rows() - 1);
        Place {
            column: (column.max(0) as u32).min(self.width - 1),
            row,
            right: (x - low).clamp(0.0, 1.0),
            down: (y - row as f32).clamp(0.0, 1.0),
        }
    }

    fn radiance_at(&self, p: Place) -> Vec3 {
        let [a, b, c, d] = self.corners(p.column, p.row).map(Vec3::from_array);
        let mix = |a: Vec3, b: Vec3, t: f32| a * (1.0 - t) + b * t;
        mix(mix(a, b, p.right), mix(c, d, p.right), p.down)
    }

    fn pdf_at(&self, column: u32, row: u32) -> f32 {
        pmf_in(&self.rows, row) * pmf_in(self.run(row), column) / self.solid_angle(row)
    }

    #[inline]
    fn run(&self, row: u32) -> &[u32] {
        let row = row as usize;
        &self.columns[self.starts[row] as usize..self.starts[row + 1] as usize]
    }

    /// Radiance from a unit direction \[W m^-2 sr^-1\].
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        self.radiance_at(self.place(direction))
    }

    /// Density per solid angle with which [`Self::sample`] draws a unit direction.
    pub fn pdf_solid_angle(&self, direction: Vec3) -> f32 {
        let p = self.place(direction);
        self.pdf_at(p.column, p.row)
    }

    /// Radiance from a unit direction, and the density with which [`Self::sample`] draws it.
    pub fn meet(&self, direction: Vec3) -> (Vec3, f32) {
        let p = self.place(direction);
        (self.radiance_at(p), self.pdf_at(p.column, p.row))
    }

    /// A direction by two full random words: the row, the column. What they say beyond that is the place in the cell.
    pub fn sample(&self, words: [u32; 2]) -> EnvironmentSample {
        let row = pick_in(&self.rows, words[0]);
        let column = pick_in(self.run(row.index), words[1]);
        let (down, right) = (math::u32_to_unit(row.remainder), math::u32_to_unit(column.remainder));
        let phi = TAU * ((column.index as f32 + 0.5 + right) / self.width as f32 - 0.5);
        // 1 - cos about the nearer pole, so that directions near one keep their digits.
        let (a, b) = (self.theta(row.index), self.theta(row.index + 1));
        let north = a + b < PI;
        let versine = |theta: f32| {
            let s = math::sin(0.5 * if north { theta } else { PI - theta });
            2.0 * s * s
        };
        let v = versine(a) + (versine(b) - versine(a)) * down;
        let sin = math::sqrt_clamped(v * (2.0 - v));
        let cos = if north { 1.0 - v } else { v - 1.0 };
        let (s, c) = math::sin_cos(phi);
        let local = Vec3::new(sin * s, cos, -sin * c);
        let [x, y, z] = self.to_world.map(|row| Vec3::from_array(row).dot(local));
        let wi = Vec3::new(x, y, z);
        let pdf = row.pmf * column.pmf / self.solid_angle(row.index);
        EnvironmentSample { wi, radiance: self.radiance(wi), pdf }
    }

    /// As [`Self::sample`], from numbers in [0, 1) of 24 bits. `salt`: any further bits of the same sample, which stand in for the rest of the words.
    pub(crate) fn sample_units(&self, u: [f32; 2], salt: [f32; 2]) -> EnvironmentSample {
        let [a, b] = salt.map(f32::to_bits);
        self.sample([widen(u[0], a ^ 0x9E37_79B9), widen(u[1], b ^ 0x85EB_CA6B)])
    }

    /// Integral of radiance over all directions \[W m^-2\] per channel, by Gauss' rule in theta.
    pub(crate) fn integral(&self) -> [f32; 3] {
        const PARTS: u32 = 16;
        let mut sum = [0.0_f64; 3];
        for row in 0..self.cell_rows() {
            let (a, step) = (self.theta(row), (self.theta(row + 1) - self.theta(row)) / PARTS as f32);
            // Integrals of sin theta, and of that times the share of the row below.
            let (mut all, mut below) = (0.0, 0.0);
            for i in 0..PARTS {
                for off in [0.211_324_87, 0.788_675_1] {
                    let x = i as f32 + off;
                    let w = f64::from(0.5 * step * math::sin(a + x * step));
                    all += w;
                    below += w * f64::from(x) / f64::from(PARTS);
                }
            }
            let next = (row + 1).min(self.height - 1);
            for (weight, row) in [(all - below, row), (below, next)] {
                let start = row as usize * self.width as usize;
                for texel in &self.texels[start..start + self.width as usize] {
                    for (s, x) in sum.iter_mut().zip(texel) {
                        *s += weight * f64::from(*x);
                    }
                }
            }
        }
        let step = f64::from(TAU) / f64::from(self.width);
        sum.map(|s| (s * step) as f32)
    }
}
