//! Principal axis and least squares, for several blocks at once: one block per lane, no branches.

use super::lanes::Vector;

/// Sweeps of one-dimensional refinement along the axis before the endpoints are rounded.
const SWEEPS: usize = 1;
/// Adding it puts an integer of [0, 2^22) into the low bits of the sum.
const SHIFT: f32 = 8_388_608.0;

/// The axis of largest variance (any length) from the six covariances xx, xy, xz, yy, yz, zz, each times the same
/// positive factor; zeros give zero.
///
/// The matrix over its trace, squared three times; the column of its largest diagonal element, multiplied once more: the
/// power 16 of the matrix, without loops or roots. Nothing overflows or vanishes: elements stay in [-1, 1] and the
/// largest is at least 3^-8. The variance along the axis is at least 0.91 of the largest: a column can stand for the
/// second eigenvector alone only if that eigenvalue's power 8 is above half of the first one's.
#[inline(always)]
pub(super) fn axis<V: Vector>(covariance: [V; 6]) -> [V; 3] {
    let trace = covariance[0].add(covariance[3]).add(covariance[5]);
    let scale = positive_inverse(trace);
    let m = covariance.map(|x| x.mul(scale));
    let [a, b, c, d, e, f] = square(square(square(m)));
    let x = a.pick(d, a, b);
    let y = a.pick(d, b, d);
    let z = a.pick(d, c, e);
    let largest = a.max(d);
    let (x, y, z) = (largest.pick(f, x, c), largest.pick(f, y, e), largest.pick(f, z, f));
    let row = |p: V, q: V, r: V| p.mul(x).add(q.mul(y)).add(r.mul(z));
    [row(a, b, c), row(b, d, e), row(c, e, f)]
}

/// The square of a symmetric matrix.
#[inline(always)]
fn square<V: Vector>([a, b, c, d, e, f]: [V; 6]) -> [V; 6] {
    let (bb, cc, ee) = (b.mul(b), c.mul(c), e.mul(e));
    [
        a.mul(a).add(bb).add(cc),
        a.mul(b).add(b.mul(d)).add(c.mul(e)),
        a.mul(c).add(b.mul(e)).add(c.mul(f)),
        bb.add(d.mul(d)).add(ee),
        b.mul(c).add(d.mul(e)).add(e.mul(f)),
        cc.add(ee).add(f.mul(f)),
    ]
}

/// 1 / x where x > 0, else 0.
#[inline(always)]
fn positive_inverse<V: Vector>(x: V) -> V {
    x.pick(V::splat(0.0), V::splat(1.0).div(x), V::splat(0.0))
}

/// Byte `BITS / 8` of each word, as a float.
#[inline(always)]
fn byte<V: Vector, const BITS: i32>(words: V::Words) -> V {
    V::float(V::and(V::right::<BITS>(words), V::word(255)))
}

/// All channels of all texels as floats: three words hold four texels.
#[inline(always)]
fn unpack<V: Vector>(words: &[V::Words; 12]) -> [[V; 3]; 16] {
    let mut out = [[V::splat(0.0); 3]; 16];
    for g in 0..4 {
        let [u, v, w] = [words[3 * g], words[3 * g + 1], words[3 * g + 2]];
        out[4 * g] = [byte::<V, 0>(u), byte::<V, 8>(u), byte::<V, 16>(u)];
        out[4 * g + 1] = [V::float(V::right::<24>(u)), byte::<V, 0>(v), byte::<V, 8>(v)];
        out[4 * g + 2] = [byte::<V, 16>(v), V::float(V::right::<24>(v)), byte::<V, 0>(w)];
        out[4 * g + 3] = [byte::<V, 8>(w), byte::<V, 16>(w), V::float(V::right::<24>(w))];
    }
    out
}

