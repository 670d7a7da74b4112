//! Starts on pieces: the formulas are total, and a place on a piece is found again by its barycentrics on the triangle.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::direct::subdivide::{Bary, GRID, Limits, Piece, Robust, Workspace};
use etendue_core::math::Vec3;
use etendue_core::sampling::discrete::even_word;
use etendue_core::transport::first_shot::place::{SLACK, density, on_triangle, within};
use etendue_core::transport::first_shot::weight::{
    light_density, light_share, look_factor, piece_flux, start_flux,
};

/// Weyl sequence with the finaliser of splitmix64.
struct Random(u64);

impl Random {
    fn word(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 32) as u32
    }

    fn unit(&mut self) -> f32 {
        (self.word() >> 8) as f32 / 16_777_216.0
    }

    /// Any bits, and often what is at the ends.
    fn any(&mut self) -> f32 {
        const HARD: [f32; 8] =
            [0.0, -0.0, 1.0, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, f32::MIN_POSITIVE];
        let word = self.word();
        if word & 1 == 0 { f32::from_bits(self.word()) } else { HARD[(word >> 1) as usize % 8] }
    }

    fn three(&mut self) -> [f32; 3] {
        [self.any(), self.any(), self.any()]
    }

    fn local(&mut self) -> [f32; 3] {
        let (a, t) = (f64::from(self.unit()).sqrt(), f64::from(self.unit()));
        [(1.0 - a) as f32, (a * t) as f32, (a * (1.0 - t)) as f32]
    }
}

#[test]
fn nothing_is_nan_whatever_comes_in() {
    let mut r = Random(1);
    for _ in 0..1_000_000 {
        let (e, density_in, per_watt) = (Vec3::from_array(r.three()), r.any(), r.any());
        let light = light_density(e, per_watt);
        assert!((0.0..=f32::MAX).contains(&light), "{e} {per_watt}");
        let flux = start_flux(e, density_in, per_watt);
        assert!(
            flux.to_array().iter().all(|x| (0.0..=f32::MAX).contains(x)),
            "{e} {density_in} {per_watt}: {flux}"
        );
        let share = light_share(e, density_in, per_watt);
        assert!((0.0..=1.0).contains(&share), "{e} {density_in} {per_watt}: {share}");
        let chance = r.any();
        let factor = look_factor(chance, true);
        assert!((-f32::MAX..=0.0).contains(&factor), "{chance}");
        assert!(look_factor(chance, false) == 1.0);
        let (weights, area, pmf) = (r.three(), r.any(), r.any());
        let flux = piece_flux(e, weights, area, pmf);
        assert!(flux.to_array().iter().all(|x| (0.0..=f32::MAX).contains(x)), "{e} {weights:?} {area} {pmf}");
        let local = if r.word() & 1 == 0 { r.three() } else { r.local() };
        let found = density(pmf, weights, area, local);
        assert!((0.0..=f32::MAX).contains(&found), "{pmf} {weights:?} {area} {local:?}: {found}");
        let _ = even_word(r.word(), r.word(), r.word() >> (r.word() & 31));
    }
}

#[test]
fn even_words_visit_each_part_once() {
    let shift = 0xABCD_EF01;
    assert_eq!((even_word(0, shift, 0), even_word(7, shift, 32), even_word(7, shift, 99)), (shift, 7, 7));
    for bits in 1..12 {
        for index in 0..1 << bits {
            let word = even_word(index, shift, bits);
            assert_eq!(
                (word >> (32 - bits), word << bits >> bits),
                (index, shift >> bits),
                "{index} of 2^{bits}"
            );
        }
    }
}

/// Irradiance without any pattern.
fn noise(bary: [f32; 3]) -> f32 {
    let mut x = bary[1].to_bits().wrapping_mul(0x9E37_79B1) ^ bary[2].to_bits().rotate_left(13);
    x = (x ^ x >> 16).wrapping_mul(0x85EB_CA6B);
    x = (x ^ x >> 13).wrapping_mul(0xC2B2_AE35);
    (x ^ x >> 16) as f32 * 2.0_f32.powi(-32)
}

fn pieces(triangle: [Vec3; 3]) -> Vec<Piece<f32>> {
    let mut out = Vec::new();
    let limits = Limits { budget: 256, ..Limits::default() };
    Workspace::new().subdivide(triangle, &Robust::default(), &limits, noise, |p| out.push(p));
    out
}

/// The least height of a piece over the triangle of barycentrics.
fn height(corners: [Bary; 3]) -> f64 {
    let [a, b, c] = corners.map(|c| [1, 2].map(|k| f64::from(c.steps()[k]) / f64::from(GRID)));
    let side = |p: [f64; 2], q: [f64; 2]| [q[0] - p[0], q[1] - p[1]];
    let (u, v, w) = (side(a, b), side(a, c), side(b, c));
    let length = |x: [f64; 2]| x[0].hypot(x[1]);
    (u[0] * v[1] - u[1] * v[0]) / length(u).max(length(v)).max(length(w))
}

/// Triangles even and thin, the longest edge in each place.
fn triangles() -> Vec<[Vec3; 3]> {
    let mut out = Vec::new();
    for thin in [1.0, 0.1, 1e-2, 1e-3, 1e-4] {
        for apex in [0.0, 0.37, 1.0] {
            let v = [Vec3::ZERO, Vec3::new(1.0, 0.0, 0.0), Vec3::new(apex, thin, 0.0)];
            for k in 0..3 {
                out.push([v[k], v[(k + 1) % 3], v[(k + 2) % 3]]);
            }
        }
    }
    out
}

#[test]
fn a_place_on_a_piece_is_found_again() {
    let mut r = Random(2);
    let mut worst = 0.0_f64;
    for triangle in triangles() {
        for p in pieces(triangle) {
            for _ in 0..16 {
                let local = r.local();
                let [_, b1, b2] = on_triangle(p.corners, local);
                let found = within(p.corners, [b1, b2]).expect("pieces have area");
                for (a, b) in local.into_iter().zip(found) {
                    // Two roundings to 2^-24 or less of the place, over the piece.
                    worst =
                        worst.max((f64::from(a) - f64::from(b)).abs() * height(p.corners) * f64::from(GRID));
                }
            }
        }
    }
    assert!(worst <= 2.0, "{worst} steps");
}

#[test]
fn pieces_leave_no_gap() {
    let mut r = Random(3);
    let mut worst = f32::INFINITY;
    for triangle in triangles() {
        let pieces = pieces(triangle);
        for _ in 0..500 {
            let [_, b1, b2] = r.local();
            let nearest = pieces
                .iter()
                .filter_map(|p| within(p.corners, [b1, b2]))
                .map(|l| l[0].min(l[1]).min(l[2]))
                .fold(f32::NEG_INFINITY, f32::max);
            worst = worst.min(nearest);
        }
    }
    assert!(worst >= -SLACK, "{worst}");
}
