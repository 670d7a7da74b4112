// The mended rule: edge probes, a tolerance, bounded angles.
//: use direct::subdivide::criterion
//: use direct::subdivide::shape
//: use math::roots

const SUBDIVIDE_SMOOTH: f32 = 0.125f;
const SUBDIVIDE_LEAP: f32 = 0.25f;
const SUBDIVIDE_LEAP_ERROR: f32 = 0.75f;
const SUBDIVIDE_ENOUGH: f32 = 0.5f;
const SUBDIVIDE_GENTLE: f32 = 0.25f;
const SUBDIVIDE_STRAIGHT: f32 = 0.25f;

struct SubdivideRobust { relative: f32, absolute: f32, share: f32 }

fn subdivide_largest_of(d: vec3<f32>) -> f32 {
    return math_max(math_max(math_abs(d.x), math_abs(d.y)), math_abs(d.z));
}

fn subdivide_mean_error(d: vec3<f32>, r_in: f32) -> f32 {
    let largest = math_max(subdivide_largest_of(d), math_abs(r_in));
    let scale = select(1.0f, largest, largest > 0.0f);
    let a = d.x / scale;
    let b = d.y / scale;
    let c = d.z / scale;
    let r = r_in / scale;
    let sum = (a + b) + c;
    let squares = (a * a + b * b) + c * c;
    let error = largest * math_sqrt((4.0f / 45.0f) * (squares + sum * sum) + (81.0f / 280.0f) * (r * r));
    return select(0.0f, error, largest > 0.0f);
}

// 3 where no edge is crossed.
fn subdivide_longest_crossed(shape: SubdivideShape, samples: ptr<function, SubdivideSamples>) -> u32 {
    let squares = shape.squares;
    var found = 3u;
    var longest = 0.0f;
    for (var i = 0u; i < 3u; i++) {
        let p = (*samples).values[(i + 1u) % 3u] > 0.0f;
        let q = (*samples).values[(i + 2u) % 3u] > 0.0f;
        if p != q && (found == 3u || squares[i] > longest) {
            found = i;
            longest = squares[i];
        }
    }
    return found;
}

// Error and largest deviation.
fn subdivide_expected(d: vec3<f32>, r: f32) -> vec2<f32> {
    let lift = (4.0f / 9.0f) * ((d.x + d.y) + d.z) + r;
    return vec2(subdivide_mean_error(d, r), math_max(subdivide_largest_of(d), math_abs(lift)));
}

fn subdivide_worst(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2(math_max(a.x, b.x), math_max(a.y, b.y));
}

fn subdivide_tolerance(rule: SubdivideRobust, largest: f32) -> f32 {
    return math_max(rule.relative, 0.0f) * largest + math_max(rule.absolute, 0.0f);
}

fn subdivide_is_small(rule: SubdivideRobust, shape: SubdivideShape, error: f32) -> bool {
    return error * math_sqrt_clamped(shape.fraction) <= math_max(rule.share, 0.0f);
}

// What a leap at the midpoint of edge `e` says: its error, or less than 0 where there is none that matters.
fn subdivide_leap(
    rule: SubdivideRobust, shape: SubdivideShape, samples: ptr<function, SubdivideSamples>, e: u32, rest: f32,
) -> f32 {
    let p = (*samples).values[(e + 1u) % 3u];
    let q = (*samples).values[(e + 2u) % 3u];
    let l = (*samples).values[SUBDIVIDE_MIDPOINT + e];
    let off = math_abs(l - subdivide_linear_midpoint(samples, e));
    let brightest = math_max(l, math_max(p, q));
    let error = SUBDIVIDE_LEAP_ERROR * off;
    let leap = off > SUBDIVIDE_LEAP * brightest && error >= SUBDIVIDE_ENOUGH * rest;
    let matters = leap && off > subdivide_tolerance(rule, brightest) && !subdivide_is_small(rule, shape, error);
    return select(-1.0f, error, matters);
}

