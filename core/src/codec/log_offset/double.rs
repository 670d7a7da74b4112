//! Numbers of twice f64's precision, for tables that are made once on the host.
//!
//! Sums and products of f64 with their errors (T. J. Dekker, 1971; D. E. Knuth, "The Art of Computer Programming", vol. 2,
//! 4.2.2); each operation here is good to about 2^-102. Only `+ - * /`: the same bits on every IEEE machine.

/// The value `hi + lo`, |lo| at most half an ulp of hi.
#[derive(Clone, Copy, Debug)]
pub(super) struct Double {
    hi: f64,
    lo: f64,
}

/// a + b as its rounded value and its error.
fn two_sum(a: f64, b: f64) -> Double {
    let hi = a + b;
    let b_part = hi - a;
    Double { hi, lo: (a - (hi - b_part)) + (b - b_part) }
}

/// a b as its rounded value and its error, for |a|, |b| < 2^900.
fn two_prod(a: f64, b: f64) -> Double {
    // 2^27 + 1 cuts 53 bits into 26 and 26 with a sign.
    let split = |x: f64| {
        let t = 134_217_729.0 * x;
        let upper = t - (t - x);
        (upper, x - upper)
    };
    let hi = a * b;
    let ((a1, a0), (b1, b0)) = (split(a), split(b));
    Double { hi, lo: ((a1 * b1 - hi) + a1 * b0 + a0 * b1) + a0 * b0 }
}

impl Double {
    pub(super) const ONE: Self = Self { hi: 1.0, lo: 0.0 };

    pub(super) const fn new(x: f64) -> Self {
        Self { hi: x, lo: 0.0 }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        let s = two_sum(self.hi, other.hi);
        two_sum(s.hi, s.lo + (self.lo + other.lo))
    }

    pub(super) fn times(self, other: Self) -> Self {
        let p = two_prod(self.hi, other.hi);
        two_sum(p.hi, p.lo + (self.hi * other.lo + self.lo * other.hi))
    }

    /// The quotient by an f64 that is not zero.
    pub(super) fn over(self, d: f64) -> Self {
        let q = self.hi / d;
        let p = two_prod(q, d);
        two_sum(q, (((self.hi - p.hi) - p.lo) + self.lo) / d)
    }

    /// 1 / self for a number that is not zero, by the first terms of the series about the quotient in f64.
    pub(super) fn inverse(self) -> Self {
        let first = 1.0 / self.hi;
        let rest = Self::ONE.plus(self.times(Self::new(first)).negated());
        Self::new(first).plus(Self::new(first).times(rest)).plus(Self::new(first).times(rest).times(rest))
    }

    pub(super) fn negated(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }

    /// The nearest f32 of a positive number whose nearest f32 is normal, rounded once.
    pub(super) fn nearest(self) -> f32 {
        // Rounded to f64 with an odd last bit wherever it is inexact, a second rounding cannot meet a false tie
        // (S. Boldo and G. Melquiond, 2008).
        let bits = self.hi.to_bits();
        let odd = match (bits & 1 == 0, self.lo > 0.0, self.lo < 0.0) {
            (true, true, _) => bits + 1,
            (true, _, true) => bits - 1,
            _ => bits,
        };
        f64::from_bits(odd) as f32
    }

    /// The least f32 that is not below a positive number.
    pub(super) fn ceiling(self) -> f32 {
        // The nearest f32 of hi: where it is above, its lower neighbour is below.
        let x = self.hi as f32;
        let wide = f64::from(x);
        if wide < self.hi || (wide == self.hi && self.lo > 0.0) { x.next_up() } else { x }
    }
}

/// e^-r for 0 <= r <= 0.36, by Taylor's series to r^26 / 26! < 2^-120.
pub(super) fn exp_negative(r: Double) -> Double {
    (1..=26).rev().fold(Double::ONE, |s, n| Double::ONE.plus(r.times(s).over(f64::from(n)).negated()))
}

/// (1 - e^-r) / r for 0 <= r <= 0.36: the mean of e^-t over t in [0, r].
pub(super) fn mean_exp_negative(r: Double) -> Double {
    (1..=26).rev().fold(Double::ONE, |s, n| Double::ONE.plus(r.times(s).over(f64::from(n + 1)).negated()))
}

/// sinh(h) / h for 0 <= h <= 0.36: the mean of e^t over t in [-h, h].
pub(super) fn mean_exp_symmetric(h: Double) -> Double {
    let square = h.times(h);
    (1..=13).rev().fold(Double::ONE, |s, n| {
        Double::ONE.plus(square.times(s).over(f64::from(2 * n) * f64::from(2 * n + 1)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// |a / b - 1| below 2^-97, of which f64 alone would miss 2^44.
    fn near(a: Double, b: Double) {
        let rest = a.plus(b.negated());
        let error = (rest.hi + rest.lo).abs() / b.hi;
        assert!(error <= 6.3e-30, "{a:?} is not {b:?}: {error:e}");
    }

    #[test]
    fn identities_hold_in_twice_the_precision() {
        for r in [1.2e-4, 0.001, 0.0225, 0.049, 0.1, 0.17] {
            let r = Double::new(r).over(3.0);
            let (once, double) = (exp_negative(r), r.plus(r));
            near(once.times(once), exp_negative(double));
            near(once.times(once.inverse()), Double::ONE);
            // r (1 - e^-r)/r + e^-r = 1, and 2 r sinh(r)/r + e^-r = e^r.
            near(r.times(mean_exp_negative(r)).plus(once), Double::ONE);
            let sinh = double.times(mean_exp_symmetric(r)).plus(once);
            near(sinh, once.inverse());
        }
    }

    #[test]
    fn both_roundings_mind_the_lower_part() {
        let ulp = f64::from(f32::EPSILON);
        let of = |hi, lo| Double { hi, lo };
        let (one, next) = (1.0_f32, 1.0_f32.next_up());
        for lo in [1e-20, 1e-30] {
            assert_eq!([of(1.0, -lo), of(1.0, 0.0), of(1.0, lo)].map(Double::ceiling), [one, one, next]);
            // A tie goes to the even neighbour, unless the lower part decides.
            let (tie, above) = (1.0 + 0.5 * ulp, 1.0 + 1.5 * ulp);
            assert_eq!([of(tie, -lo), of(tie, 0.0), of(tie, lo)].map(Double::nearest), [one, one, next]);
            let far = next.next_up();
            assert_eq!(
                [of(above, -lo), of(above, 0.0), of(above, lo)].map(Double::nearest),
                [next, far, far]
            );
        }
        assert_eq!(of(1.0 + 0.9 * ulp, 0.0).ceiling(), next);
        assert_eq!(of(1.0 + 0.1 * ulp, 0.0).ceiling(), next);
    }
}
