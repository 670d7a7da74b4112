//! The truth of the kernels of `log_offset`.

use super::{Answer, Expect, Words};
use etendue_core::kernel::Kernel;

pub(super) fn truth(kernel: Kernel, constants: &[u32], r: &mut Words<'_>) -> Answer {
    use Kernel as K;
    match kernel {
        K::LogOffsetEncode => {
            let mut c = Words::new(constants);
            let thresholds: Vec<f64> = constants.iter().map(|_| c.real()).collect();
            Answer::Is(vec![Expect::Word(code(&thresholds, r.real()))])
        }
        K::LogOffsetLookUp => Answer::Is(vec![Expect::Word(constants[r.word() as usize % 256])]),
        _ => {
            let mut c = Words::new(constants);
            let (width, max, level) = (c.real(), c.real(), r.real());
            decoded(width, max, level, kernel == K::LogOffsetDecodeMean)
        }
    }
}

/// From the lowest threshold (level 1/2) to the highest (254 1/2) levels go with the logarithm: the published map, from
/// these two alone. Next to a boundary, where their rounding counts, the number of thresholds up to `x`.
fn code(thresholds: &[f64], x: f64) -> u32 {
    let counted = thresholds.iter().filter(|t| **t <= x).count() as u32;
    let (low, high) = (thresholds[0], thresholds[254]);
    if x <= 0.0 || low == high {
        return counted;
    }
    let levels_per_log = 254.0 / (high / low).ln();
    let level = 0.5 + (x / low).ln() * levels_per_log;
    // Each threshold is rounded up by an ulp (2^-23) at most; so are those it is compared with.
    let band = 4.0 / 8_388_608.0 * levels_per_log;
    let from_boundary = (level + 0.5 - (level + 0.5).round()).abs();
    if from_boundary <= band { counted } else { level.round().clamp(0.0, 255.0) as u32 }
}

/// max e^(-width (255 - level) / 255), or its mean over half a level to both sides, by the antiderivative.
fn decoded(width: f64, max: f64, level: f64, mean: bool) -> Answer {
    if level < 0.5 {
        return Answer::Is(vec![Expect::Word(0)]);
    }
    let level = level.min(255.0);
    let at = |level: f64| width * (level - 255.0) / 255.0;
    let (value, exponent) = if mean {
        let (low, high) = (at(level - 0.5), at((level + 0.5).min(255.0)));
        // -(e^(low - high) - 1) keeps its digits where the cell is narrow.
        (max * high.exp() * -(low - high).exp_m1() / (high - low), high)
    } else {
        (max * at(level).exp(), at(level))
    };
    // An exponential is as good as its argument.
    Answer::Is(vec![Expect::Scaled(value, value * (1.0 + exponent.abs()))])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_of_the_published_map_by_hand() {
        // 25 (1 - 1/255) below 1 is level 1; e^-12.5 is level 127.5, just above the boundary of 127 and 128.
        let thresholds: Vec<f64> =
            (1..=255).map(|c| (-25.0 * (255.5 - f64::from(c)) / 255.0).exp()).collect();
        for (x, c) in [
            (1.0, 255),
            ((-25.0_f64 * 254.0 / 255.0).exp(), 1),
            ((-12.49_f64).exp(), 128),
            ((-12.51_f64).exp(), 127),
            ((-24.96_f64).exp(), 0),
            ((-24.94_f64).exp(), 1),
            (2.0, 255),
            (-1.0, 0),
        ] {
            assert_eq!(code(&thresholds, x), c, "{x}");
        }
    }
}
