// Weights of strategies that could have made the same path, by ratios of their densities.
//: use math::bits
//: use math::vector
//: use wavefront::job
//: if CUTOFF
//: use wavefront::bidirectional::links
//: end

const JOB_ALL: u32 = 0xffffffffu;
const HEURISTIC_POWER: u32 = 0u;

const WEIGHT_SUM_MAX: f32 = 1e36f;
const WEIGHT_RATIO_MAX: f32 = 1e18f;

// What a weight needs to know of a vertex and those before it on the same walk.
struct Chain { pdf: f32, back: f32, open: f32, sum: f32 }

// Densities of the direction in which a vertex was left, and of the way back if light came from there; 1 where it has none.
struct Left { opens: bool, forward: f32, backward: f32 }

// One end of a connection: its walk's chain with the densities of the other walk, and the vertex's number.
struct End { is_there: bool, index: u32, chain: Chain, forward: f32, backward: f32 }

// Nothing infinite, and nothing that is no number.
fn weight_at_most(x: f32, most: f32) -> f32 { return select(most, x, x < most); }

fn weight_uses(s: u32, t: u32) -> bool { return job.only_s == JOB_ALL || (job.only_s == s && job.only_t == t); }

// The power of a ratio that is summed.
fn weight_of(given: f32) -> f32 {
    let ratio = weight_at_most(given, WEIGHT_RATIO_MAX);
    if job.heuristic == HEURISTIC_POWER { return ratio * ratio; }
    return ratio;
}

// The vertex after this one; `here` and `there`: what turns a density of directions at the other end into one of the vertex.
fn chain_next(chain: Chain, left: Left, here: f32, there: f32) -> Chain {
    let before = weight_of(left.backward * chain.back) * chain.sum;
    var sum = before;
    if left.opens { sum = weight_of(chain.open) + before; }
    return Chain(
        left.forward * there,
        weight_at_most(here / chain.pdf, WEIGHT_RATIO_MAX),
        select(0.0f, 1.0f, left.opens),
        weight_at_most(sum, WEIGHT_SUM_MAX),
    );
}

// Sum over all strategies that leave this vertex to the other walk, over that which leaves it none.
fn weight_others(end: End) -> f32 {
    if !end.is_there { return 0.0f; }
    let inner = weight_of(end.chain.open) + weight_of(end.backward * end.chain.back) * end.chain.sum;
    return weight_at_most(weight_of(end.forward / end.chain.pdf) * inner, WEIGHT_SUM_MAX);
}

//: if CUTOFF
// Weight of a strategy: all others are listed, first for the largest density and then for the sum; `through` is the chance to fly along
// the connection.
fn weight_weigh(slot: u32, light: End, sensor: End, through: f32) -> f32 {
    var largest = 1.0f;
    var least = 0.0f;
    var sum = 1.0f;
    for (var turn = 0u; turn < 4u; turn++) {
        if turn == 2u { least = job.least_part * largest; }
        let side = turn & 1u;
        var end = light;
        if side == 1u { end = sensor; }
        if !end.is_there { continue; }
        var product = weight_at_most(end.forward / end.chain.pdf, WEIGHT_RATIO_MAX) * through;
        var open = end.chain.open;
        var i = end.index;
        loop {
            let p = product * open;
            if turn < 2u {
                largest = math_max_number(largest, p);
            } else if p >= least {
                sum += p;
            }
            if i == 0u { break; }
            i -= 1u;
            var ratio = weight_at_most(end.backward * end.chain.back, WEIGHT_RATIO_MAX);
            if i + 1u != end.index { ratio = links_ratio(slot, side, i); }
            product = weight_at_most(product * ratio, WEIGHT_SUM_MAX);
            open = links_open(slot, side, i);
        }
    }
    if least > 1.0f { return 0.0f; }
    return 1.0f / sum;
}
//: else
// Weight of a strategy by the sum of all others; `through` is the chance to fly along the connection.
fn weight_by_sum(sum: f32, through: f32) -> f32 { return 1.0f / (1.0f + weight_of(through) * sum); }

fn weight_weigh(slot: u32, light: End, sensor: End, through: f32) -> f32 {
    return weight_by_sum(weight_others(light) + weight_others(sensor), through);
}
//: end
