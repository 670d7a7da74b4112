//! The truth of the kernels of `subdivide`: the rules as they are told, in f64, with a margin at every comparison.

use super::vec::{self, V};
use super::{Answer, Expect, Words};
use etendue_core::kernel::Kernel;

/// Relative margin of comparisons: some roundings of f32.
const MARGIN: f64 = 1e-6;

/// Hangs on rounding.
struct Tie;

/// `a > b`, where the difference can be trusted: `scale` is what their roundings are relative to.
fn above(a: f64, b: f64, scale: f64) -> Result<bool, Tie> {
    // A zero scale has no roundings.
    if scale > 0.0 && (a - b).abs() <= MARGIN * scale { Err(Tie) } else { Ok(a > b) }
}

struct Triangle {
    corners: [V; 3],
    /// Corners, midpoints opposite corners, centroid.
    l: [f64; 7],
    largest: f64,
}

impl Triangle {
    fn edge(&self, from: usize, to: usize) -> V {
        vec::sub(self.corners[to % 3], self.corners[from % 3])
    }

    fn square(&self, opposite: usize) -> f64 {
        let e = self.edge(opposite + 1, opposite + 2);
        vec::dot(e, e)
    }

    /// The corner opposite the longest edge; zero edges all around name the first.
    fn longest(&self) -> Result<usize, Tie> {
        let s = [0, 1, 2].map(|i| self.square(i));
        let top = if s[0] > s[1] && s[0] > s[2] {
            0
        } else if s[1] > s[2] {
            1
        } else {
            2
        };
        if s == [0.0; 3] {
            return Ok(0);
        }
        above(s[top], s[(top + 1) % 3], s[top])?;
        above(s[top], s[(top + 2) % 3], s[top])?;
        Ok(top)
    }

    /// The corner of more than a right angle.
    fn obtuse(&self) -> Result<Option<usize>, Tie> {
        for i in 0..3 {
            let (p, q) = (self.edge(i, i + 1), self.edge(i, i + 2));
            let size: f64 = (0..3).map(|k| (p[k] * q[k]).abs()).sum();
            if above(0.0, vec::dot(p, q), size)? {
                return Ok(Some(i));
            }
        }
        Ok(None)
    }

    fn bend(&self, opposite: usize) -> f64 {
        let ends = self.l[(opposite + 1) % 3] + self.l[(opposite + 2) % 3];
        self.l[3 + opposite] - ends / 2.0
    }

    fn lift(&self) -> f64 {
        self.l[6] - (self.l[0] + self.l[1] + self.l[2]) / 3.0
    }
}

/// Names of points: A, B, C with A the given corner, then E, F, G, D.
fn named(corner: usize, pieces: &[&str]) -> Vec<u32> {
    let index = |name: char| match name {
        'A' => corner,
        'B' => (corner + 1) % 3,
        'C' => (corner + 2) % 3,
        'E' => 3 + corner,
        'F' => 3 + (corner + 2) % 3,
        'G' => 3 + (corner + 1) % 3,
        _ => 6,
    };
    let word = |p: &str| p.chars().rev().fold(0, |w, name| w << 4 | index(name) as u32);
    let mut out = vec![pieces.len() as u32];
    out.extend(pieces.iter().map(|p| word(p)));
    out.resize(5, 0);
    out
}

const TWO: [&str; 2] = ["ABE", "AEC"];
const THREE: [&str; 3] = ["ABD", "BCD", "CAD"];
const FOUR: [&str; 4] = ["AFG", "BEF", "CGE", "FEG"];
const FAN: [&str; 4] = ["AFE", "FBE", "AEG", "ECG"];
/// A deviation that is not known.
const UNKNOWN: f64 = 8.507_059_173_023_462e37;
const ACCEPTED: [u32; 5] = [1, 0, 0, 0, 0];

