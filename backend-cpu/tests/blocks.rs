//! Operators in blocks: the bits of core's own forms, for any number of threads.

#![allow(clippy::disallowed_methods, reason = "errors in f64")]

use etendue_core::radiosity::blocks::{
    self, BlockOperator, Order, Quad, Schedule, Scratch, Sent, Settings, Workspace, block_rows,
};
use etendue_core::radiosity::form_factors::{FormFactors, balance};
use etendue_core::radiosity::polynomial::{self, Multiply, Target, View};
use etendue_cpu::Linear;

/// The inside of a unit cube, m x m patches a side, form factors from middle to middle, set right.
fn cube(m: usize) -> FormFactors {
    let mut patches = Vec::new();
    for side in 0..6 {
        for k in 0..m * m {
            let step = 1.0 / m as f32;
            let (mut position, mut normal) = ([0.0; 3], [0.0; 3]);
            (position[side % 3], normal[side % 3]) = if side < 3 { (0.0, 1.0) } else { (1.0, -1.0) };
            position[(side + 1) % 3] = (0.5 + (k % m) as f32) * step;
            position[(side + 2) % 3] = (0.5 + (k / m) as f32) * step;
            patches.push((step * step * (0.7 + 0.06 * ((k * 7 + side) % 10) as f32), position, normal));
        }
    }
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mut half = Vec::new();
    for (i, (a, p, u)) in patches.iter().enumerate() {
        for (b, q, v) in &patches[..=i] {
            let d: [f32; 3] = [0, 1, 2].map(|k| q[k] - p[k]);
            let (r2, cosines) = (dot(d, d), dot(*u, d).max(0.0) * dot(*v, d).min(0.0).abs());
            half.push(if r2 > 0.0 { a * b * cosines / (std::f32::consts::PI * r2 * r2) } else { 0.0 });
        }
    }
    let n = patches.len();
    let (areas, zeros) = (patches.iter().map(|p| p.0).collect(), vec![0.0; n]);
    let mut made = FormFactors { areas, half, escaped: zeros.clone(), lost: zeros.clone(), stderr: zeros };
    balance(&mut made, &vec![1.0; n], 200);
    made
}

fn albedo(n: usize) -> Vec<[f32; 3]> {
    (0..n).map(|i| [0.7, 0.3 + 0.04 * (i % 10) as f32, 0.2]).collect()
}

fn light(n: usize) -> Vec<[f32; 3]> {
    (0..n).map(|i| if i % 7 == 0 { [3.0, 2.0, 1.0] } else { [0.1, 0.0, 0.2] }).collect()
}

/// Quads and patch by patch.
fn sent(x: &[[f32; 3]]) -> (Vec<Quad>, Vec<[f32; 4]>) {
    let mut quads = vec![Quad::default(); block_rows(x.len())];
    for (i, x) in x.iter().enumerate() {
        (0..3).for_each(|c| quads[i / 4][c][i % 4] = x[c]);
    }
    (quads, x.iter().map(|x| [x[0], x[1], x[2], 0.0]).collect())
}

#[test]
fn encoding_and_running_give_cores_bits() {
    let f = cube(8);
    let n = f.len();
    let rho = albedo(n);
    let many = [1, 2, 3].map(|t| Linear::new(Some(t)).unwrap());
    let half = Settings { half: true, ..Settings::mended() };
    let one_pass = Settings { order: Order::Greedy { passes: 1 }, ..Settings::published(2) };
    for settings in [Settings::published(3), one_pass, Settings::mended(), half, Settings::bounced(3)] {
        let made = many.each_ref().map(|l| BlockOperator::encode(l, &f, &rho, &settings).unwrap());
        assert!(made[1] == made[0] && made[2] == made[0]);
        let (quads, flat) = sent(&light(n));
        let sent = Sent { quads: &quads, flat: &flat };
        let mut y = vec![Quad::default(); block_rows(n)];
        blocks::Portable.product(&made[0], sent, &mut y, &mut Scratch::default());
        for linear in &many {
            let mut z = vec![Quad::default(); block_rows(n)];
            linear.product(&made[0], sent, &mut z, &mut Scratch::default());
            assert!(y == z && block_rows(n) > blocks::STRIPE_ROWS);
        }
        let run = |schedule: &dyn Schedule| {
            let mut indirect = vec![[0.0; 3]; n];
            let mut room = Workspace::default();
            made[0].relight(schedule, (&light(n), &[]), &mut indirect, &mut room).unwrap();
            indirect
        };
        let expected = run(&blocks::Portable);
        assert!(expected.iter().flatten().all(|x| *x > 0.0));
        many.iter().for_each(|linear| assert_eq!(run(linear), expected));
    }
}

