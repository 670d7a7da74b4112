// Photons in order: those that have landed are listed in the order that they had, sorted along Hilbert's curve so that equals keep theirs, and
// after their scattering survive where the sum of chances in that order passes a whole number. All of it in whole numbers. An invocation takes a run of the
// order from its first to its last, so that nothing depends on how invocations are scheduled.
//: use geometry::hilbert
//: use transport::photon::replicate
//: use wavefront::photons::job

// Photons of an invocation, and counts of one that adds them up.
const RUN: u32 = 64u;
const SCAN_RUN: u32 = 256u;
// Digits of a pass of the sort: 30 bits in six.
const DIGIT_BITS: u32 = 5u;
const DIGITS: u32 = 32u;
const PASSES: u32 = 6u;

// How many counts there are.
const HEAD_COUNTS: u32 = 12u;

fn order_word(list: u32, i: u32) -> u32 { return atomicLoad(&sums[list_at(list) + i]); }

fn order_put(list: u32, i: u32, x: u32) { atomicStore(&sums[list_at(list) + i], x); }

fn order_list() -> u32 { return LIST_LANDED + atomicLoad(&sums[HEAD_PARITY]); }

fn order_other() -> u32 { return LIST_LANDED + 1u - atomicLoad(&sums[HEAD_PARITY]); }

fn order_keys(list: u32) -> u32 { return list - LIST_LANDED + LIST_KEYS; }

fn order_count() -> u32 { return atomicLoad(&sums[HEAD_ORDERED]); }

fn order_runs() -> u32 { return (order_count() + RUN - 1u) / RUN; }

// Behind the counts.
fn order_partial(i: u32) -> u32 { return job.slots / 2u + 64u + i; }

@compute @workgroup_size(64)
fn landed_count(@builtin(global_invocation_id) id: vec3<u32>) {
    let runs = order_runs();
    if id.x == 0u { atomicStore(&sums[HEAD_COUNTS], runs); }
    if id.x >= runs { return; }
    let list = order_list();
    let end = min(RUN * id.x + RUN, order_count());
    var landed = 0u;
    for (var i = RUN * id.x; i < end; i++) {
        landed += u32(wave_get(order_word(list, i), ROW_QUERY) == PHOTON_LANDED);
    }
    order_put(LIST_COUNTS, id.x, landed);
}

@compute @workgroup_size(64)
fn landed_move(@builtin(global_invocation_id) id: vec3<u32>) {
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    if id.x >= order_runs() { return; }
    let list = order_list();
    let other = order_other();
    let end = min(RUN * id.x + RUN, order_count());
    let low = vec3(job.grid_x, job.grid_y, job.grid_z);
    var place = order_word(LIST_COUNTS, id.x);
    for (var i = RUN * id.x; i < end; i++) {
        let slot = order_word(list, i);
        if wave_get(slot, ROW_QUERY) == PHOTON_LANDED {
            let at = wave_triple(slot, ROW_ORIGIN) + wave_triple(slot, ROW_DIRECTION) * wave_float(slot, ROW_HIT);
            order_put(other, place, slot);
            order_put(order_keys(other), place, hilbert_grid_index(low, job.grid_scale, at));
            place += 1u;
        }
    }
}

fn order_digit(key: u32) -> u32 { return (key >> (DIGIT_BITS * atomicLoad(&sums[HEAD_PASS]))) & (DIGITS - 1u); }

@compute @workgroup_size(64)
fn digit_count(@builtin(global_invocation_id) id: vec3<u32>) {
    let runs = order_runs();
    if id.x == 0u { atomicStore(&sums[HEAD_COUNTS], DIGITS * runs); }
    if id.x >= runs { return; }
    let keys = order_keys(order_list());
    let end = min(RUN * id.x + RUN, order_count());
    var counts: array<u32, DIGITS>;
    for (var i = RUN * id.x; i < end; i++) { counts[order_digit(order_word(keys, i))] += 1u; }
    for (var digit = 0u; digit < DIGITS; digit++) { order_put(LIST_COUNTS, runs * digit + id.x, counts[digit]); }
}

