// Algorithm 1 as it was published.
//: use direct::subdivide::criterion
//: use direct::subdivide::shape

struct SubdividePublished { relative: f32, absolute: f32 }

fn subdivide_published(
    rule: SubdividePublished,
    shape: SubdivideShape,
    samples_in: SubdivideSamples,
) -> SubdivideVerdict {
    var samples = samples_in;
    var verdict = subdivide_probe(subdivide_bit(SUBDIVIDE_CENTROID));
    if subdivide_has(&samples, SUBDIVIDE_CENTROID) {
        verdict = subdivide_accept();
        let ld = samples.values[SUBDIVIDE_CENTROID];
        let off = math_abs(ld - subdivide_linear_centroid(&samples));
        let largest = math_max(
            math_max(samples.values[0], samples.values[1]),
            math_max(samples.values[2], ld),
        );
        if !(off <= math_max(rule.relative, 0.0f) * largest + math_max(rule.absolute, 0.0f)) {
            let a = subdivide_obtuse_corner(shape);
            if a == 3u {
                verdict = subdivide_cut(SubdivideSplit(SUBDIVIDE_THREE, 0u), off, off, SUBDIVIDE_LARGEST);
            } else if !subdivide_has(&samples, SUBDIVIDE_MIDPOINT + a) {
                verdict = subdivide_probe(subdivide_bit(SUBDIVIDE_MIDPOINT + a));
            } else {
                let la = samples.values[a];
                let le = samples.values[SUBDIVIDE_MIDPOINT + a];
                let edge = math_abs(le - subdivide_linear_midpoint(&samples, a));
                let median = math_abs(ld - (0.5f * la + 0.5f * le));
                let kind = select(SUBDIVIDE_TWO, SUBDIVIDE_FOUR, edge > off && median > off);
                verdict = subdivide_cut(SubdivideSplit(kind, a), off, off, SUBDIVIDE_LARGEST);
            }
        }
    }
    return verdict;
}

// The cut where limits demand one.
fn subdivide_published_demanded(shape: SubdivideShape) -> SubdivideSplit {
    let a = subdivide_obtuse_corner(shape);
    return SubdivideSplit(select(SUBDIVIDE_TWO, SUBDIVIDE_THREE, a == 3u), a % 3u);
}
