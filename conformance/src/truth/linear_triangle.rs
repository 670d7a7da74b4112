//! The truth of the kernels of `linear_triangle`: distribution functions of sums of positive terms, inverted by bisection.

use super::{Answer, Expect, Words};
use etendue_core::kernel::Kernel;

/// Negative weights count as 0, and three zeros as ones.
fn valid(w: [f64; 3]) -> [f64; 3] {
    let w = w.map(|x| if x > 0.0 { x } else { 0.0 });
    if w == [0.0; 3] { [1.0; 3] } else { w }
}

/// The lightest vertex; the first of equal ones.
fn lightest(w: [f64; 3]) -> usize {
    (0..3).fold(0, |k, i| if w[i] < w[k] { i } else { k })
}

fn turned(x: [f64; 3], k: usize) -> [f64; 3] {
    [x[k], x[(k + 1) % 3], x[(k + 2) % 3]]
}

/// Share of the density nearer to the apex than s. The density is w0 times the interpolant that is 1 at the apex, whose
/// share is s^2 (3 - 2 s) of a third, and the other weights times theirs, s^3.
fn share(w: [f64; 3], s: f64) -> f64 {
    let sum = w[0] + w[1] + w[2];
    (w[0] / sum) * s * s * (3.0 - 2.0 * s) + ((w[1] + w[2]) / sum) * s * s * s
}

/// The rest of it, where s = 1 - c, without a difference.
fn rest(w: [f64; 3], c: f64) -> f64 {
    let sum = w[0] + w[1] + w[2];
    (w[0] / sum) * c * c * (3.0 - 2.0 * c) + ((w[1] + w[2]) / sum) * c * (1.0 + (1.0 - c) * (2.0 - c))
}

/// The x in [0, 1] at which an increasing function reaches y, to the last bit: by halves of the floats' own order.
fn bisect(f: impl Fn(f64) -> f64, y: f64) -> f64 {
    let (mut low, mut high) = (0_u64, 1.0_f64.to_bits());
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if f(f64::from_bits(middle)) < y {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::from_bits(high)
}

/// Distance from the apex and its complement.
fn distance(w: [f64; 3], xi: f64) -> [f64; 2] {
    if xi <= 0.0 {
        return [0.0, 1.0];
    }
    if xi >= 1.0 {
        return [1.0, 0.0];
    }
    if xi < share(w, 0.5) {
        let s = bisect(|s| share(w, s), xi);
        [s, 1.0 - s]
    } else {
        let c = bisect(|c| rest(w, c), 1.0 - xi);
        [1.0 - c, c]
    }
}

/// Where a linear density from a to b has the share eta behind it, and what is left.
fn linear(a: f64, b: f64, eta: f64) -> [f64; 2] {
    let up = |a: f64, b: f64, eta: f64| {
        if eta <= 0.0 {
            return 0.0;
        }
        let (a, b) = (a / (a + b), b / (a + b));
        bisect(|t| t * (2.0 * a * (1.0 - t) + t * (a + b)), eta)
    };
    if a + b <= 0.0 {
        return [0.0, 1.0];
    }
    [up(a, b, eta), up(b, a, 1.0 - eta)]
}

/// Errors relative to the number itself, but for the grid of subnormals.
pub(super) fn relative(x: f64) -> Expect {
    Expect::Scaled(x, x.max(f64::from(f32::MIN_POSITIVE)))
}

/// The sampled place, by vertex.
pub(super) fn place(weights: [f64; 3], u: [f64; 2]) -> [f64; 3] {
    let weights = valid(weights);
    let k = lightest(weights);
    let w = turned(weights, k);
    let [s, c] = distance(w, u[0]);
    let [t, early] = linear(w[0] * c + w[1] * s, w[0] * c + w[2] * s, u[1]);
    let place = [c, s * early, s * t];
    [0, 1, 2].map(|i| place[(i + 3 - k) % 3])
}

pub(super) fn truth(kernel: Kernel, _constants: &[u32], r: &mut Words<'_>) -> Answer {
    if kernel == Kernel::SampleLinearTriangle {
        return Answer::Is(place(r.vec3(), [r.real(), r.real()]).map(relative).to_vec());
    }
    let weights = valid(r.vec3());
    let k = lightest(weights);
    let w = turned(weights, k);
    match kernel {
        Kernel::LinearTriangleDistance => {
            let [s, c] = distance(w, r.real());
            Answer::Is(vec![Expect::Word(k as u32), relative(s), relative(c)])
        }
        Kernel::PdfLinearTriangle => {
            let b = r.vec3();
            let sum: f64 = weights.iter().sum();
            let value: f64 = (0..3).map(|i| weights[i] / sum * b[i]).sum();
            Answer::Is(vec![Expect::Ulp(if b.iter().all(|b| *b >= 0.0) {
                (3.0 * value).min(3.0)
            } else {
                0.0
            })])
        }
        Kernel::InvertLinearTriangle => {
            let [c, b1, b2] = turned(r.vec3(), k);
            let whole = c + b1 + b2;
            let (s, c) = ((b1 + b2) / whole, c / whole);
            let xi = if s < 0.5 { share(w, s) } else { 1.0 - rest(w, c) };
            let (a, b) = (w[0] * c + w[1] * s, w[0] * c + w[2] * s);
            let t = b2 / (b1 + b2);
            let eta = if b1 + b2 > 0.0 { t * (a * (2.0 - t) + b * t) / (a + b) } else { 0.0 };
            let last = 1.0 - 1.0 / 16_777_216.0;
            Answer::Is(vec![relative(xi.clamp(0.0, last)), relative(eta.clamp(0.0, last))])
        }
        _ => Answer::Undecided,
    }
}
