//! Photons from lights against the light that arrives: what crosses a patch is the integral of its irradiance, found by the light's own sampling
//! from the patch, which is a second way to say what a light does.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::light::{self, emit};
use etendue_core::math::Vec3;
use etendue_core::scene::{LightKind, LightRecord, NO_INDEX};

/// Weyl sequence with the finaliser of splitmix64.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / 16_777_216.0
    }
}

const DARK: LightRecord = LightRecord {
    kind: 0,
    primitive: NO_INDEX,
    pmf: 1.0,
    area: 0.0,
    point: [0.0; 3],
    params: [0.0; 2],
    pad: [0.0; 3],
    radiance: [3.0, 2.0, 1.0],
    edge1: [0.0; 3],
    edge2: [0.0; 3],
    normal: [0.0; 3],
};

const SPHERE: (Vec3, f32) = (Vec3::new(0.2, 0.1, -0.3), 3.0);

fn spot(cone: f32, falloff: f32) -> LightRecord {
    let axis = Vec3::new(0.1, -1.0, 0.2).normalize();
    LightRecord {
        kind: LightKind::Spot as u32,
        point: [0.1, 1.5, 0.0],
        edge1: axis.to_array(),
        params: [cone.to_radians().cos(), falloff.to_radians().cos()],
        ..DARK
    }
}

/// One light of each kind, all above the patch.
fn lights() -> Vec<(&'static str, LightRecord)> {
    let down = Vec3::new(0.2, -1.0, -0.1).normalize();
    let surface = |kind: LightKind, e1: Vec3, e2: Vec3, share: f32| LightRecord {
        kind: kind as u32,
        area: share * e1.cross(e2).length(),
        point: [-0.4, 1.2, -0.3],
        edge1: e1.to_array(),
        edge2: e2.to_array(),
        normal: e1.cross(e2).normalize().to_array(),
        ..DARK
    };
    let (e1, e2) = (Vec3::new(0.7, 0.1, 0.0), Vec3::new(0.1, 0.2, 0.8));
    // Fronts down: u x v points to -y.
    let (a, b) = if e1.cross(e2).y < 0.0 { (e1, e2) } else { (e2, e1) };
    vec![
        ("point", LightRecord { kind: LightKind::Point as u32, point: [0.1, 1.5, 0.0], ..DARK }),
        ("spot", spot(40.0, 25.0)),
        ("hard spot", spot(35.0, 35.0)),
        ("wide spot", spot(170.0, 0.0)),
        ("directional", LightRecord { kind: LightKind::Directional as u32, normal: down.to_array(), ..DARK }),
        ("triangle", surface(LightKind::Triangle, a, b, 0.5)),
        ("parallelogram", surface(LightKind::Parallelogram, a, b, 1.0)),
        (
            "sphere",
            LightRecord {
                kind: LightKind::Sphere as u32,
                point: [0.1, 1.4, 0.2],
                params: [0.35, 0.0],
                area: 4.0 * std::f32::consts::PI * 0.35 * 0.35,
                ..DARK
            },
        ),
        (
            "disk",
            LightRecord {
                kind: LightKind::Disk as u32,
                point: [0.1, 1.4, 0.2],
                params: [0.4, 0.0],
                normal: down.to_array(),
                area: std::f32::consts::PI * 0.4 * 0.4,
                ..DARK
            },
        ),
    ]
}

/// The patch: x and z in [-0.5, 0.7] x [-0.6, 0.4] at y = 0, seen from above.
const LO: [f32; 2] = [-0.5, -0.6];
const HI: [f32; 2] = [0.7, 0.4];

fn crosses(origin: Vec3, direction: Vec3) -> bool {
    let t = -origin.y / direction.y;
    let p = origin + direction * t;
    direction.y < 0.0 && t > 0.0 && p.x >= LO[0] && p.x <= HI[0] && p.z >= LO[1] && p.z <= HI[1]
}

/// Flux onto the patch and its standard error, from places on the patch and on the light.
fn arriving(light: &LightRecord, r: &mut Random) -> (f64, f64) {
    let area = f64::from((HI[0] - LO[0]) * (HI[1] - LO[1]));
    let n = 400_000;
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..n {
        let p = Vec3::new(LO[0] + (HI[0] - LO[0]) * r.unit(), 0.0, LO[1] + (HI[1] - LO[1]) * r.unit());
        let e = light::sample(light, p, [r.unit(), r.unit()])
            .map_or(0.0, |s| f64::from(s.contribution.x * s.wi.y.max(0.0)));
        sum += e;
        squares += e * e;
    }
    let mean = sum / f64::from(n);
    let variance = (squares / f64::from(n) - mean * mean) / f64::from(n - 1);
    (area * mean, area * variance.max(0.0).sqrt())
}

