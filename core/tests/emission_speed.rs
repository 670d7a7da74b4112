//! What the ways to a piece's albedo cost, in turns within one process: the ground of the rule that chooses.
#![allow(clippy::disallowed_methods, reason = "medians of times")]

#[path = "emission_support.rs"]
mod support;

use etendue_core::direct::emission::{
    Exact, PieceAlbedo, Pyramid, RowSums, covered_estimate, sample_points, scan, scan_texels,
};
use etendue_core::sampling::counter::Counter;
use std::hint::black_box;
use std::time::Instant;
use support::{Image, piece};

#[test]
#[ignore = "ten seconds: cargo test --release -p etendue-core --test emission_speed -- --ignored --nocapture"]
fn what_the_ways_cost() {
    let image = Image::noise(256, 256, 1);
    let bitmap = image.bitmap();
    let (sums, pyramid, exact) = (RowSums::new(&bitmap), Pyramid::new(&bitmap), Exact::new(bitmap));
    let g = Counter::new(61);
    println!("ns per piece, medians of 15 turns");
    println!("texels across |  met | constant | bilinear |  edges | exact | coarse 40 | bound | 16 points");
    for size in [1.0, 3.0, 6.0, 12.0, 24.0, 48.0, 96.0, 192.0] {
        let pieces: Vec<_> = (0..200)
            .map(|n| piece(&g, n, &image, size))
            .filter(|uv| size < 8.0 || sums.vertex_albedo(&bitmap, *uv, 1e9).is_some())
            .take(60)
            .collect();
        let met = pieces.iter().map(|p| covered_estimate([256, 256], *p)).sum::<f32>() / pieces.len() as f32;
        type Way<'a> = Box<dyn Fn([[f32; 2]; 3]) -> f32 + 'a>;
        let ways: [Way<'_>; 7] = [
            Box::new(|uv| scan_texels(&bitmap, uv, 1e9).map_or(0.0, |a| a.at[0].x)),
            Box::new(|uv| scan(&bitmap, uv, 1e9).map_or(0.0, |a| a.at[0].x)),
            Box::new(|uv| sums.vertex_albedo(&bitmap, uv, 1e9).map_or(0.0, |a| a.at[0].x)),
            Box::new(|uv| exact.vertex_albedo(uv).at[0].x),
            Box::new(|uv| pyramid.coarse(uv, 40.0).at[0].x),
            Box::new(|uv| pyramid.brightest(uv).x),
            Box::new(|uv| sample_points(&bitmap, uv, 4).at[0].x),
        ];
        let mut times = vec![Vec::new(); ways.len()];
        for _ in 0..15 {
            for (way, times) in ways.iter().zip(&mut times) {
                let start = Instant::now();
                for uv in &pieces {
                    black_box(way(black_box(*uv)));
                }
                times.push(start.elapsed().as_secs_f64() * 1e9 / pieces.len() as f64);
            }
        }
        let medians: Vec<f64> = times
            .iter_mut()
            .map(|t| {
                t.sort_by(f64::total_cmp);
                t[t.len() / 2]
            })
            .collect();
        println!(
            "{size:>13} | {met:>6.0} | {}",
            medians.iter().map(|m| format!("{m:>8.0}")).collect::<Vec<_>>().join(" | ")
        );
        assert!(medians.iter().all(|m| *m > 0.0));
    }
}
