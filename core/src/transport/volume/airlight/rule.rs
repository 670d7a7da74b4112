//! Where the nodes along a segment of a ray lie, and what length each stands for.

use super::Foot;
use crate::backend::BackendError;
use crate::math::{self, HALF_PI};

/// How light that is scattered once is summed along a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// The trapezoid rule with a random first node. Unbiased.
    ///
    /// The plain rule counts the integrand at both ends of a segment half. Seen as a rule on a circle, on which the ends are one place, that is one node among equal ones. Here all nodes are moved along by the same
    /// random part of a step, so that the one at the far end becomes the one beyond the near end: there are no ends, all n nodes (i + u) / n of the segment count length / n, and as
    /// each of its places is met with the same density, the expectation is the integral. The price is that of a jump on the circle: the error of a sample falls as 1 / n, by the difference of the integrand between
    /// the ends, and that of the mean of samples by their number too.
    Trapezoid,
    /// The trapezoid rule with nodes on both ends, which count half; one node alone lies in the middle. Biased: by 1 / n^2 where the integrand is smooth, by 1 / n where light is cut off along the ray. No noise.
    PlainTrapezoid,
    /// Nodes at equal angles as seen from the light, with a random first node. Unbiased. Source: C. Kulla and M. Fajardo, "Importance sampling techniques for path tracing in participating media", EGSR
    /// 2012. For a light at infinity, which sees no angles, at equal steps of exp(-sigma t).
    Equiangular,
}

/// Single scattering by nodes along the camera's rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SingleScatter {
    /// Where they lie.
    pub rule: Rule,
    /// How many for each segment of a ray within one medium and each light without size.
    pub nodes: u32,
}

/// Most nodes of a segment.
pub const NODES_MAX: u32 = 1 << 16;
/// -ln of what transmittance counts as nothing for the plain rule, 1e-6.
const DEPTH_MAX: f32 = 13.815_511;
/// Optical thickness below which steps of exp(-sigma t) are steps of t.
const THIN: f32 = 0.05;
/// Largest angle from the foot: what lies beyond 3e6 times the light's distance is taken to be there.
const ANGLE_MAX: f32 = HALF_PI - 3.0 * f32::EPSILON;
/// The largest number below 1 of 24 bits.
const BELOW_ONE: f32 = 1.0 - 0.5 * f32::EPSILON;

impl SingleScatter {
    /// Nodes of a segment where nothing is said.
    pub const NODES: u32 = 16;

    /// Checks the number of nodes.
    ///
    /// # Errors
    /// None, or more than [`NODES_MAX`].
    pub fn check(&self) -> Result<(), BackendError> {
        if (1..=NODES_MAX).contains(&self.nodes) {
            return Ok(());
        }
        Err(BackendError::BadJob { reason: "nodes of single scattering must be from 1 to 65536" })
    }
}

/// A segment of a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    /// Where the medium begins and ends \[m\]; the end may be infinite.
    pub(super) from: f32,
    pub(super) to: f32,
    /// The least extinction \[1/m\] of the channels that are scattered; 0 where that varies along the ray.
    pub(super) sigma: f32,
}

/// A place on a segment, and the length that it stands for \[m\]; an infinite segment may have lengths that grow as 1 / T.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    pub(super) t: f32,
    pub(super) weight: f32,
}

impl Segment {
    /// Node `i` of `single.nodes`; `u` in [0, 1): where the first one lies within its step; `foot`: where a light that is near lies. `None` where the rule has no place for it.
    pub(super) fn node(&self, single: SingleScatter, i: u32, u: f32, foot: Option<Foot>) -> Option<Node> {
        let n = single.nodes as f32;
        let x = ((i as f32 + u) / n).min(BELOW_ONE);
        let length = self.to - self.from;
        let node = match (single.rule, foot) {
            (Rule::PlainTrapezoid, _) => self.plain(i, single.nodes),
            (Rule::Equiangular, Some(foot)) => self.equiangular(x, n, foot),
            (Rule::Equiangular, None) if length * self.sigma > THIN => self.exponential(x, n),
            (Rule::Trapezoid, _) if length * self.sigma > DEPTH_MAX => self.exponential(x, n),
            _ => Node { t: self.from + x * length, weight: length / n },
        };
        (node.t.is_finite() && node.weight.is_finite() && node.weight > 0.0).then_some(node)
    }

    /// At equal steps to the end, or to where nothing is left.
    fn plain(&self, i: u32, n: u32) -> Node {
        let mut length = self.to - self.from;
        if self.sigma > 0.0 {
            length = length.min(DEPTH_MAX / self.sigma);
        }
        if n == 1 {
            return Node { t: self.from + 0.5 * length, weight: length };
        }
        let step = length / (n - 1) as f32;
        let ends = i == 0 || i == n - 1;
        Node { t: (self.from + i as f32 * step).min(self.to), weight: if ends { 0.5 * step } else { step } }
    }

    /// At equal steps of 1 - exp(-sigma t), the share of the segment's own that `x` is.
    fn exponential(&self, x: f32, n: f32) -> Node {
        let all = 1.0 - math::exp(-self.sigma * (self.to - self.from));
        let left = 1.0 - x * all;
        let t = (self.from - math::ln(left) / self.sigma).min(self.to);
        Node { t, weight: all / (n * self.sigma * left) }
    }

