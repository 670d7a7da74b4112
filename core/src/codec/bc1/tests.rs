//! The parts of the search against plain implementations in f64.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use super::ALIKE;
use super::cluster::{moments, order, refit, split};
use super::lanes::Lanes;
use super::least_squares::axis;
use super::palette::{narrow, widen};
use super::score::{Mode, Target, candidate, descend};
use super::single;
use std::vec::Vec;

type V = Lanes<8>;

/// Weyl sequence with the finaliser of splitmix64.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % n
    }

    fn target(&mut self, alike: bool) -> Target {
        let spread = 1 << (1 + self.below(8));
        let base = [0; 3].map(|_: u64| self.below(256));
        let texels = [(); 16].map(|()| base.map(|b| (b + self.below(spread)).min(255) as u8));
        let weights =
            if alike { ALIKE } else { ALIKE.map(|_| [0.0, 0.25, 0.7, 3.0][self.below(4) as usize] + 0.1) };
        Target::new(&texels, &weights).unwrap()
    }
}

#[test]
fn codes_survive_widening_and_narrowing() {
    for (five, last) in [(true, 31), (false, 63)] {
        for code in 0..=last {
            assert_eq!(narrow(widen(code, five), five), code);
        }
        for x in 0..256_u32 {
            let real = f64::from(x) * f64::from(last) / 255.0;
            assert!((real - f64::from(narrow(x, five))).abs() <= 0.5);
        }
    }
}

#[test]
fn the_axis_is_the_eigenvector_of_the_largest_eigenvalue() {
    let mut random = Random(1);
    for _ in 0..2000 {
        let t = random.target(true);
        let m = moments::<V>(&t);
        let x = t.x.map(|x| x.map(f64::from));
        let mean = x.map(|x| x.iter().sum::<f64>() / 16.0);
        let cov =
            |a: usize, b: usize| (0..16).map(|i| (x[a][i] - mean[a]) * (x[b][i] - mean[b])).sum::<f64>();
        let matrix = [0, 1, 2].map(|a| [0, 1, 2].map(|b| cov(a, b)));
        let along = |v: [f64; 3]| {
            let mv = matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
            let vv = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
            if vv > 0.0 { (mv[0] * v[0] + mv[1] * v[1] + mv[2] * v[2]) / vv } else { 0.0 }
        };
        // Many steps of the power iteration from each axis.
        let mut most = 0.0_f64;
        for c in 0..3 {
            let mut v = [0.0; 3];
            v[c] = 1.0;
            for _ in 0..300 {
                let w = matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
                let length = w.iter().map(|x| x * x).sum::<f64>().sqrt();
                if length > 0.0 {
                    v = w.map(|x| x / length);
                }
            }
            most = most.max(along(v));
        }
        let got = along(m.axis.map(f64::from));
        assert!(got >= 0.91 * most && got <= most * (1.0 + 1e-5), "{got} of {most}");
    }
    assert_eq!(axis([Lanes([0.0]); 6]).map(|v| v.0), [[0.0]; 3]);
}

/// What the best two endpoints leave of the variance, solved plainly, for steps over `most`.
fn residual(t: &Target, q: &[f64; 16], most: f64) -> f64 {
    let w = t.w.map(f64::from);
    let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
    for i in 0..16 {
        let (a, b) = (1.0 - q[i] / most, q[i] / most);
        (aa, ab, bb) = (aa + w[i] * a * a, ab + w[i] * a * b, bb + w[i] * b * b);
    }
    let determinant = aa * bb - ab * ab;
    let mut left = 0.0;
    for x in t.x {
        let x = x.map(f64::from);
        let (mut ax, mut bx) = (0.0, 0.0);
        for i in 0..16 {
            ax += w[i] * (1.0 - q[i] / most) * x[i];
            bx += w[i] * q[i] / most * x[i];
        }
        let (p, r) = ((ax * bb - bx * ab) / determinant, (bx * aa - ax * ab) / determinant);
        for i in 0..16 {
            left += w[i] * (x[i] - p - (r - p) * q[i] / most).powi(2);
        }
    }
    left
}

