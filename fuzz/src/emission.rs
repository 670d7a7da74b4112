//! Target `emission`: albedos of pieces stay between the darkest and the brightest texel and below the bound, two ways
//! to the same integral agree, halves add up to the whole, and a table keeps the flux.

use etendue_core::direct::emission::{
    Bitmap, EmissionTable, Exact, PieceAlbedo, Published, RowSums, Texels, VertexAlbedo, emission_textured,
    importance, overlap_unit, piece_area, scan, scan_texels,
};
use etendue_core::math::Vec3;
use etendue_core::scene::{TextureRecord, srgb_to_linear};

fn float(bytes: &[u8], i: usize, raw: bool) -> f32 {
    if raw {
        let at = |k: usize| bytes.get(4 * i + k).copied().unwrap_or(0);
        f32::from_bits(u32::from_le_bytes([at(0), at(1), at(2), at(3)]))
    } else {
        // Eighths within four periods: corners and edges of texels are common.
        f32::from(bytes.get(i).copied().unwrap_or(0) as i8) / 32.0
    }
}

fn middle(p: [f32; 2], q: [f32; 2]) -> [f32; 2] {
    [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]
}

/// Longest edge over least height of a piece over the texels: what multiplies the rounding of its coordinates.
fn thinness(uv: [[f32; 2]; 3], size: [u32; 2]) -> f32 {
    let p = uv.map(|p| [0, 1].map(|k| f64::from(p[k]) * f64::from(size[k])));
    let edge = |i: usize, j: usize| [0, 1].map(|k| p[j][k] - p[i][k]);
    let (e, f, g) = (edge(0, 1), edge(0, 2), edge(1, 2));
    let longest = [e, f, g].iter().map(|d| d[0] * d[0] + d[1] * d[1]).fold(0.0, f64::max);
    let twice = (e[0] * f[1] - e[1] * f[0]).abs();
    // A line is as good as its length: see `scan`.
    if twice > 0.0 { (longest / twice).min(1e9) as f32 } else { longest.sqrt() as f32 / 16.0 }
}