/// Algorithm 1 with a tolerance.
fn published(t: &Triangle, tolerance: [f64; 2]) -> Result<Vec<u32>, Tie> {
    let [la, lb, lc, .., ld] = t.l;
    let off = t.lift().abs();
    let largest = la.max(lb).max(lc).max(ld);
    let exact = la == lb && la == lc && la == ld;
    if exact || !above(off, tolerance[0] * largest + tolerance[1], largest.max(tolerance[1]))? {
        return Ok(ACCEPTED.to_vec());
    }
    let Some(a) = t.obtuse()? else { return Ok(named(0, &THREE)) };
    let edge = above(t.bend(a).abs(), off, t.largest)?;
    let median = above((ld - (t.l[a] + t.l[3 + a]) / 2.0).abs(), off, t.largest)?;
    Ok(if edge && median { named(a, &FOUR) } else { named(a, &TWO) })
}

/// Root mean square of the quadratic through the deviations `d` of midpoints and of a cubic of height `r`, by a quadrature that is exact to
/// degree 6: the 28 points of a lattice would do; here closed integrals of monomials, 2 a! b! c! / (a + b + c + 2)!.
fn mean_error(d: [f64; 3], r: f64) -> f64 {
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    let mean = |p: [usize; 3]| {
        2.0 * factorial(p[0]) * factorial(p[1]) * factorial(p[2]) / factorial(p[0] + p[1] + p[2] + 2)
    };
    let powers = [[0, 1, 1], [1, 0, 1], [1, 1, 0]];
    let mut square = 0.0;
    for i in 0..3 {
        for j in 0..3 {
            let p = [0, 1, 2].map(|k| powers[i][k] + powers[j][k]);
            square += 16.0 * d[i] * d[j] * mean(p);
        }
    }
    (square + 27.0 * 27.0 * r * r * mean([2, 2, 2])).sqrt()
}

/// The pieces, and error, rest and bend.
fn robust(t: &Triangle, tolerance: [f64; 3], fraction: f64, rest: f64) -> Result<(Vec<u32>, [f64; 3]), Tie> {
    let l = &t.l;
    let within = |off: f64, brightest: f64| -> Result<bool, Tie> {
        // Nothing deviates where all is dark.
        if t.largest == 0.0 {
            return Ok(true);
        }
        Ok(!above(off, tolerance[0] * brightest + tolerance[1], t.largest.max(tolerance[1]))?)
    };
    let small = |error: f64| -> Result<bool, Tie> {
        let part = error * fraction.max(0.0).sqrt();
        if part == 0.0 || tolerance[2] == 0.0 {
            return Ok(part <= tolerance[2]);
        }
        Ok(!above(part, tolerance[2], part.max(tolerance[2]))?)
    };
    // A leap at the middle of the longest edge, or of the longest between a lit and a dark corner.
    let crossed: Vec<usize> = (0..3).filter(|i| (l[(i + 1) % 3] > 0.0) != (l[(i + 2) % 3] > 0.0)).collect();
    let mut asked = vec![t.longest()?];
    if let [i, j] = crossed[..] {
        let (p, q) = (t.square(i), t.square(j));
        asked.push(if p == 0.0 && q == 0.0 || above(p, q, p.max(q))? { i } else { j });
    }
    for e in asked {
        let brightest = l[(e + 1) % 3].max(l[(e + 2) % 3]).max(l[3 + e]);
        let off = t.bend(e).abs();
        let error = 0.75 * off;
        // Half of what is expected, or everything is looked at.
        let enough = error == 0.0 && rest == 0.0 || above(error, rest / 2.0, brightest.max(rest))?;
        if above(off, 0.25 * brightest, brightest)? && enough && !within(off, brightest)? && !small(error)? {
            return Ok((named(t.longest()?, &TWO), [error, error, UNKNOWN]));
        }
    }
    let d = [0, 1, 2].map(|i| t.bend(i));
    let bend = d.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let brightest = l[..6].iter().fold(0.0_f64, |m, x| m.max(*x));
    let r = t.lift() - 4.0 / 9.0 * (d[0] + d[1] + d[2]);
    let error = mean_error(d, r);
    if within(bend.max(t.lift().abs()), t.largest)? || small(error)? {
        return Ok((ACCEPTED.to_vec(), [0.0; 3]));
    }
    let a = t.longest()?;
    let (b, c) = ((a + 1) % 3, (a + 2) % 3);
    if l[..6].contains(&0.0)
        || above(r.abs(), 0.125 * bend, t.largest)?
        || above(bend, 0.25 * brightest, t.largest)?
    {
        return Ok((named(a, &TWO), [error, error, UNKNOWN]));
    }
    // D lies two thirds of the way from A to E.
    let median = (l[6] - l[a] / 3.0 - 2.0 * l[3 + a] / 3.0).abs();
    let straight = 0.25 * d[a].abs();
    let mut along = true;
    for x in [d[b].abs(), d[c].abs(), median] {
        along &= !above(x, straight, t.largest)?;
    }
    let s = [0, 1, 2].map(|i| t.square(i));
    let (long, short) = (s[a], s[b].min(s[c]));
    // Triangles without extent are not slim.
    let slim = long > 0.0 && (above(long, 2.5 * short, long)? || t.obtuse()?.is_some());
    // Second differences of the quadratic: each is minus an eighth of the second derivative along its edge, squared length
    // included. Of the median's (e + f)/2, e and f the edges at A, they are those of e and f less those of the half of BC.
    let median = (2.0 * d[b] + 2.0 * d[c] - d[a]) / 4.0;
    if along || long > 0.0 && above(long, 16.0 * short, long)? {
        let [p, q] = [d[b], d[c]].map(|kept| expected([d[a] / 4.0, kept, median], r / 2.0));
        return Ok((named(a, &TWO), [error, p[0].max(q[0]), p[1].max(q[1])]));
    }
    let off = bend.max(t.lift().abs());
    if slim {
        // Two of the pieces are the triangle at half the size, two have the median and halves of the others.
        let near = expected([median, d[b] / 4.0, d[c] / 4.0], r / 4.0);
        return Ok((named(a, &FAN), [error, near[0].max(error / 4.0), near[1].max(off / 4.0)]));
    }
    Ok((named(a, &FOUR), [error, error / 4.0, off / 4.0]))
}

