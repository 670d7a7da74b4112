#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use super::null::{self, Draws};
use super::{Grid, regular};
use crate::geometry::Ray;
use crate::math::Vec3;
use crate::medium::{Medium, flight};
use crate::sampling::counter::Counter;
use crate::scene::{CompiledScene, GridDesc, MediumDesc, SceneDesc, ShapeDesc, ShapeKind, compile};
use alloc::vec;
use alloc::vec::Vec;

/// A grid in a box, turned about y by this angle.
fn grid(size: [u32; 3], channels: u32, angle: f32, value: impl FnMut(u32) -> f32) -> GridDesc {
    let (s, c) = (f64::from(angle).sin() as f32, f64::from(angle).cos() as f32);
    let count = size[0] * size[1] * size[2] * channels;
    let to_world = [[2.0 * c, 0.0, 3.0 * s, -1.0], [0.0, 1.5, 0.0, 0.25], [-2.0 * s, 0.0, 3.0 * c, -0.5]];
    GridDesc { size, channels, values: (0..count).map(value).collect(), to_world }
}

fn scene(medium: MediumDesc) -> CompiledScene {
    let shape = ShapeDesc {
        kind: ShapeKind::Box { min: [-9.0; 3], max: [9.0; 3] },
        material: Default::default(),
        interior: medium.name.clone(),
        exterior: Default::default(),
    };
    compile(&SceneDesc { media: vec![medium], shapes: vec![shape], ..SceneDesc::default() }).unwrap().0
}

fn filled(density: Option<GridDesc>, sigma_a: [f32; 3], sigma_s: [f32; 3]) -> CompiledScene {
    scene(MediumDesc { density, ..MediumDesc::new("m", sigma_a, sigma_s, 0.0) })
}

/// The value at a point by the definition, in f64.
fn truth(grid: &GridDesc, p: [f64; 3]) -> [f64; 3] {
    let m = grid.to_world.map(|r| r.map(f64::from));
    // Columns are orthogonal in these tests.
    let u = [0, 1, 2].map(|k| {
        let column = [m[0][k], m[1][k], m[2][k]];
        let d = (0..3).map(|i| column[i] * (p[i] - m[i][3])).sum::<f64>();
        d / column.iter().map(|x| x * x).sum::<f64>()
    });
    if u.iter().any(|u| !(0.0..=1.0).contains(u)) {
        return [0.0; 3];
    }
    let mut out = [0.0; 3];
    let q = [0, 1, 2].map(|k| (u[k] * f64::from(grid.size[k]) - 0.5).clamp(0.0, f64::from(grid.size[k] - 1)));
    for corner in 0..8 {
        let (mut at, mut weight) = ([0; 3], 1.0);
        for k in 0..3 {
            let (low, up) = (q[k].floor(), corner >> k & 1);
            let f = q[k] - low;
            weight *= if up == 1 { f } else { 1.0 - f };
            at[k] = (low as u32 + up).min(grid.size[k] - 1);
        }
        let index = (at[2] * grid.size[1] + at[1]) * grid.size[0] + at[0];
        for (c, slot) in out.iter_mut().enumerate() {
            let c = if grid.channels == 3 { c } else { 0 };
            *slot += weight * f64::from(grid.values[index as usize * grid.channels as usize + c]);
        }
    }
    out
}