// All seven points are known.
fn subdivide_robust_judge(
    rule: SubdivideRobust,
    shape: SubdivideShape,
    samples: ptr<function, SubdivideSamples>,
) -> SubdivideVerdict {
    let a = subdivide_opposite_longest(shape);
    let halves = SubdivideSplit(SUBDIVIDE_TWO, a);
    var d = vec3(0.0f);
    for (var i = 0u; i < 3u; i++) {
        d[i] = (*samples).values[SUBDIVIDE_MIDPOINT + i] - subdivide_linear_midpoint(samples, i);
    }
    let bend = subdivide_largest_of(d);
    var brightest = 0.0f;
    var dark = false;
    for (var i = 0u; i < SUBDIVIDE_CENTROID; i++) {
        let l = (*samples).values[i];
        brightest = math_max(l, brightest);
        dark = dark || l <= 0.0f;
    }
    let ld = (*samples).values[SUBDIVIDE_CENTROID];
    let lift = ld - subdivide_linear_centroid(samples);
    let r = lift - (4.0f / 9.0f) * ((d.x + d.y) + d.z);
    let error = subdivide_mean_error(d, r);
    let off = math_max(bend, math_abs(lift));
    let accepted = off <= subdivide_tolerance(rule, math_max(brightest, ld)) || subdivide_is_small(rule, shape, error);
    let rough = dark || math_abs(r) > SUBDIVIDE_SMOOTH * bend || bend > SUBDIVIDE_GENTLE * brightest;
    let b = (a + 1u) % 3u;
    let c = (a + 2u) % 3u;
    let la = (*samples).values[a];
    let le = (*samples).values[SUBDIVIDE_MIDPOINT + a];
    let off_median = ld - (la + (2.0f / 3.0f) * (le - la));
    let straight = SUBDIVIDE_STRAIGHT * math_abs(d[a]);
    let along = math_abs(d[b]) <= straight && math_abs(d[c]) <= straight && math_abs(off_median) <= straight;
    var split = halves;
    if !along { split = subdivide_robust_demanded(shape); }
    let half = 0.25f * d[a];
    let p = 0.25f * d[b];
    let q = 0.25f * d[c];
    let median = 0.5f * (d[b] + d[c]) - half;
    var next = vec2(0.25f * error, 0.25f * off);
    if split.kind == SUBDIVIDE_TWO {
        next = subdivide_worst(
            subdivide_expected(vec3(half, d[b], median), 0.5f * r),
            subdivide_expected(vec3(half, d[c], median), 0.5f * r),
        );
    } else if split.kind == SUBDIVIDE_FAN {
        next = subdivide_worst(next, subdivide_expected(vec3(median, p, q), 0.25f * r));
    }
    var verdict = subdivide_cut(split, error, next.x, next.y);
    if rough { verdict = subdivide_cut(halves, error, error, SUBDIVIDE_LARGEST); }
    if accepted { verdict = subdivide_accept(); }
    return verdict;
}

fn subdivide_robust(
    rule: SubdivideRobust,
    shape: SubdivideShape,
    samples_in: SubdivideSamples,
    rest: f32,
) -> SubdivideVerdict {
    var samples = samples_in;
    let a = subdivide_opposite_longest(shape);
    let crossed = subdivide_longest_crossed(shape, &samples);
    var wanted = 0u;
    var leap = -1.0f;
    for (var turn = 0u; turn < 2u; turn++) {
        let e = select(crossed, a, turn == 0u);
        if e != 3u && wanted == 0u && leap < 0.0f {
            if subdivide_has(&samples, SUBDIVIDE_MIDPOINT + e) {
                leap = subdivide_leap(rule, shape, &samples, e, rest);
            } else {
                wanted = subdivide_bit(SUBDIVIDE_MIDPOINT + e);
            }
        }
    }
    if wanted == 0u && leap < 0.0f {
        wanted = SUBDIVIDE_MIDPOINTS & ~samples.known;
        if wanted == 0u { wanted = subdivide_bit(SUBDIVIDE_CENTROID) & ~samples.known; }
    }
    var verdict = subdivide_probe(wanted);
    if leap >= 0.0f {
        verdict = subdivide_cut(SubdivideSplit(SUBDIVIDE_TWO, a), leap, leap, SUBDIVIDE_LARGEST);
    } else if wanted == 0u {
        verdict = subdivide_robust_judge(rule, shape, &samples);
    }
    return verdict;
}

// The cut where limits demand one.
fn subdivide_robust_demanded(shape: SubdivideShape) -> SubdivideSplit {
    let corner = subdivide_opposite_longest(shape);
    let fan = subdivide_is_elongated(shape) || subdivide_obtuse_corner(shape) != 3u;
    var kind = select(SUBDIVIDE_FOUR, SUBDIVIDE_FAN, fan);
    if subdivide_is_needle(shape) { kind = SUBDIVIDE_TWO; }
    return SubdivideSplit(kind, corner);
}

// Whether a piece is accepted unseen.
fn subdivide_robust_settles(rule: SubdivideRobust, shape: SubdivideShape, rest: f32, bend: f32, largest: f32) -> bool {
    return bend <= subdivide_tolerance(rule, largest) || subdivide_is_small(rule, shape, rest);
}
