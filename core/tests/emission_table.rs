//! The table of pairs: total flux against integers, and what the integer density makes of it.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::direct::emission::{EmissionTable, Entry, TableError};
use etendue_core::math::Vec3;
use etendue_core::sampling::counter::Counter;
use etendue_core::sampling::discrete::WeightError;

/// `count` pairs whose emission spans 12 decades, with colours.
fn pairs(count: u32) -> Vec<Vec3> {
    let g = Counter::new(31);
    (0..count)
        .map(|n| {
            let size = 10.0_f64.powf(12.0 * f64::from(g.unit(0, n, 0)) - 6.0);
            let color = [1, 2, 3].map(|d| (size * (0.05 + 0.95 * f64::from(g.unit(0, n, d)))) as f32);
            Vec3::from_array(color)
        })
        .collect()
}

fn table(emission: &[Vec3]) -> EmissionTable {
    let mut table = EmissionTable::new();
    for (i, e) in emission.iter().enumerate() {
        assert!(table.push_pair(i as u32, 7, *e, *e).unwrap());
    }
    table
}

/// The exact sum of floats between 2^-60 and 2^60, as an integer of units 2^-90.
fn exact(values: impl Iterator<Item = f32>) -> i128 {
    values.fold(0, |sum, x| {
        let bits = x.to_bits();
        let (exponent, fraction) = ((bits >> 23) as i32, bits & 0x7f_ffff);
        assert!((127 - 60..127 + 60).contains(&exponent), "{x}");
        sum + (i128::from(fraction | 0x80_0000) << (exponent - 127 - 23 + 90))
    })
}

#[test]
fn total_flux_of_a_million_pairs_over_twelve_decades_is_conserved() {
    let mut list = pairs(1_000_000);
    for order in 0..3 {
        // As they come, small ones first, large ones first.
        match order {
            0 => {}
            1 => list.sort_unstable_by(|a, b| a.x.total_cmp(&b.x)),
            _ => list.reverse(),
        }
        let t = table(&list);
        assert_eq!(t.len(), list.len());
        let (mut worst, mut plain_worst) = (0.0_f64, 0.0_f64);
        for c in 0..3 {
            let sum = exact(list.iter().map(|e| e[c]));
            let got = exact([t.sum().flux()[c]].into_iter());
            let err = ((got - sum) as f64 / sum as f64).abs();
            assert!(err <= 1e-6, "order {order}, channel {c}: {err}");
            // What is promised is more.
            assert!(err <= 2.0_f64.powi(-24), "order {order}, channel {c}: {err}");
            worst = worst.max(err);
            let plain = list.iter().fold(0.0_f32, |s, e| s + e[c]);
            plain_worst = plain_worst.max((f64::from(plain) / (sum as f64 * 2.0_f64.powi(-90)) - 1.0).abs());
        }
        let sum = exact(t.importances().iter().copied());
        let err = ((exact([t.sum().importance()].into_iter()) - sum) as f64 / sum as f64).abs();
        assert!(err <= 2.0_f64.powi(-24), "order {order}: {err}");
        println!("order {order}: error of the flux {worst:.2e}, plain sum {plain_worst:.2e}");
    }
}

#[test]
fn blocks_appended_in_order_give_the_same_bits() {
    let list = pairs(50_000);
    let blocks = || list.chunks(4096).map(table);
    let mut joined = EmissionTable::new();
    blocks().for_each(|b| joined.append(&b).unwrap());
    // Made in another order, appended in the same.
    let mut made: Vec<_> = blocks().collect();
    made.reverse();
    let mut again = EmissionTable::new();
    made.iter().rev().for_each(|b| again.append(b).unwrap());
    assert_eq!(joined.sum(), again.sum());
    assert_eq!(joined.len(), 50_000);
    for c in 0..3 {
        let sum = exact(list.iter().map(|e| e[c]));
        let err = ((exact([joined.sum().flux()[c]].into_iter()) - sum) as f64 / sum as f64).abs();
        assert!(err <= 2.0_f64.powi(-24), "{err}");
    }
}

