//! Relighting on the device against core's own.

mod adapter;

use adapter::{backend, backend_with, exact_with};
use etendue_core::backend::{Arithmetic, Backend, BackendError};
use etendue_core::codec::bc1::Rule;
use etendue_core::radiosity::blocks::{self, BlockError, BlockOperator, Settings};
use etendue_core::radiosity::form_factors::{FormFactors, balance};
use etendue_core::radiosity::relight::{CoarseParts, Portable, RelightError, Relighter, Workspace};
use etendue_core::radiosity::tiles::{Kind, Rates};
use etendue_core::sampling::counter::Counter;
use etendue_wgpu::{Bc1Texture, BlocksOperator, Mutation, Options, WgpuBackend, wgpu};

/// Patches of random areas that see each other by smooth and by local parts, some of them not at all; sums of rows are `sum`.
fn form_factors(n: usize, sum: f64) -> FormFactors {
    seeing(n, sum, true)
}

fn seeing(n: usize, sum: f64, hidden: bool) -> FormFactors {
    let numbers = Counter::new(5);
    let areas: Vec<f32> = (0..n).map(|i| 0.5 + numbers.unit(0, i as u32, 0)).collect();
    let mut half = Vec::new();
    for i in 0..n {
        for j in 0..=i {
            let near = 1.0 / (1.0 + (i as f32 - j as f32).abs());
            // Whole tiles are empty, others have little in them.
            let apart = hidden && (i / 24 + j / 40).is_multiple_of(3);
            let seen = numbers.unit(1 + i as u32, j as u32, 1) > 0.3 && i != j && (!apart || j / 8 == i / 8);
            let smooth = if hidden && (i / 8 + j / 8).is_multiple_of(5) { 0.001 } else { 0.1 };
            half.push(if seen { areas[i] * areas[j] * (smooth + near * near) } else { 0.0 });
        }
    }
    let zeros = vec![0.0; n];
    let mut made = FormFactors { areas, half, escaped: zeros.clone(), lost: zeros.clone(), stderr: zeros };
    let mean = made.row_sums().iter().sum::<f64>() / n as f64;
    let mean = if mean > 0.0 { mean as f32 } else { 1.0 };
    made.half.iter_mut().for_each(|x| *x /= mean);
    balance(&mut made, &vec![sum; n], 30);
    made
}

/// Pairs that see little but each other: light between them overshoots, and is damped.
fn plates(n: usize) -> FormFactors {
    let mut f = seeing(n, 0.5, false);
    let pairs = n / 4;
    for k in 0..pairs {
        let (i, j) = (4 * k, 4 * ((k * 7 + 3) % pairs) + 1);
        let (high, low) = (i.max(j), i.min(j));
        f.half[high * (high + 1) / 2 + low] += 0.48 * f.areas[i].min(f.areas[j]);
    }
    f
}

fn albedo(n: usize, rho: f32) -> Vec<[f32; 3]> {
    (0..n).map(|i| [rho, rho * (0.5 + 0.5 * ((i * 7 % 10) as f32) / 10.0), 0.4 * rho]).collect()
}

fn lit(n: usize) -> Vec<[f32; 3]> {
    let mut direct: Vec<[f32; 3]> =
        (0..n).map(|i| if i % 5 == 0 { [1.0, 0.75, 0.5] } else { [0.0; 3] }).collect();
    direct[n / 3] = [30.0, 20.0, 10.0];
    direct
}

fn relighter(f: &FormFactors, rho: f32, rates: Rates, coarse: Option<Rates>) -> Relighter {
    let made = Relighter::encode(f, &albedo(f.len(), rho), rates).unwrap();
    match coarse {
        Some(rates) => made.with_coarse(&Portable, rates).unwrap(),
        None => made,
    }
}

/// A backend whose bindings have so many bytes.
fn narrow(bytes: u64) -> Option<WgpuBackend> {
    let limits = wgpu::Limits { max_storage_buffer_binding_size: bytes, ..wgpu::Limits::default() };
    let options = Options { limits: Some(limits), ..Options::default() };
    backend_with(options)
}

