// The shape of a triangle, as far as a criterion looks at it.
//: use direct::subdivide::bary
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

// From the edges opposite the corners.
fn subdivide_shape_of(edges: array<vec3<f32>, 3>, fraction: f32) -> SubdivideShape {
    let squares = vec3(
        math_dot(edges[0], edges[0]),
        math_dot(edges[1], edges[1]),
        math_dot(edges[2], edges[2]),
    );
    return SubdivideShape(edges, squares, fraction);
}

// Edges times a power of two, the largest component in [1, 2), and the two factors of that power; zeros where edges are all zero or not finite.
struct SubdivideScaled { edges: array<vec3<f32>, 3>, factors: vec2<f32> }

fn subdivide_scaled(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> SubdivideScaled {
    var scaled = SubdivideScaled(array(c - b, a - c, b - a), vec2(1.0f));
    var largest = 0.0f;
    var finite = true;
    for (var i = 0u; i < 3u; i++) {
        let e = scaled.edges[i];
        largest = math_max(math_max_component(vec3(math_abs(e.x), math_abs(e.y), math_abs(e.z))), largest);
        finite = finite && subdivide_is_finite(e);
    }
    let has_extent = largest > 0.0f && finite;
    let k = -math_exponent(largest);
    let factors = vec2(math_ldexp(1.0f, k >> 1u), math_ldexp(1.0f, k - (k >> 1u)));
    for (var i = 0u; i < 3u; i++) {
        let e = scaled.edges[i] * factors.x * factors.y;
        scaled.edges[i] = select(vec3(0.0f), e, has_extent);
    }
    if has_extent { scaled.factors = factors; }
    return scaled;
}

fn subdivide_shape(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, fraction: f32) -> SubdivideShape {
    return subdivide_shape_of(subdivide_scaled(a, b, c).edges, fraction);
}

// The parent in a scaled unit, from which the edges of pieces come: a sum of its two shorter edges. `apex`: the corner opposite the longest.
struct SubdivideFrame { apex: u32, x: vec3<f32>, y: vec3<f32>, factors: vec2<f32>, degenerate: bool }

fn subdivide_frame(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> SubdivideFrame {
    var scaled = subdivide_scaled(a, b, c);
    let apex = subdivide_opposite_longest(subdivide_shape_of(scaled.edges, 1.0f));
    let n = math_cross(scaled.edges[2], scaled.edges[0]);
    let has_area = (n.x != 0.0f || n.y != 0.0f || n.z != 0.0f)
        && !math_is_nan(n.x) && !math_is_nan(n.y) && !math_is_nan(n.z);
    let x = scaled.edges[(apex + 2u) % 3u];
    let y = -scaled.edges[(apex + 1u) % 3u];
    return SubdivideFrame(apex, x, y, scaled.factors, !has_area);
}

fn subdivide_frame_edge(frame: SubdivideFrame, origin: vec2<u32>, end: vec2<u32>) -> vec3<f32> {
    let d = subdivide_bary_minus(end, origin);
    return frame.x * d[(frame.apex + 1u) % 3u] + frame.y * d[(frame.apex + 2u) % 3u];
}

fn subdivide_frame_shape(frame: SubdivideFrame, corners: array<vec2<u32>, 3>, fraction: f32) -> SubdivideShape {
    let edges = array(
        subdivide_frame_edge(frame, corners[1], corners[2]),
        subdivide_frame_edge(frame, corners[2], corners[0]),
        subdivide_frame_edge(frame, corners[0], corners[1]),
    );
    return subdivide_shape_of(edges, fraction);
}

// A length in the scaled unit, squared; infinite lengths stay so.
fn subdivide_frame_square(frame: SubdivideFrame, length: f32) -> f32 {
    let x = math_max(length, 0.0f) * frame.factors.x * frame.factors.y;
    return x * x;
}

fn subdivide_opposite_longest(shape: SubdivideShape) -> u32 {
    let s = shape.squares;
    return select(select(2u, 1u, s.y >= s.z), 0u, s.x >= s.y && s.x >= s.z);
}

// 3 where no corner is obtuse.
fn subdivide_obtuse_corner(shape: SubdivideShape) -> u32 {
    let a = shape.edges[0];
    let b = shape.edges[1];
    let c = shape.edges[2];
    let last = select(3u, 2u, math_dot(a, b) > 0.0f);
    return select(select(last, 1u, math_dot(c, a) > 0.0f), 0u, math_dot(b, c) > 0.0f);
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
