//! The wide tree against brute force, ray by ray and bit by bit, in every instruction set of this machine.

use etendue_core::geometry::{BruteForce, Hit, Intersector, Primitives, Ray, RoundShape};
use etendue_core::math::Vec3;
use etendue_tree::{Effort, Isa, RefitError, WideTree};

/// Weyl sequence with the finaliser of splitmix64.
struct Random(u64);

impl Random {
    fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    fn below(&mut self, n: u64) -> u64 {
        self.word() % n
    }
    /// In [-1, 1].
    fn signed(&mut self) -> f32 {
        (self.word() >> 40) as f32 / 8_388_608.0 - 1.0
    }
    fn vec3(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }
}

fn sets() -> Vec<Isa> {
    [Isa::Portable, Isa::Avx2].into_iter().filter(|i| i.is_here()).collect()
}

struct Soup {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    shapes: Vec<RoundShape>,
}

impl Soup {
    fn primitives(&self) -> Primitives<'_> {
        Primitives { positions: &self.positions, triangles: &self.triangles, shapes: &self.shapes }
    }
}

/// Triangles of every kind: ordinary, on a coarse grid (shared edges, coincident ones), degenerate, huge, tiny, far away.
fn soup(r: &mut Random) -> Soup {
    let n = 1 + r.below(150) as usize;
    let kind = r.below(6);
    let mut positions = Vec::new();
    for _ in 0..3 * n {
        let p = match kind {
            0 => r.vec3(),
            1 => Vec3::new(r.below(4) as f32, r.below(4) as f32, r.below(3) as f32),
            2 => r.vec3() * [1e-20, 1e-3, 1.0, 1e6, 1e15, 1e21][r.below(6) as usize],
            3 => r.vec3() * 1e-2 + Vec3::new(1000.0, 500.0, -300.0),
            4 => Vec3::new(r.below(3) as f32, 0.0, r.below(3) as f32),
            _ => r.vec3() * 4.0,
        };
        positions.push(p.to_array());
    }
    if kind == 5 {
        // Some that no box holds.
        positions[0][1] = f32::NAN;
        positions[n][0] = f32::INFINITY;
    }
    let vertex = |r: &mut Random| r.below(3 * n as u64) as u32;
    let triangles = (0..n as u32)
        .map(|i| match r.below(8) {
            0 => [vertex(r), vertex(r), vertex(r)],
            1 if i > 0 => [3 * i - 3, 3 * i - 2, 3 * i - 1],
            2 if r.below(8) == 0 => [u32::MAX, 0, 1],
            _ => [3 * i, 3 * i + 1, 3 * i + 2],
        })
        .collect();
    let shapes = (0..r.below(4))
        .map(|i| {
            let centre = r.vec3().to_array();
            if i % 2 == 0 {
                RoundShape::sphere(centre, 0.3)
            } else {
                RoundShape::disk(centre, [0.0, 0.0, 1.0], 0.5)
            }
        })
        .collect();
    Soup { positions, triangles, shapes }
}

fn ray(r: &mut Random, s: &Soup) -> Ray {
    let vertex = |r: &mut Random| Vec3::from_array(s.positions[r.below(s.positions.len() as u64) as usize]);
    let origin = match r.below(5) {
        // Far away, where no fused box test is allowed.
        3 => vertex(r) + r.vec3() * 100.0,
        0 => r.vec3() * 3.0,
        1 => vertex(r),
        2 => Vec3::new(r.below(5) as f32 - 1.0, r.below(5) as f32 - 1.0, r.below(5) as f32 - 1.0),
        _ => vertex(r) + r.vec3() * 5.0,
    };
    let direction = match r.below(5) {
        0 => vertex(r) - origin,
        1 => [Vec3::X, Vec3::NEG_Y, Vec3::Z][r.below(3) as usize],
        2 => 0.5 * (vertex(r) + vertex(r)) - origin,
        3 => Vec3::new(r.signed(), 0.0, r.signed()),
        _ => r.vec3(),
    };
    let kinds = if r.below(4) == 0 { 6 } else { 2 };
    let t_max = [f32::INFINITY, 1.0, 0.0, 2.5, -1.0, f32::NAN][r.below(kinds) as usize];
    Ray { origin, direction, t_max }
}

fn bits(h: Option<Hit>) -> Option<[u32; 4]> {
    h.map(|h| [h.t.to_bits(), h.primitive, h.b1.to_bits(), h.b2.to_bits()])
}