/// Bits on a device whose arithmetic is exact, subnormals included; elsewhere 1e-5 of the largest number.
fn agree(backend: &WgpuBackend, found: &[[f32; 3]], truth: &[[f32; 3]], what: &str) {
    let (found, truth) = (found.as_flattened(), truth.as_flattened());
    let largest = truth.iter().fold(0.0_f32, |m, x| m.max(x.abs()));
    let worst = found.iter().zip(truth).fold(0.0_f32, |m, (a, b)| m.max((a - b).abs()));
    let equal = found.iter().zip(truth).filter(|(a, b)| a.to_bits() == b.to_bits()).count();
    println!(
        "{what}: {equal} of {} equal, off by {:e} of the largest",
        found.len(),
        worst / largest.max(1e-30)
    );
    assert!(worst <= 1e-5 * largest, "{what}: {worst} of {largest}");
    let dark = found.len() == 3
        || what.starts_with("Empty")
        || what.starts_with("None") && what.contains(" 0 passes");
    assert!(largest > 0.0 || dark, "{what}: all is dark");
    if backend.arithmetic() == Arithmetic::Ieee {
        assert_eq!(equal, found.len(), "{what}");
    }
}

fn compare(backend: &WgpuBackend, relighter: &Relighter, passes: &[u32], what: &str) {
    let n = relighter.len();
    let (direct, mut emission) = (lit(n), vec![[0.0; 3]; n]);
    emission[n / 2] = [1.0, 2.0, 3.0];
    let operator = backend.operator(relighter).unwrap();
    let mut room = Workspace::default();
    for passes in passes {
        for emission in [&emission[..], &[]] {
            let (mut truth, mut found) = (vec![[0.0; 3]; n], vec![[0.0; 3]; n]);
            relighter.relight(&Portable, (&direct, emission), &mut truth, *passes, &mut room).unwrap();
            operator.relight(relighter, (&direct, emission), &mut found, *passes).unwrap();
            agree(backend, &found, &truth, &format!("{what}, {n} patches, {passes} passes"));
        }
    }
}

#[test]
fn every_kind_of_tile_gives_what_core_gives() {
    let Some(backend) = backend() else { return };
    let n = 1100;
    let f = form_factors(n, 0.97);
    for kind in Kind::ALL {
        let made = relighter(&f, 0.7, Rates::Uniform(kind), None);
        compare(&backend, &made, &[2], &format!("{kind:?}"));
    }
    for lambda in [2e-6, 1e-6, 1e-7, 1e-8] {
        let made = relighter(&f, 0.7, Rates::Cheapest { lambda }, Some(Rates::Cheapest { lambda: 1e-6 }));
        compare(&backend, &made, &[0, 1, 3], &format!("{:?}", made.tiles().census()));
    }
}

#[test]
fn clusters_near_pairs_damping_and_weights_do_what_they_do_in_core() {
    let Some(backend) = backend() else { return };
    for n in [1, 8, 9, 65, 203] {
        let f = form_factors(n, if n == 1 { 0.0 } else { 0.9 });
        for coarse in [None, Some(Rates::Uniform(Kind::F32)), Some(Rates::Uniform(Kind::Bits6))] {
            let made = relighter(&f, 0.8, Rates::Uniform(Kind::Bits8), coarse);
            compare(&backend, &made, &[0, 1, 3, 5], &format!("{coarse:?}"));
        }
    }
    let near = relighter(&plates(96), 0.95, Rates::Uniform(Kind::F32), Some(Rates::Uniform(Kind::F32)));
    assert!(near.view().near.len() > 20);
    compare(&backend, &near, &[1, 4], "near");
    let parts = CoarseParts { damping: 0.7, ..near.coarse_parts().unwrap() };
    let damped = near.with_coarse_parts(parts).unwrap();
    compare(&backend, &damped, &[4, 16], "damped");
    let weighted = damped.with_weights(vec![1.1, 0.8, 1.4]).unwrap();
    compare(&backend, &weighted, &[2, 3], "weighted");
}

