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
    use Kernel as K;
    match kernel {
        // linear_triangle
        // emission
        // subdivide
        K::SubdividePublished => (
            "corners of any size, irradiance in [0, 2^126]; NaN and negative count as 0",
            "E. Kopylov, First Shot, algorithm 1",
        ),
        K::SubdivideRobust => (
            "corners of any size, irradiance 0 or in [1e-30, 2^126]; NaN and negative count as 0",
            "E. Kopylov, First Shot, algorithm 1, mended; longest-edge bisection: Rosenberg and Stenger 1975",
        ),
        // log_offset
        // bc1
        // polynomial
        // A kernel without an entry says nothing: the coverage test fails on it.
        _ => ("", ""),
    }
}
