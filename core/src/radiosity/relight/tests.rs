//! Relighting against a dense solution in f64.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use super::*;
use crate::radiosity::polynomial;
use crate::radiosity::tiles::Kind;
use crate::sampling::counter::Counter;
use alloc::vec;

/// Patches of random areas that see each other by smooth and by local parts; sums of rows are `sum`.
fn form_factors(n: usize, sum: f64) -> FormFactors {
    let numbers = Counter::new(5);
    let areas: Vec<f32> = (0..n).map(|i| 0.5 + numbers.unit(0, i as u32, 0)).collect();
    let mut half = Vec::new();
    for i in 0..n {
        for j in 0..=i {
            let near = 1.0 / (1.0 + (i as f32 - j as f32).abs());
            let seen = numbers.unit(1 + i as u32, j as u32, 1) > 0.3 && i != j;
            half.push(if seen { areas[i] * areas[j] * (0.1 + near * near) } else { 0.0 });
        }
    }
    let zeros = vec![0.0; n];
    let mut made = FormFactors { areas, half, escaped: zeros.clone(), lost: zeros.clone(), stderr: zeros };
    // Near to the sums first, since factors have limits.
    let mean = made.row_sums().iter().sum::<f64>() / n as f64;
    let mean = if mean > 0.0 { mean as f32 } else { 1.0 };
    made.half.iter_mut().for_each(|x| *x /= mean);
    crate::radiosity::form_factors::balance(&mut made, &vec![sum; n], 80);
    made
}

fn albedo(n: usize, rho: f32) -> Vec<[f32; 3]> {
    (0..n).map(|i| [rho, rho * (0.5 + 0.5 * ((i * 7 % 10) as f32) / 10.0), 0.0]).collect()
}

/// Indirect irradiance of all bounces, Gauss-Seidel in f64 to the end.
fn truth(f: &FormFactors, albedo: &[[f32; 3]], direct: &[[f32; 3]], emission: &[[f32; 3]]) -> Vec<[f64; 3]> {
    let n = f.len();
    let row = |i: usize, b: &[[f64; 3]], c: usize| -> f64 {
        (0..n).map(|j| f64::from(f.flux(i, j)) * b[j][c]).sum::<f64>() / f64::from(f.areas[i])
    };
    let start: Vec<[f64; 3]> = (0..n)
        .map(|i| {
            [0, 1, 2].map(|c| {
                f64::from(albedo[i][c]) * f64::from(direct[i][c])
                    + emission.get(i).map_or(0.0, |e| f64::from(e[c]))
            })
        })
        .collect();
    let mut b = start.clone();
    for _ in 0..40_000 {
        let mut moved = 0.0_f64;
        for i in 0..n {
            for c in 0..3 {
                let next = start[i][c] + f64::from(albedo[i][c]) * row(i, &b, c);
                moved = moved.max((next - b[i][c]).abs());
                b[i][c] = next;
            }
        }
        if moved < 1e-13 {
            break;
        }
    }
    (0..n).map(|i| [0, 1, 2].map(|c| row(i, &b, c))).collect()
}

fn distance(found: &[[f32; 3]], truth: &[[f64; 3]], areas: &[f32]) -> f64 {
    let (mut d, mut s) = (0.0, 0.0);
    for ((x, t), a) in found.iter().zip(truth).zip(areas) {
        for c in 0..3 {
            d += f64::from(*a) * (f64::from(x[c]) - t[c]).powi(2);
            s += f64::from(*a) * t[c].powi(2);
        }
    }
    (d / s).sqrt()
}

fn one_lit(n: usize) -> Vec<[f32; 3]> {
    let mut direct = vec![[0.0; 3]; n];
    direct[n / 3] = [3.0, 2.0, 1.0];
    direct
}

fn run(relighter: &Relighter, direct: &[[f32; 3]], emission: &[[f32; 3]], passes: u32) -> Vec<[f32; 3]> {
    let mut indirect = vec![[0.0; 3]; relighter.len()];
    let mut room = Workspace::default();
    relighter.relight(&Portable, (direct, emission), &mut indirect, passes, &mut room).unwrap();
    // The same once more, in a room that has been used.
    let mut again = indirect.clone();
    relighter.relight(&Portable, (direct, emission), &mut again, passes, &mut room).unwrap();
    assert_eq!(indirect, again);
    indirect
}