/// Integral of the value along a ray, and of exp(-sigma times that): by the midpoint rule with `parts` steps between any two planes of centres or faces.
fn integrals(grid: &GridDesc, ray: &Ray, limit: f64, sigma: Vec3, parts: u32) -> [[f64; 3]; 2] {
    let mut stops = vec![0.0, limit];
    for k in 0..3 {
        let column = [0, 1, 2].map(|i| f64::from(grid.to_world[i][k]));
        let along = |v: &dyn Fn(usize) -> f64| {
            (0..3).map(|i| column[i] * v(i)).sum::<f64>() / column.iter().map(|x| x * x).sum::<f64>()
        };
        let n = f64::from(grid.size[k]);
        let start = along(&|i| f64::from(ray.origin[i]) - f64::from(grid.to_world[i][3])) * n;
        let slope = along(&|i| f64::from(ray.direction[i])) * n;
        let planes = (0..grid.size[k]).map(|j| f64::from(j) + 0.5).chain([0.0, n]);
        stops.extend(planes.map(|p| (p - start) / slope).filter(|t| *t > 0.0 && *t < limit));
    }
    stops.sort_by(f64::total_cmp);
    let (mut value, mut left, mut tau) = ([0.0; 3], [0.0; 3], [0.0; 3]);
    for pair in stops.windows(2) {
        let step = (pair[1] - pair[0]) / f64::from(parts);
        for i in 0..parts {
            let t = pair[0] + (f64::from(i) + 0.5) * step;
            let p = [0, 1, 2].map(|k| f64::from(ray.origin[k]) + t * f64::from(ray.direction[k]));
            let d = truth(grid, p);
            for c in 0..3 {
                let half = f64::from(sigma[c]) * d[c] * step * 0.5;
                left[c] += (-(tau[c] + half)).exp() * step;
                value[c] += d[c] * step;
                tau[c] += 2.0 * half;
            }
        }
    }
    [value, left]
}

fn unit(v: Vec3) -> Vec3 {
    crate::math::normalize_or(v, Vec3::X)
}

/// Rays of all kinds, with lengths: through, from within, along axes, in faces and edges.
fn rays(numbers: &Counter, i: u32) -> (Ray, f32) {
    let n = |d: u32| 2.0 * numbers.unit(7, i, d) - 1.0;
    let axes = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    let origin = Vec3::new(n(0), n(1) + 1.0, n(2)) * if i.is_multiple_of(3) { 0.5 } else { 3.0 };
    let direction = match i % 5 {
        0 => axes[i as usize / 5 % 6],
        1 => unit(axes[i as usize / 5 % 6] + Vec3::new(n(3), n(4), n(5)) * 1e-5),
        _ => unit(Vec3::new(n(3), n(4), n(5)) - 0.3 * origin),
    };
    (Ray { origin, direction, t_max: f32::MAX }, 4.0 + 3.0 * n(6))
}

#[test]
fn optical_lengths_are_their_integrals() {
    let numbers = Counter::new(3);
    let mut worst = 0.0_f64;
    for (k, (size, channels)) in
        [([5, 4, 7], 1), ([1, 1, 1], 3), ([12, 3, 2], 3), ([20, 24, 17], 1)].into_iter().enumerate()
    {
        // Whole blocks of nothing, too.
        let desc = grid(size, channels, 0.4 * k as f32, |i| {
            if k == 3 && i % 480 < 300 { 0.0 } else { numbers.unit(1, i, k as u32) }
        });
        let made = filled(Some(desc.clone()), [0.0; 3], [1.0; 3]);
        let grid = Grid::new(&made, 0).unwrap();
        for i in 0..60 {
            let (ray, limit) = rays(&numbers, i + 100 * k as u32);
            let found =
                regular::optical_length(&grid, &grid.line(ray.origin, ray.direction), limit, Vec3::ONE);
            let [truth, _] = integrals(&desc, &ray, limit.into(), Vec3::ZERO, 1000);
            for c in 0..3 {
                worst = worst.max((f64::from(found[c]) - truth[c]).abs());
            }
        }
    }
    // Values are up to 1, and ways in the box up to 3.9 m; some of it is the midpoint rule's.
    assert!(worst < 8e-6, "{worst}");
}

