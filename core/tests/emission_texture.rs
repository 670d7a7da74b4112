//! Albedo of pieces over a bitmap: scans, edges, bounds and rules against chords in f64.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]
#![allow(clippy::needless_range_loop, reason = "vertices and channels go by index")]

#[path = "emission_support.rs"]
mod support;

use etendue_core::direct::emission::{
    Bitmap, BitmapError, Exact, MAX_SIDE, PieceAlbedo, Published, Pyramid, RowSums, Texels, VertexAlbedo,
    brightest_in, overlap_unit, sample_points, scan, scan_texels,
};
use etendue_core::math::Vec3;
use etendue_core::sampling::counter::Counter;
use etendue_core::scene::{TextureRecord, sample_bitmap};
use support::{Image, piece};

const ALL: f32 = 1e9;

fn error(got: &VertexAlbedo, truth: [[f64; 3]; 3]) -> f64 {
    let mut worst = 0.0_f64;
    for k in 0..3 {
        for c in 0..3 {
            let e = (f64::from(got.at[k][c]) - truth[k][c]).abs();
            worst = if e.is_nan() { f64::INFINITY } else { worst.max(e) };
        }
    }
    worst
}

fn images() -> Vec<Image> {
    vec![
        Image::noise(1, 1, 1),
        Image::noise(2, 2, 2),
        Image::noise(7, 3, 3),
        Image::noise(33, 50, 4),
        Image::noise(64, 64, 5),
        // One bright texel in the dark, and stripes.
        Image::new(16, 16, |x, y| if (x, y) == (3, 11) { 0xff_ffff } else { 0 }),
        Image::new(12, 5, |x, _| if x % 2 == 0 { 0xff00ff } else { 0x00ff00 }),
    ]
}

#[test]
fn scans_are_the_integrals() {
    let g = Counter::new(41);
    let mut worst = [0.0_f64; 2];
    for (i, image) in images().iter().enumerate() {
        for n in 0..60_u32 {
            let size = [0.01, 0.7, 3.0, 11.0, 40.0][(n % 5) as usize];
            let uv = piece(&g, n + 1000 * i as u32, image, size);
            for (filtered, worst) in [true, false].into_iter().zip(&mut worst) {
                let truth = image.truth(uv, filtered);
                let bitmap = image.bitmap();
                let got = if filtered { scan(&bitmap, uv, ALL) } else { scan_texels(&bitmap, uv, ALL) };
                let err = error(&got.unwrap(), truth);
                assert!(err <= 2.0_f64.powi(-20), "image {i} piece {n} {uv:?} {filtered}: {err}");
                *worst = worst.max(err);
            }
        }
    }
    println!("scan: worst {:.2e}, of constant texels: {:.2e}", worst[0], worst[1]);
}

/// Longest edge over least height of a piece over the texels.
fn thinness(uv: [[f32; 2]; 3], image: &Image) -> f64 {
    let size = image.bitmap().size().map(f64::from);
    let p = uv.map(|p| [0, 1].map(|k| f64::from(p[k]) * size[k]));
    let edge = |i: usize, j: usize| [0, 1].map(|k| p[j][k] - p[i][k]);
    let (e, f, g) = (edge(0, 1), edge(0, 2), edge(1, 2));
    let longest = [e, f, g].iter().map(|d| d[0] * d[0] + d[1] * d[1]).fold(0.0, f64::max);
    longest / (e[0] * f[1] - e[1] * f[0]).abs()
}

/// A sliver of hundreds of texels' length is as wide as the rounding of its ends makes it: the stated second term.
#[test]
fn slivers_are_known_to_the_rounding_of_their_coordinates() {
    let g = Counter::new(47);
    let (mut most, mut used) = (0.0_f64, 0);
    for (i, image) in images().iter().enumerate().skip(1) {
        for n in 0..20_u32 {
            let r = |k: u32| g.unit(i as u32, n, k);
            let (length, width) = (3.0 + 20.0 * r(0), 0.02 + 0.4 * r(1));
            let turn = |x: f32, y: f32| [0.3 + 0.8 * x - 0.6 * y, 0.2 + 0.6 * x + 0.8 * y];
            let uv = [turn(0.0, 0.0), turn(length, 0.0), turn(r(2) * length, width)];
            let Some(got) = scan(&image.bitmap(), uv, ALL) else { continue };
            let bound = 2.0_f64.powi(-20) + 2.0_f64.powi(-20) * thinness(uv, image);
            let err = error(&got, image.truth(uv, true));
            assert!(err <= bound, "image {i} {uv:?}: {err:e}, bound {bound:e}");
            most = most.max(err / bound);
            used += 1;
        }
    }
    println!("slivers: worst {most:.2} of the bound, {used} pieces");
    assert!(used > 100);
}

