//! Criterion bench of `bc1`: `cargo bench -p etendue-benches --bench bc1`. With the argument `table` it prints errors
//! and interleaved times of all contenders instead: `cargo bench -p etendue-benches --bench bc1 -- table`.
#![allow(missing_docs, reason = "criterion's macros write undocumented functions")]

use criterion::{Criterion, Throughput, criterion_group};
use etendue_benches::bc1::{contests, psnr};
use std::time::{Duration, Instant};

fn bench(c: &mut Criterion) {
    for contest in contests() {
        let mut group = c.benchmark_group(contest.file);
        group
            .sample_size(20)
            .measurement_time(Duration::from_secs(1))
            .warm_up_time(Duration::from_millis(300));
        group.throughput(Throughput::Elements(contest.items));
        for mut contender in contest.contenders {
            group.bench_function(contender.name.as_str(), |b| b.iter(|| (contender.work)()));
        }
        group.finish();
    }
}

criterion_group!(benches, bench);

/// The median of the turns of each, all contenders in turn.
fn table() {
    const TURNS: usize = 7;
    for mut contest in contests() {
        let of =
            |name: &str| contest.contenders.iter().find(|c| c.name == name).map_or(f64::NAN, |c| c.error);
        let ours = of("Exhaustive, opaque").max(of("Exhaustive"));
        assert!(
            contest.contenders.iter().all(|c| c.ours || ours < c.error),
            "a rival is better than our slowest"
        );
        println!("{}, {} blocks", contest.title, contest.items);
        let mut times = vec![Vec::new(); contest.contenders.len()];
        for _ in 0..TURNS {
            for (contender, times) in contest.contenders.iter_mut().zip(&mut times) {
                let mut n = 0;
                let start = Instant::now();
                while n == 0 || start.elapsed() < Duration::from_millis(20) {
                    (contender.work)();
                    n += 1;
                }
                times.push(start.elapsed().as_secs_f64() / f64::from(n));
            }
        }
        for (contender, times) in contest.contenders.iter().zip(&mut times) {
            times.sort_by(f64::total_cmp);
            let speed = contest.items as f64 / times[TURNS / 2] / 1e6;
            let (name, error) = (&contender.name, contender.error);
            println!("{name:36} {:8.3} dB  rmse {error:7.4}  {speed:9.4} M blocks/s", psnr(error));
        }
    }
}

fn main() {
    if std::env::args().any(|a| a == "table") {
        table();
    } else {
        benches();
        Criterion::default().configure_from_args().final_summary();
    }
}
