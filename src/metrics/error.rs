//! Why images cannot be compared.

/// Why two images cannot be compared, or a limit cannot be checked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MetricsError {
    /// An image has no pixels, or more than memory can index.
    #[error("an image of {width} x {height} pixels: expected at least one pixel, and few enough to index")]
    BadDimensions {
        /// Pixels across.
        width: usize,
        /// Pixels down.
        height: usize,
    },
    /// An array does not have one entry per pixel.
    #[error("{what} has {found} entries, expected {expected}")]
    SizeMismatch {
        /// Which array: `x`, `r`, `var_x`, `var_r`, `mask` or `replicates`.
        what: &'static str,
        /// Its length.
        found: usize,
        /// One entry per pixel.
        expected: usize,
    },
    /// The mask leaves nothing.
    #[error("the mask leaves none of {pixels} pixels")]
    EmptyMask {
        /// Pixels of the image.
        pixels: usize,
    },
    /// No pixel under the mask is finite in both images.
    #[error(
        "none of {pixels} pixels is finite in both images ({non_finite_x} are not in x, {non_finite_r} not in r)"
    )]
    NothingFinite {
        /// Pixels the mask leaves.
        pixels: usize,
        /// Of these not finite in x.
        non_finite_x: usize,
        /// Of these not finite in r.
        non_finite_r: usize,
    },
    /// A variance (or a replicate) holds values it cannot have where both images are finite.
    #[error("{what}: {count} pixels are not {expected}, the first at column {x}, row {y}")]
    BadValues {
        /// Which array: `var_x`, `var_r` or `replicates`.
        what: &'static str,
        /// What was expected.
        expected: &'static str,
        /// How many pixels.
        count: usize,
        /// Column of the first.
        x: usize,
        /// Row of the first.
        y: usize,
    },
    /// An interval needs at least two replicates.
    #[error("one replicate has no spread: expected none or at least two")]
    SingleReplicate,
    /// The viewing distance lies outside its domain.
    #[error("{value} pixels per degree, expected 1 to 1000")]
    PixelsPerDegree {
        /// The value found.
        value: f64,
    },
    /// There is no metric of this name that a limit can apply to.
    #[error("no metric \"{name}\" has an upper limit: expected one of {known}")]
    UnknownMetric {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// The metric was not measured for want of data.
    #[error("{name} was not measured: it needs {needs}")]
    NotMeasured {
        /// The metric.
        name: String,
        /// What was missing.
        needs: &'static str,
    },
}
