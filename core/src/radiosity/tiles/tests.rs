//! Tiles against dense sums in f64.

#![allow(clippy::needless_range_loop, reason = "matrices by their indices")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use super::*;
use crate::sampling::counter::Counter;

/// A symmetric matrix with large and small entries and stretches of nothing.
fn matrix(n: usize, seed: u64) -> Vec<Vec<f32>> {
    let numbers = Counter::new(seed);
    let mut rows = alloc::vec![alloc::vec![0.0_f32; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let [a, b, c] = [0, 1, 2].map(|d| numbers.unit(i as u32, j as u32, d));
            let value = if (i / 20 + j / 20) % 3 == 0 || a < 0.2 { 0.0 } else { b * c * c * c };
            (rows[i][j], rows[j][i]) = (value, value);
        }
    }
    rows
}

fn vector(n: usize) -> Vec<Planes<3>> {
    let numbers = Counter::new(9);
    let mut x = alloc::vec![Planes::<3>::default(); tile_rows(n)];
    for i in 0..n {
        for c in 0..3 {
            x[i / SIDE][c][i % SIDE] = numbers.unit(1, i as u32, c as u32);
        }
    }
    x
}

fn product(n: usize, entry: impl Fn(usize, usize) -> f32, x: &[Planes<3>]) -> Vec<[f64; 3]> {
    (0..n)
        .map(|i| {
            [0, 1, 2]
                .map(|c| (0..n).map(|j| f64::from(entry(i, j)) * f64::from(x[j / SIDE][c][j % SIDE])).sum())
        })
        .collect()
}

#[test]
fn products_are_those_of_the_decoded_entries() {
    for n in [1, 7, 8, 9, 100, 600] {
        let m = matrix(n, 3);
        let kinds = Kind::ALL.map(Rates::Uniform);
        for rates in
            kinds.into_iter().chain([Rates::Cheapest { lambda: 1e-4 }, Rates::Cheapest { lambda: 0.0 }])
        {
            let tiles = encode(n, rates, |i, j| m[i][j]).unwrap();
            let x = vector(n);
            let mut y = alloc::vec![Planes::<3>::default(); tile_rows(n)];
            tiles.apply(&x, &mut y, &mut Scratch::default());
            let truth = product(n, |i, j| tiles.entry(i, j), &x);
            for (i, t) in truth.iter().enumerate() {
                for c in 0..3 {
                    let found = f64::from(y[i / SIDE][c][i % SIDE]);
                    assert!(
                        (found - t[c]).abs() <= 1e-5 * t[c].abs() + 1e-30,
                        "{n} {rates:?} {i} {found} {}",
                        t[c]
                    );
                }
            }
        }
    }
}

#[test]
fn stripes_in_any_order_give_the_same_bits() {
    let n = 1500;
    let m = matrix(n, 4);
    let tiles = encode(n, Rates::Cheapest { lambda: 1e-5 }, |i, j| m[i][j]).unwrap();
    let (x, rows) = (vector(n), tile_rows(n));
    let mut y = alloc::vec![Planes::<3>::default(); rows];
    tiles.apply(&x, &mut y, &mut Scratch::default());
    let mut z = alloc::vec![Planes::<3>::default(); rows];
    let mut all = Vec::new();
    for first in (0..rows).step_by(STRIPE_ROWS).rev() {
        let end = rows.min(first + STRIPE_ROWS);
        let mut columns = alloc::vec![Planes::<3>::default(); end];
        tiles.stripe(first, &x, &mut z[first..end], &mut columns);
        all.push(columns);
    }
    for columns in all.iter().rev() {
        add_columns(&mut z, columns);
    }
    assert!(rows > 2 * STRIPE_ROWS && y == z);
}

