//! Pictures of environments: the density of their directions, and what they send.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::light::{EnvironmentMap, emit, escaped, sample_lights};
use etendue_core::math::Vec3;
use etendue_core::sampling::counter::Counter;
use etendue_core::scene::{
    CompiledScene, EnvironmentDesc, EnvironmentImage, LightDesc, LightKind, SceneDesc, SceneError, ShapeDesc,
    ShapeKind, compile,
};
use std::f64::consts::{PI, TAU};

const IDENTITY: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn scene_of(lights: Vec<LightDesc>) -> Result<CompiledScene, SceneError> {
    let kind = ShapeKind::Sphere { center: [1.0, 2.0, 3.0], radius: 2.0 };
    let none = String::new;
    let shapes = vec![ShapeDesc { kind, material: none(), interior: none(), exterior: none() }];
    Ok(compile(&SceneDesc { shapes, lights, ..SceneDesc::default() })?.0)
}

fn picture(width: u32, height: u32, to_world: [[f32; 3]; 3], texel: impl Fn(u32) -> [f32; 3]) -> LightDesc {
    let texels = (0..width * height).map(texel).collect();
    let image = Some(EnvironmentImage { width, height, texels, to_world });
    LightDesc::Environment(EnvironmentDesc { radiance: [1.0; 3], image })
}

fn map(light: LightDesc) -> EnvironmentMap {
    scene_of(vec![light]).unwrap().environment_map.unwrap()
}

