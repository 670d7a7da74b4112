//! Criterion bench of `emission`: `cargo bench -p etendue-benches --bench emission`.
#![allow(missing_docs, reason = "criterion's macros write undocumented functions")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use etendue_benches::emission::contests;
use etendue_core::direct::emission::{EmissionTable, emission, piece_area};
use etendue_core::math::Vec3;
use std::hint::black_box;
use std::time::Duration;

fn albedo(c: &mut Criterion) {
    for mut contest in contests() {
        let mut group = c.benchmark_group(contest.file);
        group.throughput(Throughput::Elements(contest.items));
        for contender in &mut contest.contenders {
            println!("{}: error {:.2e}", contender.name, contender.error);
            group.bench_function(&contender.name, |b| b.iter(|| (contender.work)()));
        }
        group.finish();
    }
}

fn coefficients(c: &mut Criterion) {
    let corners = [Vec3::new(0.1, 0.2, 0.3), Vec3::new(1.1, 0.3, 0.2), Vec3::new(0.4, 1.2, 0.9)];
    let light = [Vec3::splat(10.0), Vec3::splat(20.0), Vec3::splat(5.0)];
    let mut group = c.benchmark_group("emission_coefficient");
    group.bench_function("piece_area", |b| b.iter(|| piece_area(black_box(corners))));
    group.bench_function("emission", |b| b.iter(|| emission(Vec3::ONE, black_box(0.5), black_box(light))));
    group.throughput(Throughput::Elements(100_000));
    group.bench_function("table and density of 100000 pairs", |b| {
        b.iter(|| {
            let mut table = EmissionTable::new();
            for i in 0..100_000_u32 {
                let e = Vec3::splat((i % 1013 + 1) as f32);
                table.push_pair(i, 0, e, e).expect("a flux");
            }
            table.density().expect("weights")
        });
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(1));
    targets = coefficients, albedo
}
criterion_main!(benches);
