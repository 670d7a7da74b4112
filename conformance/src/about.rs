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
        // emission
        // subdivide
        // log_offset
        // bc1
        // polynomial
        Kernel::PolynomialDot => {
            ("32 terms; sum of magnitudes below f32::MAX", "16 lanes and a fold, own order")
        }
        Kernel::PolynomialApply => {
            ("up to 8 patches; sums of magnitudes below f32::MAX", "B = F x, C. Goral et al. 1984")
        }
        Kernel::PolynomialApplyHalf => (
            "up to 8 patches of positive area; sums of magnitudes below f32::MAX",
            "reciprocity A_i F_ij = A_j F_ji, J. H. Lambert 1760",
        ),
        Kernel::PolynomialSeries => (
            "up to 8 patches and 64 bounces; sums of magnitudes below f32::MAX",
            "C. Neumann 1877; sum of powers by nesting, W. G. Horner 1819",
        ),
        // A kernel without an entry says nothing: the coverage test fails on it.
        _ => ("", ""),
    }
}
