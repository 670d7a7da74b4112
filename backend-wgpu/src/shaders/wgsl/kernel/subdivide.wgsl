//: use kernel::words
//: use direct::subdivide::published
//: use direct::subdivide::robust

fn kernel_subdivide_samples() -> SubdivideSamples {
    var values: array<f32, 7>;
    for (var i = 0u; i < 7u; i++) { values[i] = float(); }
    return subdivide_samples(values);
}

fn kernel_subdivide_put(verdict: SubdivideVerdict) {
    if !verdict.cut {
        put_word(1u);
        return;
    }
    put_word(subdivide_count(verdict.split));
    let pieces = subdivide_pieces(verdict.split);
    put_word(pieces.x);
    put_word(pieces.y);
    put_word(pieces.z);
    put_word(pieces.w);
}

fn kernel_subdivide_published() {
    let relative = constant_float();
    let rule = SubdividePublished(relative, constant_float());
    let a = triple();
    let b = triple();
    let c = triple();
    let samples = kernel_subdivide_samples();
    kernel_subdivide_put(subdivide_published(rule, subdivide_shape(a, b, c, 1.0f), samples));
}

fn kernel_subdivide_robust() {
    let relative = constant_float();
    let absolute = constant_float();
    let rule = SubdivideRobust(relative, absolute, constant_float());
    let a = triple();
    let b = triple();
    let c = triple();
    let samples = kernel_subdivide_samples();
    let fraction = float();
    let verdict = subdivide_robust(rule, subdivide_shape(a, b, c, fraction), samples, float());
    kernel_subdivide_put(verdict);
    // An accepted triangle has no errors to state.
    if verdict.cut {
        put(verdict.error);
        put(verdict.rest);
        put(verdict.bend);
    }
}
