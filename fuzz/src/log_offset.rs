//! Target `log_offset`: maps of any parameters, numbers of any bit pattern.

use etendue_core::codec::log_offset::{
    ByFormula, LogOffset, LogOffsetError, MAX_WIDTH, MIN_WIDTH, Quantiser, Span, count_in, mean_at, value_at,
};

/// A width, a largest number, then numbers: as bits, or (by the first byte) near the thresholds of the map.
pub fn log_offset(bytes: &[u8]) {
    let Some((&mode, bytes)) = bytes.split_first() else { return };
    let words: Vec<u32> =
        bytes.chunks_exact(4).take(600).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]])).collect();
    let [width, max, ref rest @ ..] = words[..] else { return };
    let (width, max) = (f32::from_bits(width), f32::from_bits(max));
    let raw: Vec<f32> = rest.iter().map(|w| f32::from_bits(*w)).collect();
    fits(&raw, width);
    let map = match LogOffset::try_new(width, max) {
        Ok(map) => map,
        Err(e) => {
            match e {
                LogOffsetError::Width { .. } => assert!(!(MIN_WIDTH..=MAX_WIDTH).contains(&width)),
                LogOffsetError::Max { .. } => assert!(!max.is_finite() || max < 0.0),
                LogOffsetError::TooSmall { .. } => {
                    assert!(max < f32::MIN_POSITIVE * 2.0 * width.exp() || width > 80.0)
                }
                other => panic!("{other:?} without numbers"),
            }
            assert!(ByFormula::try_new(width, max).is_err());
            return;
        }
    };
    let values: Vec<f32> = if mode & 1 == 0 {
        raw
    } else {
        let near = |w: &u32| map.thresholds()[(w >> 8) as usize % 255].to_bits() + w % 5 - 2;
        rest.iter().map(|w| f32::from_bits(near(w))).collect()
    };
    tables(&map);
    codes(&map, &values);
    for decode in [value_at, mean_at] {
        for level in &values {
            let x = decode(width, max, *level);
            assert!(x >= 0.0 && x <= max, "level {level:e}: {x:e}");
        }
    }
}

/// Thresholds in order, and each code decodes to a number that has it.
fn tables(map: &LogOffset) {
    assert!(map.thresholds()[0] >= f32::MIN_POSITIVE);
    assert!(map.thresholds().windows(2).all(|w| w[0] <= w[1]));
    let zero = map.max() == 0.0;
    for map in [map.clone(), map.clone().mean_preserving(), map.clone().energy_preserving()] {
        for code in 0..=255_u8 {
            let x = map.decode(code);
            assert!(x >= 0.0 && x <= map.max());
            assert_eq!(map.encode(x), if zero { 0 } else { code }, "{:?}", map.decoding());
        }
    }
}

/// All forms agree, order is kept, and the measured decode too gives numbers of their codes.
fn codes(map: &LogOffset, values: &[f32]) {
    let formula = ByFormula::try_new(map.width(), map.max()).expect("the map has the same conditions");
    let mut codes = vec![0; values.len()];
    map.encode_slice(values, &mut codes).expect("equally long");
    for (x, code) in values.iter().zip(&codes) {
        assert_eq!(*code, count_in(map.thresholds(), *x), "{x:e}");
        assert_eq!(*code, map.encode_by_search(*x), "{x:e}");
        assert_eq!(*code, map.encode(*x), "{x:e}");
        if map.max() > 0.0 {
            assert!(code.abs_diff(formula.encode(*x)) <= 1, "{x:e}");
        }
    }
    let mut sorted: Vec<f32> = values.iter().copied().filter(|x| !x.is_nan()).collect();
    sorted.sort_by(f32::total_cmp);
    assert!(sorted.windows(2).all(|w| map.encode(w[0]) <= map.encode(w[1])));
    let measured = map.clone().measured(values);
    if map.max() > 0.0 {
        for code in &codes {
            assert_eq!(measured.encode(measured.decode(*code)), *code);
        }
    }
    assert_eq!(measured.decode(0), 0.0);
}

/// A fitted map keeps what it says it keeps.
fn fits(values: &[f32], share: f32) {
    let bad = values.iter().position(|v| !v.is_finite());
    for fitted in [LogOffset::fitted(values), LogOffset::fitted_losing(values, share)] {
        if let Some(first) = bad {
            assert!(matches!(fitted, Err(LogOffsetError::Value { index, .. }) if index == first));
        }
    }
    let Ok(span) = Span::of(values) else { return };
    match LogOffset::fitted(values) {
        Ok(map) => {
            assert_eq!(map.max(), span.max);
            let floor = (f64::from(span.max) * (-173.0_f64).exp()).max(f64::from(2.0 * f32::MIN_POSITIVE));
            let kept = |x: f32| f64::from(x) >= floor;
            assert!(values.iter().all(|x| map.encode(*x) > 0 || !kept(*x)));
        }
        Err(e) => assert!(matches!(e, LogOffsetError::TooSmall { max, .. } if max < 3.0 * f32::MIN_POSITIVE)),
    }
    if let Ok(map) = LogOffset::fitted_losing(values, share) {
        let positive = values.iter().filter(|v| **v > 0.0);
        let all: f64 = positive.clone().map(|v| f64::from(*v)).sum();
        let lost: f64 = positive.filter(|v| map.encode(**v) == 0).map(|v| f64::from(*v)).sum();
        // What is below the floats that a map can hold is lost in any case.
        let floor = f64::from(f32::MIN_POSITIVE) * 4.0 * values.len() as f64 + all * 1e-70;
        let share = if share > 0.0 { f64::from(share) } else { 0.0 };
        assert!(lost <= all * share.min(1.0) * (1.0 + 1e-9) + floor, "{lost:e} of {all:e}");
    }
}
