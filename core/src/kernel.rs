//! Named numeric kernels: the door through which the conformance suite reaches a backend's math.
//!
//! A kernel is a pure function from a few words per batch and a few words per item to a few words per item. Words are
//! u32; floats travel as their bits. [`evaluate`] is the scalar reference.

use crate::backend::BackendError;
use crate::math;

/// How many words a kernel takes and gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KernelShape {
    /// Words shared by the batch.
    pub constants: usize,
    /// Words per item.
    pub item: usize,
    /// Words per result.
    pub out: usize,
}

/// The kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Kernel {
    /// x -> ln x.
    Ln,
}

impl Kernel {
    /// Every kernel.
    pub const ALL: &'static [Kernel] = &[Kernel::Ln];

    /// Name, stable across versions.
    pub fn name(self) -> &'static str {
        match self {
            Kernel::Ln => "math::ln",
        }
    }

    /// Word counts.
    pub fn shape(self) -> KernelShape {
        match self {
            Kernel::Ln => KernelShape { constants: 0, item: 1, out: 1 },
        }
    }

    /// Checks slices against the shape.
    ///
    /// # Errors
    /// The first slice of wrong length.
    pub fn check(self, constants: &[u32], items: &[u32], out: &[u32]) -> Result<KernelShape, BackendError> {
        let shape = self.shape();
        let wrong = |slice, found, expected| {
            Err(BackendError::WrongLength { kernel: self.name(), slice, found, expected })
        };
        if constants.len() != shape.constants {
            return wrong("constants", constants.len(), shape.constants);
        }
        let count = items.len() / shape.item.max(1);
        if items.len() != count * shape.item {
            return wrong("items", items.len(), count * shape.item);
        }
        if out.len() != count * shape.out {
            return wrong("out", out.len(), count * shape.out);
        }
        Ok(shape)
    }
}

/// Evaluates a kernel over a batch, one item after the other.
///
/// # Errors
/// When a slice has the wrong length.
pub fn evaluate(
    kernel: Kernel,
    constants: &[u32],
    items: &[u32],
    out: &mut [u32],
) -> Result<(), BackendError> {
    let shape = kernel.check(constants, items, out)?;
    for (item, out) in items.chunks_exact(shape.item).zip(out.chunks_exact_mut(shape.out)) {
        match kernel {
            Kernel::Ln => out[0] = math::ln(f32::from_bits(item[0])).to_bits(),
        }
    }
    Ok(())
}
