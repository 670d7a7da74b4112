//! The grid of barycentrics against core, whose areas have 64 bits.

use super::{root_of, run};
use crate::Options;
use crate::gpu::Source;
use crate::shaders::Link;
use etendue_core::direct::subdivide::{Bary, GRID, signed_area};
use etendue_core::sampling::counter::Counter;

const COUNT: u32 = 1 << 16;

const TWIN: &str = "
fn twin() {
    let a = vec2(word(), word());
    let b = vec2(word(), word());
    let c = vec2(word(), word());
    let middle = subdivide_bary_midpoint(a, b);
    let centroid = subdivide_bary_centroid(a, b, c);
    put_word(u32(subdivide_bary_has_area(a, b, c)));
    put_word(u32(subdivide_bary_is_even(a, b)));
    put_word(middle.x);
    put_word(middle.y);
    put_word(centroid.x);
    put_word(centroid.y);
}
";

#[test]
fn points_and_signs_of_areas_are_cores() {
    let numbers = Counter::new(5);
    let (mut items, mut expected) = (Vec::new(), Vec::new());
    let mut tight = 0;
    for i in 0..COUNT {
        let draw = |k: u32, n: u32| ((u64::from(numbers.bits(11, i, k)) * u64::from(n)) >> 32) as u32;
        // Anywhere; within a few steps; and two long edges side by side, whose end is moved by a step or not.
        let first = [draw(0, GRID / 2 + 1), draw(1, GRID / 2 + 1)];
        let extent = if i % 4 == 1 { 3 } else { GRID / 4 };
        let [u, v] = [[draw(2, extent), draw(3, extent)], [draw(4, extent), draw(5, extent)]];
        let v = if i % 4 > 1 { [u[0] / 2 + draw(6, 2), u[1] / 2 + draw(7, 2)] } else { v };
        let corners = [first, [first[0] + u[0], first[1] + u[1]], [first[0] + v[0], first[1] + v[1]]];
        let Some(points) = corners.map(|[x, y]| Bary::try_new(x, y)).into_iter().collect::<Option<Vec<_>>>()
        else {
            continue;
        };
        let area = signed_area([points[0], points[1], points[2]]);
        tight += u32::from(area.unsigned_abs() < 1 << 24);
        items.extend(corners.as_flattened());
        let (middle, even) = points[0].midpoint(points[1]);
        let [_, m1, m2] = middle.steps();
        let [_, c1, c2] = Bary::centroid([points[0], points[1], points[2]]).steps();
        expected.extend([u32::from(area > 0), u32::from(even), m1, m2, c1, c2]);
    }
    assert!(expected.len() > 240_000 && tight > 10_000, "{} {tight}", expected.len());
    let gpu = pollster::block_on(Source::request(None, Options::default())).unwrap().gpu();
    let root = root_of("direct::subdivide::bary", "twin", [6, 6]) + TWIN;
    let link = Link { root: &root, features: &[], mutations: &[] };
    let mut found = vec![0; expected.len()];
    run(&gpu, "areas", link, [6, 6], &[], &items, &mut found).unwrap();
    let cases = items.chunks(6).zip(found.chunks(6).zip(expected.chunks(6)));
    let wrong: Vec<_> = cases.filter(|(_, (found, expected))| found != expected).collect();
    assert!(wrong.is_empty(), "{} {:?}", wrong.len(), wrong[0]);
}