/// A rotation about an axis that is none of the three.
fn turned(angle: f64) -> [[f32; 3]; 3] {
    let (s, c) = angle.sin_cos();
    let (x, y, z) = (2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0);
    let t = 1.0 - c;
    [
        [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
        [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
        [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
    ]
    .map(|r| r.map(|x| x as f32))
}

fn noise(i: u32) -> [f32; 3] {
    let n = Counter::new(1);
    // A third of nothing, and a few of much.
    let scale = [0.0, 1.0, if n.unit(0, i, 3) > 0.97 { 300.0 } else { 0.3 }][i as usize * 7 % 3];
    [0, 1, 2].map(|c| scale * n.unit(0, i, c))
}

fn pictures() -> Vec<LightDesc> {
    vec![
        picture(1, 1, IDENTITY, |_| [2.0; 3]),
        picture(3, 1, turned(1.0), noise),
        picture(1, 5, IDENTITY, noise),
        picture(2, 3, turned(2.0), noise),
        picture(16, 9, turned(0.4), noise),
        picture(33, 20, IDENTITY, noise),
        // A sun, within the picture, over the seam, and at a pole.
        picture(16, 9, turned(0.4), |i| if i == 16 * 3 + 5 { [1e5; 3] } else { [0.01; 3] }),
        picture(16, 9, IDENTITY, |i| if i == 16 * 4 { [1e5; 3] } else { [0.0; 3] }),
        picture(16, 9, turned(0.1), |i| if i == 3 { [1e5; 3] } else { [0.0; 3] }),
    ]
}

/// The radiance of the definition: by angles, in f64.
fn truth(map: &EnvironmentMap, d: [f64; 3]) -> [f64; 3] {
    let m = map.to_world.map(|r| r.map(f64::from));
    let l = [0, 1, 2].map(|k| (0..3).map(|i| m[i][k] * d[i]).sum::<f64>());
    let (w, h) = (map.width as usize, map.height as usize);
    let x = (l[0].atan2(-l[2]) / TAU + 0.5) * w as f64 - 0.5;
    let y = l[1].clamp(-1.0, 1.0).acos() / PI * (h.max(2) - 1) as f64;
    let (x0, y0) = (x.floor(), y.floor().min((h.max(2) - 2) as f64));
    let at = |i: f64, j: f64| map.texels[(j as usize).min(h - 1) * w + (i.rem_euclid(w as f64)) as usize];
    [0, 1, 2].map(|c| {
        let v = |i, j| f64::from(at(i, j)[c]);
        let (fx, fy) = (x - x0, y - y0);
        let row = |j| v(x0, j) * (1.0 - fx) + v(x0 + 1.0, j) * fx;
        row(y0) * (1.0 - fy) + row(y0 + 1.0) * fy
    })
}

/// Directions and their solid angles: n by n in each cell of four texels.
fn sphere(map: &EnvironmentMap, n: usize) -> impl Iterator<Item = (Vec3, f64)> + '_ {
    let m = map.to_world.map(|r| r.map(f64::from));
    let (across, down) = (map.width as usize * n, (map.height.max(2) - 1) as usize * n);
    (0..across * down).map(move |k| {
        let (i, j) = (k % across, k / across);
        // From the first column's centre on.
        let phi = TAU * (((i as f64 + 0.5) / n as f64 + 0.5) / f64::from(map.width) - 0.5);
        let (a, b) = (PI * j as f64 / down as f64, PI * (j + 1) as f64 / down as f64);
        let theta = 0.5 * (a + b);
        let l = [theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos()];
        let d = m.map(|row| (0..3).map(|k| row[k] * l[k]).sum::<f64>() as f32);
        (Vec3::from_array(d), (a.cos() - b.cos()) * TAU / across as f64)
    })
}

/// As fine as some 10^5 directions are.
fn fine(map: &EnvironmentMap) -> usize {
    (400.0 / f64::from(map.width * map.height.max(2)).sqrt()) as usize + 1
}

#[test]
fn the_middle_looks_along_minus_z_and_the_right_is_right() {
    // 4 columns: centres at -135, -45, 45 and 135 degrees.
    let m = map(picture(4, 3, IDENTITY, |i| [i as f32, 0.0, 1.0]));
    let at = |x: f32, y: f32, z: f32| m.radiance(Vec3::new(x, y, z).normalize()).x;
    for (found, expected) in [
        (at(0.0, 0.0, -1.0), 5.5),
        (at(1.0, 0.0, -1.0), 6.0),
        (at(-1.0, 0.0, -1.0), 5.0),
        (at(1.0, 0.0, 0.0), 6.5),
        // Over the seam, from the last column to the first.
        (at(0.0, 0.0, 1.0), 5.5),
        // The poles are whole rows.
        (at(-1e-4, 1.0, -1e-4), 1.0),
        (at(1e-4, -1.0, -1e-4), 10.0),
    ] {
        assert!((found - expected).abs() < 1e-3, "{found} {expected}");
    }
    // A quarter of a turn about +y, from +z towards +x: what looked along -z looks along -x.
    let quarter = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
    let m = map(picture(4, 3, quarter, |i| [i as f32, 0.0, 1.0]));
    assert!((m.radiance(-Vec3::X).x - 5.5).abs() < 1e-5);
}

#[test]
fn radiance_is_bilinear_in_the_angles() {
    for light in pictures() {
        let m = map(light);
        let largest = m.texels.iter().flatten().fold(0.0_f32, |a, b| a.max(*b));
        for (d, _) in sphere(&m, 7) {
            let found = m.radiance(d);
            let truth = truth(&m, d.to_array().map(f64::from));
            for c in 0..3 {
                let off = (f64::from(found[c]) - truth[c]).abs();
                assert!(off <= 3e-5 * f64::from(largest), "{d}: {found} {truth:?}");
            }
        }
    }
}

#[test]
fn densities_add_up_and_are_nowhere_missing() {
    for (k, light) in pictures().into_iter().enumerate() {
        let scene = scene_of(vec![light]).unwrap();
        let m = scene.environment_map.as_ref().unwrap();
        let (mut sum, mut radiance) = (0.0, [0.0; 3]);
        for (d, w) in sphere(m, fine(m)) {
            let (l, pdf) = m.meet(d);
            assert_eq!((l, pdf), (m.radiance(d), m.pdf_solid_angle(d)));
            assert!(pdf > 0.0 || l == Vec3::ZERO, "{k}: {d} {l}");
            sum += w * f64::from(pdf);
            radiance = [0, 1, 2].map(|c| radiance[c] + w * f64::from(l[c]));
        }
        assert!((sum - 1.0).abs() < 2e-3, "{k}: {sum}");
        // The integral that the flux is made of.
        let light = scene.lights[0];
        assert_eq!(light.kind, LightKind::Environment as u32);
        for c in 0..3 {
            let stated = f64::from(light.edge1[c]);
            assert!((stated - radiance[c]).abs() <= 2e-3 * radiance[c], "{k}: {stated} {radiance:?}");
        }
        let radius = f64::from(scene.bounding_sphere().1);
        let flux = f64::from(emit::mean_flux(&scene, 0));
        let mean = radiance.iter().sum::<f64>() / 3.0;
        assert!((flux - PI * radius * radius * mean).abs() <= 2e-3 * flux, "{k}: {flux}");
    }
}

#[test]
fn what_is_drawn_has_the_stated_density() {
    let numbers = Counter::new(4);
    for (k, light) in pictures().into_iter().enumerate() {
        let m = map(light);
        let n = 200_000_u32;
        // By quarters of cells.
        let (w, h) = (f64::from(m.width), f64::from(m.height.max(2) - 1));
        let across = 2 * m.width as usize;
        let bin = |d: Vec3| {
            let t = m.to_world.map(Vec3::from_array);
            let l = t[0] * d.x + t[1] * d.y + t[2] * d.z;
            let u = f64::from(l.x).atan2(f64::from(-l.z)) / TAU + 0.5 - 0.5 / w;
            let v = f64::from(l.x).hypot(f64::from(l.z)).atan2(f64::from(l.y)) / PI;
            ((v * 2.0 * h).min(2.0 * h - 1.0) as usize) * across
                + ((u.rem_euclid(1.0) * 2.0 * w) as usize).min(across - 1)
        };
        let bins = across * 2 * h as usize;
        let (mut found, mut expected) = (vec![0.0; bins], vec![0.0; bins]);
        for (d, angle) in sphere(&m, 2) {
            expected[bin(d)] += angle * f64::from(m.pdf_solid_angle(d)) * f64::from(n);
        }
        let (mut differ, mut sums) = (0, [0.0, 0.0]);
        for i in 0..n {
            let [a, b, ..] = numbers.bits4(k as u32, i, 0);
            let s = m.sample([a, b]);
            assert!((s.wi.length() - 1.0).abs() < 1e-6 && s.pdf > 0.0 && s.radiance.is_finite());
            assert_eq!(s.radiance, m.radiance(s.wi));
            // On the border of a cell the neighbour's counts.
            differ += u32::from((m.pdf_solid_angle(s.wi) / s.pdf - 1.0).abs() > 1e-5);
            found[bin(s.wi)] += 1.0;
            let value = f64::from(s.radiance.x) / f64::from(s.pdf);
            sums = [sums[0] + value, sums[1] + value * value];
        }
        assert!(differ < n / 5000, "{k}: {differ}");
        for (f, e) in found.iter().zip(&expected) {
            // 6000 quarters, and steps of rounding at their borders.
            assert!((f - e).abs() <= 5.5 * f64::max(*e, 2.0).sqrt() + 1e-3 * e, "{k}: {f} {e}");
        }
        let mean = sums[0] / f64::from(n);
        let error = (sums[1] / f64::from(n) - mean * mean).max(0.0).sqrt() / f64::from(n).sqrt();
        let truth = sphere(&m, fine(&m)).map(|(d, w)| w * f64::from(m.radiance(d).x)).sum::<f64>();
        assert!((mean - truth).abs() <= 4.5 * error + 2e-3 * truth, "{k}: {mean} {truth} {error}");
    }
}

#[test]
fn a_picture_among_other_lights_keeps_its_share() {
    let sun = |i| if i == 16 * 3 + 5 { [1e4; 3] } else { [0.5; 3] };
    let point = LightDesc::Point { position: [0.0; 3], intensity: [200.0; 3] };
    let constant = LightDesc::Environment(EnvironmentDesc::uniform([0.25; 3]));
    let scene = scene_of(vec![point, picture(16, 9, turned(0.7), sun), constant]).unwrap();
    assert_eq!(scene.environment, [0.25; 3]);
    assert!(scene.needs.environment && scene.needs.environment_image && scene.needs.point_like_lights);
    assert!(!scene.needs.area_lights);
    let m = scene.environment_map.as_ref().unwrap();
    assert_eq!((m.light, m.light_pmf), (1, scene.lights[1].pmf));
    let numbers = Counter::new(8);
    let (mut picked, mut mean) = (0_u32, 0.0);
    let n = 100_000;
    for i in 0..n {
        let [a, b, c, _] = numbers.bits4(0, i, 0);
        let s = sample_lights(&scene, Vec3::ZERO + 9.0, [a, b, c]).unwrap();
        if s.distant {
            picked += 1;
            let weight = escaped(&scene, s.wi, s.pdf, 1.0) - Vec3::splat(0.25);
            // A direction of the same density from elsewhere has half of the weight.
            let radiance = m.radiance(s.wi);
            assert!((weight - 0.5 * radiance).abs().max_element() <= 2e-2 * radiance.max_element());
            mean += f64::from(s.contribution.y) / f64::from(n);
        }
    }
    let share = f64::from(picked) / f64::from(n);
    assert!((share - f64::from(m.light_pmf)).abs() < 0.006, "{share}");
    let truth = f64::from(scene.lights[1].edge1[1]);
    assert!((mean / truth - 1.0).abs() < 0.02, "{mean} {truth}");
    assert_eq!(escaped(&scene, Vec3::Y, 0.0, 1.0), Vec3::splat(0.25) + m.radiance(Vec3::Y));
}

#[test]
fn photons_carry_the_flux() {
    let numbers = Counter::new(9);
    for (k, light) in pictures().into_iter().enumerate() {
        let scene = scene_of(vec![light]).unwrap();
        let sphere = scene.bounding_sphere();
        let (n, mut sums) = (100_000, [0.0, 0.0]);
        for i in 0..n {
            let [a, b, c, d] = [0, 1, 2, 3].map(|j| numbers.unit(k as u32, i, j));
            let (e, point_like) = emit::emit_entry(&scene, 0, sphere, [a, b, c, d]);
            assert!(!point_like && (e.ray.direction.length() - 1.0).abs() < 1e-5);
            // It comes from outside and goes through the disk.
            let to = sphere.0 - e.ray.origin;
            let along = to.dot(e.ray.direction);
            let off = (to - e.ray.direction * along).length();
            assert!(along >= sphere.1 && off <= sphere.1 * 1.001, "{along} {off}");
            let seen = scene.environment_map.as_ref().unwrap().radiance(-e.ray.direction);
            assert!(e.flux.x == 0.0 || seen.x > 0.0);
            let x = f64::from(e.flux.x);
            sums = [sums[0] + x, sums[1] + x * x];
        }
        let mean = sums[0] / f64::from(n);
        let error = (sums[1] / f64::from(n) - mean * mean).max(0.0).sqrt() / f64::from(n).sqrt();
        let truth = f64::from(emit::entry_flux(&scene, 0).x);
        assert!((mean - truth).abs() <= 4.5 * error + 1e-5 * truth, "{k}: {mean} {truth} {error}");
    }
}

#[test]
fn what_is_no_picture_is_refused() {
    let wrong = |light: LightDesc| scene_of(vec![light]).unwrap_err().to_string();
    let good = || picture(2, 2, IDENTITY, |_| [1.0; 3]);
    assert!(wrong(picture(0, 2, IDENTITY, |_| [1.0; 3])).contains("1 to 65536"));
    assert!(wrong(picture(2, 2, IDENTITY, |_| [f32::NAN; 3])).contains("texels"));
    assert!(wrong(picture(2, 2, IDENTITY, |_| [-1.0; 3])).contains("texels"));
    assert!(wrong(picture(2, 2, [[2.0, 0.0, 0.0]; 3], |_| [1.0; 3])).contains("rotation"));
    let mut short = good();
    if let LightDesc::Environment(EnvironmentDesc { image: Some(i), .. }) = &mut short {
        i.texels.pop();
    }
    assert!(wrong(short).contains("3 entries, expected 4"));
    let second = scene_of(vec![good(), good()]).unwrap_err();
    assert_eq!(second, SceneError::SecondImage { place: "light 1 (environment)".into() });
    // A dark one is no light.
    let dark = scene_of(vec![picture(2, 2, IDENTITY, |_| [0.0; 3])]).unwrap();
    assert!(dark.lights.is_empty() && dark.environment_map.is_none() && dark.needs.dark());
}
