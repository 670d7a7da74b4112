//! Target `subdivide`.

use etendue_core::direct::subdivide::{
    Criterion, End, Irradiance, LARGEST, Limits, Node, Piece, Published, Robust, Samples, Shape, Verdict,
    WHOLE_AREA, Workspace, refine, signed_area,
};
use etendue_core::math::Vec3;

fn float(b: &[u8]) -> f32 {
    f32::from_le_bytes([b[0], b[1], b[2], b[3]])
}

/// Irradiance at a place: one of the table's values, which may be any float. Coarse cells, so that neighbours are often equal,
/// or the places themselves mixed, so that they never are.
fn irradiance(table: &[f32], fine: bool, b: [f32; 3]) -> f32 {
    let place = if fine {
        b[1].to_bits().wrapping_mul(0x9E37_79B1) ^ b[2].to_bits().wrapping_mul(0x85EB_CA77) >> 7
    } else {
        (b[1] * 8.0) as u32 * 9 + (b[2] * 8.0) as u32
    };
    table.get(place as usize % table.len().max(1)).copied().unwrap_or(0.0)
}

/// What any list of pieces must be.
fn check(pieces: &[Piece<f32>], samples: u32, budget: usize, exact: bool, light: impl Fn([f32; 3]) -> f32) {
    assert!(!pieces.is_empty() && pieces.len() <= budget.max(1));
    assert!(samples as usize <= 3 + 14 * pieces.len(), "{samples} samples for {} pieces", pieces.len());
    let mut area = 0;
    for p in pieces {
        assert!(signed_area(p.corners) > 0, "{p:?}");
        area += signed_area(p.corners);
        assert!(p.fraction > 0.0 && p.fraction <= 1.0);
        assert!(p.end != End::Degenerate || pieces.len() == 1);
        for (corner, l) in p.corners.iter().zip(p.irradiance) {
            assert!((0.0..=LARGEST).contains(&l));
            assert_eq!(l, light(corner.to_f32()).bounded());
        }
    }
    // A midpoint off the grid moves an edge by half a step at most.
    let slack = if exact { 0 } else { pieces.len() as i64 * (WHOLE_AREA >> 24) };
    assert!((area - WHOLE_AREA).abs() <= slack, "{area} of {WHOLE_AREA} in {} pieces", pieces.len());
}

fn both<C: Criterion>(
    corners: [Vec3; 3],
    criterion: &C,
    limits: &Limits,
    exact: bool,
    light: impl Fn([f32; 3]) -> f32 + Copy,
) {
    let mut work = Workspace::new();
    let mut pieces = Vec::new();
    let summary = work.subdivide(corners, criterion, limits, light, |p| pieces.push(p));
    assert_eq!(summary.pieces as usize, pieces.len());
    check(&pieces, summary.samples, limits.budget as usize, exact, light);
    let mut again = Vec::new();
    let second = work.subdivide(corners, criterion, limits, light, |p| again.push(p));
    assert_eq!((summary, &pieces), (second, &again), "the same job gives the same pieces");
    let mut nodes = vec![Node::default(); limits.budget.max(1) as usize];
    let summary = refine(corners, criterion, limits, &mut work, &mut nodes, light);
    let pieces: Vec<_> = nodes[..summary.pieces as usize].iter().map(Node::piece).collect();
    check(&pieces, summary.samples, limits.budget as usize, exact, light);
}

/// Mode, limits, tolerances, corners, then a table of irradiance: pieces tile the triangle within their budget, whatever the numbers are.
pub fn subdivide(bytes: &[u8]) {
    let Some((head, rest)) = bytes.split_at_checked(6) else { return };
    let Some((numbers, table)) = rest.split_at_checked(4 * 14) else { return };
    let mut values: Vec<f32> = numbers.chunks_exact(4).map(float).collect();
    if head[0] & 1 == 1 {
        // Small numbers, so that right angles, equal edges and triangles without area are common.
        values = numbers.iter().map(|b| f32::from(*b as i8) * 0.25).collect();
    }
    let table: Vec<f32> = if head[0] & 2 == 0 {
        table.chunks_exact(4).take(256).map(float).collect()
    } else {
        table.iter().take(256).map(|b| f32::from(*b)).collect()
    };
    let fine = head[0] & 4 == 4;
    let light = |b: [f32; 3]| irradiance(&table, fine, b);
    let corner = |i: usize| Vec3::new(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
    let corners = [corner(0), corner(1), corner(2)];
    let limits = Limits {
        size: values[12],
        largest: values[13],
        least_depth: head[1] % 4,
        depth: head[2],
        budget: u32::from(head[3]) * 2,
    };
    let robust = Robust { relative: values[9], absolute: values[10], share: values[11] };
    both(corners, &robust, &limits, true, light);
    let tolerant = Published { relative: values[9], absolute: values[10] };
    both(corners, &tolerant, &limits, false, light);
    // Knowing everything no rule asks for more, and errors are numbers.
    let all =
        Samples::all(std::array::from_fn(|i| table.get(i + usize::from(head[4])).copied().unwrap_or(0.0)));
    let shape = Shape::new(corners, f32::from(head[5]) / 255.0);
    for verdict in [robust.examine(&shape, &all, values[11].abs()), tolerant.examine(&shape, &all, 0.0)] {
        match verdict {
            Verdict::Probe(p) => panic!("{p:?} is known"),
            Verdict::Accept => {}
            Verdict::Cut { error, rest, bend, .. } => {
                assert!([error, rest, bend].iter().all(|x| *x >= 0.0 && x.is_finite()), "{verdict:?}");
            }
        }
    }
}
