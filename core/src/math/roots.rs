//! Real roots of quadratics, in f32 without cancellation.

use super::bits::{exponent, ldexp};
use super::root_functions::sqrt;
use super::sums::two_prod;

/// b^2 - 4 a c within 2 ulp (after Kahan 2004, "On the cost of floating-point computation without extra-precise
/// arithmetic"): both products with their errors. Precondition for that accuracy: both products between 2^-100 and
/// f32::MAX; [`quadratic_roots`] scales so that they are.
#[inline]
#[must_use]
pub fn discriminant(a: f32, b: f32, c: f32) -> f32 {
    let (p, p_error) = two_prod(b, b);
    let (q, q_error) = two_prod(4.0 * a, c);
    (p - q) + (p_error - q_error)
}

/// The real roots of a x^2 + b x + c in ascending order, a double root twice; `None` where there is none. Each within a few ulp (see the tests) for all finite
/// coefficients, however small or large.
///
/// The larger root in magnitude is q / a and the other c / q, with q = -(b + sign(b) sqrt(D)) / 2: no cancellation.
/// The coefficients are first scaled by powers of two (exactly) so that |a| and |c| are near 1.
///
/// Degenerate: a = 0 gives the one root -c/b twice; a = b = 0 gives `None` (also for 0 = 0, where every x is a root);
/// a coefficient that is not finite gives `None`. A root beyond f32::MAX is +-f32::MAX; one below 2^-149 is 0.
#[inline]
#[must_use]
pub fn quadratic_roots(a: f32, b: f32, c: f32) -> Option<[f32; 2]> {
    // A sum of zeros unless one is infinite or NaN.
    if !(a * 0.0 + b * 0.0 + c * 0.0 == 0.0) {
        return None;
    }
    if a == 0.0 {
        if b == 0.0 {
            return None;
        }
        let x = finite(-quotient(c, b));
        return Some([x, x]);
    }
    if c == 0.0 {
        let x = finite(-quotient(b, a));
        return Some(if x < 0.0 { [x, 0.0] } else { [0.0, x] });
    }
    // x = 2^shift t: the coefficients of t are a 2^(2 shift), b 2^shift, c; all are then divided by 2^exponent(c).
    let (ea, ec) = (exponent(a), exponent(c));
    let shift = (ec - ea) >> 1;
    let a = ldexp(a, 2 * shift - ec);
    let b_exponent = exponent(b) + shift - ec;
    let c = ldexp(c, -ec);
    if b != 0.0 && b_exponent > 14 {
        // 4 a c < 2^-24 b^2: D = b^2 to the last bit, and b 2^shift might overflow.
        let b = ldexp(b, -exponent(b));
        let large = ldexp_finite(-b / a, b_exponent + shift);
        let small = ldexp_finite(-c / b, shift - b_exponent);
        return Some(ordered(large, small));
    }
    let b = ldexp(b, shift - ec);
    let d = discriminant(a, b, c);
    if d < 0.0 {
        return None;
    }
    let q = -0.5 * (b + f32::copysign(sqrt(d), b));
    // q is 0 only for b = c = 0, and c is not.
    Some(ordered(ldexp_finite(q / a, shift), ldexp_finite(c / q, shift)))
}

#[inline(always)]
fn ordered(a: f32, b: f32) -> [f32; 2] {
    if a < b { [a, b] } else { [b, a] }
}

#[inline(always)]
fn finite(x: f32) -> f32 {
    x.clamp(-f32::MAX, f32::MAX)
}

#[inline(always)]
fn ldexp_finite(x: f32, k: i32) -> f32 {
    finite(ldexp(x, k))
}

/// Plain division: overflow is taken care of by the caller.
#[inline(always)]
fn quotient(n: f32, d: f32) -> f32 {
    n / d
}