#[test]
fn two_levels_need_few_passes_where_plain_ones_need_many() {
    let n = 203;
    let f = form_factors(n, 0.97);
    for rho in [0.3, 0.7, 0.95] {
        let rho = albedo(n, rho);
        let relighter = Relighter::encode(&f, &rho, Rates::Uniform(Kind::F32)).unwrap();
        let two = relighter.clone().with_coarse(&polynomial::Portable, Rates::Uniform(Kind::F32)).unwrap();
        let direct = one_lit(n);
        let exact = truth(&f, &rho, &direct, &[]);
        let plain = distance(&run(&relighter, &direct, &[], 3), &exact, &f.areas);
        let errors = [1, 2, 3, 6].map(|p| distance(&run(&two, &direct, &[], p), &exact, &f.areas));
        assert!(errors[2] < 0.2 * plain && errors[2] < 0.02, "{errors:?} {plain}");
        assert!(errors.windows(2).all(|e| e[1] < e[0]) && errors[3] < 2e-4, "{errors:?}");
        assert!(distance(&run(&two, &direct, &[], 40), &exact, &f.areas) < 2e-6);
    }
}

#[test]
fn closed_and_nearly_white_is_still_right() {
    let n = 96;
    let f = form_factors(n, 1.0);
    let rho = albedo(n, 0.999);
    let two = Relighter::encode(&f, &rho, Rates::Uniform(Kind::F32)).unwrap();
    let two = two.with_coarse(&polynomial::Portable, Rates::Uniform(Kind::F32)).unwrap();
    let direct = one_lit(n);
    let exact = truth(&f, &rho, &direct, &[]);
    assert!(distance(&run(&two, &direct, &[], 3), &exact, &f.areas) < 1e-3);
    assert!(
        distance(&run(&two, &direct, &[], 30), &exact, &f.areas) < 3e-4,
        "sums of rows are f32, and 1 / (1 - rho) is 1000"
    );
}

#[test]
fn black_surfaces_and_emission() {
    let n = 40;
    let f = form_factors(n, 0.9);
    let direct = one_lit(n);
    let mut emission = vec![[0.0; 3]; n];
    emission[7] = [1.0, 0.5, 2.0];
    for rho in [0.0, 0.5] {
        let rho = albedo(n, rho);
        let two = Relighter::encode(&f, &rho, Rates::Uniform(Kind::F32)).unwrap();
        let two = two.with_coarse(&polynomial::Portable, Rates::Uniform(Kind::F32)).unwrap();
        let exact = truth(&f, &rho, &direct, &emission);
        assert!(distance(&run(&two, &direct, &emission, 12), &exact, &f.areas) < 1e-5);
    }
}

#[test]
fn few_bits_keep_the_energy() {
    let n = 256;
    let f = form_factors(n, 1.0);
    let rho = albedo(n, 0.6);
    let relighter = Relighter::encode(&f, &rho, Rates::Uniform(Kind::Bits3)).unwrap();
    let flat = |d: &[f32]| -> f64 {
        let mut relighter = relighter.clone();
        relighter =
            Relighter::new(relighter.tiles().clone(), relighter.areas().to_vec(), d.to_vec(), &rho).unwrap();
        let mut sums = vec![[0.0; 3]; n];
        relighter.bounce(&Portable, &vec![[1.0; 3]; n], &mut sums).unwrap();
        sums.iter().map(|s| f64::from(s[0] - 1.0).abs()).sum::<f64>() / n as f64
    };
    let (with, without) = (flat(relighter.factors()), flat(&vec![1.0; n]));
    assert!(with < 1e-4 && with < 0.1 * without, "{with} {without}");
}

#[test]
fn albedos_can_change_afterwards() {
    let n = 64;
    let f = form_factors(n, 0.95);
    let (a, b) = (albedo(n, 0.2), albedo(n, 0.8));
    let coarse = Rates::Uniform(Kind::F32);
    let make = |rho: &[[f32; 3]]| {
        Relighter::encode(&f, rho, Rates::Uniform(Kind::Bits8))
            .unwrap()
            .with_coarse(&polynomial::Portable, coarse)
            .unwrap()
    };
    let mut changed = make(&a);
    changed.set_albedo(&polynomial::Portable, &b).unwrap();
    assert_eq!(changed, make(&b));
}

