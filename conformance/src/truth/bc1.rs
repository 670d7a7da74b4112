//! The truth of the kernels of `bc1` and `bc4`: from the formats' definitions, in f64 and in other steps than core's.

use super::{Answer, Expect, Words};
use etendue_core::kernel::Kernel;

/// A texel: red, green, blue, in units of 1/255.
type Colour = [f64; 3];

/// To the nearest integer; no case here is a tie but halves, which go up.
fn nearest(x: f64) -> f64 {
    (x + 0.5).floor()
}

/// The levels of an endpoint's channels over 31, 63, 31.
fn levels(word: u32) -> [f64; 3] {
    [f64::from(word / 2048), f64::from(word / 32 % 64), f64::from(word % 32)]
}

const MOST: [f64; 3] = [31.0, 63.0, 31.0];

/// The palette and its alpha by rule: nearest, truncated, Mesa, AMD, NVIDIA.
fn palette(first: u32, second: u32, rule: u32) -> [[f64; 4]; 4] {
    let four = first > second;
    let mut out = [[0.0; 4]; 4];
    for c in 0..3 {
        let (p, q) = (levels(first)[c], levels(second)[c]);
        // Bits repeated below their end: 8 x + x / 4 and 4 x + x / 16.
        let wide = |x: f64| (x * if c == 1 { 4.0625 } else { 8.25 }).floor();
        let (a, b) = (wide(p), wide(q));
        let green = c == 1;
        // The shares of the endpoints in 256 parts, of which Mesa gives the second's entry one less.
        let third = |a: f64, b: f64, p: f64, q: f64, less: f64| match rule {
            1 => ((2.0 * a + b) / 3.0).floor(),
            2 => (((171.0 - less) * a + (85.0 + less) * b) / 256.0).floor(),
            3 => ((43.0 * a + 21.0 * b + 32.0) / 64.0).floor(),
            4 if green => ((256.0 * a + ((b - a) / 4.0).trunc() + 128.0 + (b - a) * 80.0) / 256.0).floor(),
            4 => ((2.0 * p + q) * 2.75).floor(),
            _ => nearest((2.0 * a + b) / 3.0),
        };
        let half = match rule {
            1 => ((a + b) / 2.0).floor(),
            4 if green => ((256.0 * a + ((b - a) / 4.0).trunc() + 128.0 + (b - a) * 128.0) / 256.0).floor(),
            4 => ((p + q) * 4.125).floor(),
            _ => nearest((a + b) / 2.0),
        };
        let last = if four { third(b, a, q, p, 1.0) } else { 0.0 };
        let column = [a, b, if four { third(a, b, p, q, 0.0) } else { half }, last];
        for (entry, x) in out.iter_mut().zip(column) {
            entry[c] = x;
        }
    }
    for (k, entry) in out.iter_mut().enumerate() {
        entry[3] = if k == 3 && !four { 0.0 } else { 255.0 };
    }
    out
}

fn decode(ends: u32, indices: u32, rule: u32, alpha: bool) -> Answer {
    let palette = palette(ends % 65_536, ends / 65_536, rule);
    let texel = |i: u32| {
        let entry = palette[(indices / 4_u32.pow(i) % 4) as usize];
        let word = entry[0]
            + 256.0 * entry[1]
            + 65_536.0 * entry[2]
            + 16_777_216.0 * if alpha { entry[3] } else { 0.0 };
        Expect::Word(word as u32)
    };
    Answer::Is((0..16).map(texel).collect())
}

