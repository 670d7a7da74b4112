//! Inputs and the truth of the linear-triangle tests (`#[path]`-included; no tests of its own).
#![allow(dead_code, reason = "each test file uses its part")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

/// SplitMix64: a fixed, portable stream per seed.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    /// In [0, 1), 53 bits.
    pub(crate) fn wide(&mut self) -> f64 {
        (self.next() >> 11) as f64 / 9_007_199_254_740_992.0
    }
    /// In [0, 1), a multiple of 2^-24.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / 16_777_216.0
    }
    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }
}

/// Weights of the kinds that break the published form, over the whole range of f32.
pub(crate) fn hard_weights(r: &mut Random) -> [f32; 3] {
    let base = match r.below(16) {
        0 => f64::from(f32::MAX),
        1 => 2.0_f64.powi(-140),
        _ => (r.wide() * 250.0 - 125.0).exp2(),
    };
    let tiny = |r: &mut Random, decades: f64| 10.0_f64.powf(-decades * r.wide());
    let mut w = match r.below(8) {
        // Flat, and nearly so.
        0 => [1.0; 3],
        1 => [1.0 - 1e-7 * r.wide(), 1.0 - 1e-7 * r.wide(), 1.0 - 1e-7 * r.wide()],
        // One vertex alone, one vertex zero.
        2 => [0.0, 0.0, 1.0],
        3 => [0.0, r.wide(), r.wide()],
        // Ratios to 1e30.
        4 => [1.0, tiny(r, 30.0), tiny(r, 30.0)],
        5 => {
            let x = tiny(r, 30.0);
            [1.0, x, x]
        }
        6 => {
            let e = tiny(r, 8.0);
            [1.0 - e, 1.0 - e * r.wide(), 1.0 - e * r.wide()]
        }
        _ => [r.wide(), r.wide(), r.wide()],
    };
    w.rotate_left(r.below(3) as usize);
    let w = w.map(|x| (x * base) as f32);
    if w.iter().sum::<f32>() > 0.0 { w } else { [1.0; 3] }
}

/// Random numbers, the ends and what lies next to them often.
pub(crate) fn hard_unit(r: &mut Random) -> f32 {
    match r.below(8) {
        0 => 0.0,
        1 => f32::from_bits(1),
        2 => 1.0 - 1.0 / 16_777_216.0,
        3 => (-149.0 * r.wide()).exp2() as f32,
        4 => (1.0 - (-24.0 * r.wide()).exp2()) as f32,
        _ => r.unit(),
    }
}

/// The root in [0, 1] of an increasing function, by halving; all of f64's bits.
fn root(f: impl Fn(f64) -> f64, value: f64) -> f64 {
    // In the logarithm first, so that small roots have all their bits too.
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    if f(1.0) <= value {
        return 1.0;
    }
    for _ in 0..1100 {
        let middle =
            if low == 0.0 || high / low > 4.0 { (low.max(1e-300) * high).sqrt() } else { 0.5 * (low + high) };
        if middle <= low || middle >= high {
            break;
        }
        if f(middle) < value {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Distance from a vertex of weight `apex` and its complement, where the two others weigh `others`: the marginal distribution
/// is an integral of a positive density, so each form below is a sum of positive terms.
///
/// `1 - P` = c (3 V (1 - c) + V c^2 + w c (3 - 2 c)) / S, V the others' sum; P = s^2 (w (3 - 2 s) + V s) / S.
pub(crate) fn distance(apex: f64, others: [f64; 2], xi: f64) -> [f64; 2] {
    let v = others[0] + others[1];
    let sum = apex + v;
    let up_to = |s: f64| s * s * (apex * (3.0 - 2.0 * s) + v * s) / sum;
    let beyond = |c: f64| c * (3.0 * v * (1.0 - c) + v * c * c + apex * c * (3.0 - 2.0 * c)) / sum;
    if xi <= 0.0 {
        return [0.0, 1.0];
    }
    if up_to(0.5) >= xi {
        let s = root(up_to, xi);
        [s, 1.0 - s]
    } else {
        let c = root(beyond, 1.0 - xi);
        [1.0 - c, c]
    }
}

/// The shares of a segment whose density runs linearly from a to b: the part up to the point of probability eta, and the rest.
pub(crate) fn shares(a: f64, b: f64, eta: f64) -> [f64; 2] {
    let part = |a: f64, b: f64, eta: f64| {
        if eta <= 0.0 { 0.0 } else { eta * (a + b) / (a + (a * a * (1.0 - eta) + b * b * eta).sqrt()) }
    };
    [part(a, b, eta), part(b, a, 1.0 - eta)]
}

/// Weights over their largest, as f64; zeros only where all are.
pub(crate) fn scaled(w: [f32; 3]) -> [f64; 3] {
    let largest = w.iter().copied().fold(0.0_f32, f32::max);
    w.map(|x| f64::from(x) / f64::from(largest))
}

/// Barycentrics of the point, by the documented rule: the apex is the lightest vertex, of equal ones that of least index; the
/// first number places the distance from it, the second runs from the next vertex to the one after.
pub(crate) fn sample(w: [f32; 3], u: [f32; 2]) -> [f64; 3] {
    let apex = (0..3).fold(0, |best, i| if w[i] < w[best] { i } else { best });
    let w = scaled(w);
    let [w0, w1, w2] = [0, 1, 2].map(|i| w[(apex + i) % 3]);
    let [s, c] = distance(w0, [w1, w2], f64::from(u[0]));
    let [late, early] = shares(w0 * c + w1 * s, w0 * c + w2 * s, f64::from(u[1]));
    let mut out = [0.0; 3];
    out[apex] = c;
    out[(apex + 1) % 3] = s * early;
    out[(apex + 2) % 3] = s * late;
    out
}
