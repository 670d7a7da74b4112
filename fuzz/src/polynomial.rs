//! Target `polynomial`.

use etendue_core::radiosity::operator::{Dense, LinearOperator, SymmetricHalf};
use etendue_core::radiosity::polynomial::{
    ConjugateGradients, Doubling, GaussSeidel, Horner, Jacobi, Portable, PowerSum, Settings, SolveError,
    gather, infinite, series, small_apply, small_apply_half, small_series, solve,
};

/// Floats from the bytes, zeros once they are used up: raw bits, or quarters.
struct Floats<'a> {
    bytes: &'a [u8],
    raw: bool,
}

impl Floats<'_> {
    fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.bytes.split_first() else { return 0 };
        self.bytes = rest;
        first
    }
    fn float(&mut self) -> f32 {
        if self.raw {
            f32::from_le_bytes([self.byte(), self.byte(), self.byte(), self.byte()])
        } else {
            f32::from(self.byte() as i8) * 0.25
        }
    }
    fn floats(&mut self, n: usize) -> Vec<f32> {
        (0..n).map(|_| self.float()).collect()
    }
}

/// An operator of a few patches, vectors and albedos. Any bits: errors or values, never NaN from finite input, the same
/// bits for one channel and for three. Rows that sum to less than one: all forms of the sum agree, and a solution
/// leaves no residual.
pub fn polynomial(bytes: &[u8]) {
    let mut input = Floats { bytes, raw: false };
    let mode = input.byte();
    input.raw = mode & 1 == 1;
    let (n, k) = (usize::from(input.byte() % 21), u32::from(input.byte() % 70));
    if mode & 2 == 0 { anything(&mut input, n, k) } else { substochastic(&mut input, n, k) }
}

fn anything(input: &mut Floats<'_>, n: usize, k: u32) {
    let entries = input.floats(n * n);
    let areas = input.floats(n);
    let half = input.floats(n * (n + 1) / 2);
    let x = input.floats(n);
    let albedo: Vec<[f32; 1]> = input.floats(n).iter().map(|x| [*x]).collect();
    let full: [f32; 8] = std::array::from_fn(|i| x.get(i).copied().unwrap_or(0.0));
    let small = n.min(8);
    for y in [
        small_apply(small, &entries, full),
        small_apply_half(small, &areas, &half, full),
        small_series(small, &entries, full, k),
    ] {
        assert!(y.iter().all(|y| !y.is_nan()), "{y:?}");
    }
    let finite = |x: &[f32]| x.iter().all(|x| x.is_finite());
    let dense = Dense::try_new(n, entries.clone());
    assert_eq!(dense.is_ok(), finite(&entries));
    let symmetric = SymmetricHalf::try_new(areas.clone(), half.clone());
    assert_eq!(symmetric.is_ok(), finite(&half) && finite(&areas) && areas.iter().all(|a| *a > 0.0));
    let operators: [Option<&dyn LinearOperator>; 2] =
        [dense.as_ref().ok().map(|o| o as _), symmetric.as_ref().ok().map(|o| o as _)];
    let b: Vec<[f32; 1]> = x.iter().map(|x| [*x]).collect();
    for o in operators.into_iter().flatten() {
        let (mut y, mut y3) = (vec![1.0; n], vec![[1.0; 3]; n]);
        o.apply(&x, &mut y).expect("lengths agree");
        o.apply_rgb(&x.iter().map(|x| [*x, 0.5 * x, *x]).collect::<Vec<_>>(), &mut y3)
            .expect("lengths agree");
        for (y, y3) in y.iter().zip(&y3) {
            assert!(!y.is_nan());
            assert_eq!([y.to_bits(); 2], [y3[0].to_bits(), y3[2].to_bits()]);
        }
        assert!(series(o, &albedo, &b, k).expect("lengths agree").iter().all(|x| !x[0].is_nan()));
        let settings = Settings { max_passes: 60, ..Settings::default() };
        if let Ok(s) = solve(&ConjugateGradients, o, &areas, &albedo, &b, settings) {
            assert!(s.bound[0] >= 0.0);
            residual(o, &albedo, &b, &s.radiosity);
        }
        if let Ok(s) = solve(&Jacobi, o, &areas, &albedo, &b, settings) {
            residual(o, &albedo, &b, &s.radiosity);
        }
    }
    if let Ok(dense) = &dense {
        for sum in [Horner.sum(&Portable, dense, k), Doubling.sum(&Portable, dense, k)].into_iter().flatten()
        {
            assert!(finite(sum.entries()));
        }
        let settings = Settings { max_passes: 60, ..Settings::default() };
        if let Ok(s) = solve(&GaussSeidel, dense, &areas, &albedo, &b, settings) {
            residual(dense, &albedo, &b, &s.radiosity);
        }
        for m in
            [infinite::<f32, _>(&Portable, dense), infinite::<f64, _>(&Portable, dense)].into_iter().flatten()
        {
            assert!(finite(m.entries()));
        }
        let rho: Vec<f32> = albedo.iter().map(|x| x[0]).collect();
        if let Ok(g) = gather::<f64, _>(&Portable, dense, &rho) {
            assert!(finite(g.entries()));
        }
    }
}

