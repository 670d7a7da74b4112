//! Criterion bench of `subdivide`: `cargo bench -p etendue-benches --bench subdivide`.
#![allow(missing_docs, reason = "criterion's macros write undocumented functions")]

use criterion::{Criterion, criterion_group, criterion_main};
use etendue_benches::subdivide::contest;
use etendue_core::direct::subdivide::{Criterion as _, Published, Robust, Samples, Shape};
use etendue_core::math::Vec3;
use std::hint::black_box;

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("subdivide");
    for mut contender in contest().contenders {
        group.bench_function(format!("triangle, {}", contender.name), |b| b.iter(|| (contender.work)()));
    }
    let corners = [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 0.866, 0.0)];
    let samples = Samples::all([1.0, 1.2, 0.9, 1.1, 1.0, 1.15, 1.12]);
    let (published, robust) = (Published::default(), Robust::default());
    group.bench_function("one decision, published", |b| {
        b.iter(|| published.examine(&Shape::new(black_box(corners), 1.0), black_box(&samples), 0.0))
    });
    group.bench_function("one decision, robust", |b| {
        b.iter(|| robust.examine(&Shape::new(black_box(corners), 1.0), black_box(&samples), 0.0))
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_secs(1));
    targets = bench
}
criterion_main!(benches);
