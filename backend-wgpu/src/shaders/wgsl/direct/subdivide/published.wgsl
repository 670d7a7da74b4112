// Algorithm 1 as it was published.
//: use direct::subdivide::criterion
//: use direct::subdivide::shape

fn subdivide_published(
    relative: f32,
    absolute: f32,
    shape: SubdivideShape,
    samples_in: SubdivideSamples,
) -> SubdivideVerdict {
    var samples = samples_in;
    let ld = samples.values[SUBDIVIDE_CENTROID];
    let off = math_abs(ld - subdivide_linear_centroid(&samples));
    let largest = math_max(
        math_max(samples.values[0], samples.values[1]),
        math_max(samples.values[2], ld),
    );
    if off <= math_max(relative, 0.0f) * largest + math_max(absolute, 0.0f) { return subdivide_accept(); }
    let a = subdivide_obtuse_corner(shape);
    if a == 3u {
        return SubdivideVerdict(true, SubdivideSplit(SUBDIVIDE_THREE, 0u), off, off, SUBDIVIDE_LARGEST);
    }
    let la = samples.values[a];
    let le = samples.values[SUBDIVIDE_MIDPOINT + a];
    let edge = math_abs(le - subdivide_linear_midpoint(&samples, a));
    let median = math_abs(ld - (0.5f * la + 0.5f * le));
    let kind = select(SUBDIVIDE_TWO, SUBDIVIDE_FOUR, edge > off && median > off);
    return SubdivideVerdict(true, SubdivideSplit(kind, a), off, off, SUBDIVIDE_LARGEST);
}