/// B0 + R F B - B of a solution that was rounded to f32 is rounding of its terms, if none has overflowed.
fn residual(o: &dyn LinearOperator, albedo: &[[f32; 1]], b0: &[[f32; 1]], b: &[[f32; 1]]) {
    let wide: Vec<f64> = b.iter().map(|b| f64::from(b[0])).collect();
    let magnitudes: Vec<f64> = wide.iter().map(|b| b.abs()).collect();
    let largest = magnitudes.iter().fold(0.0_f64, |m, x| m.max(*x));
    if largest > f64::from(f32::MAX) {
        return;
    }
    let n = b.len();
    let (mut f_b, mut size) = (vec![0.0; n], vec![0.0; n]);
    o.apply_wide(&wide, &mut f_b).expect("lengths agree");
    o.apply_magnitudes(&vec![largest; n], &mut size).expect("lengths agree");
    for i in 0..n {
        let rho = f64::from(albedo[i][0]);
        let left = f64::from(b0[i][0]) + rho * f_b[i] - wide[i];
        // Half an ulp of each B, and the proved error of at most 2^-24 of the largest, through 1 and R F.
        let allowed = 1.2e-7 * (largest + rho * size[i]) + 1e-44;
        assert!(left.abs() <= allowed, "residual {left:e} of patch {i}, allowed {allowed:e}");
    }
}

fn substochastic(input: &mut Floats<'_>, n: usize, k: u32) {
    if n == 0 {
        return;
    }
    // Symmetric weights make reciprocal form factors; what leaves the scene is a weight of its own.
    let mut s = vec![0.0_f64; n * n];
    for i in 0..n {
        for j in 0..=i {
            let x = f64::from(input.byte()) / 16.0;
            (s[i * n + j], s[j * n + i]) = (x, x);
        }
    }
    let areas: Vec<f32> = (0..n)
        .map(|i| s[i * n..][..n].iter().sum::<f64>() + f64::from(input.byte()) + 1.0)
        .map(|a| a as f32)
        .collect();
    let entries: Vec<f32> = (0..n * n).map(|i| (s[i] / f64::from(areas[i / n])) as f32).collect();
    let f = Dense::try_new(n, entries).expect("finite");
    let albedo: Vec<[f32; 1]> = (0..n).map(|_| [f32::from(input.byte()) / 256.0]).collect();
    let b0: Vec<[f32; 1]> = (0..n).map(|_| [f32::from(input.byte())]).collect();
    let rho: Vec<f32> = albedo.iter().map(|x| x[0]).collect();
    let a = f.reflecting(&rho).expect("finite");
    let horner = Horner.sum(&Portable, &a, k).expect("a contraction");
    let doubling = Doubling.sum(&Portable, &a, k).expect("a contraction");
    let passes = series(&f, &albedo, &b0, k).expect("lengths agree");
    let largest = b0.iter().fold(0.0_f64, |m, b| m.max(f64::from(b[0])));
    let of = |m: &Dense, i: usize| -> f64 {
        m.row(i).iter().zip(&b0).map(|(m, b)| f64::from(*m) * f64::from(b[0])).sum()
    };
    // Each bounce brings less than the largest B0, and a rounding of at most n + 4 units of 2^-24 of it, which later
    // bounces carry on.
    let bounces = f64::from(k) + 1.0;
    let allowed = (n as f64 + 4.0) * bounces * bounces * largest / 16_777_216.0;
    for i in 0..n {
        let (h, d, p) = (of(&horner, i), of(&doubling, i), f64::from(passes[i][0]));
        assert!((h - d).abs() <= allowed && (h - p).abs() <= allowed, "{h} {d} {p} at patch {i}, k = {k}");
    }
    let half = SymmetricHalf::from_dense(&f, &areas).expect("finite");
    let by_half = series(&half, &albedo, &b0, k).expect("lengths agree");
    for (x, y) in passes.iter().zip(&by_half) {
        assert!(f64::from(x[0] - y[0]).abs() <= 2.0 * allowed, "{x:?} {y:?}");
    }
    let sure = |e: SolveError| -> ! { panic!("an albedo below 1 and rows of at most 1: {e}") };
    let settings = Settings::default();
    let cg = solve(&ConjugateGradients, &f, &areas, &albedo, &b0, settings).unwrap_or_else(|e| sure(e));
    let jacobi = solve(&Jacobi, &f, &areas, &albedo, &b0, settings).unwrap_or_else(|e| sure(e));
    let seidel = solve(&GaussSeidel, &f, &areas, &albedo, &b0, settings).unwrap_or_else(|e| sure(e));
    residual(&f, &albedo, &b0, &cg.radiosity);
    let whole = infinite::<f64, _>(&Portable, &a).unwrap_or_else(|e| sure(e));
    let size = cg.radiosity.iter().fold(0.0_f64, |m, x| m.max(f64::from(x[0])));
    for i in 0..n {
        let [c, j, s] = [&cg, &jacobi, &seidel].map(|s| f64::from(s.radiosity[i][0]));
        assert!((c - j).abs() <= 2.5e-7 * size && (c - s).abs() <= 2.5e-7 * size, "{c} {j} {s}");
        // R F was rounded to f32: 1 / (1 - albedo) amplifies it, at most 256 times here.
        let m = f64::from(b0[i][0]) + of(&whole, i);
        assert!((c - m).abs() <= 4e-5 * size, "{c} and {m} by elimination");
    }
}