#[test]
fn the_best_split_is_the_best_of_all_splits() {
    let mut random = Random(2);
    for round in 0..40 {
        let t = random.target(round % 2 == 0);
        let m = moments::<V>(&t);
        let o = order::<V>(&t, &m, m.axis);
        let w = t.w.map(f64::from);
        let total: f64 = w.iter().sum();
        let x = t.x.map(|x| x.map(f64::from));
        let variance: f64 = x
            .iter()
            .map(|x| {
                let mean = (0..16).map(|i| w[i] * x[i]).sum::<f64>() / total;
                (0..16).map(|i| w[i] * (x[i] - mean).powi(2)).sum::<f64>()
            })
            .sum();
        // Places by a plain sort.
        let along = |i: usize| (0..3).map(|c| m.axis[c] * t.x[c][i]).fold(0.0_f32, |s, x| s + x);
        let mut texels: Vec<usize> = (0..16).collect();
        texels.sort_by(|a, b| along(*a).total_cmp(&along(*b)).then(a.cmp(b)));
        for (four, most) in [(true, 3.0), (false, 2.0)] {
            let mut least = variance;
            for i in 0..16 {
                for j in i..16 {
                    for k in j..16 {
                        let mut q = [0.0; 16];
                        for (place, texel) in texels.iter().enumerate() {
                            let from = |start: usize| f64::from(u8::from(place >= start));
                            q[*texel] = from(i) + from(k) + if four { from(j) } else { 0.0 };
                        }
                        let r = residual(&t, &q, most);
                        if r.is_finite() {
                            least = least.min(r);
                        }
                    }
                }
            }
            let mut splits = split::<V>(&o, four);
            let gain = splits.gain.iter().fold(0.0_f32, |m, g| m.max(*g));
            let explained = variance - least;
            assert!(
                (f64::from(gain) - explained).abs() <= 2e-5 * variance + 1e-3,
                "{gain} {explained} {variance}"
            );
            if let Some(q) = splits.take(&o, four) {
                let r = residual(&t, &q.map(f64::from), most);
                assert!(r <= least + 2e-5 * variance + 1e-3, "{r} {least}");
            }
        }
    }
}

#[test]
fn refitted_codes_are_next_to_the_best_of_all_codes() {
    let mut random = Random(3);
    let (mut same, mut all) = (0, 0);
    for round in 0..200 {
        let t = random.target(round % 2 == 0);
        let mode = if round % 3 == 0 { Mode::Three } else { Mode::Four };
        let most = if mode == Mode::Four { 3 } else { 2 };
        let q = [(); 16].map(|()| random.below(most + 1) as f32);
        let codes = refit::<V>(&t, &t.w, &q, mode);
        for c in 0..3 {
            let last = if c == 1 { 63 } else { 31 };
            let error = |a: f64, b: f64| -> f64 {
                (0..16)
                    .map(|i| {
                        let s = f64::from(q[i]) / most as f64;
                        let y = (a * (1.0 - s) + b * s) * 255.0 / f64::from(last);
                        f64::from(t.w[i]) * (f64::from(t.x[c][i]) - y).powi(2)
                    })
                    .sum()
            };
            let mut least = f64::INFINITY;
            for a in 0..=last {
                for b in 0..=last {
                    least = least.min(error(f64::from(a), f64::from(b)));
                }
            }
            let got = error(f64::from(codes[c][0]), f64::from(codes[c][1]));
            all += 1;
            same += u32::from(got <= least * (1.0 + 1e-5) + 1e-3);
            assert!(got <= least * 1.25 + 60.0, "{got} {least}");
        }
    }
    assert!(same * 100 >= all * 90, "{same} of {all} are the best");
}

#[test]
fn descent_ends_where_no_neighbour_is_better() {
    let mut random = Random(4);
    for round in 0..200 {
        let t = random.target(true);
        let mode = [Mode::Four, Mode::Three, Mode::Black][round % 3];
        let codes = [32, 64, 32].map(|n| [random.below(n) as u32, random.below(n) as u32]);
        let from = candidate::<V>(&t, codes, mode);
        let end = descend::<V>(&t, from);
        assert!(end.error <= from.error);
        assert_eq!(end.error, candidate::<V>(&t, end.codes, mode).error, "what is kept is what is reached");
        for c in 0..3 {
            for step in 0..9 {
                let moved = |e: usize, s: i32| {
                    (end.codes[c][e] as i32 + s).clamp(0, if c == 1 { 63 } else { 31 }) as u32
                };
                let mut codes = end.codes;
                codes[c] = [moved(0, step % 3 - 1), moved(1, step / 3 - 1)];
                assert!(end.error <= candidate::<V>(&t, codes, mode).error);
            }
        }
    }
}

#[test]
fn one_colour_has_the_nearest_entry_there_is() {
    for x in 0..256_u32 {
        for (five, last) in [(true, 31), (false, 63)] {
            for mode in [Mode::Four, Mode::Three] {
                let entry = |a: u32, b: u32| {
                    let (a, b) = (widen(a, five), widen(b, five));
                    if mode == Mode::Four { (2 * a + b + 1) / 3 } else { (a + b).div_ceil(2) }
                };
                let [a, b] = single::ends(x, five, mode);
                let least = (0..=last)
                    .flat_map(|a| (0..=last).map(move |b| (a, b)))
                    .map(|(a, b)| entry(a, b).abs_diff(x));
                assert_eq!(entry(a, b).abs_diff(x), least.min().unwrap());
            }
        }
    }
}