#[test]
fn many_columns_are_summed_in_chunks() {
    // More than 256 columns of tiles, and clusters of more than one stripe.
    let f = form_factors(4300, 0.97);
    let made = relighter(&f, 0.7, Rates::Cheapest { lambda: 3e-9 }, Some(Rates::Cheapest { lambda: 1e-6 }));
    let Some(backend) = backend() else { return };
    compare(&backend, &made, &[3], &format!("{:?}", made.tiles().census()));
}

/// Takes a minute: times beside those of one thread.
#[test]
#[ignore = "slow"]
fn eight_thousand_patches() {
    let Some(backend) = backend() else { return };
    let f = form_factors(8192, 0.97);
    let made = relighter(&f, 0.7, Rates::Cheapest { lambda: 1e-9 }, Some(Rates::Cheapest { lambda: 1e-8 }));
    println!("{:?}, {} bytes, {} near", made.tiles().census(), made.bytes(), made.view().near.len());
    let start = std::time::Instant::now();
    let operator = backend.operator(&made).unwrap();
    println!("prepared in {:?}", start.elapsed());
    let (direct, mut room) = (lit(8192), Workspace::default());
    let (mut truth, mut found) = (vec![[0.0; 3]; 8192], vec![[0.0; 3]; 8192]);
    for _ in 0..3 {
        let start = std::time::Instant::now();
        made.relight(&Portable, (&direct, &[]), &mut truth, 3, &mut room).unwrap();
        let core = start.elapsed();
        let start = std::time::Instant::now();
        operator.relight(&made, (&direct, &[]), &mut found, 3).unwrap();
        println!("core {core:?}, device {:?}", start.elapsed());
        agree(&backend, &found, &truth, "8192 patches");
    }
}

/// What a backend with a fault in its shaders gives.
fn mutated(from: Mutation) -> Option<WgpuBackend> {
    exact_with(Options { mutations: vec![from], ..Options::default() })
}

#[test]
fn other_orders_of_sums_are_noticed() {
    let n = 700;
    let f = form_factors(n, 0.9);
    let (direct, mut truth, mut found) = (lit(n), vec![[0.0; 3]; n], vec![[0.0; 3]; n]);
    let light = (&direct[..], &[][..]);
    let made = relighter(&f, 0.7, Rates::Cheapest { lambda: 1e-8 }, Some(Rates::Cheapest { lambda: 1e-6 }));
    made.relight(&Portable, light, &mut truth, 3, &mut Workspace::default()).unwrap();
    for (module, from, to) in [
        ("relight::product", "((s0 + s4) + (s2 + s6))", "((s0 + s2) + (s4 + s6))"),
        ("relight::product", "const TILES_STRIPE: u32 = 64u", "const TILES_STRIPE: u32 = 32u"),
        ("relight::product", "head.unit * (even + odd)", "head.unit * even + head.unit * odd"),
        (
            "relight::product",
            "tiles_entry(head, r, k) * (head.unit * x)",
            "(tiles_entry(head, r, k) * head.unit) * x",
        ),
        ("relight::passes", "pass_share(row, k) * x[k]", "pass_share(row, 7u - k) * x[7u - k]"),
        ("radiosity::tiles", "scale * (1.0f / 225.0f)", "scale / 225.0f"),
    ] {
        let Some(backend) = mutated(Mutation { module, from, to }) else { return };
        let operator = backend.operator(&made).unwrap();
        operator.relight(&made, light, &mut found, 3).unwrap();
        assert_ne!(found, truth, "{from}");
    }
    let made = BlockOperator::encode(&Portable, &f, &albedo(n, 0.6), &Settings::bounced(3)).unwrap();
    made.relight(&Portable, light, &mut truth, &mut blocks::Workspace::default()).unwrap();
    for (from, to) in [
        ("(blocks_lanes[s] + blocks_lanes[s + 2u])", "(blocks_lanes[s] + blocks_lanes[s + 1u])"),
        ("sum + ((x0 + x1) + (x2 + x3))", "sum + ((x0 + x2) + (x1 + x3))"),
        ("const BLOCKS_STRIPE: u32 = 64u", "const BLOCKS_STRIPE: u32 = 32u"),
        ("blocks_starts[kept_row] + (e & 1u); i < end; i += 2u", "blocks_starts[kept_row]; i < end; i += 1u"),
        ("* blocks_part.unit;", "* (1.01 * blocks_part.unit);"),
    ] {
        let Some(backend) = mutated(Mutation { module: "relight::blocks", from, to }) else { return };
        let operator = backend.blocks_operator(&made).unwrap();
        operator.relight(&made, light, &mut found).unwrap();
        assert_ne!(found, truth, "{from}");
    }
}