@compute @workgroup_size(64)
fn digit_move(@builtin(global_invocation_id) id: vec3<u32>) {
    let runs = order_runs();
    if id.x >= runs { return; }
    let list = order_list();
    let other = order_other();
    let end = min(RUN * id.x + RUN, order_count());
    var places: array<u32, DIGITS>;
    for (var digit = 0u; digit < DIGITS; digit++) { places[digit] = order_word(LIST_COUNTS, runs * digit + id.x); }
    for (var i = RUN * id.x; i < end; i++) {
        let key = order_word(order_keys(list), i);
        let place = places[order_digit(key)];
        places[order_digit(key)] = place + 1u;
        order_put(other, place, order_word(list, i));
        order_put(order_keys(other), place, key);
    }
}

@compute @workgroup_size(64)
fn chance_sum(@builtin(global_invocation_id) id: vec3<u32>) {
    let runs = order_runs();
    if id.x == 0u { atomicStore(&sums[HEAD_COUNTS], runs); }
    if id.x >= runs { return; }
    let list = order_list();
    let end = min(RUN * id.x + RUN, order_count());
    var sum = 0u;
    for (var i = RUN * id.x; i < end; i++) { sum += wave_get(order_word(list, i), ROW_HIT); }
    order_put(LIST_COUNTS, id.x, sum);
}

@compute @workgroup_size(64)
fn survive(@builtin(global_invocation_id) id: vec3<u32>) {
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    if id.x >= order_runs() { return; }
    let list = order_list();
    let end = min(RUN * id.x + RUN, order_count());
    var sum = job.offset + order_word(LIST_COUNTS, id.x);
    for (var i = RUN * id.x; i < end; i++) {
        let slot = order_word(list, i);
        let chance = wave_get(slot, ROW_HIT);
        sum += chance;
        // Of the whole numbers only that one was passed matters.
        if sum < chance {
            wave_put_triple(slot, ROW_FLUX, wave_triple(slot, ROW_FLUX) * photon_survivor_factor(chance));
            wave_ask(slot, PHOTON_CLOSEST);
        }
    }
}

// Sums of counts before each of them: of runs, of the sums of runs, and back.
@compute @workgroup_size(64)
fn scan_runs(@builtin(global_invocation_id) id: vec3<u32>) {
    let count = atomicLoad(&sums[HEAD_COUNTS]);
    if SCAN_RUN * id.x >= count { return; }
    let end = min(SCAN_RUN * id.x + SCAN_RUN, count);
    var sum = 0u;
    for (var i = SCAN_RUN * id.x; i < end; i++) { sum += order_word(LIST_COUNTS, i); }
    order_put(LIST_COUNTS, order_partial(id.x), sum);
}

@compute @workgroup_size(1)
fn scan_all() {
    let count = (atomicLoad(&sums[HEAD_COUNTS]) + SCAN_RUN - 1u) / SCAN_RUN;
    var sum = 0u;
    for (var i = 0u; i < count; i++) {
        let one = order_word(LIST_COUNTS, order_partial(i));
        order_put(LIST_COUNTS, order_partial(i), sum);
        sum += one;
    }
    atomicStore(&sums[HEAD_TOTAL], sum);
}

@compute @workgroup_size(64)
fn scan_back(@builtin(global_invocation_id) id: vec3<u32>) {
    let count = atomicLoad(&sums[HEAD_COUNTS]);
    if SCAN_RUN * id.x >= count { return; }
    let end = min(SCAN_RUN * id.x + SCAN_RUN, count);
    var sum = order_word(LIST_COUNTS, order_partial(id.x));
    for (var i = SCAN_RUN * id.x; i < end; i++) {
        let one = order_word(LIST_COUNTS, i);
        order_put(LIST_COUNTS, i, sum);
        sum += one;
    }
}

// The lists change places after each pass; the first is that of those that have landed.
@compute @workgroup_size(1)
fn order_turn() {
    let pass_ = (atomicLoad(&sums[HEAD_PASS]) + 1u) % (PASSES + 1u);
    atomicStore(&sums[HEAD_PASS], pass_);
    atomicStore(&sums[HEAD_PARITY], 1u - atomicLoad(&sums[HEAD_PARITY]));
    if pass_ == 0u { atomicStore(&sums[HEAD_ORDERED], atomicLoad(&sums[HEAD_TOTAL])); }
}
