// Which media a point lies in: their numbers, counted from 1, in the order in which they were entered; two to a word, 0 behind the last.
//: use medium

const INSIDE_MAX: u32 = 6u;
const INSIDE_WORDS: vec3<u32> = vec3(0u, 1u, 2u);

alias Inside = vec3<u32>;

fn inside_number(inside: Inside, k: u32) -> u32 { return (inside[k >> 1u] >> (16u * (k & 1u))) & 0xffffu; }

// With a number in a place that has none.
fn inside_with(inside: Inside, k: u32, number: u32) -> Inside {
    return select(inside, inside | vec3(number << (16u * (k & 1u))), INSIDE_WORDS == vec3(k >> 1u));
}

fn inside_enter(inside: Inside, number: u32) -> Inside {
    if number == 0u { return inside; }
    for (var k = 0u; k < INSIDE_MAX; k++) {
        if inside_number(inside, k) == 0u { return inside_with(inside, k, number); }
    }
    return inside;
}

// Forgets the medium where it was entered last; media that were never entered are not left.
fn inside_leave(inside: Inside, number: u32) -> Inside {
    if number == 0u { return inside; }
    var last = INSIDE_MAX;
    for (var k = 0u; k < INSIDE_MAX; k++) {
        if inside_number(inside, k) == number { last = k; }
    }
    if last == INSIDE_MAX { return inside; }
    var left = vec3(0u);
    for (var k = 0u; k + 1u < INSIDE_MAX; k++) {
        left = inside_with(left, k, inside_number(inside, select(k, k + 1u, k >= last)));
    }
    return left;
}

// After crossing a surface with these media (interior in the low half, exterior in the high one), to its back or to its front.
fn inside_across(inside: Inside, media: u32, to_back: bool) -> Inside {
    if media == 0u { return inside; }
    let behind = media & 0xffffu;
    let before = media >> 16u;
    return inside_enter(inside_leave(inside, select(behind, before, to_back)), select(before, behind, to_back));
}

// Where the record of the medium that counts begins; MEDIUM_NONE where there is none.
const MEDIUM_NONE: u32 = 0xffffffffu;

fn inside_current(inside: Inside) -> u32 {
    var best = MEDIUM_NONE;
    var highest = 0;
    for (var k = 0u; k < INSIDE_MAX; k++) {
        let number = inside_number(inside, k);
        if number == 0u { break; }
        let record = scene_at.media + MEDIUM_WORDS * (number - 1u);
        let priority = bitcast<i32>(scene_word(record + 7u));
        if best == MEDIUM_NONE || priority >= highest {
            best = record;
            highest = priority;
        }
    }
    return best;
}
