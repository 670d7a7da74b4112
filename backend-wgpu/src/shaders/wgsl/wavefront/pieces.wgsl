// Lit triangles are cut into pieces: a lane holds one pair of a triangle and a light at a time, and takes one sample of irradiance at each of its steps,
// so that lanes that are at different points of their subdivisions trace together. Core's order within a triangle; pieces of different
// pairs come as they are made, with their numbers.
//: use direct::subdivide::published
//: use direct::subdivide::robust
//: use transport::first_shot::pieces
//: use wavefront::pieces::lanes

// The part in hand is a piece. `sure`: samples have judged it.
fn pieces_emit(sure: bool) {
    let at = PIECES_HEAD + PIECE_WORDS * atomicAdd(&made[PIECES_MADE], 1u);
    atomicStore(&made[at], lane.pair - 1u);
    atomicStore(&made[at + 1u], (lane.pieces << 1u) | u32(sure));
    var corners = part.corners;
    for (var i = 0u; i < 3u; i++) {
        atomicStore(&made[at + 2u + 2u * i], corners[i].x);
        atomicStore(&made[at + 3u + 2u * i], corners[i].y);
        atomicStore(&made[at + 8u + i], bitcast<u32>(part.irradiance[i]));
    }
    atomicStore(&made[at + 11u], bitcast<u32>(part.fraction));
    lane.pieces += 1u;
    lane.spare = max(lane.budget, 1u) - 1u;
    lane.phase = PIECES_NEXT;
}

// The next pair, if there is one.
fn pieces_take() {
    if lane.pair != 0u { atomicAdd(&made[PIECES_DONE], 1u); }
    var taken = job.count;
    if atomicLoad(&made[PIECES_TAKEN]) < job.count { taken = atomicAdd(&made[PIECES_TAKEN], 1u); }
    lane.pair = 0u;
    lane.wanted = 0u;
    lane.waiting = 0u;
    if taken < job.count {
        lane.pair = taken + 1u;
        lane.phase = PIECES_BEGIN;
        lane.pieces = 0u;
        lane.spare = 0u;
        lane.budget = max(job.budget, 1u);
        lane.wanted = select(SUBDIVIDE_CORNERS, 1u, pieces_how() == PIECES_GLANCE);
        samples.known = 0u;
        part = subdivide_whole(vec3(0.0f));
    }
}

fn pieces_frame() -> SubdivideFrame {
    let vertex = surface_vertices(pieces_pair(0u));
    return subdivide_frame(surface_position(vertex.x), surface_position(vertex.y), surface_position(vertex.z));
}

fn pieces_rule() -> SubdivideRobust { return SubdivideRobust(job.relative, job.absolute, pieces_pair_float(3u)); }

fn pieces_pop() {
    lane.waiting -= 1u;
    let at = pieces_stacked(lane.waiting);
    part = pieces_load_part(at);
    lane.budget = work[at + 13u * job.lanes];
}

// The parts of a cut wait, but for the order in which they come: the one whose corners differ most comes first.
fn pieces_push() {
    var known = samples;
    let pieces = subdivide_pieces(lane.split);
    let count = subdivide_count(lane.split);
    var spreads = vec4(0.0f);
    for (var i = 0u; i < count; i++) {
        spreads[i] =
            subdivide_spread(subdivide_part(part, lane.split, pieces[i], &known, lane.rest, lane.bend).irradiance);
    }
    let shares = subdivide_shares(spreads, count, lane.budget);
    for (var k = 0u; k < count; k++) {
        // From the last to the first, without the first to come, and then that.
        let back = count - 1u - k;
        let before = select(back, back - 1u, back <= shares.first && back > 0u);
        let i = select(before, shares.first, k + 1u == count);
        let at = pieces_stacked(lane.waiting);
        pieces_store_part(at, subdivide_part(part, lane.split, pieces[i], &known, lane.rest, lane.bend));
        work[at + 13u * job.lanes] = shares.budgets[i];
        lane.waiting += 1u;
    }
    lane.phase = PIECES_NEXT;
}

// The part in hand is cut so, or is a piece after all.
fn pieces_try(split: SubdivideSplit, rest: f32, bend: f32) {
    let count = subdivide_count(split);
    if subdivide_can_cut(part, split) && count <= lane.budget && lane.waiting + count <= SUBDIVIDE_STACK {
        lane.split = split;
        lane.rest = rest;
        lane.bend = bend;
        lane.wanted = subdivide_needs(split);
        lane.phase = PIECES_CUT;
    } else {
        pieces_emit(false);
    }
}