fn compare(seed: u64, soups: u32, rays: u32) {
    let mut r = Random(seed);
    let mut hits = 0;
    for k in 0..soups {
        let s = soup(&mut r);
        let oracle = BruteForce { primitives: s.primitives() };
        let trees: Vec<WideTree> =
            sets().into_iter().map(|i| WideTree::build(&s.primitives()).with_isa(i)).collect();
        let mut all = Vec::new();
        for _ in 0..rays {
            let ray = ray(&mut r, &s);
            hits += u32::from(agree(&trees, &oracle, &ray, || format!("soup {k} of seed {seed}")));
            all.push(ray);
            // Neighbours of some, for packets that stay together.
            while all.len() % 8 != 0 && r.below(12) != 0 {
                let origin = if r.below(2) == 0 { ray.origin } else { ray.origin + r.vec3() * 0.01 };
                let direction = ray.direction + r.vec3() * ray.direction.length() * 0.02;
                let t_max = if r.below(3) == 0 { 1.0 } else { ray.t_max };
                all.push(Ray { origin, direction, t_max });
            }
        }
        batches_agree(&trees, &all, k);
    }
    assert!(hits > soups * rays / 20, "too few rays hit anything: {hits}");
}

/// Rays by batches give what they give one by one.
fn batches_agree(trees: &[WideTree], rays: &[Ray], k: u32) {
    let mut found = vec![None; rays.len()];
    let mut occluded = vec![false; rays.len()];
    for tree in trees {
        tree.closest_hits(rays, &mut found);
        tree.any_hits(rays, &mut occluded);
        for ((ray, found), occluded) in rays.iter().zip(&found).zip(&occluded) {
            assert_eq!(bits(*found), bits(tree.closest_hit(ray)), "soup {k}, {:?}: {ray:?}", tree.isa());
            assert_eq!(*occluded, tree.occluded(ray), "soup {k}, {:?}: {ray:?}", tree.isa());
        }
    }
}

/// Whether the ray hits anything: the same for all.
fn agree(trees: &[WideTree], oracle: &BruteForce<'_>, ray: &Ray, what: impl Fn() -> String) -> bool {
    let expected = oracle.closest_hit(ray);
    for tree in trees {
        let found = tree.closest_hit(ray);
        assert_eq!(bits(found), bits(expected), "{}, {:?}: {ray:?}", what(), tree.isa());
        assert_eq!(tree.occluded(ray), expected.is_some(), "{}, {:?}: {ray:?}", what(), tree.isa());
    }
    expected.is_some()
}

#[test]
fn every_effort_gives_the_same_hits() {
    let mut r = Random(7);
    for k in 0..60 {
        let s = soup(&mut r);
        let oracle = BruteForce { primitives: s.primitives() };
        let trees = [Effort::Quick, Effort::Standard, Effort::Thorough]
            .map(|effort| WideTree::build_timed(&s.primitives(), effort).0);
        for _ in 0..100 {
            agree(&trees, &oracle, &ray(&mut r, &s), || format!("soup {k}"));
        }
    }
}

#[test]
fn a_refitted_tree_gives_the_hits_of_the_moved_scene() {
    let mut r = Random(8);
    let (mut refitted, mut hits) = (0, 0);
    for k in 0..200 {
        let mut s = soup(&mut r);
        let mut trees: Vec<WideTree> =
            sets().into_iter().map(|i| WideTree::build(&s.primitives()).with_isa(i)).collect();
        // A few frames: some vertices jump, some vanish, all drift; shapes follow.
        for frame in 0..3 {
            for p in &mut s.positions {
                match r.below(12) {
                    0 => *p = (r.vec3() * 5.0).to_array(),
                    1 if frame > 0 && r.below(20) == 0 => p[0] = f32::NAN,
                    _ => *p = (Vec3::from_array(*p) + r.vec3() * 0.1).to_array(),
                }
            }
            for shape in &mut s.shapes {
                *shape = RoundShape::sphere((r.vec3() * 2.0).to_array(), 0.2);
            }
            if trees.iter_mut().any(|t| t.refit(&s.primitives()).is_err()) {
                // A NaN of the first soup became a number.
                trees = sets().into_iter().map(|i| WideTree::build(&s.primitives()).with_isa(i)).collect();
            } else {
                refitted += 1;
            }
            let oracle = BruteForce { primitives: s.primitives() };
            for _ in 0..60 {
                let ray = ray(&mut r, &s);
                hits += u32::from(agree(&trees, &oracle, &ray, || format!("soup {k}, frame {frame}")));
            }
        }
    }
    assert!(refitted > 400 && hits > 2000, "{refitted} frames refitted, {hits} hits");
}

