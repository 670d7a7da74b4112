// Choice among weighted entries by cumulative counts. They are behind `discrete_count(i)`, which the shader that uses this
// file defines: in a table of a batch, or at some place in a buffer of the scene.

// (high, low) / `divisor` for a low word of 0 and high < divisor, by two digits of 16 bits (Knuth, algorithm D).
fn discrete_shifted_quotient(high: u32, divisor: u32) -> u32 {
    let shift = countLeadingZeros(divisor);
    let v = divisor << shift;
    let v1 = v >> 16u;
    let v0 = v & 0xffffu;
    let u = high << shift;
    var q1 = u / v1;
    var rest = u - q1 * v1;
    while q1 >= 0x10000u || q1 * v0 > rest << 16u {
        q1 -= 1u;
        rest += v1;
        if rest >= 0x10000u { break; }
    }
    let w = (u << 16u) - q1 * v;
    var q0 = w / v1;
    rest = w - q0 * v1;
    while q0 >= 0x10000u || q0 * v0 > rest << 16u {
        q0 -= 1u;
        rest += v1;
        if rest >= 0x10000u { break; }
    }
    return (q1 << 16u) + q0;
}

// Counts of an entry: [start, end) of 2^32, where `whole` means all of them and `count` is 0.
struct DiscreteSpan { start: u32, count: u32, whole: bool }

fn discrete_span(length: u32, index: u32) -> DiscreteSpan {
    if index >= length { return DiscreteSpan(0xffffffffu, 0u, false); }
    let start = discrete_count(index);
    if index + 1u < length {
        let end = discrete_count(index + 1u);
        return DiscreteSpan(start, select(0u, end - start, end > start), false);
    }
    return DiscreteSpan(start, 0u - start, start == 0u);
}

// In two halves, since conversions of a device may round by other rules than its sums.
fn discrete_probability(count: u32, whole: bool) -> f32 {
    if whole { return 1.0f; }
    return (f32(count >> 16u) * 65536.0f + f32(count & 0xffffu)) * (1.0f / 4294967296.0f);
}

struct Pick { index: u32, pmf: f32, remainder: u32 }

fn discrete_pick_in(length: u32, x: u32) -> Pick {
    if length == 0u { return Pick(0u, 0.0f, x); }
    var low = 0u;
    var size = length;
    while size > 1u {
        let half = size / 2u;
        if discrete_count(low + half) <= x { low += half; }
        size -= half;
    }
    let span = discrete_span(length, low);
    let offset = select(0u, x - span.start, x > span.start);
    if span.whole { return Pick(low, 1.0f, offset); }
    let count = max(span.count, 1u);
    let pmf = discrete_probability(count, false);
    // Of a malformed run only.
    if offset >= count { return Pick(low, pmf, 0xffffffffu); }
    return Pick(low, pmf, discrete_shifted_quotient(offset, count));
}

fn discrete_pmf_in(length: u32, index: u32) -> f32 {
    let span = discrete_span(length, index);
    return discrete_probability(span.count, span.whole);
}

fn discrete_even_word(index: u32, shift: u32, bits: u32) -> u32 {
    if bits == 0u { return shift; }
    if bits < 32u { return (index << (32u - bits)) | (shift >> bits); }
    return index;
}
