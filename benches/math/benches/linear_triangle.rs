//! Criterion bench of `linear_triangle`: `cargo bench -p etendue-benches --bench linear_triangle`.
#![allow(missing_docs, reason = "criterion's macros write undocumented functions")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use etendue_benches::linear_triangle::contest;
use std::time::Duration;

fn bench(c: &mut Criterion) {
    let contest = contest();
    let mut group = c.benchmark_group(contest.file);
    group.sample_size(20).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    group.throughput(Throughput::Elements(contest.items));
    for mut contender in contest.contenders {
        group.bench_function(contender.name.as_str(), |b| b.iter(|| (contender.work)()));
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