#[test]
fn convergence_takes_as_many_passes() {
    let Some(backend) = backend() else { return };
    let made = relighter(&plates(96), 0.95, Rates::Uniform(Kind::F32), Some(Rates::Uniform(Kind::F32)));
    let (direct, operator) = (lit(96), backend.operator(&made).unwrap());
    for until in [(500, 1e-6), (5, 1e-9), (0, 0.1), (3, 0.0)] {
        let (mut truth, mut found) = (vec![[0.0; 3]; 96], vec![[0.0; 3]; 96]);
        let mut room = Workspace::default();
        let passes = made.converge(&Portable, (&direct, &[]), &mut truth, until, &mut room).unwrap();
        assert_eq!(operator.converge(&made, (&direct, &[]), &mut found, until).unwrap(), passes);
        agree(&backend, &found, &truth, &format!("{until:?}: {passes} passes"));
    }
}

#[test]
fn what_exceeds_a_binding_comes_in_parts() {
    let f = form_factors(1500, 0.97);
    let coarse = Some(Rates::Uniform(Kind::F32));
    let made = relighter(&f, 0.7, Rates::Uniform(Kind::Bits8), coarse);
    let Some(backend) = narrow(600_000) else { return };
    let operator = backend.operator(&made).unwrap();
    assert!(operator.parts() > 1, "{}", operator.parts());
    compare(&backend, &made, &[3], &format!("{} parts", operator.parts()));
    let Some(cramped) = narrow(200_000) else { return };
    let refused = cramped.operator(&made);
    assert!(matches!(refused, Err(BackendError::LimitExceeded { allowed: 200_000, .. })), "{refused:?}");
}

#[test]
fn operators_stay_until_they_change_and_wrong_numbers_are_refused() {
    let Some(backend) = backend() else { return };
    let f = form_factors(64, 0.9);
    let mut made = relighter(&f, 0.5, Rates::Uniform(Kind::Bits8), Some(Rates::Uniform(Kind::F32)));
    let operator = backend.operator(&made).unwrap();
    assert!(std::sync::Arc::ptr_eq(&operator, &backend.operator(&made.clone()).unwrap()));
    let mut found = vec![[0.0; 3]; 64];
    let short = operator.relight(&made, (&lit(64)[1..], &[]), &mut found, 3);
    assert!(matches!(short, Err(RelightError::WrongLength { .. })));
    let bad = operator.relight(&made, (&vec![[f32::NAN; 3]; 64], &[]), &mut found, 3);
    assert!(matches!(bad, Err(RelightError::BadValue { .. })));
    made.set_albedo(&Portable, &albedo(64, 0.8)).unwrap();
    assert!(operator.relight(&made, (&lit(64), &[]), &mut found, 3).is_err());
    compare(&backend, &made, &[3], "another albedo");
}

#[test]
fn a_lost_device_is_told_and_replaced() {
    let Some(backend) = backend() else { return };
    let f = form_factors(64, 0.9);
    let made = relighter(&f, 0.5, Rates::Uniform(Kind::Bits8), Some(Rates::Uniform(Kind::F32)));
    let operator = backend.operator(&made).unwrap();
    backend.lose_device();
    let found = operator.relight(&made, (&lit(64), &[]), &mut vec![[0.0; 3]; 64], 3);
    assert!(matches!(found, Err(RelightError::Backend(BackendError::DeviceLost { .. }))), "{found:?}");
    let fresh = relighter(&f, 0.6, Rates::Uniform(Kind::Bits8), None);
    compare(&backend, &fresh, &[3], "a fresh device");
    compare(&backend, &made, &[3], "the operator from before");
}

