//! The density as a mixture: w . b is a sum of w_i b_i, and b_i alone is a Dirichlet density.

/// A vertex is picked by weight, then a point from the Dirichlet density (2, 1, 1) that favours it. An oracle, not a sampler to use: it
/// takes four random numbers, and neighbours among them do not give neighbours on the triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mixture;

impl Mixture {
    /// Barycentrics of a point, for a random number that picks the vertex and three that place it.
    ///
    /// The gaps that three uniform numbers leave in [0, 1] have the Dirichlet density (1, 1, 1, 1); two of them together make that of
    /// (2, 1, 1) (L. Devroye, "Non-Uniform Random Variate Generation", 1986, chapter 11). Preconditions: weights >= 0 with a sum that is
    /// positive and finite, numbers in [0, 1).
    #[must_use]
    pub fn sample(weights: [f32; 3], pick: f32, place: [f32; 3]) -> [f32; 3] {
        let [a, b, c] = weights;
        let x = pick * (a + b + c);
        let vertex = if x < a {
            0
        } else if x < a + b {
            1
        } else {
            2
        };
        let [x, y, z] = place;
        let (low, high) = if x < y { (x, y) } else { (y, x) };
        // The least of the three ends the first of two gaps that are taken together: it does not matter.
        let rest = if z < low { low } else { z };
        let (second, third) = if rest < high { (rest, high) } else { (high, rest) };
        // The two gaps up to the second, the one to the third, and what is left.
        let favoured = second;
        let (one, other) = (third - second, 1.0 - third);
        match vertex {
            0 => [favoured, one, other],
            1 => [other, favoured, one],
            _ => [one, other, favoured],
        }
    }

    /// Density with respect to the triangle of unit area: the sum over the vertices of pick times 3 b_i.
    #[must_use]
    pub fn pdf(weights: [f32; 3], bary: [f32; 3]) -> f32 {
        let sum: f32 = weights.iter().sum();
        weights.iter().zip(bary).map(|(w, b)| w / sum * (3.0 * b)).sum()
    }
}
