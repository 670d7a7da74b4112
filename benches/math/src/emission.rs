//! Contenders for `emission`: the mean albedo of pieces over a bitmap.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use crate::figure::{Contender, Contest};
use etendue_conformance::statistics::Random;
use etendue_conformance::truth::emission::Bitmap as Truth;
use etendue_core::direct::emission::{
    Bitmap, Exact, PieceAlbedo, Published, Pyramid, RowSums, sample_points, scan, scan_texels,
};
use etendue_core::math::Vec3;
use etendue_core::sampling::warp::sample_triangle;
use etendue_core::scene::{TextureRecord, sample_bitmap, srgb_to_linear};
use std::hint::black_box;
use std::sync::Arc;

type Piece = [[f32; 2]; 3];
const SIDE: u32 = 256;

/// A bitmap with large and small structure: waves, and noise from texel to texel.
struct Image {
    record: TextureRecord,
    texels: Vec<u32>,
    decode: Vec<f32>,
}

impl Image {
    fn new() -> Self {
        let mut r = Random::new(71);
        let texels = (0..SIDE * SIDE)
            .map(|i| {
                let (x, y) = (f64::from(i % SIDE), f64::from(i / SIDE));
                let turn = std::f64::consts::TAU / f64::from(SIDE);
                [(3.0, 2.0), (7.0, -5.0), (2.0, 9.0)].iter().enumerate().fold(0, |word, (c, (a, b))| {
                    let wave = 110.0 + 60.0 * ((a * x + b * y) * turn).sin();
                    let code = (wave + 50.0 * (f64::from(r.unit()) - 0.5)) as u32;
                    word | code.min(255) << (8 * c)
                })
            })
            .collect();
        Self {
            record: TextureRecord { width: SIDE, height: SIDE, first_texel: 0, pad: 0 },
            texels,
            decode: (0..=255).map(srgb_to_linear).collect(),
        }
    }

    fn bitmap(&self) -> Bitmap<'_> {
        Bitmap::try_new(&self.record, &self.texels, &self.decode).expect("a bitmap")
    }
}

/// Pieces over a few texels: where a scan is what the source does.
pub fn contest_few() -> Contest {
    contest(
        "Mean albedo of pieces about 6 texels across, each way against the bilinear filter's integral",
        "emission_few",
        6.0,
        64,
    )
}

/// Pieces over many texels: where the source takes the brightest.
pub fn contest_many() -> Contest {
    contest(
        "Mean albedo of pieces about 60 texels across, each way against the bilinear filter's integral",
        "emission_many",
        60.0,
        12,
    )
}

/// Both.
pub fn contests() -> Vec<Contest> {
    vec![contest_few(), contest_many()]
}

fn contest(title: &'static str, file: &'static str, size: f64, count: usize) -> Contest {
    let mut r = Random::new(72);
    let image = Arc::new(Image::new());
    let pieces: Arc<Vec<Piece>> = Arc::new(
        (0..count)
            .map(|_| {
                let at = [r.range(-1.0, 1.0), r.range(-1.0, 1.0)];
                [0; 3].map(|_| [0, 1].map(|k| (at[k] + r.range(-0.5, 0.5) * size / f64::from(SIDE)) as f32))
            })
            .collect(),
    );
    let mut constants = vec![SIDE, SIDE];
    constants.extend(&image.texels);
    let truth = Truth::new(&constants);
    let expected: Vec<[f64; 3]> = pieces
        .iter()
        .map(|uv| {
            let a = truth.vertex_albedo(uv.map(|p| p.map(f64::from)), true);
            [0, 1, 2].map(|c| (a[0][c] + a[1][c] + a[2][c]) / 3.0)
        })
        .collect();

    // Tables outlive the contenders: they are made once and kept.
    let kept: &'static Image = Box::leak(Box::new(Image::new()));
    let bitmap = kept.bitmap();
    let sums = Arc::new(RowSums::new(&bitmap));
    let pyramid = Arc::new(Pyramid::new(&bitmap));
    let exact = Exact::new(bitmap);
    let published = Published::new(bitmap, 64.0);
    const ALL: f32 = 1e9;
    type Way = Box<dyn Fn(&Piece) -> Vec3>;
    let (p, q, s) = (pyramid.clone(), pyramid.clone(), sums);
    let mut ways: Vec<(String, bool, Way)> = vec![
        ("brightest texel of the piece (pyramid)".into(), true, Box::new(move |uv| p.brightest(*uv))),
        ("published rule, 64 texels".into(), false, Box::new(move |uv| published.vertex_albedo(*uv).mean())),
        (
            "scan of constant texels".into(),
            false,
            Box::new(move |uv| scan_texels(&bitmap, *uv, ALL).unwrap_or_default().mean()),
        ),
        (
            "scan, bilinear".into(),
            true,
            Box::new(move |uv| scan(&bitmap, *uv, ALL).unwrap_or_default().mean()),
        ),
        (
            "edges (row sums), else the scan".into(),
            true,
            Box::new(move |uv| match s.vertex_albedo(&bitmap, *uv, ALL) {
                Some(a) => a.mean(),
                None => scan(&bitmap, *uv, ALL).unwrap_or_default().mean(),
            }),
        ),
        ("exact rule".into(), true, Box::new(move |uv| exact.vertex_albedo(*uv).mean())),
    ];
    for texels in [40.0, 160.0_f32] {
        let q = q.clone();
        ways.push((
            format!("pyramid, {texels} texels"),
            true,
            Box::new(move |uv| q.coarse(*uv, texels).mean()),
        ));
    }
    for n in [1, 4, 16] {
        ways.push((
            format!("{} regular points", n * n),
            true,
            Box::new(move |uv| sample_points(&bitmap, *uv, n).mean()),
        ));
    }
    for n in [16, 256, 4096_u32] {
        // The same random points for every piece.
        let mut r = Random::new(73);
        let points: Vec<[f32; 3]> = (0..n).map(|_| sample_triangle([r.unit(), r.unit()])).collect();
        let image = image.clone();
        ways.push((
            format!("{n} random points"),
            false,
            Box::new(move |uv| {
                let mut sum = Vec3::ZERO;
                for b in &points {
                    let at = [0, 1].map(|k| b[0] * uv[0][k] + b[1] * uv[1][k] + b[2] * uv[2][k]);
                    sum += sample_bitmap(&image.record, &image.texels, &image.decode, at);
                }
                sum / n as f32
            }),
        ));
    }
    let contenders = ways
        .into_iter()
        .map(|(name, ours, way)| {
            let mut square = 0.0;
            for (uv, expected) in pieces.iter().zip(&expected) {
                let got = way(uv);
                square += (0..3).map(|c| (f64::from(got[c]) - expected[c]).powi(2)).sum::<f64>();
            }
            let pieces = pieces.clone();
            let work = Box::new(move || {
                for uv in pieces.iter() {
                    black_box(way(black_box(uv)));
                }
            });
            Contender { name, ours, error: (square / (3 * count) as f64).sqrt(), work }
        })
        .collect();
    Contest {
        title,
        file,
        error_label: "RMS error of the mean albedo",
        item: "piece",
        items: count as u64,
        contenders,
    }
}
