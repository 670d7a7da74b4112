//! Operators in blocks against dense sums in f64.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod parts;
mod room;

use super::order;
use super::*;
use crate::codec::bc1;
use crate::radiosity::form_factors::FormFactors;
use crate::radiosity::polynomial::{Multiply, Portable as Products, Target, View};
use alloc::vec;
use room::{albedo, cube, lit, part};

/// One thread for both.
struct One;

impl Multiply for One {
    fn multiply_add(&self, c: Target<'_, f32>, a: View<'_, f32>, b: View<'_, f32>) {
        Products.multiply_add(c, a, b);
    }
    fn multiply_add_wide(&self, c: Target<'_, f64>, a: View<'_, f64>, b: View<'_, f64>) {
        Products.multiply_add_wide(c, a, b);
    }
}

impl Schedule for One {
    fn product(&self, operator: &BlockOperator, sent: Sent<'_>, y: &mut [Quad], scratch: &mut Scratch) {
        Portable.product(operator, sent, y, scratch);
    }
    fn encode(&self, source: &Source<'_>, blocks: &mut [[u8; 8]]) {
        Portable.encode(source, blocks);
    }
    fn greedy(&self, codes: &[u8], width: usize, order: &mut [u32]) {
        Portable.greedy(codes, width, order);
    }
}

fn encode(f: &FormFactors, rho: &[[f32; 3]], settings: &Settings<'_>) -> BlockOperator {
    BlockOperator::encode(&One, f, rho, settings).unwrap()
}

fn run(operator: &BlockOperator, direct: &[[f32; 3]], emission: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let mut indirect = vec![[7.0; 3]; operator.len()];
    let mut room = Workspace::default();
    operator.relight(&Portable, (direct, emission), &mut indirect, &mut room).unwrap();
    // The same once more, in a room that has been used.
    let mut again = indirect.clone();
    operator.relight(&Portable, (direct, emission), &mut again, &mut room).unwrap();
    assert_eq!(indirect, again);
    indirect
}

/// Indirect irradiance of so many bounces in f64.
fn irradiance(
    f: &FormFactors,
    rho: &[[f32; 3]],
    (direct, emission): (&[[f32; 3]], &[[f32; 3]]),
    bounces: u32,
) -> Vec<[f64; 3]> {
    let n = f.len();
    let rows: Vec<f64> =
        (0..n * n).map(|k| f64::from(f.flux(k / n, k % n)) / f64::from(f.areas[k / n])).collect();
    let start: Vec<[f64; 3]> = (0..n)
        .map(|i| {
            let own = |c: usize| emission.get(i).map_or(0.0, |e| f64::from(e[c]));
            [0, 1, 2].map(|c| f64::from(rho[i][c]) * f64::from(direct[i][c]) + own(c))
        })
        .collect();
    let mut b = start.clone();
    let mut e = vec![[0.0; 3]; n];
    for _ in 0..bounces {
        for i in 0..n {
            e[i] = [0, 1, 2].map(|c| (0..n).map(|j| rows[i * n + j] * b[j][c]).sum());
        }
        for i in 0..n {
            b[i] = [0, 1, 2].map(|c| start[i][c] + f64::from(rho[i][c]) * e[i][c]);
        }
    }
    e
}

/// The same as an operator gives it: irradiance or radiosity.
fn truth(
    operator: &BlockOperator,
    f: &FormFactors,
    light: (&[[f32; 3]], &[[f32; 3]]),
    bounces: u32,
) -> Vec<[f64; 3]> {
    let rho = &operator.parts().albedo;
    let e = irradiance(f, rho, light, bounces);
    match operator.quantity() {
        Quantity::Irradiance => e,
        Quantity::Radiosity => {
            e.iter().zip(rho).map(|(e, rho)| [0, 1, 2].map(|c| e[c] * f64::from(rho[c]))).collect()
        }
    }
}

