//! Assembly and balance.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use super::*;
use alloc::vec;
use alloc::vec::Vec;

fn row(met: &[(u32, u32)], escaped: u32, rays: u32) -> Row {
    Row { met: met.to_vec(), escaped, lost: 0, rays }
}

#[test]
fn both_counts_of_a_pair_make_one_number() {
    // A patch of 1 m^2 with 100 rays sees one of 2 m^2 with 100 by 20 of them, and is seen by 14.
    let found = assemble(&[1.0, 2.0], &[row(&[(0, 4), (1, 20)], 76, 100), row(&[(0, 14)], 86, 100)]).unwrap();
    let flux = 34.0 / (100.0 + 50.0);
    assert!((found.flux(0, 1) - flux).abs() < 1e-6 && found.flux(0, 1) == found.flux(1, 0));
    assert!((found.flux(0, 0) - 0.04).abs() < 1e-6, "a patch that sees itself by 4 of 100");
    let sums = found.row_sums();
    assert!(
        (sums[0] - f64::from(0.04 + flux)).abs() < 1e-6 && (sums[1] - f64::from(flux / 2.0)).abs() < 1e-6
    );
    assert_eq!(found.escaped, [0.76, 0.86]);
    let stderr = (f64::from(flux) / 150.0 + 0.04 / 200.0).sqrt();
    assert!((f64::from(found.stderr[0]) - stderr).abs() < 1e-6);
}

#[test]
fn rows_that_do_not_fit_are_refused() {
    assert_eq!(assemble(&[1.0], &[]), Err(RowError::WrongLength { found: 0, expected: 1 }));
    assert_eq!(assemble(&[1.0], &[row(&[(1, 1)], 0, 4)]), Err(RowError::UnknownPatch { row: 0, patch: 1 }));
    assert_eq!(assemble(&[1.0], &[row(&[], 0, 0)]), Err(RowError::NoRays { row: 0 }));
    assert!(assemble(&[], &[]).is_ok_and(|f| f.is_empty()));
}

/// Six patches that see each other all, with noise.
fn noisy() -> FormFactors {
    let areas = [1.0, 2.0, 0.5, 1.5, 1.0, 3.0];
    let rows: Vec<Row> = (0..6_u32)
        .map(|i| {
            let met: Vec<(u32, u32)> = (0..6)
                .filter(|j| *j != i)
                .map(|j| (j, 100 + (37 * i + 61 * j) % 83 + 40 * u32::from(j == 5)))
                .collect();
            let rays = met.iter().map(|m| m.1).sum();
            row(&met, 0, rays)
        })
        .collect();
    assemble(&areas, &rows).unwrap()
}

#[test]
fn balancing_sets_sums_right_and_keeps_symmetry() {
    let mut found = noisy();
    let targets = found.targets();
    assert_eq!(targets, [1.0; 6]);
    let report = balance(&mut found, &targets, 60);
    assert!(report.before > 0.1 && report.after < 1e-6, "{report:?}");
    assert!(found.row_sums().iter().all(|s| (s - 1.0).abs() < 1e-6));
}

#[test]
fn sums_that_cannot_be_reached_leave_finite_numbers() {
    // 0 and 1 see each other alone, and their areas differ: both sums cannot be 1. 2 sees nothing.
    let rows = [row(&[(1, 64)], 0, 64), row(&[(0, 64)], 0, 64), row(&[], 64, 64)];
    let mut found = assemble(&[1.0, 4.0, 1.0], &rows).unwrap();
    let targets = found.targets();
    let report = balance(&mut found, &targets, 50);
    assert!(found.half.iter().all(|x| x.is_finite()) && report.after.is_finite());
    assert_eq!(found.row_sums()[2], 0.0);
}

#[test]
fn another_order_is_the_same_light() {
    let found = noisy();
    let order = [3, 0, 5, 1, 4, 2];
    let again = found.reordered(&order);
    for i in 0..6 {
        for j in 0..6 {
            assert_eq!(again.flux(i, j), found.flux(order[i] as usize, order[j] as usize));
        }
    }
    assert_eq!(vec![again.areas[0], again.areas[5]], vec![found.areas[3], found.areas[2]]);
}

#[test]
fn what_is_covered_is_no_area_and_no_row_sees_more_than_all() {
    // Patch 0: half of its rays lie under something; patch 1: nearly all, though patch 2 sees much of it.
    let row = |rays: u32, lost: u32, met: &[(u32, u32)]| Row {
        rays,
        lost,
        met: met.to_vec(),
        escaped: rays - lost - met.iter().map(|m| m.1).sum::<u32>(),
    };
    let rows = [row(1000, 500, &[(2, 400)]), row(1000, 995, &[(2, 5)]), row(1000, 0, &[(0, 100), (1, 400)])];
    let areas = [1.0, 1.0, 4.0];
    let full = assemble(&areas, &rows).unwrap();
    let (seen, shares) = full.clone().seen();
    assert_eq!(seen.half, full.half);
    assert!((shares[0] - 0.5).abs() < 1e-6 && shares[2] == 1.0, "{shares:?}");
    assert!((seen.escaped[0] - 0.2).abs() < 1e-6 && seen.lost.iter().all(|l| *l == 0.0));
    assert!(seen.row_sums().iter().all(|s| *s <= 1.0 + 1e-6), "{:?}", seen.row_sums());
    assert!(shares[1] >= (full.row_sums()[1] as f32).min(1.0) && shares[1] > 0.005);
}