fn compare_blocks(backend: &WgpuBackend, made: &BlockOperator, what: &str) {
    compare_blocks_with(backend, &backend.blocks_operator(made).unwrap(), made, what);
}

fn compare_blocks_with(backend: &WgpuBackend, operator: &BlocksOperator, made: &BlockOperator, what: &str) {
    let n = made.len();
    let (direct, mut emission) = (lit(n), vec![[0.0; 3]; n]);
    emission[n / 2] = [1.0, 2.0, 3.0];
    let mut room = blocks::Workspace::default();
    for emission in [&emission[..], &[]] {
        let (mut truth, mut found) = (vec![[0.0; 3]; n], vec![[0.0; 3]; n]);
        made.relight(&Portable, (&direct, emission), &mut truth, &mut room).unwrap();
        operator.relight(made, (&direct, emission), &mut found).unwrap();
        agree(backend, &found, &truth, &format!("{what}, {n} patches, {} parts", operator.parts()));
    }
}

#[test]
fn every_sort_of_blocks_gives_what_core_gives() {
    let Some(backend) = backend() else { return };
    for n in [1, 5, 203, 600] {
        let f = form_factors(n, if n == 1 { 0.0 } else { 0.9 });
        for (what, settings) in [
            ("published", Settings::published(3)),
            ("mended", Settings::mended()),
            ("mended, half", Settings { half: true, ..Settings::mended() }),
            ("bounced", Settings::bounced(4)),
            ("bounced, whole", Settings { half: false, ..Settings::bounced(2) }),
            ("published, half", Settings { half: true, kept: blocks::Kept::Full, ..Settings::mended() }),
            ("bounced, full", Settings { kept: blocks::Kept::Full, ..Settings::bounced(2) }),
        ] {
            let made = BlockOperator::encode(&Portable, &f, &albedo(n, 0.6), &settings).unwrap();
            compare_blocks(&backend, &made, what);
        }
    }
}

#[test]
fn blocks_that_exceed_a_binding_come_in_parts() {
    let n = 1100;
    let f = form_factors(n, 0.9);
    let Some(backend) = narrow(300_000) else { return };
    for settings in [Settings::published(1), Settings::bounced(3)] {
        let made = BlockOperator::encode(&Portable, &f, &albedo(n, 0.6), &settings).unwrap();
        assert!(backend.blocks_operator(&made).unwrap().parts() > 1);
        compare_blocks(&backend, &made, "narrow");
        let Some(cramped) = narrow(20_000) else { return };
        let refused = cramped.blocks_operator(&made).map(|_| ());
        assert!(matches!(refused, Err(BackendError::LimitExceeded { .. })), "{refused:?}");
    }
}

/// The same operator with endpoints alone, which every decoder of BC1 has alike.
fn endpoints_alone(made: &BlockOperator) -> BlockOperator {
    let mut parts = made.parts().clone();
    for block in &mut parts.blocks {
        // The high bit of an index chooses what lies between.
        block[4..].iter_mut().for_each(|byte| *byte &= 0x55);
    }
    BlockOperator::from_parts(parts).unwrap()
}

#[test]
fn textures_of_blocks_give_what_the_shader_decodes() {
    let Some(backend) = backend() else { return };
    let texture = backend.bc1_texture().unwrap();
    if let Bc1Texture::Wrong | Bc1Texture::Missing = texture {
        eprintln!("SKIPPED: {} has no textures of BC1 ({texture:?})", backend.info().adapter);
        return;
    }
    for n in [5, 203, 600] {
        let f = form_factors(n, 0.9);
        for settings in [Settings::published(3), Settings { half: true, ..Settings::mended() }] {
            let made = BlockOperator::encode(&Portable, &f, &albedo(n, 0.6), &settings).unwrap();
            let plain = endpoints_alone(&made);
            let operator = backend.texture_operator(&plain).unwrap();
            compare_blocks_with(&backend, &operator, &plain, "endpoints of textures");
            if texture == Bc1Texture::Rule(Rule::Nearest) {
                compare_blocks(&backend, &made, "textures");
            }
        }
    }
    let f = form_factors(40, 0.9);
    let one = BlockOperator::encode(&Portable, &f, &albedo(40, 0.6), &Settings::bounced(2)).unwrap();
    assert!(matches!(backend.texture_operator(&one), Err(BackendError::Unsupported { .. })));
}