#[test]
fn edges_give_the_integral_too() {
    let g = Counter::new(42);
    let (mut worst, mut taken) = (0.0_f64, 0);
    for (i, image) in images().iter().enumerate() {
        let sums = RowSums::new(&image.bitmap());
        for n in 0..40_u32 {
            let size = [9.0, 25.0, 60.0][(n % 3) as usize];
            let mut uv = piece(&g, n + 1000 * i as u32, image, size);
            if n % 5 == 4 {
                // Vertices on texel centres and corners, edges along lines.
                let grid = |u: f32, n: u32| {
                    ((f64::from(u) * 2.0 * f64::from(n)).round() / (2.0 * f64::from(n))) as f32
                };
                uv = uv.map(|p| [grid(p[0], image.record.width), grid(p[1], image.record.height)]);
                uv[1][1] = uv[0][1];
            }
            let Some(got) = sums.vertex_albedo(&image.bitmap(), uv, ALL) else { continue };
            taken += 1;
            let err = error(&got, image.truth(uv, true));
            assert!(err <= 6.1e-8, "image {i} piece {n} {uv:?}: {err}");
            worst = worst.max(err);
        }
    }
    assert!(taken >= 100, "{taken}");
    println!("edges: worst {worst:.2e} over {taken} pieces");
}

#[test]
#[ignore = "half a minute: cargo test --release -p etendue-core --test emission_texture -- --ignored large_pieces"]
fn large_pieces_too() {
    let g = Counter::new(43);
    let image = Image::noise(500, 300, 9);
    let sums = RowSums::new(&image.bitmap());
    let mut worst = [0.0_f64; 2];
    for n in 0..30 {
        let uv = piece(&g, n, &image, 1500.0);
        let truth = image.truth(uv, true);
        let by_cells = scan(&image.bitmap(), uv, ALL).unwrap();
        worst[0] = worst[0].max(error(&by_cells, truth));
        if let Some(by_edges) = sums.vertex_albedo(&image.bitmap(), uv, ALL) {
            worst[1] = worst[1].max(error(&by_edges, truth));
        }
    }
    println!("pieces of up to 10^6 texels: by cells {:.2e}, by edges {:.2e}", worst[0], worst[1]);
    assert!(worst[0] <= 1e-5 && worst[1] <= 6.1e-8, "{worst:?}");
}

#[test]
fn far_away_pieces_are_found_to_the_accuracy_of_their_coordinates() {
    // On a bitmap with sides that are powers of two, coordinates moved by periods are as exact as they are floats.
    let g = Counter::new(44);
    let image = Image::noise(64, 32, 6);
    for n in 0..50 {
        let uv = piece(&g, n, &image, 4.0).map(|p| p.map(|x| (x * 4096.0).round() / 4096.0));
        let near = scan(&image.bitmap(), uv, ALL).unwrap();
        let truth = near.at.map(|a| a.to_array().map(f64::from));
        for moved in [1.0, -3.0, 100.0, -1000.0_f32] {
            let far = uv.map(|p| [p[0] + moved, p[1] - moved]);
            let err = error(&scan(&image.bitmap(), far, ALL).unwrap(), truth);
            assert!(err <= 2.0_f64.powi(-19), "moved by {moved}: {err}");
        }
        // Sides that are no powers of two: the product with the side is kept in two parts.
        let odd = Image::noise(61, 37, 7);
        let far = uv.map(|p| [p[0] + 100.0, p[1] + 100.0]);
        let err = error(&scan(&odd.bitmap(), far, ALL).unwrap(), odd.truth(far, true));
        assert!(err <= 2.0_f64.powi(-19), "{err}");
    }
}