#[test]
fn blocks_of_wide_registers_are_cores_blocks() {
    let f = cube(5);
    let n = f.len();
    for settings in [Settings::published(2), Settings::mended(), Settings::bounced(2)] {
        let wide = BlockOperator::encode(&Linear::new(Some(2)).unwrap(), &f, &albedo(n), &settings).unwrap();
        let plain = BlockOperator::encode(&Plain, &f, &albedo(n), &settings).unwrap();
        assert!(wide == plain);
    }
}

/// Core's own forms of everything.
struct Plain;

impl Multiply for Plain {
    fn multiply_add(&self, c: Target<'_, f32>, a: View<'_, f32>, b: View<'_, f32>) {
        polynomial::Portable.multiply_add(c, a, b);
    }
    fn multiply_add_wide(&self, c: Target<'_, f64>, a: View<'_, f64>, b: View<'_, f64>) {
        polynomial::Portable.multiply_add_wide(c, a, b);
    }
}

impl Schedule for Plain {
    fn product(&self, operator: &BlockOperator, sent: Sent<'_>, y: &mut [Quad], scratch: &mut Scratch) {
        blocks::Portable.product(operator, sent, y, scratch);
    }
    fn encode(&self, source: &blocks::Source<'_>, out: &mut [[u8; 8]]) {
        blocks::Portable.encode(source, out);
    }
    fn greedy(&self, codes: &[u8], width: usize, order: &mut [u32]) {
        blocks::Portable.greedy(codes, width, order);
    }
}

