// Walks that find what light can get to: an invocation takes one walk to its end, and marks the element sides that it meets.
//: use radiosity::form_factors::reach

struct ReachJob {
    // The scene's bounding sphere.
    sphere: vec4<f32>,
    seed: vec2<u32>,
    replicate: u32,
    // Whether walks begin all around the scene; lights and cameras at which they begin otherwise.
    from_infinity: u32,
    begins: u32,
    // The walk with which this dispatch begins, and how many it takes.
    first: u32,
    count: u32,
    // Most hits of a walk.
    hits: u32,
    elements: u32,
    per_side: u32,
    // For `math_opaque`.
    zero: u32,
}

@group(0) @binding(1) var<uniform> job: ReachJob;
// Walks that left the scene, then a bit for each element side.
@group(0) @binding(7) var<storage, read_write> marks: array<atomic<u32>>;
// Four words of each primitive.
@group(0) @binding(8) var<storage, read> element_words: array<u32>;

fn element_word(i: u32) -> u32 { return element_words[i]; }

fn reach_mark(element: u32) {
    if element < job.elements {
        let at = 1u + element / 32u;
        let bit = 1u << (element % 32u);
        // Most are marked already.
        if (atomicLoad(&marks[at]) & bit) == 0u { atomicOr(&marks[at], bit); }
    }
}

@compute @workgroup_size(64)
fn reach(@builtin(global_invocation_id) id: vec3<u32>) {
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    if id.x >= job.count { return; }
    let map = ElementMap(0u, job.per_side, false, true);
    let numbers = numbers_with_index(numbers_sobol(job.seed, job.replicate), job.first + id.x);
    var ray = reach_start(numbers, job.from_infinity != 0u, job.begins, job.sphere);
    var hits = 0u;
    while hits < job.hits {
        let hit = tree_closest(ray);
        if hit.primitive == TREE_NOTHING {
            atomicAdd(&marks[0], 1u);
            hits = job.hits;
        } else {
            let surface = surface_place(ray, hit);
            // By the side that the walk goes on from.
            reach_mark(elements_deposit(map, hit.primitive, hit.b1, hit.b2, surface.from_front).elements.x);
            ray = reach_next(numbers, hits, surface);
            hits += 1u;
        }
    }
}
