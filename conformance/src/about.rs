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
        Kernel::LogOffsetEncode => (
            "every finite x; tables of widths 0.0625 to 174, and of a matrix of zeros",
            "log/offset map of a thesis on compressed radiosity (ln in [-25, 0] to 8 bits); comparison with exact boundaries",
        ),
        Kernel::LogOffsetLookUp => ("every word", "table"),
        Kernel::LogOffsetDecode => (
            "widths 0.0625 to 174, max 0 to 3e38, levels 0 to 255 and beyond",
            "inverse of the log/offset map: max e^(-width (255 - level) / 255)",
        ),
        Kernel::LogOffsetDecodeMean => (
            "widths 0.0625 to 174, max 0 to 3e38, levels 0 to 255 and beyond",
            "conditional mean as the decoded value: Max 1960, Lloyd 1982",
        ),
        // bc1
        // polynomial
        // A kernel without an entry says nothing: the coverage test fails on it.
        _ => ("", ""),
    }
}
