//! From points to triangles: closed forms, and rays that look at triangles.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use super::*;
use crate::geometry::SurfacePoint;
use crate::math::Vec3;
use crate::sampling::counter::Counter;

const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// From a point to a rectangle a x b over it at height c, parallel, one corner straight above (J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-3).
fn over(a: f64, b: f64, c: f64) -> f64 {
    let (x, y) = (a / c, b / c);
    let part = |x: f64, y: f64| x / x.hypot(1.0) * (y / x.hypot(1.0)).atan();
    (part(x, y) + part(y, x)) / std::f64::consts::TAU
}

#[test]
fn triangles_over_a_point_make_the_rectangle_of_the_catalogue() {
    for (a, b, c) in [(1.0, 1.0, 1.0), (3.0, 0.2, 0.5), (1e-2, 1e-2, 1.0), (40.0, 50.0, 0.1)] {
        let corners = [[0.0, 0.0, c], [a, 0.0, c], [a, b, c], [0.0, b, c]];
        let found: f64 = [[0, 1, 2], [0, 2, 3], [2, 1, 0], [3, 2, 0]]
            .iter()
            .map(|t| point_to_triangle([0.0; 3], UP, t.map(|k| corners[k])))
            .sum();
        let truth = over(a, b, c);
        assert!((found / (2.0 * truth) - 1.0).abs() < 1e-5, "{a} {b} {c}: {found} {truth}, either turn");
    }
}

#[test]
fn what_lies_below_the_horizon_is_cut_off() {
    // An upright rectangle, half of it under ground: Howell B-4, from the one half alone.
    let upper = [[1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 2.0], [1.0, -1.0, 2.0]];
    let whole = upper.map(|[x, y, z]| [x, y, 2.0 * z - 2.0]);
    let sum = |c: [[f64; 3]; 4]| -> f64 {
        [[0, 1, 2], [0, 2, 3]].iter().map(|t| point_to_triangle([0.0; 3], UP, t.map(|k| c[k]))).sum()
    };
    let truth =
        ((1.0_f64).atan() - (1.0 / 5.0_f64.sqrt()) * (1.0 / 5.0_f64.sqrt()).atan()) / std::f64::consts::PI;
    assert!((sum(upper) - truth).abs() < 1e-6, "{} {truth}", sum(upper));
    assert!((sum(whole) - truth).abs() < 1e-6, "{} {truth}", sum(whole));
    assert_eq!(sum(upper.map(|[x, y, z]| [x, y, -0.5 - z])), 0.0);
    assert_eq!(sum(upper.map(|[x, y, _]| [x, y, 0.0])), 0.0, "in the point's plane");
    // All around a point within a tetrahedron, 1.
    let t = [[-9.0, -9.0, -3.0], [9.0, 0.0, -3.0], [-9.0, 9.0, -3.0], [0.0, 0.0, 7.0]];
    let faces = [[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let all: f64 = faces.iter().map(|f| point_to_triangle([0.0; 3], UP, f.map(|k| t[k]))).sum();
    assert!((all - 1.0).abs() < 1e-6, "{all}");
}

#[test]
fn any_numbers_give_a_form_factor() {
    let odd = [0.0, -0.0, 1.0, -1.0, 1e-30, 1e30, 1e300, f64::NAN, f64::INFINITY];
    for a in odd {
        for b in odd {
            for v in [[[a, b, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]], [[a; 3], [b; 3], [a, b, a]]] {
                let f = point_to_triangle([0.0; 3], UP, v);
                assert!((0.0..=1.0).contains(&f), "{v:?} {f}");
            }
        }
    }
}

#[test]
fn rays_to_a_triangle_count_its_form_factor_in_the_mean() {
    let numbers = Counter::new(3);
    let point = SurfacePoint { position: Vec3::ZERO, extent: 1.0 };
    // Far, near, very near to an edge, cut by the horizon, seen at a grazing angle, and one that cannot be told from its plane.
    let cases = [
        [[0.0, 0.0, 9.0], [0.0, 1.0, 9.0], [1.0, 0.0, 9.5]],
        [[0.0, -1.0, 1.0], [0.5, 1.0, 1.0], [1.0, 0.0, 0.3]],
        [[0.01, -1.0, 0.0], [0.01, 1.0, 0.0], [0.01, 0.0, 1.0]],
        [[0.5, -1.0, -0.7], [0.5, 1.0, -0.3], [1.0, 0.0, 1.0]],
        [[0.5, -1.0, 0.001], [0.5, 1.0, 0.001], [2.0, 0.0, 0.0015]],
    ];
    for vertices in cases {
        let whole = vertices.map(|v: [f32; 3]| Vec3::from_array(v));
        let normal = (whole[1] - whole[0]).cross(whole[2] - whole[0]).normalize();
        let normal = if normal.dot(whole[0]) < 0.0 { normal } else { -normal };
        let target = MemberTriangle { vertices: whole, normal, whole, sliver: 1.0 };
        let truth = point_to_triangle([0.0; 3], UP, whole.map(wide));
        const N: u32 = 1 << 17;
        let (mut sum, mut squares) = (0.0, 0.0);
        for i in 0..N {
            let u = [numbers.unit(i, 0, 0), numbers.unit(i, 1, 0)];
            if let Some((ray, weight)) = aim::aim(&point, Vec3::Z, &target, u) {
                let end = ray.origin + ray.direction * ray.t_max;
                assert!(weight > 0.0 && weight < 1.0 && end.is_finite(), "{ray:?} {weight}");
                sum += f64::from(weight);
                squares += f64::from(weight).powi(2);
            }
        }
        let mean = sum / f64::from(N);
        let stderr = ((squares / f64::from(N) - mean * mean) / f64::from(N)).sqrt();
        assert!(
            (mean - truth).abs() < 4.0 * stderr + 1e-3 * truth + 1e-7,
            "{vertices:?}: {mean} +- {stderr}, {truth}"
        );
        assert!(stderr < 0.02 * truth, "few weights must not stand for all: {stderr} of {truth}");
    }
}