/// Times of both decoders side by side.
#[test]
#[ignore = "a measurement"]
fn textures_of_blocks_take_as_long() {
    let Some(backend) = backend() else { return };
    let n = 4096;
    let made = BlockOperator::encode(
        &Portable,
        &form_factors(n, 0.97),
        &albedo(n, 0.6),
        &Settings { order: blocks::Order::Patches, ..Settings::published(2) },
    );
    let made = endpoints_alone(&made.unwrap());
    let (direct, mut found) = (lit(n), vec![[0.0; 3]; n]);
    let operators =
        [Ok(backend.blocks_operator(&made).unwrap()), Err(backend.texture_operator(&made).unwrap())];
    for _ in 0..3 {
        for operator in &operators {
            let (what, operator) = match operator {
                Ok(shader) => ("shader", &**shader),
                Err(texture) => ("texture", texture),
            };
            let start = std::time::Instant::now();
            operator.relight(&made, (&direct, &[]), &mut found).unwrap();
            println!("{what}: {:?}", start.elapsed());
        }
    }
}

#[test]
fn sessions_relight_on_the_device_and_on_the_next_one() {
    let Some(backend) = backend() else { return };
    let scenes = etendue_conformance::golden::scenes();
    let scenes = scenes.iter().filter_map(|s| etendue_conformance::analytic::compiled(&s.scene).ok());
    let scene = scenes.into_iter().find(|s| !s.needs.volume()).unwrap();
    let session = backend.open(scene).unwrap();
    let n = 203;
    let f = form_factors(n, 0.9);
    let made = relighter(&f, 0.7, Rates::Uniform(Kind::Bits8), Some(Rates::Uniform(Kind::F32)));
    let blocks = BlockOperator::encode(&Portable, &f, &albedo(n, 0.6), &Settings::mended()).unwrap();
    let (direct, mut room, mut rooms) = (lit(n), Workspace::default(), blocks::Workspace::default());
    let light = (&direct[..], &[][..]);
    let (mut found, mut truth) = (vec![[0.0; 3]; n], vec![[0.0; 3]; n]);
    for what in ["a device", "the next"] {
        session.relight(&made, light, &mut found, 3, &mut room).unwrap();
        made.relight(&Portable, light, &mut truth, 3, &mut room).unwrap();
        agree(&backend, &found, &truth, what);
        let passes = session.converge(&made, light, &mut found, (50, 1e-4), &mut room).unwrap();
        assert_eq!(made.converge(&Portable, light, &mut truth, (50, 1e-4), &mut room).unwrap(), passes);
        agree(&backend, &found, &truth, what);
        session.relight_blocks(&blocks, light, &mut found, &mut rooms).unwrap();
        blocks.relight(&Portable, light, &mut truth, &mut rooms).unwrap();
        agree(&backend, &found, &truth, what);
        backend.lose_device();
    }
}

#[test]
fn blocks_refuse_what_core_refuses() {
    let Some(backend) = backend() else { return };
    let f = form_factors(40, 0.9);
    let mut made = BlockOperator::encode(&Portable, &f, &albedo(40, 0.6), &Settings::bounced(3)).unwrap();
    let operator = backend.blocks_operator(&made).unwrap();
    let mut found = vec![[0.0; 3]; 40];
    let short = operator.relight(&made, (&lit(40)[1..], &[]), &mut found);
    assert!(matches!(short, Err(BlockError::WrongLength { .. })));
    made.set_albedo(&albedo(40, 0.3)).unwrap();
    assert!(operator.relight(&made, (&lit(40), &[]), &mut found).is_err());
    compare_blocks(&backend, &made, "another albedo");
}
