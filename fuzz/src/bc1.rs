//! Target `bc1`.

use etendue_core::codec::bc1::{self, Black, Quality, Rule, Texels};
use etendue_core::codec::bc4;

/// First byte: what is done, and (in one of sixteen) that the exhaustive searches run too: they take milliseconds. Then a block; or weights' kinds (one byte per texel) and texels, three bytes each, which
/// are repeated where the input ends.
///
/// Blocks: every one decodes, the rules stay within 5 of each other, and what is decoded encodes without loss. Texels: a
/// search is not worse than the range fit, nor than the quality before it; the same with BC4; black is avoided when asked.
pub fn bc1(bytes: &[u8]) {
    let Some((&mode, rest)) = bytes.split_first() else { return };
    let thorough = mode >> 4 == 1;
    if mode % 4 == 0 {
        if let Some(block) = rest.first_chunk() {
            decoders(*block, thorough);
        }
        return;
    }
    let Some((kinds, colours)) = rest.split_first_chunk::<16>() else { return };
    if colours.is_empty() {
        return;
    }
    let mut next = colours.iter().cycle();
    let mut byte = || next.next().copied().unwrap_or(0);
    let texels: Texels = [(); 16].map(|()| [byte(), byte(), byte()]);
    let weights = kinds.map(|k| match k {
        0 => 0.0,
        1 => f32::NAN,
        2 => -1.0,
        3 => f32::INFINITY,
        4 => f32::MIN_POSITIVE,
        5 => 1e-45,
        6 => 3e38,
        7..128 => 1.0,
        k => f32::from(k - 127) * 0.37,
    });
    let weights = if mode % 4 == 1 { bc1::ALIKE } else { weights };
    encoders(&texels, &weights, thorough);
    single_channel(&texels.map(|t| t[0]), &weights, thorough);
}

fn decoders(block: [u8; 8], thorough: bool) {
    let reference = bc1::decode_rgba(block);
    for rule in Rule::ALL {
        for (x, y) in reference.iter().zip(bc1::decode_with(block, rule)) {
            assert_eq!(x[3], y[3]);
            assert!((0..3).all(|c| x[c].abs_diff(y[c]) <= 5), "{rule:?}");
        }
    }
    let texels = bc1::decode(block);
    assert_eq!(texels, reference.map(|[r, g, b, _]| [r, g, b]));
    // A search that starts from the data alone need not find this block, but what it finds is measured right.
    let again = bc1::encode(&texels, &bc1::ALIKE, Quality::Refined);
    let range = bc1::encode(&texels, &bc1::ALIKE, Quality::RangeFit);
    let error = |b| bc1::error(&texels, &bc1::ALIKE, b);
    assert_eq!(error(block), 0.0);
    assert!(error(again) <= error(range));
    let four = bc4::decode(block);
    let error = |quality| bc4::error(&four, &bc1::ALIKE, bc4::encode(&four, &bc1::ALIKE, quality));
    assert!(error(bc4::Quality::Refined) <= error(bc4::Quality::RangeFit));
    if thorough {
        assert_eq!(error(bc4::Quality::Exhaustive), 0.0);
    }
}

/// Sums of f32 against f64: weights may differ by any factor, but the texels of large weight decide.
const SLACK: f64 = 1.0 + 1e-5;

fn encoders(texels: &Texels, weights: &[f32; 16], thorough: bool) {
    // As the encoder takes them: of infinities only the largest float.
    let error = |b| bc1::error(texels, weights, b);
    let none = weights.iter().all(|w| w.is_nan() || *w <= 0.0);
    let mut before = f64::INFINITY;
    for quality in [Quality::RangeFit, Quality::Cluster, Quality::Refined, Quality::Exhaustive] {
        if quality == Quality::Exhaustive && !thorough {
            continue;
        }
        let block = bc1::encode(texels, weights, quality);
        assert!(!none || block == [0; 8]);
        let here = error(block);
        assert!(here <= before * SLACK, "{quality:?}: {here} after {before}");
        before = here;
        let opaque = bc1::encode_with(texels, weights, quality, Black::Avoided);
        assert!(none || bc1::decode_rgba(opaque).iter().all(|t| t[3] == 255));
        // More is allowed with black, but the searches are greedy: only the range fit bounds both.
        let range = error(bc1::encode(texels, weights, Quality::RangeFit));
        assert!(none || error(opaque) <= range * SLACK);
    }
    let fast = bc1::encode(texels, weights, Quality::LeastSquares);
    assert!(none || bc1::decode_rgba(fast).iter().all(|t| t[3] == 255));
    // Eight at once give the bits of one.
    let mut out = [[0; 8]; 9];
    bc1::encode_blocks(&[*texels; 9], Quality::LeastSquares, Black::Allowed, &mut out)
        .expect("equal lengths");
    assert_eq!(out, [bc1::encode(texels, &bc1::ALIKE, Quality::LeastSquares); 9]);
    // One colour of the format is exact.
    let colour = bc1::decode([texels[0][0], texels[0][1], texels[0][0], texels[0][1], 0, 0, 0, 0])[0];
    for quality in [Quality::RangeFit, Quality::LeastSquares, Quality::Cluster] {
        assert_eq!(bc1::decode(bc1::encode(&[colour; 16], &bc1::ALIKE, quality)), [colour; 16]);
    }
    if let Some(proof) = bc1::encode_proved(texels, weights, Black::Allowed, 64) {
        assert!(!none && proof.bound <= proof.error && proof.bound >= 0.0);
    }
}

fn single_channel(texels: &[u8; 16], weights: &[f32; 16], thorough: bool) {
    let mut before = f64::INFINITY;
    for quality in bc4::Quality::ALL {
        if quality == bc4::Quality::Exhaustive && !thorough {
            continue;
        }
        let here = bc4::error(texels, weights, bc4::encode(texels, weights, quality));
        assert!(here <= before * SLACK, "{quality:?}: {here} after {before}");
        before = here;
    }
}
