// The shape of a triangle, as far as a criterion looks at it.
//: use math::bits
//: use math::rounding
//: use math::vector

// Edges opposite the corners, up to a common power of two, and the share of the parent.
struct SubdivideShape {
    edges: array<vec3<f32>, 3>,
    squares: vec3<f32>,
    fraction: f32,
}

fn subdivide_is_finite(v: vec3<f32>) -> bool {
    return math_is_finite(v.x) && math_is_finite(v.y) && math_is_finite(v.z);
}

fn subdivide_shape(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, fraction: f32) -> SubdivideShape {
    var edges = array(c - b, a - c, b - a);
    var largest = 0.0f;
    var finite = true;
    for (var i = 0u; i < 3u; i++) {
        let e = edges[i];
        largest = math_max(math_max_component(vec3(math_abs(e.x), math_abs(e.y), math_abs(e.z))), largest);
        finite = finite && subdivide_is_finite(e);
    }
    if largest <= 0.0f || !finite {
        return SubdivideShape(array(vec3(0.0f), vec3(0.0f), vec3(0.0f)), vec3(0.0f), fraction);
    }
    let k = -math_exponent(largest);
    let f1 = math_ldexp(1.0f, k >> 1u);
    let f2 = math_ldexp(1.0f, k - (k >> 1u));
    var squares = vec3(0.0f);
    for (var i = 0u; i < 3u; i++) {
        let e = edges[i] * f1 * f2;
        edges[i] = e;
        squares[i] = math_dot(e, e);
    }
    return SubdivideShape(edges, squares, fraction);
}

fn subdivide_opposite_longest(shape: SubdivideShape) -> u32 {
    let s = shape.squares;
    if s.x >= s.y && s.x >= s.z { return 0u; }
    return select(2u, 1u, s.y >= s.z);
}

// 3 where no corner is obtuse.
fn subdivide_obtuse_corner(shape: SubdivideShape) -> u32 {
    let a = shape.edges[0];
    let b = shape.edges[1];
    let c = shape.edges[2];
    if math_dot(b, c) > 0.0f { return 0u; }
    if math_dot(c, a) > 0.0f { return 1u; }
    if math_dot(a, b) > 0.0f { return 2u; }
    return 3u;
}

// Whether the longest edge's square is more than so many times the shortest one's.
fn subdivide_is_longer(shape: SubdivideShape, times: f32) -> bool {
    let s = shape.squares;
    let long = math_max(s.x, math_max(s.y, s.z));
    let short = math_min(s.x, math_min(s.y, s.z));
    return long > times * short;
}

fn subdivide_is_elongated(shape: SubdivideShape) -> bool { return subdivide_is_longer(shape, 2.5f); }

fn subdivide_is_needle(shape: SubdivideShape) -> bool { return subdivide_is_longer(shape, 16.0f); }
