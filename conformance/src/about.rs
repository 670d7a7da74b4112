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
        Kernel::EmissionCoefficient => (
            "edges 1e-9 to 1e9 m, heights from 2^-16 of the length, irradiance 1e-12 to 1e9 W m^-2",
            "Kopylov, First Shot, section 3: E(m, n) = Ka S_m I(m, n); area by products in two parts (Dekker 1971)",
        ),
        Kernel::EmissionOverlap => (
            "triangles of 1e-3 to 8 cells about the cell, corners on its borders; u of 1 + size / extent per axis",
            "clipping by half-planes (Sutherland and Hodgman 1974) in barycentric coordinates; this project",
        ),
        Kernel::EmissionScan => (
            "pieces of 0.02 to 12 texels on bitmaps of 1 x 1 to 64 x 32, needles, lines and points; u of albedo 1",
            "integral of the bilinear filter in closed form per cell; this project",
        ),
        Kernel::EmissionScanTexels => (
            "pieces of 0.02 to 12 texels on bitmaps of 1 x 1 to 64 x 32; u of 1 + texel / extent per axis",
            "Kopylov, First Shot, section 3: the scan of the covering texels, with exact overlaps",
        ),
        Kernel::EmissionBrightest => (
            "pieces of 0.02 to 12 texels on bitmaps of 1 x 1 to 64 x 32, within two periods",
            "Kopylov, First Shot, section 3: the brightest texel, here of the piece",
        ),

        // subdivide
        // log_offset
        // bc1
        // polynomial
        // A kernel without an entry says nothing: the coverage test fails on it.
        _ => ("", ""),
    }
}
