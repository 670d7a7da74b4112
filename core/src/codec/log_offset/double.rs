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
