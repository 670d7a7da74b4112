//! FLIP: how different two images look when they are flipped between in place, per pixel on \[0, 1\].
//!
//! Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom and Fairchild, "FLIP: A Difference Evaluator for
//! Alternating Images", HPG 2020. Colour: both images go to YCxCz, are blurred by the contrast sensitivity of
//! the eye at the viewing distance (eq. 4 and table 1), clipped to displayable colours, go to L*a*b* with
//! Hunt's adjustment, and are compared by HyAB to the power 0.7, mapped so that the distance of green and blue
//! is 1 and 0.4 of it is 0.95. Features: edges and points of the achromatic channel by first and second
//! derivatives of a Gaussian as wide as an edge is sharp (0.082 degrees). Together: `color^(1 - feature)`.
//!
//! Every filter is a product of filters along x and y (the blue-yellow one a sum of two such products).
//! Outside the image its nearest pixel is repeated. Planes are f32, colour and weights f64; the result agrees
//! with the authors' own program within 1e-3 per pixel (tests/metrics_flip.rs).

use super::MetricsError;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// The paper's default: 0.7 m in front of a 0.7 m wide display of 3840 pixels.
pub const DEFAULT_PIXELS_PER_DEGREE: f64 = 67.0;

/// Contrast sensitivity (table 1 of the paper): amplitude a and scale b (degrees^2) of each Gaussian.
const SENSITIVITY_Y: (f64, f64) = (1.0, 0.0047);
const SENSITIVITY_CX: (f64, f64) = (1.0, 0.0053);
const SENSITIVITY_CZ: [(f64, f64); 2] = [(34.1, 0.04), (13.5, 0.025)];
/// Exponent of the colour difference, and the point where its mapping bends.
const COLOR_EXPONENT: f64 = 0.7;
const BEND_AT: f64 = 0.4;
const BEND_TO: f64 = 0.95;
/// Width of a detected feature in degrees. (The feature difference goes to the power 0.5: a square root.)
const FEATURE_WIDTH: f64 = 0.082;

/// D65 white of the sRGB primaries below: the row sums of the matrix.
const RGB_TO_XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

type Color = [f64; 3];

fn multiply(m: &[[f64; 3]; 3], v: Color) -> Color {
    [0, 1, 2].map(|i| m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2])
}