fn distance_of(found: &[[f32; 3]], truth: &[[f64; 3]], areas: &[f32]) -> f64 {
    let (mut d, mut s) = (0.0, 0.0);
    for ((x, t), a) in found.iter().zip(truth).zip(areas) {
        for c in 0..3 {
            d += f64::from(*a) * (f64::from(x[c]) - t[c]).powi(2);
            s += f64::from(*a) * t[c].powi(2);
        }
    }
    if s > 0.0 { (d / s).sqrt() } else { d }
}

/// All of it kept, in every form.
fn exact(matrix: Matrix, half: bool, kept: Kept, keep: f32) -> Settings<'static> {
    Settings { matrix, half, kept, keep, ..Settings::mended() }
}

const MATRICES: [(Matrix, bool, u32); 6] = [
    (Matrix::Bounces(1), false, 1),
    (Matrix::Bounces(3), false, 3),
    (Matrix::AllBounces, false, 400),
    (Matrix::Gather, false, 400),
    (Matrix::Gather, true, 400),
    (Matrix::FormFactors { bounces: 5 }, true, 5),
];

#[test]
fn keeping_all_is_exact_up_to_rounding() {
    for n in [1, 2, 5, 9, 70] {
        let (f, rho) = (part(n), albedo(n, 0.6));
        let (direct, emission) = (lit(n), vec![[0.25, 0.0, 1.0]; n]);
        for (matrix, half, bounces) in MATRICES {
            for (kept, tolerance) in [(Kept::Full, 2e-6), (Kept::Short, 1e-3)] {
                let made = encode(&f, &rho, &exact(matrix, half, kept, 1.0));
                assert!(made.parts().blocks.iter().all(|b| *b == [0; 8]), "nothing is left for blocks");
                let truth = truth(&made, &f, (&direct, &emission), bounces);
                let error = distance_of(&run(&made, &direct, &emission), &truth, &f.areas);
                assert!(error <= tolerance, "{n} {matrix:?} {half} {kept:?} {error}");
            }
        }
    }
}