#[test]
fn more_bits_have_less_error_and_floats_hardly_any() {
    let n = 200;
    let m = matrix(n, 5);
    let error = |rates| {
        let tiles = encode(n, rates, |i, j| m[i][j]).unwrap();
        let squares =
            |f: &dyn Fn(usize, usize) -> f64| -> f64 { (0..n * n).map(|k| f(k / n, k % n).powi(2)).sum() };
        let distance = squares(&|i, j| f64::from(tiles.entry(i, j)) - f64::from(m[i][j]));
        (distance / squares(&|i, j| f64::from(m[i][j]))).sqrt()
    };
    let errors = Kind::ALL.map(|k| error(Rates::Uniform(k)));
    assert!(errors.windows(2).all(|e| e[1] < e[0]), "{errors:?}");
    assert!(
        errors[0] == 1.0 && errors[5] < 0.06 && errors[7] < 0.004 && errors[8] < 3e-4 && errors[9] == 0.0,
        "{errors:?}"
    );
}

#[test]
fn the_cheapest_kinds_cost_no_more_than_any_one_kind() {
    let n = 200;
    let m = matrix(n, 6);
    for lambda in [1e-7, 1e-5, 1e-3, 1e-1] {
        let cost = |rates| {
            let tiles = encode(n, rates, |i, j| m[i][j]).unwrap();
            let distance: f64 = (0..n * n)
                .map(|k| (f64::from(tiles.entry(k / n, k % n)) - f64::from(m[k / n][k % n])).powi(2))
                .sum();
            distance + lambda * 8.0 * tiles.payload().len() as f64
        };
        let best = cost(Rates::Cheapest { lambda });
        for kind in &Kind::ALL[..8] {
            assert!(best <= cost(Rates::Uniform(*kind)) * (1.0 + 1e-9), "{lambda} {kind:?}");
        }
    }
}

#[test]
fn wrong_bytes_are_refused() {
    let m = matrix(40, 7);
    let tiles = encode(40, Rates::Uniform(Kind::Bits4), |i, j| m[i][j]).unwrap();
    let (kinds, payload) = (tiles.kinds().to_vec(), tiles.payload().to_vec());
    assert_eq!(Tiles::try_new(40, kinds.clone(), payload.clone()), Ok(tiles));
    assert!(matches!(Tiles::try_new(41, kinds.clone(), payload.clone()), Err(TileError::Kinds { .. })));
    assert!(matches!(
        Tiles::try_new(40, kinds.clone(), payload[1..].to_vec()),
        Err(TileError::Payload { .. })
    ));
    let mut unknown = kinds.clone();
    unknown[0] = 15;
    assert_eq!(
        Tiles::try_new(40, unknown, payload.clone()),
        Err(TileError::UnknownKind { row: 0, column: 0 })
    );
    let mut infinite = payload;
    infinite[..2].copy_from_slice(&0x7f80_u16.to_le_bytes());
    assert!(matches!(Tiles::try_new(40, kinds, infinite), Err(TileError::BadValue { .. })));
    assert!(matches!(Tiles::try_new(usize::MAX, Vec::new(), Vec::new()), Err(TileError::TooLarge { .. })));
    assert!(Tiles::try_new(0, Vec::new(), Vec::new()).is_ok_and(|t| t.is_empty()));
}

#[test]
fn each_entry_is_visited_once() {
    let n = 61;
    let m = matrix(n, 8);
    let tiles = encode(n, Rates::Uniform(Kind::F32), |i, j| m[i][j]).unwrap();
    let mut seen = alloc::vec![alloc::vec![0.0_f32; n]; n];
    tiles.for_each(|i, j, value| seen[i][j] += value);
    for i in 0..n {
        for j in 0..n {
            assert_eq!(seen[i][j], if j <= i { m[i][j] } else { 0.0 });
        }
    }
}

#[test]
fn scales_that_are_no_numbers_are_refused() {
    for kind in &Kind::ALL[1..8] {
        let good = encode(8, Rates::Uniform(*kind), |_, _| 0.5).unwrap();
        for scale in [0x7f80_u16, 0x7fc0, 0x8000, 0xbf80, 0xffff] {
            let mut payload = good.payload().to_vec();
            payload[..2].copy_from_slice(&scale.to_le_bytes());
            let bad = Tiles::try_new(8, good.kinds().to_vec(), payload);
            assert_eq!(bad, Err(TileError::BadValue { row: 0, column: 0 }), "{kind:?} {scale:#x}");
        }
    }
}