#[test]
fn starts_weighted_by_the_integer_probability_conserve_the_flux() {
    let list = pairs(1_000_000);
    let t = table(&list);
    let density = t.density().unwrap();
    let (mut light, mut light_counts, mut second, mut heaviest) = (0_u64, 0_u64, 0.0_f64, 0.0_f64);
    let mut mean = [0.0_f64; 3];
    let total = exact(t.importances().iter().copied()) as f64 * 2.0_f64.powi(-90);
    for i in 0..list.len() as u32 {
        let count = density.count(i);
        assert!(count > 0, "entry {i}");
        let q = count as f64 / 4_294_967_296.0;
        let flux = t.start_flux(i, density.pmf(i));
        for c in 0..3 {
            mean[c] += q * f64::from(flux[c]);
        }
        let weight = f64::from(t.importances()[i as usize]) / q / total;
        second += q * weight * weight;
        heaviest = heaviest.max(weight);
        if count == 1 {
            (light, light_counts) = (light + 1, light_counts + count);
        }
    }
    for c in 0..3 {
        let sum = exact(list.iter().map(|e| e[c])) as f64 * 2.0_f64.powi(-90);
        let err = (mean[c] / sum - 1.0).abs();
        assert!(err <= 1e-6, "channel {c}: {err}");
        println!("channel {c}: mean over all words within {err:.2e}");
    }
    // What the counts cost: the variance of the scalar weight in units of its mean squared.
    let variance = second - 1.0;
    println!(
        "10^6 entries over 12 decades: {light} of one count, {:.2e} of all words; variance added {variance:.2e}; \
         heaviest weight {heaviest:.4} of the mean",
        light_counts as f64 / 4_294_967_296.0
    );
    assert!(variance <= 2.4e-4, "{variance}");
    assert!(heaviest <= 1.5 + 1e-3, "{heaviest}");
}

#[test]
fn picks_find_their_entries_and_weigh_them() {
    let g = Counter::new(33);
    let list = pairs(1000);
    let t = table(&list);
    let density = t.density().unwrap();
    // 2^20 picks: the mean weight is the flux within 5 standard errors (alpha < 1e-6 per channel, three channels).
    let (mut sum, mut square) = ([0.0_f64; 3], [0.0_f64; 3]);
    let n = 1 << 20;
    for s in 0..n {
        let pick = density.pick(g.bits(0, s, 0));
        assert_eq!(t.entries()[pick.index as usize], Entry::Pair { piece: pick.index, light: 7 });
        let flux = t.start_flux(pick.index, pick.pmf);
        for c in 0..3 {
            sum[c] += f64::from(flux[c]);
            square[c] += f64::from(flux[c]).powi(2);
        }
    }
    for c in 0..3 {
        let (n, truth) = (f64::from(n), f64::from(t.sum().flux()[c]));
        let mean = sum[c] / n;
        let error = ((square[c] / n - mean * mean).max(0.0) / n).sqrt();
        assert!(
            (mean - truth).abs() <= 5.0 * error + 1e-6 * truth,
            "channel {c}: {mean} for {truth} +- {error}"
        );
    }
}

#[test]
fn what_is_no_flux_is_refused_and_what_sends_nothing_is_left_out() {
    let mut t = EmissionTable::new();
    assert_eq!(t.density(), Err(WeightError::Empty));
    assert_eq!(t.push_pair(0, 0, Vec3::ZERO, Vec3::ZERO), Ok(false));
    assert!(t.is_empty());
    for bad in [f32::NAN, f32::INFINITY, -1.0] {
        let v = Vec3::new(1.0, bad, 1.0);
        assert!(matches!(t.push_pair(1, 2, v, Vec3::ONE), Err(TableError::Invalid { .. })));
        assert!(matches!(t.push_pair(1, 2, Vec3::ONE, v), Err(TableError::Invalid { .. })));
        assert!(matches!(t.push_light(1, v), Err(TableError::Invalid { .. })));
    }
    assert!(t.is_empty());
    // Dark on the whole, with a bright corner: kept, at the least weight.
    assert_eq!(t.push_pair(3, 1, Vec3::ZERO, Vec3::ONE), Ok(true));
    assert_eq!(t.push_light(4, Vec3::splat(2.0)), Ok(true));
    assert_eq!(t.entries(), [Entry::Pair { piece: 3, light: 1 }, Entry::Light { light: 4 }]);
    let d = t.density().unwrap();
    assert!(d.count(0) > 0);
    assert_eq!(t.start_flux(0, d.pmf(0)), Vec3::ZERO);
    assert_eq!(t.start_flux(9, 0.0), Vec3::ZERO);
    assert_eq!(t.sum().flux(), Vec3::splat(2.0));
    let mut huge = EmissionTable::new();
    for i in 0..3 {
        huge.push_light(i, Vec3::splat(f32::MAX)).unwrap();
    }
    assert_eq!(huge.sum().flux(), Vec3::splat(f32::MAX));
    assert!(huge.density().is_ok());
}
