// Direct irradiance on elements: an invocation takes one place and one of the lights without size, and adds what arrives to sums in fixed point, which
// have core's bits in whatever order they are made.
//: use direct::irradiance
//: use direct::irradiance::point
//: use illumination::sums
//: use sampling::sobol
//: use tree::walk
//: if VOLUME
//: use transport::volume::lights
//: end

struct DirectJob {
    seed: vec2<u32>,
    block: u32,
    // Places of a division in a block.
    samples: u32,
    // The division and its place with which this dispatch begins, and how many places it takes.
    first_cell: u32,
    first_sample: u32,
    count: u32,
    primitives: u32,
    // Where the numbers of the lights without size begin among the words of elements, and how many there are.
    lights: u32,
    light_count: u32,
    // Flux is counted in units of 2^-power W.
    power: i32,
    elements: u32,
    nodes: u32,
    per_side: u32,
    // 1: linear; 2: sides apart; 4: a primitive is not one division but several.
    flags: u32,
    // For `math_opaque`.
    zero: u32,
}

@group(0) @binding(1) var<uniform> job: DirectJob;
// Rays in two words, two words unused, then six of each element: three sums.
@group(0) @binding(7) var<storage, read_write> sums: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read> element_words: array<u32>;

var<workgroup> rays_of_group: atomic<u32>;

const SUMS_HEAD: u32 = 4u;

fn element_word(i: u32) -> u32 { return element_words[i]; }

// The primitive of a division: the last that begins at it or before.
fn direct_primitive(cell: u32) -> u32 {
    if (job.flags & 4u) == 0u { return cell; }
    var low = 0u;
    var high = job.primitives;
    while low + 1u < high {
        let middle = (low + high) / 2u;
        if element_word(ELEMENT_PLACE_WORDS * middle + 2u) <= cell { low = middle; } else { high = middle; }
    }
    return low;
}

fn direct_arrive(primitive: u32, at: DirectPoint, from_front: bool, flux: vec3<f32>) {
    let map = ElementMap(job.nodes, job.per_side, (job.flags & 1u) != 0u, (job.flags & 2u) != 0u);
    let deposit = elements_deposit(map, primitive, at.b1, at.b2, from_front);
    sums_deposit(deposit, SUMS_HEAD, job.elements, flux, job.power);
}

//: if VOLUME
// Null boundaries, panes and smooth dielectrics hold no flux.
fn direct_is_passage(primitive: u32) -> bool {
    let flags = surface_flags(primitive);
    return boundaries_passes(primitive) || (flags & (MATERIAL_DIELECTRIC | MATERIAL_ROUGH)) == MATERIAL_DIELECTRIC;
}

// Behind the numbers of lights: what is outside, then what each of them sends into.
fn direct_media(i: u32) -> Inside {
    let at = job.lights + job.light_count + 3u * i;
    return vec3(element_word(at), element_word(at + 1u), element_word(at + 2u));
}
//: end

// What a light brings to a place; the rays that took.
fn direct_place(place: u32, light_number: u32) -> u32 {
    let sample = job.first_sample + place;
    let number = job.first_cell + sample / job.samples;
    let primitive = direct_primitive(number);
    //: if VOLUME
    if direct_is_passage(primitive) { return 0u; }
    //: end
    let cell = number - element_word(ELEMENT_PLACE_WORDS * primitive + 2u);
    let sampler = sobol_block_sampler(job.seed, primitive, job.block, sample % job.samples);
    let at = irradiance_point_on(primitive, cell, sobol_group2(sampler, cell));
    if !at.found { return 0u; }
    let light = scene_at.lights + LIGHT_WORDS * element_word(job.lights + light_number);
    let direct = irradiance_from_light(light, at.point, at.normal);
    if !direct.found { return 0u; }
    //: if VOLUME
    let inside = direct_media(1u + light_number);
    let outside = direct_media(0u);
    let place_ = at.point.position;
    let followed = lights_follow(LIGHTS_BACK, direct.ray, inside, outside, place_, at.normal, false);
    let rays = followed.rays;
    let arrives = !math_is_zero3(followed.left);
    let irradiance = direct.irradiance * followed.left;
    //: else
    let rays = 1u;
    let arrives = !tree_occluded(direct.ray);
    let irradiance = direct.irradiance;
    //: end
    if arrives {
        let divisions = elements_divisions(primitive);
        let area = bitcast<f32>(element_word(ELEMENT_PLACE_WORDS * primitive + 3u))
            / (f32(divisions * divisions) * f32(job.samples));
        let from_front = math_dot(emit_toward(light, at.point.position), at.normal) >= 0.0f;
        direct_arrive(primitive, at, from_front, irradiance * area);
    }
    return rays;
}

// Lights are along y, and along z where there are very many.
@compute @workgroup_size(64)
fn direct(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    let light = id.z * groups.y + id.y;
    if id.x < job.count && light < job.light_count {
        atomicAdd(&rays_of_group, direct_place(id.x, light));
    }
    workgroupBarrier();
    if local == 0u { sums_add(0u, vec2(atomicLoad(&rays_of_group), 0u)); }
}
