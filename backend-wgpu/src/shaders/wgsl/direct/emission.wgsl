// Emission coefficients: area of a piece, and what it sends on under a linear irradiance.
//: use math::bits
//: use math::roots
//: use math::rounding
//: use math::sums
//: use math::vector

fn emission_clean(x: f32) -> f32 {
    if x > 0.0f { return math_min(x, MAX_FLOAT); }
    return 0.0f;
}

fn emission_scaled(x: f32, k: i32) -> f32 { return math_min(math_ldexp(x, k), MAX_FLOAT); }

fn emission_ldexp3(v: vec3<f32>, k: i32) -> vec3<f32> {
    return vec3(math_ldexp(v.x, k), math_ldexp(v.y, k), math_ldexp(v.z, k));
}

fn emission_abs3(v: vec3<f32>) -> vec3<f32> { return vec3(math_abs(v.x), math_abs(v.y), math_abs(v.z)); }

fn emission_largest(v: vec3<f32>) -> f32 {
    return math_max(math_max(math_max(0.0f, math_abs(v.x)), math_abs(v.y)), math_abs(v.z));
}

// An edge in two parts, times 2^-k.
struct EmissionEdge { high: vec3<f32>, low: vec3<f32>, k: i32 }

fn emission_edge(p: vec3<f32>, a: vec3<f32>) -> EmissionEdge {
    let x = math_two_sum(p.x, -a.x);
    let y = math_two_sum(p.y, -a.y);
    let z = math_two_sum(p.z, -a.z);
    let high = vec3(x.value, y.value, z.value);
    let k = math_exponent(emission_largest(high));
    return EmissionEdge(emission_ldexp3(high, -k), emission_ldexp3(vec3(x.error, y.error, z.error), -k), k);
}

// e_i f_j - e_j f_i
fn emission_minor(e: EmissionEdge, f: EmissionEdge, i: u32, j: u32) -> f32 {
    let p = math_two_prod(e.high[i], f.high[j]);
    let q = math_two_prod(e.high[j], f.high[i]);
    let s = math_two_sum(p.value, -q.value);
    let cross = (e.high[i] * f.low[j] + e.low[i] * f.high[j]) - (e.high[j] * f.low[i] + e.low[j] * f.high[i]);
    return s.value + math_kept(s.error + math_kept(math_kept(p.error - q.error) + cross));
}

fn emission_is_finite(v: vec3<f32>) -> bool {
    return math_is_finite(v.x) && math_is_finite(v.y) && math_is_finite(v.z);
}

fn emission_piece_area(a_in: vec3<f32>, b_in: vec3<f32>, c_in: vec3<f32>) -> f32 {
    var extent = math_max(0.0f, math_max_component(emission_abs3(a_in)));
    extent = math_max(extent, math_max_component(emission_abs3(b_in)));
    extent = math_max(extent, math_max_component(emission_abs3(c_in)));
    let finite = emission_is_finite(a_in) && emission_is_finite(b_in) && emission_is_finite(c_in);
    if !finite || extent == 0.0f { return 0.0f; }
    let k = select(0, 2, extent > 1e37f);
    let a = emission_ldexp3(a_in, -k);
    let e = emission_edge(emission_ldexp3(b_in, -k), a);
    let f = emission_edge(emission_ldexp3(c_in, -k), a);
    let cross = vec3(
        emission_minor(e, f, 1u, 2u),
        emission_minor(e, f, 2u, 0u),
        emission_minor(e, f, 0u, 1u),
    );
    let largest = emission_largest(cross);
    if largest == 0.0f { return 0.0f; }
    let k3 = math_exponent(largest);
    let v = emission_ldexp3(cross, -k3);
    return emission_scaled(math_sqrt(math_dot(v, v)), 2 * k + e.k + f.k + k3 - 1);
}

// A number times 2^k.
struct EmissionMean { mean: f32, k: i32 }

// One channel of (A0 I0 + A1 I1 + A2 I2) / 3.
fn emission_weighted_irradiance(a: vec3<f32>, irradiance: vec3<f32>) -> EmissionMean {
    let e0 = emission_clean(irradiance.x);
    let e1 = emission_clean(irradiance.y);
    let e2 = emission_clean(irradiance.z);
    let k = math_exponent(math_max(e0, math_max(e1, e2)));
    let t0 = emission_clean(a.x) * math_ldexp(e0, -k);
    let t1 = emission_clean(a.y) * math_ldexp(e1, -k);
    let t2 = emission_clean(a.z) * math_ldexp(e2, -k);
    return EmissionMean(((t0 + t1) + t2) / 3.0f, k);
}

// Irradiance and texture at the vertices.
fn emission_textured(
    albedo: vec3<f32>,
    area_in: f32,
    irradiance: array<vec3<f32>, 3>,
    texture: array<vec3<f32>, 3>,
) -> vec3<f32> {
    let clean = emission_clean(area_in);
    let ks = math_exponent(clean);
    let area = math_ldexp(clean, -ks);
    var out = vec3(0.0f);
    for (var c = 0u; c < 3u; c++) {
        let m = emission_weighted_irradiance(
            vec3(texture[0][c], texture[1][c], texture[2][c]),
            vec3(irradiance[0][c], irradiance[1][c], irradiance[2][c]),
        );
        let own = emission_clean(albedo[c]);
        let km = math_exponent(m.mean);
        let ka = math_exponent(own);
        out[c] = emission_scaled(math_ldexp(m.mean, -km) * area * math_ldexp(own, -ka), m.k + km + ka + ks);
    }
    return out;
}

fn emission_emission(albedo: vec3<f32>, area: f32, irradiance: array<vec3<f32>, 3>) -> vec3<f32> {
    return emission_textured(albedo, area, irradiance, array(vec3(1.0f), vec3(1.0f), vec3(1.0f)));
}
