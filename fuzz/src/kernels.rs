//! Total functions of core, on floats of any bit pattern.

use etendue_core::geometry::{BruteForce, Bvh2, Intersector, Primitives, Ray};
use etendue_core::math::Vec3;
use etendue_core::sampling::discrete::IntegerCdf;
use etendue_core::sampling::{u32_to_unit, warp};
use etendue_cpu::tree::{Isa, WideTree};

fn words(bytes: &[u8]) -> impl Iterator<Item = u32> + '_ {
    bytes.chunks_exact(4).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]]))
}

/// Weights of any kind: refused, or counts that add up to 2^32, with no entry picked that weighs nothing.
pub fn discrete(bytes: &[u8]) {
    let mut words = words(bytes);
    let Some(x) = words.next() else { return };
    let weights: Vec<f32> = words.map(f32::from_bits).collect();
    let Ok(cdf) = IntegerCdf::try_new(&weights) else { return };
    let total: u64 = (0..weights.len() as u32).map(|i| cdf.count(i)).sum();
    assert_eq!(total, 1 << 32, "the probabilities sum to one");
    for (i, &w) in weights.iter().enumerate() {
        assert_eq!(cdf.count(i as u32) > 0, w > 0.0, "entry {i} of weight {w}");
    }
    let pick = cdf.pick(x);
    assert!(weights[pick.index as usize] > 0.0);
    assert!(pick.pmf > 0.0 && pick.pmf <= 1.0);
}

/// A ray, then vertices, three to a triangle. Small integers as well as raw bits, so that shared edges, hits on
/// edges and coplanar rays are common.
pub fn geometry(bytes: &[u8]) {
    let Some((&mode, bytes)) = bytes.split_first() else { return };
    let values: Vec<f32> = if mode % 2 == 0 {
        words(bytes).map(f32::from_bits).collect()
    } else {
        bytes.iter().map(|&b| f32::from(b as i8) * 0.25).collect()
    };
    let vectors: Vec<[f32; 3]> =
        values.chunks_exact(3).take(2 + 3 * 64).map(|c| [c[0], c[1], c[2]]).collect();
    let [origin, direction, positions @ ..] = &vectors[..] else { return };
    let triangles: Vec<[u32; 3]> =
        (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let primitives = Primitives { positions, triangles: &triangles, shapes: &[] };
    let t_max = if mode & 2 == 0 { f32::INFINITY } else { 1.0 };
    let ray = Ray { origin: Vec3::from_array(*origin), direction: Vec3::from_array(*direction), t_max };
    let (oracle, tree) = (BruteForce { primitives }, Bvh2::new(primitives));
    let hit = oracle.closest_hit(&ray);
    assert_eq!(hit, tree.closest_hit(&ray));
    assert_eq!(hit.is_some(), tree.occluded(&ray));
    assert_eq!(hit.is_some(), oracle.occluded(&ray));
    wide_tree(&primitives, &ray, &oracle);
    if let Some(hit) = hit {
        assert!(hit.t >= 0.0 && hit.t <= t_max);
        assert!(hit.b1 >= 0.0 && hit.b2 >= 0.0 && hit.b1 + hit.b2 <= 1.0);
    }
}

/// The CPU's wide tree, in both of its forms, ray by ray, by batches and refitted: the oracle's bits.
fn wide_tree(primitives: &Primitives<'_>, ray: &Ray, oracle: &BruteForce<'_>) {
    // Neighbours of the ray, which walk together where they may.
    let rays: [Ray; 8] = core::array::from_fn(|i| {
        let shift = if i < 4 { 0.0 } else { i as f32 * 1e-3 };
        Ray {
            origin: ray.origin + Vec3::splat(shift),
            direction: ray.direction * (1.0 + 0.1 * i as f32),
            t_max: ray.t_max,
        }
    });
    let expected = rays.map(|ray| oracle.closest_hit(&ray));
    let native = WideTree::build(primitives);
    // Built of something else, then moved here.
    let elsewhere: Vec<[f32; 3]> =
        (0..primitives.positions.len()).map(|i| [i as f32, (i * i % 7) as f32, 1.0]).collect();
    let mut moved = WideTree::build(&Primitives { positions: &elsewhere, ..*primitives });
    moved.refit(primitives).expect("as many triangles, and all were present");
    for tree in [native.clone().with_isa(Isa::Portable), native, moved] {
        let (mut hits, mut occluded) = ([None; 8], [false; 8]);
        tree.closest_hits(&rays, &mut hits);
        tree.any_hits(&rays, &mut occluded);
        for (i, ray) in rays.iter().enumerate() {
            assert_eq!(tree.closest_hit(ray), expected[i], "{:?}", tree.isa());
            assert_eq!(hits[i], expected[i], "{:?}", tree.isa());
            assert_eq!(tree.occluded(ray), expected[i].is_some(), "{:?}", tree.isa());
            assert_eq!(occluded[i], expected[i].is_some(), "{:?}", tree.isa());
        }
    }
}

/// Warps: any random words give a unit direction or a point of the domain, and the inverse gives numbers in [0, 1].
pub fn warps(bytes: &[u8]) {
    let mut words = words(bytes);
    let (Some(a), Some(b)) = (words.next(), words.next()) else { return };
    let u = [u32_to_unit(a), u32_to_unit(b)];
    let unit = |w: Vec3| assert!((w.length_squared() - 1.0).abs() <= 1e-5, "{w} has unit length");
    let inside = |u: [f32; 2]| assert!(u.iter().all(|x| (0.0..=1.0).contains(x)), "{u:?}");
    let w = warp::sample_sphere(u);
    unit(w);
    inside(warp::invert_sphere(w));
    let w = warp::sample_hemisphere(u);
    unit(w);
    inside(warp::invert_hemisphere(w));
    let w = warp::sample_cosine_hemisphere(u);
    unit(w);
    inside(warp::invert_cosine_hemisphere(w));
    let p = warp::sample_disk(u);
    assert!(p[0] * p[0] + p[1] * p[1] <= 1.0 + 1e-6, "{p:?}");
    inside(warp::invert_disk(p));
    let bary = warp::sample_triangle(u);
    assert!(bary.iter().all(|b| (0.0..=1.0).contains(b)), "{bary:?}");
    inside(warp::invert_triangle(bary));
    // Raw bits as points: no panic, and what the inverse says is a number for finite input.
    let raw = [f32::from_bits(a), f32::from_bits(b)];
    if raw.iter().all(|x| x.is_finite()) {
        assert!(warp::invert_disk(raw).iter().all(|x| !x.is_nan()), "{raw:?}");
    }
}