#[test]
fn any_number_of_patches_works_and_wrong_numbers_are_refused() {
    for n in [1, 2, 8, 9] {
        let f = form_factors(n, if n == 1 { 0.0 } else { 0.9 });
        let rho = albedo(n, 0.5);
        let two = Relighter::encode(&f, &rho, Rates::Uniform(Kind::F32)).unwrap();
        let two = two.with_coarse(&polynomial::Portable, Rates::Uniform(Kind::F32)).unwrap();
        let direct = one_lit(n);
        let exact = truth(&f, &rho, &direct, &[]);
        let found = run(&two, &direct, &[], 30);
        assert!(
            found.iter().zip(&exact).all(|(x, t)| (0..3).all(|c| (f64::from(x[c]) - t[c]).abs() < 1e-5)),
            "{n}"
        );
        let mut out = vec![[0.0; 3]; n];
        let mut room = Workspace::default();
        let wrong = two.relight(&Portable, (&direct[1..], &[]), &mut out, 3, &mut room);
        assert!(matches!(wrong, Err(RelightError::WrongLength { .. })));
        let nan = vec![[f32::NAN; 3]; n];
        assert!(matches!(
            two.relight(&Portable, (&nan, &[]), &mut out, 3, &mut room),
            Err(RelightError::BadValue { .. })
        ));
        assert!(Relighter::encode(&f, &vec![[1.5; 3]; n], Rates::Uniform(Kind::F32)).is_err());
    }
}

#[test]
fn its_parts_make_it_again() {
    for n in [1, 8, 9, 65, 130] {
        for rates in
            [Rates::Uniform(Kind::Bits8), Rates::Uniform(Kind::F32), Rates::Cheapest { lambda: 1e-5 }]
        {
            let f = form_factors(n, 0.9);
            let made = Relighter::encode(&f, &albedo(n, 0.7), Rates::Cheapest { lambda: 1e-4 }).unwrap();
            let made = made.with_coarse(&polynomial::Portable, rates).unwrap();
            let copy = |t: &Tiles| Tiles::try_new(t.len(), t.kinds().to_vec(), t.payload().to_vec()).unwrap();
            let parts = || {
                let (areas, factors) = (made.areas().to_vec(), made.factors().to_vec());
                Relighter::new(copy(made.tiles()), areas, factors, &made.albedo_list()).unwrap()
            };
            let coarse = made.coarse_parts().unwrap();
            assert_eq!(parts().with_coarse_parts(coarse.clone()).unwrap(), made, "{n} {rates:?}");
            let other = encode(tile_rows(n) + 1, rates, |_, _| 0.0).unwrap();
            let wrong =
                CoarseParts { tiles: [other.clone(), copy(&coarse.tiles[1]), other], ..coarse.clone() };
            assert!(matches!(
                parts().with_coarse_parts(wrong),
                Err(RelightError::WrongLength { slice: "clusters", .. })
            ));
            for wrong in [
                CoarseParts { damping: 0.0, ..coarse.clone() },
                CoarseParts { spread: vec![f32::NAN; n], ..coarse.clone() },
                CoarseParts { spread: vec![0.5; n + 1], ..coarse },
            ] {
                assert!(parts().with_coarse_parts(wrong).is_err());
            }
        }
    }
}

/// Pairs of patches that see little but each other, as the wall behind a picture does, spread over clusters with others.
fn plates(n: usize) -> FormFactors {
    let mut f = form_factors(n, 0.5);
    let pairs = n / 4;
    for k in 0..pairs {
        let (i, j) = (4 * k, 4 * ((k * 7 + 3) % pairs) + 1);
        let (high, low) = (i.max(j), i.min(j));
        let area = f.areas[i].min(f.areas[j]);
        f.half[high * (high + 1) / 2 + low] += 0.48 * area;
    }
    f
}

#[test]
fn surfaces_that_face_each_other_closely_do_not_overshoot() {
    let n = 96;
    let f = plates(n);
    let rho = vec![[0.95, 0.9, 0.0]; n];
    let (direct, exact) = (one_lit(n), truth(&f, &rho, &one_lit(n), &[]));
    let two = Relighter::encode(&f, &rho, Rates::Uniform(Kind::F32)).unwrap();
    let two = two.with_coarse(&polynomial::Portable, Rates::Uniform(Kind::F32)).unwrap();
    let errors = [4, 16, 64].map(|k| distance(&run(&two, &direct, &[], k), &exact, two.areas()));
    assert!(errors[0] > errors[1] && errors[1] > errors[2] && errors[2] < 1e-4, "{errors:?}");
    let mut found = vec![[0.0; 3]; n];
    let passes = two.converge(&Portable, (&direct, &[]), &mut found, (500, 1e-7), &mut Workspace::default());
    assert!(passes.as_ref().is_ok_and(|k| *k < 200), "{passes:?}");
    assert!(distance(&found, &exact, two.areas()) < 1e-5);
}