#[test]
fn pieces_add_up_exactly() {
    // A field that is trilinear everywhere: x y z of the unit box, whose integral along a diagonal is known.
    let n = 64;
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
    let to_world = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    let values = (0..n * n * n).map(|i| (at(i % n) * at(i / n % n) * at(i / n / n)) as f32).collect();
    let made = filled(Some(GridDesc { size: [n; 3], channels: 1, values, to_world }), [0.0; 3], [1.0; 3]);
    let grid = Grid::new(&made, 0).unwrap();
    // Between the outermost centres.
    let (a, b) = (0.5 / f64::from(n), 1.0 - 0.5 / f64::from(n));
    let direction = unit(Vec3::ONE);
    let line = grid.line(Vec3::splat(a as f32), direction);
    let length = (b - a) * 3.0_f64.sqrt();
    let found = regular::optical_length(&grid, &line, length as f32, Vec3::ONE).x;
    let truth = 3.0_f64.sqrt() * (b.powi(4) - a.powi(4)) / 4.0;
    assert!((f64::from(found) / truth - 1.0).abs() < 3e-6, "{found} {truth}");
}

#[test]
fn the_linear_ramp_has_its_published_transmittance() {
    // sigma(x) = 0.2 + 0.5 x on [0, 3]: T = exp(-(0.2 * 3 + 0.5 * 9 / 2)). Centres at 0 and 3; the outer half cells are left out by the ray.
    let to_world = [[6.0, 0.0, 0.0, -1.5], [0.0, 1.0, 0.0, -0.5], [0.0, 0.0, 1.0, -0.5]];
    let made = filled(
        Some(GridDesc { size: [2, 1, 1], channels: 1, values: vec![0.2, 1.7], to_world }),
        [0.5; 3],
        [0.5; 3],
    );
    let medium = Medium::new(&made, &made.media[0]);
    let ray = Ray { origin: Vec3::ZERO, direction: Vec3::X, t_max: f32::MAX };
    let found = medium.transmittance(&ray, 0.0, 3.0);
    assert!((found - Vec3::splat(0.057_844_32)).abs().max_element() < 1e-7, "{found}");
}

#[test]
fn a_length_that_is_reached_has_the_wanted_integral() {
    let numbers = Counter::new(5);
    for channels in [1, 3] {
        // Corners of 0 make pieces whose density starts from nothing.
        let desc = grid([9, 6, 7], channels, 0.7, |i| {
            let u = numbers.unit(1, i, channels);
            if u < 0.3 { 0.0 } else { 4.0 * u }
        });
        let made = filled(Some(desc), [0.0; 3], [1.0; 3]);
        let grid = Grid::new(&made, 0).unwrap();
        for i in 0..3000 {
            let (ray, limit) = rays(&numbers, i);
            let line = grid.line(ray.origin, ray.direction);
            let c = (i % 3) as usize;
            let whole = regular::optical_length(&grid, &line, limit, Vec3::ONE)[c];
            let wanted = numbers.unit(2, i, 0) * 1.1 * whole;
            let found = regular::fly(&grid, &line, limit, wanted, c);
            let Some(length) = found.length else {
                assert!(wanted >= whole && found.optical[c] == whole, "{i}");
                continue;
            };
            assert!(length <= limit && wanted < whole, "{i}: {length} {limit}");
            assert!((found.optical[c] - wanted).abs() <= 2e-6 * whole, "{i}: {} {wanted}", found.optical[c]);
            let again = regular::optical_length(&grid, &line, length, Vec3::ONE)[c];
            assert!((again - wanted).abs() <= 1e-5 * (1.0 + whole), "{i}: {again} {wanted}");
        }
    }
}

