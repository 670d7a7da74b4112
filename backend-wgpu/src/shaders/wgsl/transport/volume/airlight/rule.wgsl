// Where the nodes along a segment of a ray lie, and what length each stands for.
//: use math::choice
//: use math::consts
//: use math::exp_ln
//: use math::inverse_trig
//: use math::trig
//: use math::vector
//: use wavefront::job

const RULE_TRAPEZOID: u32 = 0u;
const RULE_PLAIN: u32 = 1u;
const RULE_EQUIANGULAR: u32 = 2u;

// -ln of what transmittance counts as nothing for the plain rule.
const RULE_DEPTH_MAX: f32 = 13.815511f;
// Optical thickness below which steps of exp(-sigma t) are steps of t.
const RULE_THIN: f32 = 0.05f;
const RULE_ANGLE_MAX: f32 = HALF_PI - 3.0f * 1.1920929e-7f;

// Where the medium begins and ends; the end may be infinite. `sigma`: the least extinction of the channels that are scattered.
struct Segment { is_there: bool, begin: f32, end: f32, sigma: f32 }

// Where a light that is near lies beside a ray.
struct Foot { near: bool, along: f32, distance: f32 }

// A place on a segment, and the length that it stands for.
struct Node { found: bool, t: f32, weight: f32 }

// At equal steps to the end, or to where nothing is left.
fn rule_plain(s: Segment, i: u32) -> Node {
    var length = s.end - s.begin;
    if s.sigma > 0.0f { length = math_min_number(length, RULE_DEPTH_MAX / s.sigma); }
    if job.nodes == 1u { return Node(true, s.begin + 0.5f * length, length); }
    let step = length / f32(job.nodes - 1u);
    let ends = i == 0u || i == job.nodes - 1u;
    return Node(true, math_min_number(s.begin + f32(i) * step, s.end), select(step, 0.5f * step, ends));
}

// At equal steps of 1 - exp(-sigma t).
fn rule_exponential(s: Segment, x: f32, n: f32) -> Node {
    let all = 1.0f - math_exp(-s.sigma * (s.end - s.begin));
    let left = 1.0f - x * all;
    let t = math_min_number(s.begin - math_ln(left) / s.sigma, s.end);
    return Node(true, t, all / (n * s.sigma * left));
}

// At equal angles about the light.
fn rule_equiangular(s: Segment, x: f32, n: f32, foot: Foot) -> Node {
    let a = math_atan2(s.begin - foot.along, foot.distance);
    let b = math_atan2(s.end - foot.along, foot.distance);
    let turn = math_sin_cos(math_clamp_number(a + x * (b - a), -RULE_ANGLE_MAX, RULE_ANGLE_MAX));
    let off = foot.distance * (turn.s / turn.c);
    let t = math_clamp_number(foot.along + off, s.begin, s.end);
    // Divided first: no square that overflows.
    let ratio = off / foot.distance;
    return Node(true, t, (b - a) * foot.distance * (1.0f + ratio * ratio) / n);
}

// Node `i`; `u`: where the first one lies within its step.
fn rule_node(s: Segment, i: u32, u: f32, foot: Foot) -> Node {
    let n = f32(job.nodes);
    let x = math_min_number((f32(i) + u) / n, ONE_MINUS_EPSILON);
    let length = s.end - s.begin;
    let deep = length * s.sigma;
    var node = Node(true, s.begin + x * length, length / n);
    if job.rule == RULE_PLAIN {
        node = rule_plain(s, i);
    } else if job.rule == RULE_EQUIANGULAR && foot.near {
        node = rule_equiangular(s, x, n, foot);
    } else if deep > select(RULE_DEPTH_MAX, RULE_THIN, job.rule == RULE_EQUIANGULAR) {
        node = rule_exponential(s, x, n);
    }
    node.found = math_is_finite(node.t) && math_is_finite(node.weight) && node.weight > 0.0f;
    return node;
}
