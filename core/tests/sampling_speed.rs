//! Prices of the inner loops, in ns per call: `cargo test --release -p etendue-core --test sampling_speed -- --ignored --nocapture`.

use etendue_core::sampling::counter::Counter;
use etendue_core::sampling::discrete::IntegerCdf;
use etendue_core::sampling::sobol::{BlockSampler, Set};
use etendue_core::sampling::warp;
use std::hint::black_box;
use std::time::Instant;

fn price(name: &str, mut f: impl FnMut(u32) -> u32) {
    // Many short runs: on a busy machine the least of them is the price.
    let n = 20_000_u32;
    let mut best = f64::INFINITY;
    for _ in 0..400 {
        let start = Instant::now();
        let mut sum = 0_u32;
        for i in 0..n {
            sum = sum.wrapping_add(f(i));
        }
        black_box(sum);
        best = best.min(start.elapsed().as_secs_f64() * 1e9 / f64::from(n));
    }
    println!("{name:32} {best:6.2} ns");
}

fn fold4(x: [u32; 4]) -> u32 {
    x[0] ^ x[1] ^ x[2] ^ x[3]
}

#[test]
#[ignore = "a measurement: cargo test --release -p etendue-core --test sampling_speed -- --ignored --nocapture"]
fn prices() {
    let g = Counter::new(black_box(7));
    price("Counter::bits4", |i| fold4(g.bits4(3, i, 0)));
    let s = BlockSampler::new(black_box(7), 1, 2, 3);
    price("BlockSampler::new", |i| BlockSampler::new(black_box(7), i, 2, 3).bits2(0)[0]);
    price("with_index + bits2", |i| s.with_index(i).bits2(0)[0]);
    price("with_index + bits4", |i| fold4(s.with_index(i).bits4(1)));
    price("with_index + group4", |i| {
        let u = s.with_index(i).group4(i & 7);
        (u[0] + u[1] + u[2] + u[3]).to_bits()
    });
    price("group4, one index, 8 groups", |i| fold4(s.with_index(i >> 3).bits4(i & 7)));
    let set = Set::new(black_box(9));
    price("Set::dimension", |i| set.dimension(i, 7));
    price("SetPoint, 16 dimensions", |i| {
        let p = set.point(i);
        (0..16).fold(0, |x, d| x ^ p.dimension(d))
    });
    for n in [16_usize, 1024, 1 << 20] {
        let weights: Vec<f32> = (0..n).map(|i| ((i * 7919) % 1009) as f32).collect();
        let start = Instant::now();
        let cdf = IntegerCdf::try_new(&weights).unwrap_or_else(|e| panic!("{e}"));
        println!("IntegerCdf::try_new({n}) {:.3} ms", start.elapsed().as_secs_f64() * 1e3);
        price(&format!("pick of {n}"), |i| cdf.pick(i.wrapping_mul(0x9E37_79B9)).index);
    }
    let u = |i: u32| [(i & 4095) as f32 / 4096.0, (i >> 12 & 4095) as f32 / 4096.0];
    price("sample_sphere", |i| warp::sample_sphere(u(i)).x.to_bits());
    price("sample_cosine_hemisphere", |i| warp::sample_cosine_hemisphere(u(i)).z.to_bits());
    price("sample_triangle", |i| warp::sample_triangle(u(i))[0].to_bits());
    price("sample_cone", |i| warp::sample_cone(u(i), 0.1).x.to_bits());
    price("sample_power_cosine", |i| warp::sample_power_cosine(u(i), 30.0).x.to_bits());
}