/// Encodes blocks by least squares, all texels counting alike: the two words of each.
#[inline(always)]
pub(super) fn fit<V: Vector>(blocks: &V::Blocks) -> [V::Words; 2] {
    let x = unpack::<V>(&V::load(blocks));
    let splat = V::splat;
    let (zero, three, n) = (splat(0.0), splat(3.0), splat(16.0));

    // Sums and products are integers below 2^24, and so are the covariances times 256: exact.
    let mut sum = [zero; 3];
    let mut product = [zero; 6];
    for [r, g, b] in x {
        sum = [sum[0].add(r), sum[1].add(g), sum[2].add(b)];
        let p = product;
        product = [
            p[0].add(r.mul(r)),
            p[1].add(r.mul(g)),
            p[2].add(r.mul(b)),
            p[3].add(g.mul(g)),
            p[4].add(g.mul(b)),
            p[5].add(b.mul(b)),
        ];
    }
    let ([r, g, b], p) = (sum, product);
    let covariance = |k: usize, x: V, y: V| p[k].mul(n).sub(x.mul(y));
    let v = axis([
        covariance(0, r, r),
        covariance(1, r, g),
        covariance(2, r, b),
        covariance(3, g, g),
        covariance(4, g, b),
        covariance(5, b, b),
    ]);

    // Positions along the axis and their ends; then steps 0..3 for each, and regression of the position on the step.
    let mut t = [zero; 16];
    let (mut low, mut high) = (splat(f32::MAX), splat(f32::MIN));
    for (t, [r, g, b]) in t.iter_mut().zip(x) {
        *t = v[0].mul(r).add(v[1].mul(g)).add(v[2].mul(b));
        (low, high) = (t.min(low), t.max(high));
    }
    let t_sum = v[0].mul(r).add(v[1].mul(g)).add(v[2].mul(b));
    let sixteenth = splat(1.0 / 16.0);
    let mut start = low;
    let mut steps = three.mul(positive_inverse(high.sub(low)));
    let step = |t: V, start: V, steps: V| t.sub(start).mul(steps).max(zero).min(three).round();
    for _ in 0..SWEEPS {
        let (mut q_sum, mut qq_sum, mut qt_sum) = (zero, zero, zero);
        for t in t {
            let q = step(t, start, steps);
            q_sum = q_sum.add(q);
            qq_sum = qq_sum.add(q.mul(q));
            qt_sum = qt_sum.add(q.mul(t));
        }
        let variance = qq_sum.mul(n).sub(q_sum.mul(q_sum));
        let both = qt_sum.mul(n).sub(q_sum.mul(t_sum));
        // With one cluster, or a slope that rounding made nothing, the ends stay where they are.
        let slope = both.mul(positive_inverse(variance));
        start = slope.pick(zero, t_sum.sub(slope.mul(q_sum)).mul(sixteenth), start);
        steps = slope.pick(zero, variance.div(both), steps);
    }

    // Regression of the colours on the step.
    let (mut q_sum, mut qq_sum, mut qx_sum) = (zero, zero, [zero; 3]);
    for (t, x) in t.into_iter().zip(x) {
        let q = step(t, start, steps);
        q_sum = q_sum.add(q);
        qq_sum = qq_sum.add(q.mul(q));
        for (sum, x) in qx_sum.iter_mut().zip(x) {
            *sum = sum.add(q.mul(x));
        }
    }
    let inverse = positive_inverse(qq_sum.mul(n).sub(q_sum.mul(q_sum)));
    let shift = splat(SHIFT);
    let mut word = [V::word(0); 2];
    let mut ends = [[zero; 3]; 2];
    for c in 0..3 {
        let slope = qx_sum[c].mul(n).sub(q_sum.mul(sum[c])).mul(inverse);
        let first = sum[c].sub(slope.mul(q_sum)).mul(sixteenth);
        for (e, x) in [first, first.add(slope.mul(three))].into_iter().enumerate() {
            let levels = if c == 1 { 63.0 } else { 31.0 };
            let code = x.mul(splat(levels / 255.0)).max(zero).min(splat(levels)).round().add(shift).bits();
            let code = V::and(code, V::word(63));
            let (shifted, wide) = if c == 1 {
                (V::left::<6>(word[e]), V::or(V::left::<2>(code), V::right::<4>(code)))
            } else {
                (V::left::<5>(word[e]), V::or(V::left::<3>(code), V::right::<2>(code)))
            };
            word[e] = V::or(shifted, code);
            ends[e][c] = V::float(wide);
        }
    }

    // The larger word goes first.
    let [a, b] = word.map(V::float);
    let first = a.pick(b, a, b);
    let second = a.pick(b, b, a);
    let [p, q] = ends;
    let origin = [a.pick(b, p[0], q[0]), a.pick(b, p[1], q[1]), a.pick(b, p[2], q[2])];
    let end = [a.pick(b, q[0], p[0]), a.pick(b, q[1], p[1]), a.pick(b, q[2], p[2])];
    let d = [end[0].sub(origin[0]), end[1].sub(origin[1]), end[2].sub(origin[2])];
    let length = d[0].mul(d[0]).add(d[1].mul(d[1])).add(d[2].mul(d[2]));
    let scale = three.mul(positive_inverse(length));
    let d = d.map(|x| x.mul(scale));
    let origin = d[0].mul(origin[0]).add(d[1].mul(origin[1])).add(d[2].mul(origin[2]));
    let mut bits = V::word(0);
    for [r, g, b] in x.into_iter().rev() {
        let t = d[0].mul(r).add(d[1].mul(g)).add(d[2].mul(b)).sub(origin);
        let q = t.max(zero).min(three).add(shift).bits();
        bits = V::or(V::left::<2>(bits), V::and(q, V::word(3)));
    }
    // Steps 0, 1, 2, 3 from the first endpoint are the indices 0, 2, 3, 1.
    let pairs = V::word(0x5555_5555);
    let (upper, lower) = (V::and(V::right::<1>(bits), pairs), V::and(bits, pairs));
    let low_word = V::and(first.add(shift).bits(), V::word(0xffff));
    let high_word = V::left::<16>(second.add(shift).bits());
    [V::or(low_word, high_word), V::or(V::left::<1>(V::xor(upper, lower)), upper)]
}