#[test]
fn a_tree_says_what_it_cannot_be_refitted_to() {
    let triangle = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mut positions = [triangle, triangle].concat();
    for p in &mut positions[3..] {
        p[0] = f32::NAN;
    }
    let scene = |positions: &[[f32; 3]], count: usize| Soup {
        positions: positions.to_vec(),
        triangles: [[0, 1, 2], [3, 4, 5]][..count].to_vec(),
        shapes: vec![],
    };
    let mut tree = WideTree::build(&scene(&positions, 2).primitives());
    let error = tree.refit(&scene(&positions, 1).primitives()).unwrap_err();
    assert_eq!(error, RefitError::Count { tree: [2, 0], scene: [1, 0] });
    positions[4][0] = 1.0;
    positions[3][0] = 0.0;
    positions[5][0] = 0.0;
    let error = tree.refit(&scene(&positions, 2).primitives()).unwrap_err();
    assert_eq!(error, RefitError::Appeared { primitive: 1 });
    // As it was: the first triangle alone.
    let ray = Ray { origin: Vec3::new(0.2, 0.2, 1.0), direction: Vec3::NEG_Z, t_max: 9.0 };
    assert_eq!(tree.closest_hit(&ray).map(|h| h.primitive), Some(0));
}

#[test]
fn a_batch_fills_what_it_is_given() {
    let mut r = Random(10);
    let s = soup(&mut r);
    let tree = WideTree::build(&s.primitives());
    let rays: Vec<Ray> = (0..21).map(|_| ray(&mut r, &s)).collect();
    let expected: Vec<_> = rays.iter().map(|ray| bits(tree.closest_hit(ray))).collect();
    for given in [0, 5, 8, 19, 21, 30] {
        let mut hits = vec![Some(Hit { t: -7.0, primitive: 0, b1: 0.0, b2: 0.0 }); given];
        let mut occluded = vec![true; given];
        tree.closest_hits(&rays, &mut hits);
        tree.any_hits(&rays, &mut occluded);
        for (i, hit) in hits.iter().enumerate() {
            if i < rays.len() {
                assert_eq!(bits(*hit), expected[i]);
                assert_eq!(occluded[i], expected[i].is_some());
            } else {
                assert_eq!(hit.unwrap().t, -7.0, "beyond the rays nothing is written");
            }
        }
    }
}

#[test]
fn what_moves_apart_costs_more() {
    let mut r = Random(9);
    let mut s = Soup { positions: vec![], triangles: vec![], shapes: vec![] };
    for i in 0..3000 {
        let centre = r.vec3() * 10.0;
        s.positions.extend([0; 3].map(|_| (centre + r.vec3() * 0.1).to_array()));
        s.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let mut tree = WideTree::build(&s.primitives());
    let built = tree.cost();
    let thorough = WideTree::build_timed(&s.primitives(), Effort::Thorough).0.cost();
    assert!(thorough <= built, "{thorough} with more effort, {built} with less");
    for p in &mut s.positions {
        *p = (Vec3::from_array(*p) + r.vec3() * 3.0).to_array();
    }
    tree.refit(&s.primitives()).unwrap();
    let new = WideTree::build(&s.primitives()).cost();
    assert!(tree.cost() > 1.2 * new, "{} of the refitted tree, {new} of a new one", tree.cost());
}

#[test]
fn every_walk_agrees_with_brute_force() {
    compare(1, 300, 200);
}

#[test]
#[ignore = "a minute: cargo nextest run -p etendue-cpu --run-ignored only every_walk_agrees_with_brute_force_at_length"]
fn every_walk_agrees_with_brute_force_at_length() {
    for seed in 2..42 {
        compare(seed, 1000, 300);
    }
}

#[test]
fn an_empty_scene_is_missed() {
    let s = Soup { positions: vec![], triangles: vec![], shapes: vec![] };
    let tree = WideTree::build(&s.primitives());
    let ray = Ray { origin: Vec3::ZERO, direction: Vec3::X, t_max: f32::INFINITY };
    assert!(tree.closest_hit(&ray).is_none() && !tree.occluded(&ray));
}

/// Nested boxes on one centre give a binary tree that is a chain; coincident triangles give no order at all.
#[test]
fn chains_and_heaps_stay_within_the_stack() {
    let mut positions = Vec::new();
    for k in 0..3000 {
        let x = 1.0 + k as f32 * 0.37;
        positions.extend([[-x, -x, 0.0], [x, -x, 0.0], [0.0, x, 0.0]]);
    }
    positions.extend([[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]].repeat(3000));
    let triangles = (0..6000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let s = Soup { positions, triangles, shapes: vec![] };
    let oracle = BruteForce { primitives: s.primitives() };
    for isa in sets() {
        let tree = WideTree::build(&s.primitives()).with_isa(isa);
        let mut r = Random(7);
        for _ in 0..300 {
            let ray = Ray { origin: r.vec3() * 40.0, direction: r.vec3(), t_max: f32::INFINITY };
            assert_eq!(bits(tree.closest_hit(&ray)), bits(oracle.closest_hit(&ray)));
            assert_eq!(tree.occluded(&ray), oracle.occluded(&ray));
        }
    }
}
