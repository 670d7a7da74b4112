//! Integer operations on the bits of a float: all exact.

/// Maps 32 random bits to [0, 1): `(x >> 8) * 2^-24`. Exact; the largest value is
/// [`ONE_MINUS_EPSILON`](super::ONE_MINUS_EPSILON). (Dividing by 2^32 would return 1.0 for 128 of the inputs.)
#[inline]
#[must_use]
pub const fn u32_to_unit(x: u32) -> f32 {
    (x >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// 2^k for -126 <= k <= 127. Out of that range the bits are meaningless, so that callers must keep it.
#[inline(always)]
pub(super) const fn pow2(k: i32) -> f32 {
    f32::from_bits(((k + 127) as u32) << 23)
}

/// `y * 2^k` for a `y` in [1/4, 4] and -160 <= k <= 160: one rounding when the result is subnormal, +-infinity above f32::MAX.
#[inline(always)]
pub(super) const fn scale(y: f32, k: i32) -> f32 {
    // The first product is exact, so that only the second rounds.
    let half = k >> 1;
    y * pow2(half) * pow2(k - half)
}

/// `x * 2^k` for any `x` and `k`: exact but for overflow (to +-infinity) and for one rounding to a subnormal.
#[inline]
#[must_use]
pub const fn ldexp(x: f32, k: i32) -> f32 {
    let (mut x, mut k) = (x, k);
    if k > 127 {
        x *= pow2(127);
        k -= 127;
        if k > 127 {
            x *= pow2(127);
            k -= 127;
            if k > 127 {
                k = 127;
            }
        }
    } else if k < -126 {
        // Steps of 2^-102 keep a result that ends subnormal normal until the last product.
        x *= pow2(-102);
        k += 102;
        if k < -126 {
            x *= pow2(-102);
            k += 102;
            if k < -126 {
                k = -126;
            }
        }
    }
    x * pow2(k)
}

/// floor(log2 |x|), right for subnormals; 0 for zero, 128 for infinity and NaN.
#[inline]
#[must_use]
pub const fn exponent(x: f32) -> i32 {
    let magnitude = x.to_bits() & 0x7fff_ffff;
    if magnitude >= 0x0080_0000 {
        (magnitude >> 23) as i32 - 127
    } else if magnitude == 0 {
        0
    } else {
        -118 - magnitude.leading_zeros() as i32
    }
}

/// The upper 12 significant bits of `x` (toward zero): the product of two such values is exact, and so is `x - upper(x)`.
#[inline(always)]
pub(super) const fn upper12(x: f32) -> f32 {
    f32::from_bits(x.to_bits() & 0xffff_f000)
}

/// The upper 8 significant bits of `x` (toward zero): the cube of such a value is exact.
#[inline(always)]
pub(super) const fn upper8(x: f32) -> f32 {
    f32::from_bits(x.to_bits() & 0xffff_0000)
}

/// The integer nearest to `x`, halves to even, as an integer and as a float; |x| < 2^22 (a NaN gives NaN and a
/// meaningless integer).
///
/// Adding 1.5 * 2^23 leaves it in the low bits of the sum. A shader compiler may fold that sum away: the WGSL twin
/// is `round`, which is halves to even too.
#[inline(always)]
pub(super) fn nearest(x: f32) -> (i32, f32) {
    const SHIFT: f32 = 12_582_912.0;
    let sum = x + SHIFT;
    ((sum.to_bits() as i32).wrapping_sub(SHIFT.to_bits() as i32), sum - SHIFT)
}

/// Whether `x` is positive, finite and not subnormal: one comparison.
#[inline(always)]
pub(super) const fn is_positive_normal(x: f32) -> bool {
    x.to_bits().wrapping_sub(0x0080_0000) < 0x7f00_0000
}

/// A positive normal `x` as `2^k m` with m in [sqrt(1/2), sqrt 2): (k, m). Exact.
#[inline(always)]
pub(super) const fn split_around_one(x: f32) -> (i32, f32) {
    const SQRT_HALF: u32 = 0x3f35_04f3;
    let above = x.to_bits().wrapping_sub(SQRT_HALF);
    ((above as i32) >> 23, f32::from_bits((above & 0x007f_ffff) + SQRT_HALF))
}

/// 2^23 makes every subnormal normal: a subnormal `x` is `2^-23 normalised(x)`.
#[inline(always)]
pub(super) const fn normalised(x: f32) -> f32 {
    x * 8_388_608.0
}