/// What operators cost and lose; run it by name, in release, to see (`--ignored --nocapture`).
#[test]
#[ignore = "prints measurements; it asserts nothing that others do not"]
fn measure() {
    use std::time::Instant;
    let side: usize = std::env::var("ETENDUE_BOX_SIDE").ok().and_then(|s| s.parse().ok()).unwrap_or(18);
    let f = cube(side);
    let n = f.len();
    let rho = albedo(n);
    let linear = Linear::new(None).unwrap();
    let one = Linear::new(Some(1)).unwrap();
    // kd order of a cube's patches: by place.
    let list: Vec<_> = (0..n)
        .map(|i| {
            use etendue_core::radiosity::patches::Patch;
            let (s, k) = (i / (side * side), i % (side * side));
            let (mut position, mut normal) = ([0.0; 3], [0.0; 3]);
            (position[s % 3], normal[s % 3]) = if s < 3 { (0.0, 1.0) } else { (1.0, -1.0) };
            position[(s + 1) % 3] = (k % side) as f32 / side as f32;
            position[(s + 2) % 3] = (k / side) as f32 / side as f32;
            Patch { area: 1.0, position, normal, ..Patch::default() }
        })
        .collect();
    let kd = etendue_core::radiosity::order::kd(&list, 8);
    let exact = |bounces| Settings {
        keep: 1.0,
        kept: blocks::Kept::Full,
        matrix: blocks::Matrix::FormFactors { bounces },
        half: true,
        ..Settings::mended()
    };
    let run = |o: &BlockOperator, light: &[[f32; 3]]| {
        let mut e = vec![[0.0; 3]; n];
        o.relight(&linear, (light, &[]), &mut e, &mut Workspace::default()).unwrap();
        e
    };
    let lights: Vec<Vec<[f32; 3]>> = (0..6)
        .map(|k| match k {
            0 => light(n),
            1..=3 => (0..n).map(|i| if i / (side * side) == k { [1.0; 3] } else { [0.0; 3] }).collect(),
            _ => (0..n).map(|i| if i == k * 31 % n { [100.0; 3] } else { [0.0; 3] }).collect(),
        })
        .collect();
    let all = BlockOperator::encode(&linear, &f, &rho, &exact(60)).unwrap();
    let report = |name: &str, settings: &Settings<'_>| {
        let t = Instant::now();
        let o = BlockOperator::encode(&linear, &f, &rho, settings).unwrap();
        let seconds = t.elapsed().as_secs_f64();
        let mut errors = Vec::new();
        for light in &lights {
            let mut truth = run(&all, light);
            let mut found = run(&o, light);
            if o.quantity() == blocks::Quantity::Radiosity {
                for (t, r) in truth.iter_mut().zip(&rho) {
                    (0..3).for_each(|c| t[c] *= r[c]);
                }
            }
            let mut sums = [0.0_f64; 2];
            for ((x, t), a) in found.iter_mut().zip(&truth).zip(&f.areas) {
                for c in 0..3 {
                    sums[0] += f64::from(*a) * f64::from(x[c] - t[c]).powi(2);
                    sums[1] += f64::from(*a) * f64::from(t[c]).powi(2);
                }
            }
            errors.push((sums[0] / sums[1]).sqrt());
        }
        let mut times = Vec::new();
        for l in [&one, &linear] {
            let (mut e, mut room) = (vec![[0.0; 3]; n], Workspace::default());
            let mut best = f64::INFINITY;
            for _ in 0..12 {
                let t = Instant::now();
                o.relight(l, (&lights[0], &[]), &mut e, &mut room).unwrap();
                best = best.min(t.elapsed().as_secs_f64());
            }
            times.push(best * 1e3);
        }
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        let worst = errors.iter().fold(0.0_f64, |m, e| m.max(*e));
        println!(
            "{name:34} {:.3} B/pair  error {:.2} % ({:.2})  encode {seconds:.1} s  run {:.2} / {:.2} ms",
            o.bytes_per_pair(),
            100.0 * rms,
            100.0 * worst,
            times[0],
            times[1]
        );
    };
    println!("n = {n}");
    let given = Order::Given(&kd);
    report("published 3", &Settings::published(3));
    let all_bounces = Settings { matrix: blocks::Matrix::AllBounces, ..Settings::published(1) };
    report("published, all bounces, no order", &Settings { order: Order::Patches, ..all_bounces });
    report(
        "published, all bounces, greedy 1",
        &Settings { order: Order::Greedy { passes: 1 }, ..all_bounces },
    );
    report("published, all bounces, greedy 2", &all_bounces);
    report("published, all bounces, kd", &Settings { order: given, ..all_bounces });
    let mended = Settings { order: given, ..Settings::mended() };
    report("mended", &mended);
    report("mended, greedy 1", &Settings { order: Order::Greedy { passes: 1 }, ..mended });
    report("mended, half", &Settings { half: true, ..mended });
    report("mended, refined", &Settings { bc1: etendue_core::codec::bc1::Quality::Refined, ..mended });
    report("mended, not measured", &Settings { measured: false, ..mended });
    report("mended, 1 %", &Settings { keep: 0.01, ..mended });
    let bounced = Settings { order: given, ..Settings::bounced(12) };
    report("bounced 12", &bounced);
    report("bounced 12, 1 %", &Settings { keep: 0.01, ..bounced });
    report("bounced 40", &Settings { order: given, ..Settings::bounced(40) });
    report(
        "bounced 40, logarithms",
        &Settings { order: given, range: Settings::mended().range, ..Settings::bounced(40) },
    );
    report("bounced 3", &Settings { order: given, ..Settings::bounced(3) });
    let t = Instant::now();
    println!("{:#?}", blocks::published_table(&linear, &f, &rho, 3, 0.04).unwrap());
    println!("table {:.1} s", t.elapsed().as_secs_f64());
}