/// Mode and sides, then the numbers (24 bytes raw, 6 otherwise, twice as many again for the piece), then the texels.
pub fn emission(bytes: &[u8]) {
    let [mode, width, height, rest @ ..] = bytes else { return };
    let raw = mode & 1 != 0;
    let (width, height) = (u32::from(width % 16) + 1, u32::from(height % 16) + 1);
    let words = if raw { 4 } else { 1 };
    let (numbers, codes) = rest.split_at(rest.len().min(18 * words));
    let texels: Vec<u32> = (0..width * height)
        .map(|i| {
            let at = |k: usize| u32::from(codes.get(i as usize * 3 + k).copied().unwrap_or(0));
            at(0) | at(1) << 8 | at(2) << 16
        })
        .collect();
    let decode: Vec<f32> = (0..=255).map(srgb_to_linear).collect();
    let record = TextureRecord { width, height, first_texel: 0, pad: 0 };
    let bitmap = Bitmap::try_new(&record, &texels, &decode).expect("a bitmap");
    let uv = [0, 1, 2].map(|k| [float(numbers, 2 * k, raw), float(numbers, 2 * k + 1, raw)]);

    let (mut least, mut most) = (Vec3::ONE, Vec3::ZERO);
    for i in 0..width * height {
        let texel = Vec3::from_array(bitmap.texel(i % width, i / width));
        (least, most) = (least.min(texel), most.max(texel));
    }
    let exact = Exact::new(bitmap).with_max_cells(4096.0);
    let bound = exact.brightest(uv);
    let within = |a: &VertexAlbedo, bound: Vec3| {
        for at in a.at {
            assert!(at.cmple(bound).all(), "{uv:?}: {at} above {bound}");
            assert!(at.cmpge(least * (1.0 - 1e-4)).all(), "{uv:?}: {at} below {least}");
        }
    };
    let whole = exact.vertex_albedo(uv);
    within(&whole, bound);
    within(&Published::new(bitmap, 64.0).vertex_albedo(uv), most);
    if let Some(texels) = scan_texels(&bitmap, uv, 4096.0) {
        within(&texels, bound);
    }
    if let Some(cells) = scan(&bitmap, uv, 4096.0) {
        within(&cells, bound);
        if let Some(edges) = RowSums::new(&bitmap).vertex_albedo(&bitmap, uv, 4096.0) {
            let rounding = thinness(uv, [width, height]) / 1_048_576.0;
            for (a, b) in cells.at.iter().zip(edges.at) {
                assert!(
                    (*a - b).abs().max_element() <= 1e-5 + rounding,
                    "{uv:?}: {a} by cells, {b} by edges"
                );
            }
        }
        // Halves, where the middle is exact: the mean of the two is the whole's.
        let m = middle(uv[0], uv[1]);
        let fits =
            [0, 1].iter().all(|k| f64::from(m[*k]) == 0.5 * (f64::from(uv[0][*k]) + f64::from(uv[1][*k])));
        let halves = [[uv[0], m, uv[2]], [m, uv[1], uv[2]]].map(|h| scan(&bitmap, h, 4096.0));
        if let (true, [Some(a), Some(b)]) = (fits, halves) {
            let error = (0.5 * (a.mean() + b.mean()) - cells.mean()).abs().max_element();
            let rounding = thinness(uv, [width, height]) / 524_288.0;
            assert!(error <= 1e-5 + rounding, "{uv:?}: halves are off by {error}");
        }
    }
    let cell = overlap_unit(uv);
    assert!((0.0..=1.0).contains(&cell.share) && cell.bary.iter().all(|b| (0.0..=1.0).contains(b)));

    let v =
        |k: usize| Vec3::new(float(numbers, k, raw), float(numbers, k + 1, raw), float(numbers, k + 2, raw));
    let corners = [v(6), v(9), v(12)];
    let area = piece_area(corners);
    assert!((0.0..=f32::MAX).contains(&area), "{corners:?}: {area}");
    let turned = piece_area([corners[1], corners[2], corners[0]]);
    // Thin ones keep their digits to 2^-44 of the longest edge's square.
    let longest = [(0, 1), (1, 2), (2, 0)]
        .iter()
        .map(|(i, j)| {
            let d = [0, 1, 2].map(|k| f64::from(corners[*i][k]) - f64::from(corners[*j][k]));
            d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
        })
        .fold(0.0_f64, f64::max);
    if longest.is_finite() {
        let slack = 2.4e-7 * f64::from(area) + longest * 1.2e-13 + 1e-44;
        assert!((f64::from(area) - f64::from(turned)).abs() <= slack, "{corners:?}: {area}, turned {turned}");
    }
    let light = [v(3), v(12), v(15)];
    let em = emission_textured(Vec3::ONE, area, light, &whole);
    let limit = emission_textured(Vec3::ONE, area, light, &VertexAlbedo::uniform(bound));
    for x in em.to_array() {
        assert!((0.0..=f32::MAX).contains(&x), "{em}");
    }
    assert!(importance(em, limit) >= importance(em, em) * 0.999_999);
    let mut table = EmissionTable::new();
    let kept = table.push_pair(0, 0, em, limit).expect("fluxes");
    assert_eq!(kept, limit.max_element() > 0.0 || em.max_element() > 0.0);
    for k in 1..4 {
        table.push_pair(k, 0, em, limit).expect("fluxes");
    }
    if kept {
        let density = table.density().expect("weights");
        let mean: f64 = (0..table.len() as u32)
            .map(|i| {
                density.count(i) as f64 / 4_294_967_296.0 * f64::from(table.start_flux(i, density.pmf(i)).x)
            })
            .sum();
        let total = table.sum().flux_f64()[0];
        if total < 1e37 {
            assert!((mean - total).abs() <= 1e-6 * total + 1e-40, "{mean} for {total}");
        }
    }
}