#[test]
fn weights_tell_what_would_follow() {
    let n = 203;
    let f = form_factors(n, 0.97);
    let rho = albedo(n, 0.9);
    let two = Relighter::encode(&f, &rho, Rates::Uniform(Kind::F32)).unwrap();
    let two = two.with_coarse(&polynomial::Portable, Rates::Uniform(Kind::F32)).unwrap();
    let lit = |patch: usize| {
        let mut direct = vec![[0.0; 3]; n];
        direct[patch] = [1.0, 2.0, 3.0];
        direct
    };
    let narrow = |list: Vec<[f64; 3]>| list.into_iter().map(|x| x.map(|x| x as f32)).collect::<Vec<_>>();
    let lights: Vec<_> = [10, 60, 130, 190].map(lit).to_vec();
    let exact: Vec<_> = lights.iter().map(|l| narrow(truth(&f, &rho, l, &[]))).collect();
    let mut room = Workspace::default();
    let fitted = weights::fit::<RelightError>(two.areas(), &lights, &exact, 3, |light, passes, found| {
        two.relight(&Portable, (light, &[]), found, passes, &mut room)
    });
    let weighted = two.clone().with_weights(fitted.unwrap()).unwrap();
    // Lights that weights have not seen.
    for patch in [33, 88, 160] {
        let exact = truth(&f, &rho, &lit(patch), &[]);
        let [plain, better] =
            [&two, &weighted].map(|r| distance(&run(r, &lit(patch), &[], 3), &exact, two.areas()));
        assert!(better < 0.8 * plain, "{patch}: {better} with weights, {plain} without");
        // Another number of passes has none.
        assert_eq!(run(&two, &lit(patch), &[], 2), run(&weighted, &lit(patch), &[], 2));
    }
    assert!(two.clone().with_weights(vec![f32::NAN]).is_err());
    // Nothing to learn from: passes as they are.
    let none = weights::fit::<RelightError>(two.areas(), &[], &[], 2, |_, _, _| Ok(()));
    assert_eq!(none.unwrap(), [1.0, 1.0]);
}

#[test]
fn what_sees_nothing_stays_dark_and_sends_nothing() {
    let n = 50;
    let mut f = form_factors(n, 0.9);
    let lonely = 20;
    for i in 0..n {
        let (high, low) = (i.max(lonely), i.min(lonely));
        f.half[high * (high + 1) / 2 + low] = 0.0;
    }
    let two = Relighter::encode(&f, &albedo(n, 0.8), Rates::Uniform(Kind::F32)).unwrap();
    let two = two.with_coarse(&polynomial::Portable, Rates::Uniform(Kind::F32)).unwrap();
    let mut direct = vec![[0.0; 3]; n];
    direct[lonely] = [5.0; 3];
    for passes in 0..4 {
        assert!(run(&two, &direct, &[], passes).as_flattened().iter().all(|x| *x == 0.0), "{passes}");
    }
    let found = run(&two, &vec![[1.0; 3]; n], &[], 3);
    assert_eq!(found[lonely], [0.0; 3]);
    assert!(found[lonely + 1][0] > 0.1);
}

#[test]
fn light_between_surfaces_near_each_other_takes_fewer_passes() {
    // Plates face each other, each in a cluster of plates that face the other way from its partner.
    let n = 128;
    let mut f = form_factors(n, 0.2);
    for i in 0..n / 2 {
        let j = i + n / 2;
        f.half[j * (j + 1) / 2 + i] += 0.7 * f.areas[i].min(f.areas[j]);
    }
    let rho = albedo(n, 0.9);
    let made = Relighter::encode(&f, &rho, Rates::Uniform(Kind::F32)).unwrap();
    let two = made.with_coarse(&polynomial::Portable, Rates::Uniform(Kind::F32)).unwrap();
    let without = Relighter { near: near::Near::default(), ..two.clone() };
    let direct = one_lit(n);
    let exact = truth(&f, &rho, &direct, &[]);
    for passes in [2, 3, 5] {
        let [with, without] =
            [&two, &without].map(|r| distance(&run(r, &direct, &[], passes), &exact, &f.areas));
        assert!(with < 0.7 * without, "{passes}: {with} {without}");
    }
    // It changes the way, not the end.
    assert!(distance(&run(&two, &direct, &[], 80), &exact, &f.areas) < 2e-6);
    assert!(two.bytes() > without.bytes());
}
