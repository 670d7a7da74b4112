//! f16 (IEEE 754 binary16) of numbers that are not negative.

/// To nearest, ties to even; what is too large becomes the largest finite number.
pub(super) fn from_f32(x: f32) -> u16 {
    // Adding 2^-1 x the step rounds in f32 itself: below 2^-14 the step is 2^-24 throughout.
    if x < 1.0 / 16_384.0 {
        let units = x * 16_777_216.0;
        let low = units as u32;
        let rest = units - low as f32;
        let up = rest > 0.5 || (rest == 0.5 && low % 2 == 1);
        return (low + u32::from(up)) as u16;
    }
    let bits = x.to_bits();
    let rounded = bits + 0xfff + (bits >> 13 & 1);
    ((rounded >> 13).saturating_sub(112 << 10)).min(0x7bff) as u16
}

/// The number itself: exact.
#[inline(always)]
pub(super) fn to_f32(half: u16) -> f32 {
    let (exponent, fraction) = (u32::from(half) >> 10 & 31, u32::from(half) & 0x3ff);
    if exponent == 0 {
        return fraction as i32 as f32 * (1.0 / 16_777_216.0);
    }
    f32::from_bits(((exponent + 112) << 23) | fraction << 13)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_half_comes_back() {
        for h in 0..=0x7bff_u16 {
            assert_eq!(from_f32(to_f32(h)), h);
        }
        for (x, h) in
            [(0.0, 0), (1.0, 0x3c00), (65504.0, 0x7bff), (1e9, 0x7bff), (5.960_464_5e-8, 1), (2.9e-8, 0)]
        {
            assert_eq!(from_f32(x), h, "{x}");
        }
    }

    #[test]
    fn halves_between_are_the_nearest() {
        for h in 0..0x7bff_u16 {
            let (a, b) = (f64::from(to_f32(h)), f64::from(to_f32(h + 1)));
            for t in [0.25, 0.49, 0.51, 0.75] {
                let x = (a + (b - a) * t) as f32;
                let nearest = if t < 0.5 { h } else { h + 1 };
                assert_eq!(from_f32(x), nearest, "{h} {t}");
            }
        }
    }
}