/// Flux of photons onto the patch and its standard error.
fn photons(n: u32, mut emission: impl FnMut() -> emit::Emission) -> (f64, f64) {
    let (mut hits, mut flux) = (0_u32, 0.0);
    for _ in 0..n {
        let e = emission();
        assert!((e.ray.direction.length() - 1.0).abs() < 1e-5, "{e:?}");
        flux = f64::from(e.flux.x);
        hits += u32::from(crosses(e.ray.origin, e.ray.direction));
    }
    let p = f64::from(hits) / f64::from(n);
    (flux * p, flux * (p * (1.0 - p) / f64::from(n)).sqrt())
}

#[test]
fn photons_bring_what_arrives() {
    let mut r = Random(1);
    for (name, light) in lights() {
        let (truth, error) = arriving(&light, &mut r);
        let (found, noise) =
            photons(400_000, || emit::emit(&light, SPHERE, [r.unit(), r.unit(), r.unit(), r.unit()]));
        let z = (found - truth) / error.hypot(noise);
        // Nine lights at alpha = 1e-4 altogether.
        assert!(z.abs() < 4.4, "{name}: {found} by photons, {truth} by the light's own sampling, z = {z}");
        assert!(noise < 0.02 * truth, "{name}: too noisy to tell, {noise} of {truth}");
    }
}

#[test]
fn an_environment_brings_pi_times_its_radiance() {
    let mut r = Random(2);
    let radiance = Vec3::new(3.0, 2.0, 1.0);
    let (found, noise) = photons(2_000_000, || {
        emit::emit_environment(radiance, SPHERE, [r.unit(), r.unit(), r.unit(), r.unit()])
    });
    let truth = std::f64::consts::PI * 3.0 * f64::from((HI[0] - LO[0]) * (HI[1] - LO[1]));
    assert!(((found - truth) / noise).abs() < 4.0, "{found} {truth} {noise}");
}

/// Shares of a spot's flux by the cosine, in f64.
fn spot_share(one_minus_cos: f64, cone: f64, full: f64) -> f64 {
    let ring = 0.5 * (full - cone);
    let inner = 1.0 - full;
    if one_minus_cos <= inner {
        return one_minus_cos / (inner + ring);
    }
    let x = ((1.0 - cone) - one_minus_cos) / (full - cone);
    1.0 - ring * (2.0 * x.powi(3) - x.powi(4)) / (inner + ring)
}

#[test]
fn a_spots_falloff_is_inverted() {
    for (cone, falloff) in [(40.0, 25.0), (170.0, 0.0), (2.0, 1.0), (90.0, 89.0), (60.0, 60.0)] {
        let light = spot(cone, falloff);
        let axis = Vec3::from_array(light.edge1);
        let [c, f] = light.params.map(f64::from);
        for i in 0..4096_u32 {
            let u = (i as f32 + 0.5) / 4096.0;
            let d = emit::emit(&light, SPHERE, [u, 0.3, 0.0, 0.0]).ray.direction;
            // 1 - cos from the chord, which keeps its digits for narrow cones.
            let chord = f64::from((d - axis).length_squared()) * 0.5;
            let share = spot_share(chord, c, f);
            // Directions are rounded to 2^-23, a narrow cone has few of them.
            let tolerance = 2e-6 + 4e-7 / (1.0 - c);
            assert!((share - f64::from(u)).abs() < tolerance, "{cone} {falloff}: u = {u}, share {share}");
        }
    }
}

#[test]
fn fluxes_are_what_closed_forms_say() {
    let pi = std::f32::consts::PI;
    let close = |a: f32, b: f32| assert!((a - b).abs() <= 2e-6 * b, "{a} {b}");
    close(emit::flux(&lights()[0].1, 9.0).x, 12.0 * pi);
    let [cone, full] = spot(40.0, 25.0).params;
    close(emit::flux(&spot(40.0, 25.0), 9.0).y, 2.0 * 2.0 * pi * (1.0 - 0.5 * (cone + full)));
    close(emit::flux(&lights()[4].1, 9.0).z, pi * 81.0);
    close(emit::flux(&lights()[6].1, 9.0).z, pi * lights()[6].1.area);
    close(emit::environment_flux(Vec3::ONE, 2.0).x, 16.0 * pi * pi);
}

#[test]
fn numbers_at_the_ends_give_directions() {
    let ends = [0.0, 1.0 - 1.0 / 16_777_216.0];
    for (name, light) in lights() {
        for i in 0..16 {
            let u = [0, 1, 2, 3].map(|k| ends[i >> k & 1]);
            let e = emit::emit(&light, SPHERE, u);
            let ok = e.ray.origin.is_finite() && (e.ray.direction.length() - 1.0).abs() < 1e-5;
            assert!(ok, "{name} {u:?}: {e:?}");
        }
    }
}