#[test]
fn a_constant_grid_is_a_homogeneous_medium() {
    let numbers = Counter::new(6);
    let (a, s) = ([0.1, 0.4, 0.2], [0.4, 0.0, 2.0]);
    let plain = filled(None, a, s);
    let full = filled(Some(grid([6, 5, 4], 1, 0.0, |_| 1.0)), a, s);
    let (plain, full) = (Medium::new(&plain, &plain.media[0]), Medium::new(&full, &full.media[0]));
    for i in 0..2000 {
        let n = |d: u32| numbers.unit(3, i, d);
        let origin = Vec3::new(-0.9 + 1.8 * n(0), 0.3 + 1.3 * n(1), -0.4 + 2.8 * n(2));
        let ray = Ray { origin, direction: unit(Vec3::new(n(3), n(4), n(5)) - 0.5), t_max: f32::MAX };
        let (lead, limit) = (0.01 * n(6), 0.05 + 0.02 * n(7));
        let [a, b] = [&plain, &full].map(|m| m.fly(&ray, lead, limit, Vec3::ONE, [n(8), n(9)]));
        assert_eq!(a.collided, b.collided, "{i}");
        assert!((a.length - b.length).abs() < 2e-6, "{i}: {a:?} {b:?}");
        assert!(
            (a.weight - b.weight).abs().max_element() <= 1e-5 * a.weight.max_element(),
            "{i}: {a:?} {b:?}"
        );
        let [a, b] = [&plain, &full].map(|m| m.transmittance(&ray, lead, limit));
        assert!((a - b).abs().max_element() < 1e-6, "{i}: {a} {b}");
        let [a, b] = [&plain, &full].map(|m| m.sigma_s_at(origin));
        assert!((a - b).abs().max_element() < 1e-6, "{i}: {a} {b}");
    }
}

/// Mean and standard error of many, per channel.
fn mean(n: u32, mut one: impl FnMut(u32) -> Vec3) -> ([f64; 3], [f64; 3]) {
    let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
    for i in 0..n {
        let v = one(i);
        for c in 0..3 {
            sum[c] += f64::from(v[c]);
            squares[c] += f64::from(v[c]).powi(2);
        }
    }
    let n = f64::from(n);
    let error = [0, 1, 2].map(|c| ((squares[c] / n - (sum[c] / n).powi(2)).max(0.0) / n).sqrt());
    (sum.map(|s| s / n), error)
}