fn inverse(m: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let minor = |i: usize, j: usize| {
        let (a, b) = ((i + 1) % 3, (i + 2) % 3);
        let (c, d) = ((j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| minor(j, i) / determinant))
}

/// Colour conversions with the constants that depend on the matrix.
struct Space {
    white: Color,
    from_xyz: [[f64; 3]; 3],
    /// HyAB^0.7 of the most distant displayable pair, green and blue.
    max_distance: f64,
}

impl Space {
    fn new() -> Self {
        let mut space = Self {
            white: multiply(&RGB_TO_XYZ, [1.0; 3]),
            from_xyz: inverse(&RGB_TO_XYZ),
            max_distance: 1.0,
        };
        let (green, blue) = (space.hunt_lab([0.0, 1.0, 0.0]), space.hunt_lab([0.0, 0.0, 1.0]));
        space.max_distance = hyab(green, blue).powf(COLOR_EXPONENT);
        space
    }

    /// XYZ over white.
    fn relative(&self, linear: Color) -> Color {
        let xyz = multiply(&RGB_TO_XYZ, linear);
        [0, 1, 2].map(|i| xyz[i] / self.white[i])
    }

    /// Linear display light on \[0, 1\] (clamped, NaN 0) to YCxCz: L*a*b* without its cube roots.
    fn ycxcz(&self, linear: [f32; 3]) -> Color {
        let [x, y, z] = self.relative(linear.map(|v| f64::from(v.max(0.0)).min(1.0)));
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// YCxCz to the nearest displayable linear colour.
    fn displayable(&self, [y, cx, cz]: Color) -> Color {
        let y = (y + 16.0) / 116.0;
        let relative = [y + cx / 500.0, y, y - cz / 200.0];
        let xyz = [0, 1, 2].map(|i| relative[i] * self.white[i]);
        multiply(&self.from_xyz, xyz).map(|v| v.clamp(0.0, 1.0))
    }

    /// Linear colour to L*a*b* with Hunt's adjustment: chroma fades with lightness.
    fn hunt_lab(&self, linear: Color) -> Color {
        const DELTA: f64 = 6.0 / 29.0;
        let f = self.relative(linear).map(|v| {
            if v > DELTA * DELTA * DELTA { v.cbrt() } else { v / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
        });
        let lightness = 116.0 * f[1] - 16.0;
        let hunt = 0.01 * lightness;
        [lightness, hunt * 500.0 * (f[0] - f[1]), hunt * 200.0 * (f[1] - f[2])]
    }

    /// The colour difference on \[0, 1\] of two blurred YCxCz colours.
    fn color_difference(&self, a: Color, b: Color) -> f64 {
        let lab = |c| self.hunt_lab(self.displayable(c));
        let d = hyab(lab(a), lab(b)).powf(COLOR_EXPONENT);
        let bend = BEND_AT * self.max_distance;
        if d < bend {
            d / bend * BEND_TO
        } else {
            BEND_TO + (d - bend) / (self.max_distance - bend) * (1.0 - BEND_TO)
        }
    }
}

/// City-block distance in lightness plus Euclidean distance in chroma (Abasi, Tehran and Fairchild 2019).
fn hyab(p: Color, q: Color) -> f64 {
    let (a, b) = (p[1] - q[1], p[2] - q[2]);
    (p[0] - q[0]).abs() + (a * a + b * b).sqrt()
}

/// Weights at -radius..=radius.
struct Kernel(Vec<f32>);

impl Kernel {
    /// `weight` at each whole offset, positive and negative weights each scaled to a sum of magnitude 1.
    fn balanced(radius: usize, weight: impl Fn(f64) -> f64) -> Self {
        let raw: Vec<f64> = (0..=2 * radius).map(|i| weight(i as f64 - radius as f64)).collect();
        let positive: f64 = raw.iter().filter(|w| **w > 0.0).sum();
        let negative: f64 = -raw.iter().filter(|w| **w < 0.0).sum::<f64>();
        let scaled = |w: f64| match w {
            w if w > 0.0 => w / positive,
            w if w < 0.0 => w / negative,
            _ => 0.0,
        };
        Self(raw.into_iter().map(|w| scaled(w) as f32).collect())
    }

    fn radius(&self) -> usize {
        self.0.len() / 2
    }
}

/// An achromatic or chromatic channel, row by row.
struct Size {
    width: usize,
    height: usize,
}

impl Size {
    /// Convolution along each row.
    fn rows(&self, plane: &[f32], kernel: &Kernel) -> Vec<f32> {
        let radius = kernel.radius();
        let mut out = vec![0.0_f32; plane.len()];
        let mut padded = vec![0.0_f32; self.width + 2 * radius];
        for (row, out) in plane.chunks_exact(self.width).zip(out.chunks_exact_mut(self.width)) {
            padded[..radius].fill(row[0]);
            padded[radius..radius + self.width].copy_from_slice(row);
            padded[radius + self.width..].fill(row[self.width - 1]);
            for (k, w) in kernel.0.iter().enumerate() {
                for (o, p) in out.iter_mut().zip(&padded[k..]) {
                    *o += w * p;
                }
            }
        }
        out
    }

    /// Convolution along each column, as sums of whole rows.
    fn columns(&self, plane: &[f32], kernel: &Kernel) -> Vec<f32> {
        let radius = kernel.radius();
        let mut out = vec![0.0_f32; plane.len()];
        for (y, out) in out.chunks_exact_mut(self.width).enumerate() {
            for (k, w) in kernel.0.iter().enumerate() {
                let from = (y + k).saturating_sub(radius).min(self.height - 1);
                let row = &plane[from * self.width..][..self.width];
                for (o, p) in out.iter_mut().zip(row) {
                    *o += w * p;
                }
            }
        }
        out
    }

    fn blur(&self, plane: &[f32], kernel: &Kernel) -> Vec<f32> {
        self.columns(&self.rows(plane, kernel), kernel)
    }
}

/// The filters of one viewing distance.
struct Filters {
    y: Kernel,
    cx: Kernel,
    cz: [Kernel; 2],
    /// Share of each product in the blue-yellow filter; they sum to 1.
    cz_share: [f32; 2],
    gauss: Kernel,
    edge: Kernel,
    point: Kernel,
}

impl Filters {
    fn new(pixels_per_degree: f64) -> Self {
        // All channels take the radius of the widest: three standard deviations, sigma^2 = b / (2 pi^2).
        let widest = SENSITIVITY_CZ[0].1.max(SENSITIVITY_CZ[1].1);
        let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as usize;
        let profile = |b: f64| {
            move |offset: f64| {
                let degrees = offset / pixels_per_degree;
                (-PI * PI * degrees * degrees / b).exp()
            }
        };
        // Weight of a two-dimensional Gaussian of amplitude a sqrt(pi / b) (eq. 4), before the common scale.
        let mass = SENSITIVITY_CZ.map(|(a, b)| {
            let sum: f64 = (0..=2 * radius).map(|i| profile(b)(i as f64 - radius as f64)).sum();
            a * (PI / b).sqrt() * sum * sum
        });
        let sigma = 0.5 * FEATURE_WIDTH * pixels_per_degree;
        let feature_radius = (3.0 * sigma).ceil() as usize;
        let gauss = move |offset: f64| (-offset * offset / (2.0 * sigma * sigma)).exp();
        Self {
            y: Kernel::balanced(radius, profile(SENSITIVITY_Y.1)),
            cx: Kernel::balanced(radius, profile(SENSITIVITY_CX.1)),
            cz: SENSITIVITY_CZ.map(|(_, b)| Kernel::balanced(radius, profile(b))),
            cz_share: mass.map(|m| (m / (mass[0] + mass[1])) as f32),
            gauss: Kernel::balanced(feature_radius, gauss),
            edge: Kernel::balanced(feature_radius, |o| -o * gauss(o)),
            point: Kernel::balanced(feature_radius, |o| (o * o / (sigma * sigma) - 1.0) * gauss(o)),
        }
    }
}

/// What is compared of one image: blurred colour, strength of edges and of points.
struct Seen {
    color: [Vec<f32>; 3],
    edge: Vec<f32>,
    point: Vec<f32>,
}

impl Seen {
    fn new(size: &Size, space: &Space, filters: &Filters, image: &[[f32; 3]]) -> Self {
        let mut planes = [0, 1, 2].map(|_| Vec::with_capacity(image.len()));
        for pixel in image {
            let color = space.ycxcz(*pixel);
            for (plane, value) in planes.iter_mut().zip(color) {
                plane.push(value as f32);
            }
        }
        let [y, cx, cz] = planes;
        let mut blue_yellow = size.blur(&cz, &filters.cz[0]);
        let second = size.blur(&cz, &filters.cz[1]);
        for (a, b) in blue_yellow.iter_mut().zip(&second) {
            *a = *a * filters.cz_share[0] + b * filters.cz_share[1];
        }
        let color = [size.blur(&y, &filters.y), size.blur(&cx, &filters.cx), blue_yellow];

        // Features see lightness on [0, 1].
        let gray: Vec<f32> = y.iter().map(|v| (v + 16.0) / 116.0).collect();
        let smooth = size.rows(&gray, &filters.gauss);
        let norm = |kernel: &Kernel| -> Vec<f32> {
            let along_x = size.columns(&size.rows(&gray, kernel), &filters.gauss);
            let along_y = size.columns(&smooth, kernel);
            along_x.iter().zip(&along_y).map(|(a, b)| (a * a + b * b).sqrt()).collect()
        };
        Self { color, edge: norm(&filters.edge), point: norm(&filters.point) }
    }

    fn color_at(&self, i: usize) -> Color {
        [0, 1, 2].map(|c| f64::from(self.color[c][i]))
    }
}

/// The FLIP difference of each pixel, on \[0, 1\], row by row from the top.
///
/// `reference` and `test` are sRGB display values on \[0, 1\] (encoded, not linear; clamped, NaN 0), `width *
/// height` each. `pixels_per_degree` is the viewing distance times the pixels of that length, times pi / 180;
/// [`DEFAULT_PIXELS_PER_DEGREE`] is the paper's. The difference is symmetric in the two images and exactly 0
/// where they agree over the filters' reach (10 pixels at 67 per degree).
///
/// # Errors
/// No pixels, arrays of another size, or `pixels_per_degree` outside \[1, 1000\].
pub fn flip_map(
    width: usize,
    height: usize,
    reference: &[[f32; 3]],
    test: &[[f32; 3]],
    pixels_per_degree: f64,
) -> Result<Vec<f32>, MetricsError> {
    let decode = |image: &[[f32; 3]]| -> Vec<[f32; 3]> { image.iter().map(|p| p.map(decode_srgb)).collect() };
    flip_map_linear(width, height, &decode(reference), &decode(test), pixels_per_degree)
}

/// The inverse of the sRGB transfer function (IEC 61966-2-1), on \[0, 1\] (clamped, NaN 0).
fn decode_srgb(value: f32) -> f32 {
    let v = f64::from(value.max(0.0)).min(1.0);
    (if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }) as f32
}

/// [`flip_map`] of images that are not encoded: the linear light of a display on \[0, 1\] (clamped, NaN 0).
///
/// # Errors
/// As [`flip_map`].
pub fn flip_map_linear(
    width: usize,
    height: usize,
    reference: &[[f32; 3]],
    test: &[[f32; 3]],
    pixels_per_degree: f64,
) -> Result<Vec<f32>, MetricsError> {
    let pixels = super::pixel_count(width, height)?;
    for (what, image) in [("r", reference), ("x", test)] {
        if image.len() != pixels {
            return Err(MetricsError::SizeMismatch { what, found: image.len(), expected: pixels });
        }
    }
    if !(1.0..=1000.0).contains(&pixels_per_degree) {
        return Err(MetricsError::PixelsPerDegree { value: pixels_per_degree });
    }
    let (size, space, filters) = (Size { width, height }, Space::new(), Filters::new(pixels_per_degree));
    let r = Seen::new(&size, &space, &filters, reference);
    let x = Seen::new(&size, &space, &filters, test);
    let difference = |i: usize| {
        let color = space.color_difference(r.color_at(i), x.color_at(i));
        let change = (r.edge[i] - x.edge[i]).abs().max((r.point[i] - x.point[i]).abs());
        let feature = (FRAC_1_SQRT_2 * f64::from(change)).clamp(0.0, 1.0).sqrt();
        color.powf(1.0 - feature).clamp(0.0, 1.0) as f32
    };
    Ok((0..pixels).map(difference).collect())
}
