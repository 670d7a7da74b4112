// A triangle cut into n^2 equal ones.
//: use math::choice
//: use math::vector

struct LatticeCell { index: u32, corners: vec3<u32>, bary: vec3<f32> }

fn lattice_point(n: u32, i: u32, j: u32) -> u32 { return j * (2u * n + 3u - j) / 2u + i; }

fn lattice_corners(n: u32, i: u32, j: u32, upper: bool) -> vec3<u32> {
    if upper {
        return vec3(
            lattice_point(n, i + 1u, j + 1u),
            lattice_point(n, i, j + 1u),
            lattice_point(n, i + 1u, j),
        );
    }
    return vec3(lattice_point(n, i, j), lattice_point(n, i + 1u, j), lattice_point(n, i, j + 1u));
}

// The cell in which a point lies; any numbers lead to a cell of the lattice.
fn lattice_cell(n: u32, b1: f32, b2: f32) -> LatticeCell {
    let x = b1 * f32(n);
    let y = b2 * f32(n);
    let j = min(math_to_u32(y), n - 1u);
    let i = min(math_to_u32(x), n - 1u - j);
    let fx = math_clamp_number(x - f32(i), 0.0f, 1.0f);
    let fy = math_clamp_number(y - f32(j), 0.0f, 1.0f);
    let upper = fx + fy > 1.0f && i + j + 1u < n;
    var bary = vec3(math_max_number(1.0f - fx - fy, 0.0f), fx, fy);
    if upper { bary = vec3(fx + fy - 1.0f, 1.0f - fx, 1.0f - fy); }
    return LatticeCell(j * (2u * n - j) + 2u * i + u32(upper), lattice_corners(n, i, j, upper), bary);
}

// Barycentrics of vertices 1 and 2 of a point of a cell, from those in the cell.
fn lattice_in_cell(n: u32, index: u32, local: vec2<f32>) -> vec2<f32> {
    var j = 0u;
    while (j + 1u) * (2u * n - j - 1u) <= index { j += 1u; }
    let within = index - j * (2u * n - j);
    var p = local;
    if (within & 1u) == 1u { p = vec2(1.0f - local.x, 1.0f - local.y); }
    return vec2((f32(within / 2u) + p.x) / f32(n), (f32(j) + p.y) / f32(n));
}
