// What the host says of the part of a job that a wave takes.

struct PathJob {
    seed: vec2<u32>,
    // Slots that the buffers are made for, and those of this wave.
    slots: u32,
    count: u32,
    // Elements of the film; the first of this wave and its block.
    elements: u32,
    first_element: u32,
    first_block: u32,
    // Samples of a block that this wave takes, from which one on.
    samples: u32,
    first_sample: u32,
    max_depth: u32,
    // Where probes begin among the words of the states; 0 for images.
    probes: u32,
    width: u32,
    // The media that the camera stands in.
    camera_inside0: u32,
    camera_inside1: u32,
    camera_inside2: u32,
    // For `math_opaque`.
    zero: u32,
    // Of samples from both ends. The scene's bounding sphere: its centre, and its radius.
    sphere: vec4<f32>,
    heuristic: u32,
    // Of the largest density, below which `CUTOFF` leaves a strategy out.
    least_part: f32,
    // The one strategy that counts; JOB_ALL for all of them.
    only_s: u32,
    only_t: u32,
    // Units of splats in one of radiance.
    per_unit: f32,
    // Where splats begin among the words of the queue, and of how many blocks there are any.
    splats: u32,
    splat_blocks: u32,
    // Where the list of free annexes begins there, and where they themselves do among the words of the states.
    free_annexes: u32,
    annexes: u32,
    // Where it says among the words of the states what each light sends into.
    light_media: u32,
    // Of summed airlight: where nodes lie, and how many there are of a segment and light.
    rule: u32,
    nodes: u32,
}

@group(0) @binding(1) var<uniform> job: PathJob;