#[test]
fn null_collisions_agree() {
    let numbers = Counter::new(9);
    for channels in [1, 3] {
        let desc = grid([10, 9, 8], channels, 0.3, |i| {
            let u = numbers.unit(4, i, 3);
            if u < 0.4 { 0.0 } else { 2.0 * u }
        });
        let made = filled(Some(desc), [0.3, 0.1, 0.0], [0.2, 0.9, 3.0]);
        let medium = Medium::new(&made, &made.media[0]);
        let grid = medium.density().unwrap();
        for i in [2, 8, 14, 33] {
            let (ray, limit) = rays(&numbers, i);
            let way = (ray.origin, ray.direction);
            let exact = medium.transmittance(&ray, 0.0, limit);
            let sigma = medium.sigma_t;
            let carried = Vec3::new(1.0, 0.5, 2.0);
            let n = 40_000;
            let ratio = mean(n, |j| null::transmittance(&grid, way, limit, sigma, &mut Draws::new(1, i, j)));
            let null = |j| null::fly(&grid, way, limit, sigma, carried, &mut Draws::new(2, i, j));
            let flown = |j| {
                let u = [numbers.unit(i, j, 0), numbers.unit(i, j, 1)];
                medium.fly(&ray, 0.0, limit, carried, u)
            };
            let passed = |f: flight::Flight| if f.collided { Vec3::ZERO } else { f.weight };
            // What scatters, by a function of the place.
            let hit = |f: flight::Flight| {
                let p = ray.origin + ray.direction * f.length;
                let seen = 1.0 + p.x + 0.5 * p.z * p.z;
                if f.collided { f.weight * medium.sigma_s_at(p) * seen } else { Vec3::ZERO }
            };
            let (a, b) = (mean(n, |j| hit(flown(j))), mean(n, |j| hit(null(j))));
            let through = [ratio, mean(n, |j| passed(flown(j))), mean(n, |j| passed(null(j)))];
            for c in 0..3 {
                for (k, (found, error)) in through.iter().enumerate() {
                    let off = (found[c] - f64::from(exact[c])).abs();
                    assert!(off <= 5.0 * error[c] + 1e-6, "ray {i}, {k}, channel {c}: {found:?} {exact}");
                }
                let off = (a.0[c] - b.0[c]).abs();
                assert!(off <= 5.0 * (a.1[c].hypot(b.1[c])) + 1e-6, "ray {i} channel {c}: {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn emission_is_its_integral() {
    let (numbers, mut worst) = (Counter::new(11), 0.0_f64);
    for (channels, scale) in [(1, 0.2), (3, 3.0), (1, 60.0)] {
        let desc = grid([6, 5, 4], channels, 0.3, |i| numbers.unit(4, i, 3));
        let sigma = Vec3::new(1.0, 0.3, 0.0) * scale;
        let medium = MediumDesc {
            density: Some(desc.clone()),
            emission: [1.0, 2.0, 0.5],
            ..MediumDesc::new("m", sigma.to_array(), [0.0; 3], 0.0)
        };
        let made = scene(medium);
        let medium = Medium::new(&made, &made.media[0]);
        for i in 0..20 {
            let (ray, limit) = rays(&numbers, i);
            let found = medium.emitted(&ray, 0.0, limit);
            let truth = integrals(&desc, &ray, limit.into(), sigma, 1000)[1];
            for c in 0..3 {
                let truth = truth[c] * f64::from(medium.emission[c]);
                let off = (f64::from(found[c]) - truth).abs();
                worst = worst.max(off / truth.max(0.01));
            }
        }
    }
    assert!(worst < 2e-5, "{worst}");
}

#[test]
fn albedos_of_a_grid_scale_extinction() {
    let desc = MediumDesc {
        density: Some(grid([2, 2, 2], 1, 0.0, |_| 0.5)),
        albedo: Some(grid([1, 1, 1], 3, 0.0, |i| 0.25 * i as f32)),
        ..MediumDesc::new("m", [1.0; 3], [3.0; 3], 0.0)
    };
    let made = scene(desc.clone());
    assert!(made.needs.grids && made.needs.unsupported.is_empty());
    let medium = Medium::new(&made, &made.media[0]);
    let inside = Vec3::new(0.3, 0.6, 0.7);
    assert_eq!(medium.sigma_t_at(inside), Vec3::splat(2.0));
    assert_eq!(medium.sigma_s_at(inside), Vec3::new(0.0, 0.5, 1.0));
    assert_eq!(medium.sigma_s_at(Vec3::splat(20.0)), Vec3::ZERO);
    // Without a density the extinction is the same everywhere, and nothing scatters beyond the albedos.
    let made = scene(MediumDesc { density: None, ..desc });
    let medium = Medium::new(&made, &made.media[0]);
    assert_eq!((medium.sigma_t_at(inside).x, medium.sigma_s_at(inside).z), (4.0, 2.0));
    assert_eq!(medium.sigma_s_at(Vec3::splat(20.0)), Vec3::ZERO);
}

#[test]
fn no_ray_is_too_hard() {
    let made = filled(Some(grid([4, 9, 3], 1, 0.0, |i| (i % 7) as f32)), [1.0, 0.0, 1e3], [1.0, 0.0, 0.0]);
    let medium = Medium { emission: Vec3::ONE, ..Medium::new(&made, &made.media[0]) };
    // Coordinates of faces of the box, of planes of centres, inside, far away, and worse.
    let places = [-1.0, 1.0, 0.25, 1.75, 0.5, -0.5, 2.5, 0.0, 1e6, -1e6, 1e30, f32::MAX, f32::NAN];
    let ways = [0.0, -0.0, 1.0, -1.0, 0.6, 1e-5, 1e-20, -1e-38];
    let mut all: Vec<Vec3> = Vec::new();
    for x in ways {
        for y in ways {
            for z in ways {
                all.push(Vec3::new(x, y, z));
                all.push(crate::math::normalize_or(Vec3::new(x, y, z), Vec3::X));
            }
        }
    }
    let mut at = 0;
    for x in places {
        for y in places {
            for z in places {
                for limit in [0.0, 1e-30, 1.0, 5e6, f32::INFINITY] {
                    at += 1;
                    let ray =
                        Ray { origin: Vec3::new(x, y, z), direction: all[at % all.len()], t_max: f32::MAX };
                    let f = medium.fly(&ray, 1e-4, limit, Vec3::ONE, [0.4, 0.5]);
                    assert!(f.length <= limit && f.weight.is_finite(), "{ray:?} {limit}: {f:?}");
                    assert!(f.weight.min_element() >= 0.0);
                    let left = medium.transmittance(&ray, 1e-4, limit);
                    assert!(
                        left.min_element() >= 0.0 && left.max_element() <= 1.0,
                        "{ray:?} {limit}: {left}"
                    );
                    assert!(!medium.emitted(&ray, 1e-4, limit).is_nan(), "{ray:?} {limit}");
                    assert!(medium.sigma_s_at(ray.origin).is_finite());
                    let grid = medium.density().unwrap();
                    let way = (ray.origin, ray.direction);
                    let estimate =
                        null::transmittance(&grid, way, limit, Vec3::ONE, &mut Draws::new(1, 2, at as u32));
                    assert!(estimate.min_element() >= 0.0 && estimate.max_element() <= 1.0);
                }
            }
        }
    }
}

/// Time of flights and transmittances by either way; printed, not judged.
#[test]
#[ignore = "a measurement"]
fn speed() {
    extern crate std;
    let numbers = Counter::new(1);
    for (n, scale) in [(16, 2.0), (64, 2.0), (128, 2.0), (128, 20.0), (128, 200.0)] {
        // A cloud in a ball, nothing around it.
        let desc = grid([n; 3], 1, 0.0, |i| {
            let [x, y, z] = [i % n, i / n % n, i / n / n].map(|k| (k as f32 + 0.5) / n as f32 - 0.5);
            if x * x + y * y + z * z < 0.16 { numbers.unit(1, i, 0) } else { 0.0 }
        });
        let made = filled(Some(desc), [0.0; 3], [scale; 3]);
        let medium = Medium::new(&made, &made.media[0]);
        let grid = medium.density().unwrap();
        let ray = |i: u32| {
            let v = |d: u32| {
                Vec3::new(numbers.unit(2, i, d), numbers.unit(2, i, d + 1), numbers.unit(2, i, d + 2))
            };
            let target = Vec3::new(-1.0, 0.25, -0.5) + Vec3::new(2.0, 1.5, 3.0) * v(0);
            let origin = (v(4) - 0.5) * 8.0;
            Ray { origin, direction: unit(target - origin), t_max: f32::MAX }
        };
        let time = |f: &dyn Fn(u32) -> f32| {
            let start = std::time::Instant::now();
            let sum: f32 = (0..20_000).map(f).sum();
            (start.elapsed().as_secs_f64() / 20_000.0 * 1e9, sum / 20_000.0)
        };
        let way = |i| (ray(i).origin, ray(i).direction);
        let u = |i| [numbers.unit(3, i, 0), numbers.unit(3, i, 1)];
        let none = time(&|i| way(i).1.x + u(i)[0]).0;
        let fly = time(&|i| medium.fly(&ray(i), 0.0, 20.0, Vec3::ONE, u(i)).length.min(9.0));
        let null = time(&|i| {
            null::fly(&grid, way(i), 20.0, medium.sigma_t, Vec3::ONE, &mut Draws::new(1, 1, i))
                .length
                .min(9.0)
        });
        let exact = time(&|i| medium.transmittance(&ray(i), 0.0, 20.0).x);
        let ratio =
            time(&|i| null::transmittance(&grid, way(i), 20.0, medium.sigma_t, &mut Draws::new(1, 1, i)).x);
        std::println!(
            "{n}^3 x {scale}: fly {:.0} ns, by null collisions {:.0}; transmittance {:.0}, by ratios {:.0} (means {:?} {:?} {:?} {:?}, overhead {none:.0})",
            fly.0 - none,
            null.0 - none,
            exact.0 - none,
            ratio.0 - none,
            fly.1,
            null.1,
            exact.1,
            ratio.1
        );
    }
}
