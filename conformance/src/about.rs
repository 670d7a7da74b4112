//! What a reader of the accuracy tables asks of each kernel: where its statement holds, and where it comes from.

use etendue_core::kernel::Kernel;

/// Words beside the numbers of a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct About {
    /// The inputs over which the errors are stated.
    pub domain: &'static str,
    /// Author and year of the method, and the equation where there is one.
    pub source: &'static str,
}

/// The entry of a kernel.
pub fn about(kernel: Kernel) -> About {
    let (domain, source) = words(kernel);
    About { domain, source }
}

fn words(kernel: Kernel) -> (&'static str, &'static str) {
    match kernel {
        // linear_triangle
        Kernel::SampleLinearTriangle | Kernel::LinearTriangleDistance => (
            "weights >= 0 with a positive sum, normal numbers; u in [0, 1]",
            "density: E. A. Kopylov, algorithm 2; the lightest vertex as apex and Halley's step: core::sampling::linear_triangle",
        ),
        Kernel::PdfLinearTriangle => (
            "weights >= 0 with a positive sum, normal numbers; barycentrics that sum to 1",
            "linear interpolation over its mean",
        ),
        Kernel::InvertLinearTriangle => (
            "weights >= 0 with a positive sum, normal numbers; barycentrics >= 0",
            "distribution functions of the density of E. A. Kopylov, algorithm 2, from the lightest vertex",
        ),
        // emission
        // subdivide
        // log_offset
        // bc1
        // polynomial
        // A kernel without an entry says nothing: the coverage test fails on it.
        _ => ("", ""),
    }
}