/// Range fit of the texels that count: the pair of outermost texels along the box's diagonal of positive correlation.
fn range_fit(texels: &[Colour], counts: &[bool]) -> [u32; 2] {
    let counted: Vec<Colour> = texels.iter().zip(counts).filter(|(_, c)| **c).map(|(x, _)| *x).collect();
    if counted.is_empty() {
        return [0, 0];
    }
    let column = |c: usize| counted.iter().map(move |x| x[c]);
    let extent = [0, 1, 2].map(|c| column(c).fold(0.0, f64::max) - column(c).fold(255.0, f64::min));
    let largest = extent.iter().copied().fold(0.0, f64::max);
    let widest = extent.iter().position(|e| *e == largest).expect("one of them is the largest");
    // Sum over all pairs of the product of differences: n^2 times the covariance, without means.
    let covariance = |c: usize| -> f64 {
        counted
            .iter()
            .flat_map(|x| counted.iter().map(move |y| (x[c] - y[c]) * (x[widest] - y[widest])))
            .sum()
    };
    let axis = [0, 1, 2].map(|c| if covariance(c) < 0.0 { -extent[c] } else { extent[c] });
    let along = |x: &Colour| axis[0] * x[0] + axis[1] * x[1] + axis[2] * x[2];
    // The first of the least and the first of the greatest.
    let least = counted.iter().map(along).fold(f64::INFINITY, f64::min);
    let most = counted.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
    let word = |at: f64| {
        let x = counted.iter().find(|x| along(x) == at).expect("it is attained");
        let level = |c: usize| nearest(x[c] * MOST[c] / 255.0) as u32;
        level(0) * 2048 + level(1) * 32 + level(2)
    };
    let (a, b) = (word(least), word(most));
    let (first, second) = (a.max(b), a.min(b));
    let palette = palette(first, second, 0);
    let mut indices = 0;
    for (i, x) in texels.iter().enumerate() {
        if counts[i] && first != second {
            let d = palette.map(|p| (0..3).map(|c| (p[c] - x[c]).powi(2)).sum::<f64>());
            let least = d.iter().copied().fold(f64::INFINITY, f64::min);
            indices +=
                (d.iter().position(|d| *d == least).expect("it is attained") as u32) * 4_u32.pow(i as u32);
        }
    }
    [first + 65_536 * second, indices]
}

fn palette4(a: f64, b: f64) -> [f64; 8] {
    if a > b {
        let at = |k: f64| nearest(a + (b - a) * k / 7.0);
        [a, b, at(1.0), at(2.0), at(3.0), at(4.0), at(5.0), at(6.0)]
    } else {
        let at = |k: f64| nearest(a + (b - a) * k / 5.0);
        [a, b, at(1.0), at(2.0), at(3.0), at(4.0), 0.0, 255.0]
    }
}

fn range_fit4(texels: &[f64], counts: &[bool]) -> [u32; 2] {
    let counted = || texels.iter().zip(counts).filter(|(_, c)| **c).map(|(x, _)| *x);
    if counted().count() == 0 {
        return [0, 0];
    }
    let (a, b) = (counted().fold(0.0, f64::max), counted().fold(255.0, f64::min));
    let palette = palette4(a, b);
    let mut bits = a as u64 + 256 * b as u64;
    for (i, x) in texels.iter().enumerate().filter(|(i, _)| counts[*i]) {
        let d = palette.map(|p| (p - x).abs());
        let least = d.iter().copied().fold(f64::INFINITY, f64::min);
        bits += (d.iter().position(|d| *d == least).expect("it is attained") as u64) << (16 + 3 * i);
    }
    [bits as u32, (bits >> 32) as u32]
}

pub(super) fn truth(kernel: Kernel, constants: &[u32], r: &mut Words<'_>) -> Answer {
    let exactly = |words: [u32; 2]| Answer::Is(words.map(Expect::Word).to_vec());
    match kernel {
        Kernel::Bc1Decode => decode(r.word(), r.word(), 0, false),
        Kernel::Bc1DecodeWith => decode(r.word(), r.word(), constants[0], true),
        Kernel::Bc1EncodeRangeFit => {
            let texels: Vec<Colour> = (0..16)
                .map(|_| {
                    let x = r.word();
                    [f64::from(x % 256), f64::from(x / 256 % 256), f64::from(x / 65_536 % 256)]
                })
                .collect();
            let counts = r.word();
            let counts: Vec<bool> = (0..16).map(|i| counts >> i & 1 == 1).collect();
            exactly(range_fit(&texels, &counts))
        }
        Kernel::Bc4Decode => {
            let bits = u64::from(r.word()) + (u64::from(r.word()) << 32);
            let palette = palette4((bits % 256) as f64, (bits / 256 % 256) as f64);
            Answer::Is(
                (0..16).map(|i| Expect::Word(palette[(bits >> (16 + 3 * i) & 7) as usize] as u32)).collect(),
            )
        }
        Kernel::Bc4EncodeRangeFit => {
            let texels: Vec<f64> = (0..16).map(|_| f64::from(r.word() % 256)).collect();
            let counts = r.word();
            let counts: Vec<bool> = (0..16).map(|i| counts >> i & 1 == 1).collect();
            exactly(range_fit4(&texels, &counts))
        }
        _ => Answer::Undecided,
    }
}
