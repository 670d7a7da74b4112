//! Prints what the contests and curves show.

use super::*;
use std::time::Instant;

/// Nanoseconds that this thread has had a processor for: what other programs take is not counted.
fn own_time() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|t| t.parse().ok()).unwrap_or(f64::NAN)
}

#[test]
#[ignore = "prints times: cargo test -p etendue-benches --release --lib polynomial -- --ignored --nocapture of_a_pass"]
fn of_a_pass() {
    let (f, areas) = random_operator(512, 3);
    let half = SymmetricHalf::from_dense(&f, &areas).expect("as many areas as patches");
    let one = linear(1);
    let x = vec![0.5_f32; 512];
    let x3 = vec![[0.5_f32, 0.3, 0.2]; 512];
    let (w, w3) = (vec![0.5_f64; 512], vec![[0.5_f64, 0.3, 0.2]; 512]);
    fn time(name: &str, mut f: impl FnMut()) {
        let mut best = f64::INFINITY;
        for _ in 0..60 {
            let start = Instant::now();
            (0..20).for_each(|_| f());
            best = best.min(start.elapsed().as_secs_f64() * 1e9 / 20.0);
        }
        println!("{name:32} {:8.1} us", best * 1e-3);
    }
    fn all<O: LinearOperator>(name: &str, o: &O, x: &[f32], x3: &[[f32; 3]], w: &[f64], w3: &[[f64; 3]]) {
        let mut y = vec![0.0; x.len()];
        time(&format!("{name}, f32"), || o.apply(x, black_box(&mut y)).expect("lengths agree"));
        let mut y = vec![[0.0; 3]; x.len()];
        time(&format!("{name}, f32 rgb"), || o.apply_rgb(x3, black_box(&mut y)).expect("lengths agree"));
        let mut y = vec![0.0; x.len()];
        time(&format!("{name}, f64"), || o.apply_wide(w, black_box(&mut y)).expect("lengths agree"));
        let mut y = vec![[0.0; 3]; x.len()];
        time(&format!("{name}, f64 rgb"), || o.apply_wide_rgb(w3, black_box(&mut y)).expect("lengths agree"));
    }
    all("dense, portable", &f, &x, &x3, &w, &w3);
    all("dense, AVX2", &one.operator(&f), &x, &x3, &w, &w3);
    all("half, portable", &half, &x, &x3, &w, &w3);
    all("half, AVX2", &one.operator(&half), &x, &x3, &w, &w3);
}

#[test]
#[ignore = "prints times: cargo test -p etendue-benches --release --lib polynomial -- --ignored --nocapture times"]
fn times() {
    for mut contest in contests() {
        println!("{}", contest.title);
        let count = contest.contenders.len();
        let mut found = vec![Vec::new(); count];
        for _ in 0..9 {
            for (c, times) in contest.contenders.iter_mut().zip(&mut found) {
                let (start, own) = (Instant::now(), own_time());
                (c.work)();
                times.push((start.elapsed().as_secs_f64() * 1e3, (own_time() - own) * 1e-6));
            }
        }
        for (c, times) in contest.contenders.iter().zip(&mut found) {
            let wall = times.iter().fold(f64::INFINITY, |m, t| m.min(t.0));
            times.sort_by(|a, b| a.1.total_cmp(&b.1));
            let own = [times[0].1, times[4].1];
            println!("  {:40} wall {wall:8.2} ms, own {own:8.2?} ms, error {:.2e}", c.name, c.error);
        }
    }
}

#[test]
#[ignore = "prints curves: cargo test -p etendue-benches --release --lib polynomial -- --ignored --nocapture error_over_bounces"]
fn error_over_bounces() {
    for curves in curves() {
        println!("{}", curves.title);
        for s in &curves.series {
            let points: Vec<String> = s.points.iter().map(|(x, y)| format!("{x}: {y:.2e}")).collect();
            println!("  {}: {}", s.name, points.join(", "));
        }
    }
}