#[test]
fn pieces_squeezed_to_lines_and_points_are_means_along_them() {
    let image = Image::noise(16, 8, 8);
    let bitmap = image.bitmap();
    let cases: [[[f32; 2]; 3]; 6] = [
        [[0.3, 0.4]; 3],
        [[0.5, 0.5]; 3],
        [[0.1, 0.2], [0.6, 0.2], [0.3, 0.2]],
        [[0.1, 0.2], [0.1, 0.9], [0.1, 0.2]],
        [[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]],
        [[-0.35, 0.3], [0.95, 0.3], [-0.35, 0.3]],
    ];
    for uv in cases {
        for filtered in [true, false] {
            if !filtered && uv[0] == [0.5, 0.5] && uv[1] == uv[0] {
                // On a corner of four texels: any of them.
                continue;
            }
            let got = if filtered { scan(&bitmap, uv, ALL) } else { scan_texels(&bitmap, uv, ALL) };
            // Texel edges make the midpoint rule one of first order.
            let (n, limit) = if filtered { (512, 2e-5) } else { (512, 4e-3) };
            let err = error(&got.unwrap(), image.midpoints(uv, filtered, n));
            assert!(err <= limit, "{uv:?} {filtered}: {err}");
        }
    }
    // A point is a sample, to the rounding of coordinates.
    let got = scan(&bitmap, [[0.3, 0.4]; 3], ALL).unwrap();
    let sample = sample_bitmap(&image.record, &image.texels, &image.decode, [0.3, 0.4]);
    for at in got.at {
        assert!((at - sample).abs().max_element() <= 4e-6, "{at} for {sample}");
    }
}

#[test]
fn no_sample_is_brighter_than_the_bound() {
    let g = Counter::new(45);
    for (i, image) in images().iter().enumerate() {
        let pyramid = Pyramid::new(&image.bitmap());
        for n in 0..100_u32 {
            let size = [0.0, 0.3, 2.0, 9.0, 100.0][(n % 5) as usize];
            let mut uv = piece(&g, n + 1000 * i as u32, image, size);
            if n % 7 == 0 {
                let far = [1e3, -1e5, 3e7, 1e20_f32][(n / 7 % 4) as usize];
                uv = uv.map(|p| [p[0] + far, p[1] - far]);
            }
            let bound = brightest_in(&image.bitmap(), uv);
            let cheap = pyramid.brightest(uv);
            assert!(cheap.cmpge(bound).all(), "image {i} {uv:?}: {cheap} below {bound}");
            for s in 0..200 {
                let (a, b) = (g.unit(6, n, 2 * s), g.unit(6, n, 2 * s + 1));
                let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
                let c = 1.0 - a - b;
                let at = [0, 1].map(|k| c * uv[0][k] + a * uv[1][k] + b * uv[2][k]);
                let sample = sample_bitmap(&image.record, &image.texels, &image.decode, at);
                assert!(sample.cmple(bound).all(), "image {i} {uv:?} at {at:?}: {sample} above {bound}");
            }
            let mean = scan(&image.bitmap(), uv, 1e5);
            for at in mean.iter().flat_map(|m| m.at) {
                assert!(at.cmple(bound).all(), "image {i} {uv:?}: {at} above {bound}");
            }
        }
    }
}

