//! Criterion bench of `polynomial`: `cargo bench -p etendue-benches --bench polynomial`.
#![allow(missing_docs, reason = "criterion's macros write undocumented functions")]

use criterion::{Criterion, criterion_group, criterion_main};
use etendue_benches::polynomial::contests;
use std::time::Duration;

fn bench(c: &mut Criterion) {
    for mut contest in contests() {
        let mut group = c.benchmark_group(contest.title);
        for contender in &mut contest.contenders {
            // The definitions in scalar code are there for their bits.
            if !contender.name.contains("scalar reference") {
                group.bench_function(&contender.name, |b| b.iter(&mut contender.work));
            }
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(Duration::from_secs(1)).warm_up_time(Duration::from_millis(200));
    targets = bench
}
criterion_main!(benches);
