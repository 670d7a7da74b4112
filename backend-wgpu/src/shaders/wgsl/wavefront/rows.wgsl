// Rows of form factors: an invocation traces one ray and says what it met. Rays are counted through all patches of the job, modulo 2^32.
//: use radiosity::form_factors::rays

struct RowsJob {
    seed: vec2<u32>,
    // Ray with which this dispatch begins, how many it takes, and the patches that these are of.
    first_ray: u32,
    count: u32,
    first_patch: u32,
    end_patch: u32,
    // Where the first rays of patches begin among the words of elements, so that that of patch p is at starts + p.
    starts: u32,
    of_patch: u32,
    first_member: u32,
    members: u32,
    primitives: u32,
    cumulative: u32,
    per_side: u32,
    // For `math_opaque`.
    zero: u32,
}

@group(0) @binding(1) var<uniform> job: RowsJob;
@group(0) @binding(7) var<storage, read_write> met: array<u32>;
// Four words of each primitive, then the lists of patches.
@group(0) @binding(8) var<storage, read> element_words: array<u32>;

fn element_word(i: u32) -> u32 { return element_words[i]; }

// The last patch whose rays begin with this one or before.
fn rows_patch(ray: u32) -> u32 {
    let base = element_word(job.starts + job.first_patch);
    var low = job.first_patch;
    var high = job.end_patch;
    while low + 1u < high {
        let middle = (low + high) / 2u;
        if element_word(job.starts + middle) - base <= ray - base { low = middle; } else { high = middle; }
    }
    return low;
}

@compute @workgroup_size(64)
fn rows(@builtin(global_invocation_id) id: vec3<u32>) {
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    if id.x >= job.count { return; }
    let number = job.first_ray + id.x;
    let patch_ = rows_patch(number);
    let start = element_word(job.starts + patch_);
    let map = ElementMap(0u, job.per_side, false, true);
    let lists = PatchLists(job.of_patch, job.first_member, job.members, job.primitives, job.cumulative);
    let rays = element_word(job.starts + patch_ + 1u) - start;
    let ray = rays_ray(map, lists, job.seed, patch_, number - start, rays);
    met[id.x] = rays_met(map, lists, ray, tree_closest(ray));
}