    /// At equal angles about the light. Its density per length is distance / ((b - a) (distance^2 + s^2)), s the length from the foot.
    fn equiangular(&self, x: f32, n: f32, foot: Foot) -> Node {
        let Foot { along, distance } = foot;
        let a = math::atan2(self.from - along, distance);
        let b = math::atan2(self.to - along, distance);
        let s = distance * math::tan((a + x * (b - a)).clamp(-ANGLE_MAX, ANGLE_MAX));
        let t = (along + s).clamp(self.from, self.to);
        // Divided first: no square that overflows.
        let ratio = s / distance;
        Node { t, weight: (b - a) * distance * (1.0 + ratio * ratio) / n }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::disallowed_methods, reason = "truth in f64")]

    use super::*;

    /// The integral of a function by a rule, over many shifts.
    fn mean(single: SingleScatter, segment: Segment, foot: Option<Foot>, f: impl Fn(f64) -> f64) -> f64 {
        const SHIFTS: u32 = 1 << 13;
        let mut sum = 0.0;
        for k in 0..SHIFTS {
            let u = (k as f32 + 0.5) / SHIFTS as f32;
            for i in 0..single.nodes {
                if let Some(node) = segment.node(single, i, u, foot) {
                    assert!(node.t >= segment.from && node.t <= segment.to, "{node:?} {segment:?}");
                    sum += f64::from(node.weight) * f(f64::from(node.t));
                }
            }
        }
        sum / f64::from(SHIFTS)
    }

    /// The same by small steps of ln(t + 1).
    fn truth(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
        let (a, b) = (from.ln_1p(), to.min(1e6).ln_1p());
        let n = 200_000;
        let h = (b - a) / f64::from(n);
        (0..n).map(|i| (a + (f64::from(i) + 0.5) * h).exp()).map(|x| f(x - 1.0) * x * h).sum()
    }

    #[test]
    fn shifted_rules_give_integrals() {
        for (from, to) in [(0.0, 2.0), (1.0, 7.5), (0.0, 300.0), (3.0, 40.0), (0.0, f32::INFINITY)] {
            for (along, distance) in [(1.0, 0.5), (-3.0, 2.0), (50.0, 4.0), (2.0, 0.01)] {
                for sigma in [0.3_f32, 2.0] {
                    let f = |t: f64| {
                        let s = t - f64::from(along);
                        (-f64::from(sigma) * (t - f64::from(from))).exp()
                            / (f64::from(distance * distance) + s * s)
                    };
                    let expected = truth(f64::from(from), f64::from(to), f);
                    let segment = Segment { from, to, sigma };
                    for nodes in [1, 3, 16] {
                        for (rule, near) in
                            [(Rule::Trapezoid, true), (Rule::Equiangular, true), (Rule::Equiangular, false)]
                        {
                            let foot = near.then_some(Foot { along, distance });
                            // So many shifts do not resolve what is narrower than a few of their steps.
                            let narrow = if rule == Rule::Equiangular && near {
                                sigma * distance * distance < 0.1 * along * along
                            } else {
                                distance < 0.1 || to == 300.0
                            };
                            if narrow {
                                continue;
                            }
                            let found = mean(SingleScatter { rule, nodes }, segment, foot, f);
                            assert!(
                                (found / expected - 1.0).abs() < 2e-3,
                                "{rule:?} {nodes} {segment:?} {foot:?}: {found} {expected}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn the_plain_rule_is_exact_for_lines_and_ends_where_nothing_is_left() {
        let segment = Segment { from: 1.0, to: 5.0, sigma: 0.0 };
        for nodes in [1, 2, 3, 16] {
            let single = SingleScatter { rule: Rule::PlainTrapezoid, nodes };
            assert!((mean(single, segment, None, |t| 3.0 * t + 1.0) - 40.0).abs() < 1e-4);
            let endless = Segment { from: 0.0, to: f32::INFINITY, sigma: 2.0 };
            let all = mean(single, endless, None, |_| 1.0);
            assert!((all - 1e6_f64.ln() / 2.0).abs() < 1e-4);
        }
        // Where extinction varies, an end must be known.
        let unknown = Segment { from: 0.0, to: f32::INFINITY, sigma: 0.0 };
        for rule in [Rule::Trapezoid, Rule::PlainTrapezoid] {
            assert_eq!(unknown.node(SingleScatter { rule, nodes: 2 }, 1, 0.5, None), None);
        }
    }

    #[test]
    fn extreme_segments_have_numbers() {
        for sigma in [0.0, 1e-30, 1e-3, 1.0, 1e30] {
            for to in [0.0, 1e-30, 1.0, 1e30, f32::INFINITY] {
                for rule in [Rule::Trapezoid, Rule::PlainTrapezoid, Rule::Equiangular] {
                    for foot in [
                        None,
                        Some(Foot { along: 1e20, distance: 1e-20 }),
                        Some(Foot { along: 0.0, distance: 1e-30 }),
                        Some(Foot { along: -1e15, distance: 1e18 }),
                    ] {
                        for u in [0.0, 0.5, BELOW_ONE] {
                            let segment = Segment { from: 0.0, to, sigma };
                            for i in 0..4 {
                                let node = segment.node(SingleScatter { rule, nodes: 4 }, i, u, foot);
                                assert!(node.is_none_or(|n| n.t >= 0.0 && n.t <= to && n.weight > 0.0));
                            }
                        }
                    }
                }
            }
        }
        assert!(SingleScatter { rule: Rule::Trapezoid, nodes: 0 }.check().is_err());
        assert!(SingleScatter { rule: Rule::Trapezoid, nodes: NODES_MAX + 1 }.check().is_err());
        assert!(SingleScatter { rule: Rule::Trapezoid, nodes: SingleScatter::NODES }.check().is_ok());
    }
}
