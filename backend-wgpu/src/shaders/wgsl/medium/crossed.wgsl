// Boundaries that a way crosses, kept to be crossed in the other order: what the first of them does is done last. Of all of them together is left which
// media they leave, and which they enter after that, in order.
//: use medium::inside

struct Crossings { leaves: Inside, enters: Inside }

fn crossed_nothing() -> Crossings { return Crossings(vec3(0u), vec3(0u)); }

fn crossed_holds(inside: Inside, number: u32) -> bool {
    var holds = false;
    for (var k = 0u; k < INSIDE_MAX; k++) { holds = holds || inside_number(inside, k) == number; }
    return holds;
}

// One boundary more, which will be crossed before all others; `to_back` as for `inside_across`.
fn crossed_before(crossings: Crossings, media: u32, to_back: bool) -> Crossings {
    var out = crossings;
    let behind = media & 0xffffu;
    let before = media >> 16u;
    let enters = select(before, behind, to_back);
    let leaves = select(behind, before, to_back);
    if enters != 0u {
        if crossed_holds(out.leaves, enters) {
            out.leaves = inside_leave(out.leaves, enters);
        } else {
            let e = out.enters;
            out.enters = (e << vec3(16u)) | vec3(enters, e.x >> 16u, e.y >> 16u);
        }
    }
    out.leaves = inside_enter(out.leaves, leaves);
    return out;
}

// What is left of these media beyond all of them.
fn crossed_by(crossings: Crossings, start: Inside) -> Inside {
    var inside = start;
    for (var k = 0u; k < INSIDE_MAX; k++) { inside = inside_leave(inside, inside_number(crossings.leaves, k)); }
    for (var k = 0u; k < INSIDE_MAX; k++) { inside = inside_enter(inside, inside_number(crossings.enters, k)); }
    return inside;
}
