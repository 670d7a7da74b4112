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
        // log_offset
        // bc1
        K::Bc1Decode => (
            "all blocks",
            "the format BC1 (S. Iourcha, K. Nayak, Z. Hong 1999); thirds and halves to nearest",
        ),
        K::Bc1DecodeWith => {
            ("all blocks, five rules", "Mesa, AMD, NVIDIA (I. Castano 2008): as stated with each rule")
        }
        K::Bc1EncodeRangeFit => (
            "all texels, all sets that count",
            "J. M. P. van Waveren 2006; J. M. P. van Waveren, I. Castano 2007",
        ),
        K::Bc4Decode => {
            ("all blocks", "the format BC4 (ATI 2004; Khronos Data Format 1.3); quotients to nearest")
        }
        K::Bc4EncodeRangeFit => {
            ("all texels, all sets that count", "the format's own range; nearest entries")
        }
        // polynomial
        // A kernel without an entry says nothing: the coverage test fails on it.
        _ => ("", ""),
    }
}