#[test]
fn products_are_those_of_the_entries() {
    let orders = [Order::Patches, Order::Greedy { passes: 1 }, Order::Greedy { passes: 2 }];
    for n in [1, 2, 5, 9, 70] {
        let (f, rho) = (part(n), albedo(n, 0.6));
        let given: Vec<u32> = (0..n as u32).rev().collect();
        for (matrix, half, _) in MATRICES {
            // One product.
            let matrix = match matrix {
                Matrix::FormFactors { .. } => Matrix::FormFactors { bounces: 1 },
                other => other,
            };
            for order in orders.into_iter().chain([Order::Given(&given)]) {
                for (keep, kept) in [(0.0, Kept::Full), (0.1, Kept::Full), (0.1, Kept::Short)] {
                    let made = encode(&f, &rho, &Settings { order, ..exact(matrix, half, kept, keep) });
                    let direct = lit(n);
                    let found = run(&made, &direct, &[]);
                    for i in 0..n {
                        for c in 0..3 {
                            let b = |j: usize| f64::from(rho[j][c]) * f64::from(direct[j][c]);
                            let sum: f64 = (0..n).map(|j| f64::from(made.entry(i, j)[c]) * b(j)).sum();
                            let error = (f64::from(found[i][c]) - sum).abs();
                            assert!(
                                error <= 4e-6 * sum.abs() + 1e-12,
                                "{n} {matrix:?} {order:?} {sum} {error}"
                            );
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn the_mended_codecs_are_near_the_truth_and_the_published_one_is_not() {
    let (f, order) = cube(9);
    let n = f.len();
    let rho = albedo(n, 0.6);
    let f = f.reordered(&order);
    let direct = lit(n);
    let published = encode(&f, &rho, &Settings::published(3));
    let error = |made: &BlockOperator, bounces: u32| {
        let truth = truth(made, &f, (&direct, &[]), bounces);
        distance_of(&run(made, &direct, &[]), &truth, &f.areas)
    };
    let first = error(&published, 3);
    for half in [false, true] {
        let mended = encode(&f, &rho, &Settings { half, ..Settings::mended() });
        let second = error(&mended, 200);
        assert!(second < 0.03 && second < 0.3 * first, "{first} {second}");
        // Half of the blocks, and half of the kept entries.
        let share = if half { 0.55 } else { 0.95 };
        assert!((mended.bytes() as f64) < share * published.bytes() as f64);
    }
    let bounced = encode(&f, &rho, &Settings::bounced(12));
    let third = error(&bounced, 12);
    assert!(third < 0.02, "{third}");
    assert!(bounced.bytes_per_pair() < 0.5, "{}", bounced.bytes_per_pair());
}

#[test]
fn sums_of_the_mended_matrix_are_kept() {
    let (f, _) = cube(5);
    let rho = albedo(f.len(), 0.6);
    let n = f.len();
    let sum = |made: &BlockOperator| -> f64 {
        (0..n * n).map(|k| made.entry(k / n, k % n).iter().map(|x| f64::from(*x)).sum::<f64>()).sum()
    };
    let whole = sum(&encode(&f, &rho, &exact(Matrix::Gather, false, Kept::Full, 1.0)));
    let made = sum(&encode(&f, &rho, &Settings { bc1: bc1::Quality::LeastSquares, ..Settings::mended() }));
    assert!(
        (made / whole - 1.0).abs() < 2e-4,
        "f16 of kept entries, and what code 0 loses: {}",
        made / whole - 1.0
    );
}

#[test]
fn a_patch_that_sees_nothing_gets_nothing() {
    let (mut f, _) = cube(4);
    let n = f.len();
    let blind = 17;
    for j in 0..n {
        let (high, low) = (blind.max(j), blind.min(j));
        f.half[high * (high + 1) / 2 + low] = 0.0;
    }
    let rho = albedo(n, 0.5);
    for (matrix, half, _) in MATRICES {
        let made = encode(&f, &rho, &exact(matrix, half, Kept::Short, 0.04));
        let light = run(&made, &lit(n), &[]);
        // Zeros share blocks with others: what they decode to is far below the rest.
        let mean = light.iter().map(|x| x[0]).sum::<f32>() / n as f32;
        assert!(
            light[blind][0].abs() < 0.1 * mean && light.iter().flatten().all(|x| x.is_finite()),
            "{matrix:?}"
        );
        let all = encode(&f, &rho, &exact(matrix, half, Kept::Full, 1.0));
        assert_eq!(run(&all, &lit(n), &[])[blind], [0.0; 3]);
    }
}

#[test]
fn black_and_nearly_white() {
    let (f, _) = cube(4);
    let n = f.len();
    let black = vec![[0.0; 3]; n];
    let mut emission = vec![[0.0; 3]; n];
    emission[3] = [2.0, 1.0, 0.5];
    for (matrix, half, bounces) in MATRICES {
        let made = encode(&f, &black, &exact(matrix, half, Kept::Full, 1.0));
        let (direct, found) = (lit(n), run(&made, &lit(n), &emission));
        let expected = truth(&made, &f, (&direct, &emission), bounces);
        assert!(distance_of(&found, &expected, &f.areas) < 2e-6);
        // Radiosity of black is 0, and so is what is said to arrive there.
        let mut e = found.clone();
        made.to_irradiance(&mut e);
        assert_eq!(e, found);
    }
    let white = vec![[0.999; 3]; n];
    for (matrix, half) in [(Matrix::AllBounces, false), (Matrix::Gather, false), (Matrix::Gather, true)] {
        let made = encode(&f, &white, &exact(matrix, half, Kept::Full, 1.0));
        let direct = lit(n);
        let expected = truth(&made, &f, (&direct, &[]), 30_000);
        let mut found = run(&made, &direct, &[]);
        let error = distance_of(&found, &expected, &f.areas);
        assert!(error < 3e-4, "elimination in f32, 1 / (1 - rho) is 1000: {error}");
        made.to_irradiance(&mut found);
        let e = irradiance(&f, &white, (&direct, &[]), 30_000);
        assert!(distance_of(&found, &e, &f.areas) < 3e-4);
    }
    let settings = exact(Matrix::Gather, false, Kept::Full, 1.0);
    assert!(matches!(
        BlockOperator::encode(&One, &f, &vec![[1.0; 3]; n], &settings),
        Err(BlockError::Solve(_)) | Ok(_)
    ));
}

#[test]
fn greedy_orders_are_permutations_that_bring_like_rows_together() {
    let (f, kd) = cube(6);
    let n = f.len();
    let rho = albedo(n, 0.5);
    // The order of patches is by sides and rows: random order is what there is to gain from.
    let shuffled: Vec<u32> = {
        let numbers = crate::sampling::counter::Counter::new(4);
        let mut list: Vec<u32> = (0..n as u32).collect();
        list.sort_by_key(|i| (numbers.unit(*i, 0, 0).to_bits(), *i));
        list
    };
    let f = f.reordered(&shuffled);
    let table = published_table(&One, &f, &rho, 3, 0.04).unwrap();
    let [none, one, two] = &table.orders[..] else { panic!() };
    assert!(one.neighbour_distance < none.neighbour_distance / 2);
    assert!(two.neighbour_distance < none.neighbour_distance / 2);
    assert!(one.total < none.total && two.total < none.total, "{table:?}");
    for errors in &table.orders {
        assert!(
            errors.max >= errors.mean && (errors.total / (3.0 * (n * n) as f64) - errors.mean).abs() < 1e-15
        );
        assert!((3.0..12.0).contains(&table.ratio_to_matrix(errors)));
    }
    for passes in [1, 2] {
        let made = encode(&f, &rho, &Settings { order: Order::Greedy { passes }, ..Settings::published(3) });
        let mut order = made.parts().order.clone();
        order.sort_unstable();
        assert!(order.iter().enumerate().all(|(i, o)| i == *o as usize) && order.len() == n);
    }
    let bad = Settings { order: Order::Given(&kd[1..]), ..Settings::published(3) };
    assert!(matches!(BlockOperator::encode(&One, &f, &rho, &bad), Err(BlockError::WrongLength { .. })));
}

#[test]
fn greedy_is_what_its_definition_says() {
    let numbers = crate::sampling::counter::Counter::new(8);
    let (n, width) = (40, 700);
    let codes: Vec<u8> =
        (0..n * width).map(|k| (numbers.unit((k / width) as u32 % 13, k as u32, 0) * 256.0) as u8).collect();
    let mut order: Vec<u32> = (0..n as u32).collect();
    order::greedy(&codes, width, &mut order);
    let row = |i: u32| &codes[i as usize * width..][..width];
    let l1 = |a: u32, b: u32| -> u64 {
        row(a).iter().zip(row(b)).map(|(a, b)| (i64::from(*a) - i64::from(*b)).unsigned_abs()).sum()
    };
    let mut expected: Vec<u32> = (0..n as u32).collect();
    for here in 0..n - 1 {
        let next = (here + 1..n).min_by_key(|k| l1(expected[here], expected[*k])).unwrap();
        expected.swap(here + 1, next);
    }
    assert_eq!(order, expected);
    let along: u64 = order.windows(2).map(|p| l1(p[0], p[1])).sum();
    assert_eq!(order::neighbour_distance(&codes, width, &order), along);
}

#[test]
fn stripes_in_any_order_give_the_same_bits() {
    let (f, order) = cube(9);
    let n = f.len();
    let (f, rho) = (f.reordered(&order), albedo(n, 0.5));
    for (matrix, half, _) in MATRICES {
        let made = encode(
            &f,
            &rho,
            &Settings { bc1: bc1::Quality::RangeFit, ..exact(matrix, half, Kept::Short, 0.04) },
        );
        let rows = block_rows(n);
        let mut quads = vec![Quad::default(); rows];
        let mut flat = vec![[0.0; 4]; n];
        for (i, x) in lit(n).iter().enumerate() {
            for c in 0..3 {
                (quads[i / SIDE][c][i % SIDE], flat[i][c]) = (x[c], x[c]);
            }
        }
        let sent = Sent { quads: &quads, flat: &flat };
        let mut y = vec![Quad::default(); rows];
        Portable.product(&made, sent, &mut y, &mut Scratch::default());
        let mut z = vec![Quad::default(); rows];
        let mut all = Vec::new();
        for first in (0..rows).step_by(STRIPE_ROWS).rev() {
            let end = rows.min(first + STRIPE_ROWS);
            let mut columns = vec![Quad::default(); if half { end } else { 0 }];
            made.stripe(first, sent, &mut z[first..end], &mut columns);
            all.push(columns);
        }
        all.iter().rev().for_each(|columns| add_columns(&mut z, columns));
        assert!(rows > STRIPE_ROWS && y == z, "{matrix:?}");
    }
}

#[test]
fn blocks_and_kept_entries_come_back() {
    // What range fit cannot lose: blocks of one code, in three channels that BC1 holds exactly.
    let codes = [[0_u8; 3], [132, 130, 132], [255; 3]];
    let n = 8;
    let texel = |i: usize, j: usize| codes[(i / 4 + j / 4) % 3];
    let all: Vec<u8> = (0..n * n).flat_map(|k| texel(k / n, k % n)).collect();
    let order: Vec<u32> = (0..n as u32).collect();
    let source = Source {
        n,
        format: Format::Bc1,
        half: false,
        order: &order,
        codes: &all,
        kept: None,
        bc1: bc1::Quality::RangeFit,
        bc4: crate::codec::bc4::Quality::RangeFit,
    };
    let mut row = [[0; 8]; 2];
    for i in 0..2 {
        source.encode_row_portable(i, &mut row);
        for (j, block) in row.iter().enumerate() {
            assert_eq!(bc1::decode(*block)[5], texel(4 * i, 4 * j));
        }
    }
    // And kept entries are the matrix itself, through any order.
    let (f, rho) = (part(70), albedo(70, 0.4));
    let order = Order::Greedy { passes: 2 };
    let made = encode(&f, &rho, &Settings { order, ..exact(Matrix::Bounces(1), false, Kept::Full, 1.0) });
    for i in 0..70 {
        for j in 0..70 {
            let form_factor = (f64::from(f.flux(i, j)) / f64::from(f.areas[i])) as f32;
            assert_eq!(made.entry(i, j), rho[i].map(|rho| rho * form_factor));
        }
    }
}

#[test]
fn codes_of_roots_are_within_half_a_step() {
    let (f, rho) = (part(70), albedo(70, 0.4));
    let settings = Settings { keep: 0.0, ..Settings::bounced(1) };
    let planes = super::matrix::Planes::new(&One, &f, &rho, &settings).unwrap();
    let coded = super::encode::code(&planes, 70, &settings).unwrap();
    let max = planes.channels[0].iter().fold(0.0_f32, |m, x| m.max(*x));
    for (x, code) in planes.channels[0].iter().zip(&coded.codes) {
        let root = 255.0 * f64::from(x / max).sqrt();
        assert!((root - f64::from(*code)).abs() <= 0.5 + 1e-4);
    }
    assert!(coded.codes.contains(&255) && coded.kept.iter().all(|k| !k));
}

#[test]
fn albedos_of_form_factors_can_change() {
    let (f, _) = cube(4);
    let n = f.len();
    let (a, b) = (albedo(n, 0.2), albedo(n, 0.8));
    let mut made = encode(&f, &a, &Settings { order: Order::Greedy { passes: 1 }, ..Settings::bounced(4) });
    made.set_albedo(&b).unwrap();
    assert_eq!(
        made,
        encode(&f, &b, &Settings { order: Order::Greedy { passes: 1 }, ..Settings::bounced(4) })
    );
    let mut baked = encode(&f, &a, &Settings::published(2));
    assert!(matches!(baked.set_albedo(&b), Err(BlockError::Baked { .. })));
}