#[test]
fn bounds_are_tight_where_they_can_be() {
    // A piece within one texel's cell of a dark corner does not see the bright texel across the bitmap.
    let image = Image::new(64, 64, |x, y| if (x, y) == (40, 40) { 0xff_ffff } else { 0x01_0101 });
    let dark = [[0.1, 0.9], [0.12, 0.9], [0.1, 0.88]];
    let pyramid = Pyramid::new(&image.bitmap());
    assert!(brightest_in(&image.bitmap(), dark).max_element() < 0.001);
    assert!(pyramid.brightest(dark).max_element() < 0.001);
    assert_eq!(pyramid.brightest_texel(), Vec3::ONE);
    assert!(pyramid.brightest([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).min_element() >= 1.0);
}

#[test]
fn coarse_levels_keep_the_mean_and_converge() {
    let g = Counter::new(46);
    for image in images() {
        let pyramid = Pyramid::new(&image.bitmap());
        let sums = RowSums::new(&image.bitmap());
        // The last level is the mean of all texels, and the rows agree.
        let whole = pyramid.coarse([[0.0, 0.0], [1e9, 0.0], [0.0, 1e9]], 32.0);
        let mut mean = [0.0_f64; 3];
        for code in &image.texels {
            for (m, s) in mean.iter_mut().zip([0, 8, 16]) {
                *m += f64::from(image.decode[(code >> s & 255) as usize]) / image.texels.len() as f64;
            }
        }
        for c in 0..3 {
            assert!((f64::from(whole.at[0][c]) - mean[c]).abs() <= 3e-7, "{whole:?} for {mean:?}");
            assert!((f64::from(sums.mean()[c]) - mean[c]).abs() <= 6e-8);
        }
    }
    // Smooth noise over a large piece: more texels, less error.
    let image = Image::new(256, 256, |x, y| {
        let (a, b) = (f64::from(x) * 0.0245437, f64::from(y) * 0.0490874);
        let v = (127.0 + 60.0 * a.sin() + 60.0 * (b + a).cos()) as u32;
        v | (v / 2) << 8 | (255 - v) << 16
    });
    let pyramid = Pyramid::new(&image.bitmap());
    let mut last = f64::INFINITY;
    for texels in [40.0, 160.0, 640.0, 2560.0] {
        let mut sum = 0.0;
        for n in 0..20 {
            let uv = piece(&g, n, &image, 300.0);
            let exact = scan(&image.bitmap(), uv, ALL).unwrap();
            sum += error(&pyramid.coarse(uv, texels), exact.at.map(|a| a.to_array().map(f64::from))) / 20.0;
        }
        println!("coarse with {texels} texels: mean error {sum:.2e}");
        assert!(sum <= 0.75 * last, "{texels}: {sum} after {last}");
        last = sum;
    }
}

#[test]
fn rules_choose_and_agree() {
    let g = Counter::new(47);
    let image = Image::noise(64, 48, 10);
    let exact = Exact::new(image.bitmap());
    let published = Published::new(image.bitmap(), 64.0);
    for n in 0..100 {
        let uv = piece(&g, n, &image, [0.5, 5.0, 30.0, 90.0][(n % 4) as usize]);
        let got = exact.vertex_albedo(uv);
        let truth = scan(&image.bitmap(), uv, ALL).unwrap();
        let err = error(&got, truth.at.map(|a| a.to_array().map(f64::from)));
        assert!(err <= 2.0_f64.powi(-19), "{uv:?}: {err}");
        let source = published.vertex_albedo(uv);
        match scan_texels(&image.bitmap(), uv, 64.0) {
            Some(scanned) => assert_eq!(source, scanned),
            None => assert!(source.at.iter().all(|a| *a == Vec3::ONE), "{source:?}"),
        }
    }
    // Where even the edges meet too much: samples, in bounded time, near the mean.
    let sums = RowSums::new(&image.bitmap());
    for span in [1e4, 1e9, 1e30_f32] {
        let got = exact.vertex_albedo([[0.0, 0.0], [span, 0.3 * span], [0.1 * span, span]]);
        assert!(got.at.iter().all(|a| a.is_finite() && a.min_element() >= 0.0 && a.max_element() <= 1.0));
        if span < 1e5 {
            assert!((got.mean() - sums.mean()).abs().max_element() <= 0.05, "{got:?}");
        }
    }
}

#[test]
fn samples_of_a_smooth_bitmap_are_near_its_integral() {
    let image = Image::new(8, 8, |x, y| (x * 20 + 40) | (y * 20 + 40) << 8 | 0x80_0000);
    let uv = [[0.1, 0.1], [0.8, 0.2], [0.3, 0.9]];
    let truth = image.truth(uv, true);
    let mut last = f64::INFINITY;
    for n in [1, 4, 16, 64] {
        let err = error(&sample_points(&image.bitmap(), uv, n), truth);
        println!("{n} divisions: {err:.2e}");
        assert!(err <= 0.5 * last, "{n}: {err} after {last}");
        last = err;
    }
    assert!(last <= 1e-4, "{last}");
    // A constant is a constant.
    let flat = Image::new(3, 3, |_, _| 0x80_8080);
    let got = sample_points(&flat.bitmap(), uv, 10);
    let code = flat.decode[128];
    assert!(error(&got, [[f64::from(code); 3]; 3]) <= 1e-6);
}

#[test]
fn any_floats_give_albedos() {
    let g = Counter::new(48);
    let image = Image::noise(9, 5, 11);
    let exact = Exact::new(image.bitmap());
    let published = Published::new(image.bitmap(), 64.0);
    let hard = [
        0.0,
        -0.0,
        1.0,
        0.5,
        -1e-40,
        1e-40,
        1e38,
        -1e38,
        f32::MAX,
        f32::NAN,
        f32::INFINITY,
        8388608.5,
        1e6,
        -0.99999994,
    ];
    for n in 0..1000_u32 {
        let uv = [0, 1, 2].map(|k| {
            [0, 1].map(|a| {
                let w = g.bits(7, n, 2 * k + a);
                if w.is_multiple_of(3) {
                    hard[(w / 3 % hard.len() as u32) as usize]
                } else {
                    f32::from_bits(g.bits(8, n, 2 * k + a))
                }
            })
        });
        let bound = exact.brightest(uv);
        for albedo in [exact.vertex_albedo(uv), published.vertex_albedo(uv)] {
            for a in albedo.at {
                assert!(a.min_element() >= 0.0 && a.max_element() <= 1.0 && a.is_finite(), "{uv:?}: {a}");
            }
        }
        let ours = exact.vertex_albedo(uv);
        assert!(ours.at.iter().all(|a| a.cmple(bound).all()), "{uv:?}: {ours:?} above {bound}");
    }
}

#[test]
fn overlaps_of_a_grid_add_up_to_the_triangle() {
    let g = Counter::new(49);
    let mut worst = 0.0_f64;
    for n in 0..2000_u32 {
        let p = [0, 1, 2].map(|k| [0, 1].map(|a| g.unit(9, n, 2 * k + a) * 4.0));
        let (mut share, mut bary) = (0.0_f64, [0.0_f64; 3]);
        for i in 0..4 {
            for j in 0..4 {
                let cell = overlap_unit(p.map(|p| [p[0] - i as f32, p[1] - j as f32]));
                share += f64::from(cell.share);
                for k in 0..3 {
                    bary[k] += f64::from(cell.share) * f64::from(cell.bary[k]);
                }
            }
        }
        worst = worst.max((share - 1.0).abs());
        assert!((share - 1.0).abs() <= 2e-6, "{p:?}: {share}");
        assert!(bary.iter().all(|b| (b - 1.0 / 3.0).abs() <= 2e-6), "{p:?}: {bary:?}");
    }
    println!("shares of a grid: sum off by {worst:.2e}");
    assert_eq!(overlap_unit([[2.0, 2.0], [3.0, 2.0], [2.0, 3.0]]).share, 0.0);
    assert_eq!(overlap_unit([[f32::NAN, 0.0], [1.0, 0.0], [0.0, 1.0]]).share, 0.0);
    let half = overlap_unit([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    assert_eq!((half.share, half.bary), (1.0, [1.0 / 3.0; 3]));
}

#[test]
fn what_is_no_bitmap_is_refused() {
    let image = Image::noise(4, 4, 12);
    let of = |width, height, first_texel| TextureRecord { width, height, first_texel, pad: 0 };
    let new = |t: &TextureRecord| Bitmap::try_new(t, &image.texels, &image.decode).err();
    assert_eq!(new(&of(4, 4, 0)), None);
    assert_eq!(new(&of(0, 4, 0)), Some(BitmapError::Side { width: 0, height: 4 }));
    assert_eq!(new(&of(4, MAX_SIDE + 1, 0)), Some(BitmapError::Side { width: 4, height: MAX_SIDE + 1 }));
    assert_eq!(new(&of(4, 4, 1)), Some(BitmapError::Short { found: 16, expected: 17 }));
    assert!(matches!(new(&of(MAX_SIDE, MAX_SIDE, u32::MAX)), Some(BitmapError::Short { .. })));
    let bad = Bitmap::try_new(&of(4, 4, 0), &image.texels, &[0.0; 255]);
    assert_eq!(bad.err(), Some(BitmapError::Decode { len: 255 }));
    let bad = Bitmap::try_new(&of(4, 4, 0), &image.texels, &[f32::NAN; 256]);
    assert_eq!(bad.err(), Some(BitmapError::Decode { len: 256 }));
}