// Goes on, with the samples that were wanted.
fn pieces_advance() {
    if lane.phase == PIECES_CUT { pieces_push(); }
    var at_hand = false;
    if lane.phase == PIECES_NEXT {
        if lane.waiting > 0u {
            pieces_pop();
            at_hand = true;
        } else {
            pieces_take();
        }
    } else if lane.phase == PIECES_BEGIN {
        let first = samples.values[0];
        let glanced = pieces_how() == PIECES_GLANCE;
        part.irradiance = select(vec3(first, samples.values[1], samples.values[2]), vec3(first), glanced);
        at_hand = pieces_how() >= PIECES_PUBLISHED && !pieces_frame().degenerate;
        if !at_hand { pieces_emit(false); }
    }
    let is_robust = pieces_how() == PIECES_ROBUST;
    let looks = at_hand || lane.phase == PIECES_LOOK;
    if looks {
        let frame = pieces_frame();
        let shape = subdivide_frame_shape(frame, part.corners, part.fraction);
        let longest = shape.squares[subdivide_opposite_longest(shape)];
        var large = math_infinity();
        if job.largest < large { large = subdivide_frame_square(frame, job.largest); }
        let demanded = longest > large || part.depth < (pieces_pair(2u) >> 8u);
        let rule = pieces_rule();
        if at_hand {
            lane.budget += lane.spare;
            lane.spare = 0u;
            samples.known = SUBDIVIDE_CORNERS;
            for (var i = 0u; i < 7u; i++) { samples.values[i] = 0.0f; }
            for (var i = 0u; i < 3u; i++) { samples.values[i] = part.irradiance[i]; }
            let brightest = math_max(math_max(part.irradiance.x, part.irradiance.y), math_max(part.irradiance.z, 0.0f));
            let settled = is_robust && !demanded
                && subdivide_robust_settles(rule, shape, part.rest, part.bend, brightest);
            let ends = lane.budget < 2u || longest <= subdivide_frame_square(frame, job.size)
                || part.depth >= min(job.depth, SUBDIVIDE_MOST_CUTS);
            lane.phase = PIECES_LOOK;
            if ends || settled { pieces_emit(settled && !ends); }
        }
        if lane.phase == PIECES_LOOK {
            var verdict = subdivide_accept();
            var wished = SubdivideSplit(0u, 0u);
            if is_robust {
                verdict = subdivide_robust(rule, shape, samples, part.rest);
                wished = subdivide_robust_demanded(shape);
            } else {
                verdict = subdivide_published(SubdividePublished(job.relative, job.absolute), shape, samples);
                wished = subdivide_published_demanded(shape);
            }
            let wanted = verdict.wanted & ~samples.known;
            if wanted != 0u {
                lane.wanted = wanted;
            } else if verdict.cut {
                pieces_try(verdict.split, verdict.rest, verdict.bend);
            } else if demanded {
                pieces_try(wished, math_infinity(), math_infinity());
            } else {
                pieces_emit(true);
            }
        }
    }
}

fn pieces_know(i: u32, value: f32) {
    samples.values[i] = value;
    samples.known |= subdivide_bit(i);
    lane.wanted &= ~subdivide_bit(i);
}

//: if VOLUME
fn pieces_media(i: u32) -> Inside {
    let at = job.media + 3u * i;
    return vec3(work[at], work[at + 1u], work[at + 2u]);
}
//: end

// Takes the samples that are wanted up to the first that must be traced.
fn pieces_sample() {
    var points = subdivide_points(part.corners);
    let is_cut = pieces_how() >= PIECES_PUBLISHED;
    var known = is_cut;
    while known && lane.wanted != 0u {
        let i = firstTrailingBit(lane.wanted);
        let at = pieces_slot(points[i]);
        known = pieces_remembers(at, points[i]);
        if known { pieces_know(i, bitcast<f32>(pieces_word(at, 3u))); }
    }
    if lane.wanted != 0u {
        let i = firstTrailingBit(lane.wanted);
        var b = subdivide_bary_to_f32(points[i]);
        if pieces_how() == PIECES_GLANCE { b = vec3(pieces_pair_float(3u), pieces_pair_float(4u), pieces_pair_float(5u)); }
        let light = pieces_pair(1u);
        //: if VOLUME
        let sampled =
            first_shot_sample(pieces_pair(0u), light_record(light), b, pieces_media(1u + light), pieces_media(0u));
        //: else
        let sampled = first_shot_sample(pieces_pair(0u), light_record(light), b);
        //: end
        lane.rays += sampled.rays;
        let value = select(sampled.irradiance, subdivide_bounded(sampled.irradiance), is_cut);
        pieces_know(i, value);
        if is_cut {
            let at = pieces_slot(points[i]);
            work[at] = job.first + lane.pair;
            work[at + job.lanes] = points[i].x;
            work[at + 2u * job.lanes] = points[i].y;
            work[at + 3u * job.lanes] = bitcast<u32>(value);
        }
    }
}

// One sample of each lane.
@compute @workgroup_size(64)
fn pieces(@builtin(global_invocation_id) id: vec3<u32>) {
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    if id.x < job.lanes {
        lane.number = id.x;
        // Where nothing is left, lanes with nothing at hand have nothing to do.
        if pieces_get(0u) != 0u || atomicLoad(&made[PIECES_TAKEN]) < job.count {
            pieces_load();
            if lane.wanted == 0u { pieces_advance(); }
            if lane.pair != 0u { pieces_sample(); }
            pieces_store();
            if lane.rays != 0u { atomicAdd(&made[PIECES_RAYS], lane.rays); }
        }
    }
}