/// Error and largest deviation at a probe.
fn expected(d: [f64; 3], r: f64) -> [f64; 2] {
    let centroid = 4.0 / 9.0 * (d[0] + d[1] + d[2]) + r;
    [mean_error(d, r), d.iter().fold(centroid.abs(), |m, x| m.max(x.abs()))]
}

pub(super) fn truth(kernel: Kernel, constants: &[u32], r: &mut Words<'_>) -> Answer {
    let mut c = Words::new(constants);
    let tolerance = |c: &mut Words<'_>| c.real().max(0.0);
    let corners = [r.vec3(), r.vec3(), r.vec3()];
    let l = [0; 7].map(|_| r.real().max(0.0).min(2.0_f64.powi(126)));
    let mut t = Triangle { corners, l, largest: l.iter().fold(0.0_f64, |m, x| m.max(*x)) };
    let overflows = (0..3).any(|i| !t.edge(i, i + 1).iter().all(|x| (*x as f32).is_finite()));
    if overflows {
        // Without extent, as documented.
        t.corners = [[0.0; 3]; 3];
    }
    let words = |w: Vec<u32>| w.into_iter().map(Expect::Word).collect::<Vec<_>>();
    match kernel {
        Kernel::SubdividePublished => match published(&t, [tolerance(&mut c), tolerance(&mut c)]) {
            Ok(w) => Answer::Is(words(w)),
            Err(Tie) => Answer::Undecided,
        },
        Kernel::SubdivideRobust => {
            let tolerances = [tolerance(&mut c), tolerance(&mut c), tolerance(&mut c)];
            match robust(&t, tolerances, r.real(), r.real()) {
                Ok((w, errors)) => {
                    let mut expected = words(w);
                    // An accepted triangle has no errors to state.
                    let scale = if expected[0] == Expect::Word(1) { 0.0 } else { t.largest };
                    expected.extend(errors.map(|x| Expect::Scaled(x, scale)));
                    Answer::Is(expected)
                }
                Err(Tie) => Answer::Undecided,
            }
        }
        _ => Answer::Undecided,
    }
}
