//! Which instruction set walks: asked for once per tree, entered here and nowhere else.

use super::lanes::Scalar;
use super::walk::{self, View};
use etendue_core::geometry::{Hit, Ray};

/// An instruction set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isa {
    /// Scalar code, on every machine.
    Portable,
    /// AVX2, on x86-64.
    Avx2,
}

impl Isa {
    /// Whether this processor has it.
    pub fn is_here(self) -> bool {
        match self {
            Self::Portable => true,
            Self::Avx2 => crate::simd::has_avx2(),
        }
    }

    /// The widest that this processor has.
    pub fn widest() -> Self {
        if Self::Avx2.is_here() { Self::Avx2 } else { Self::Portable }
    }
}

#[cfg(target_arch = "x86_64")]
mod entry {
    use super::super::avx2::Avx2;
    use super::*;

    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
    pub(super) fn closest_avx2(view: View<'_>, ray: &Ray) -> Option<Hit> {
        walk::closest::<Avx2>(view, ray)
    }

    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
    pub(super) fn any_avx2(view: View<'_>, ray: &Ray) -> bool {
        walk::any::<Avx2>(view, ray)
    }
}

/// The closest hit. Precondition of every set but the portable one: [`Isa::is_here`], which [`super::WideTree`] keeps.
#[inline]
pub(super) fn closest(isa: Isa, view: View<'_>, ray: &Ray) -> Option<Hit> {
    match isa {
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => {
            // SAFETY: a tree holds `Avx2` only after `is_here` said that the processor has these features.
            #[expect(unsafe_code, reason = "the one way into code compiled for more features")]
            unsafe {
                entry::closest_avx2(view, ray)
            }
        }
        _ => walk::closest::<Scalar>(view, ray),
    }
}

/// Whether anything is hit; precondition as for [`closest`].
#[inline]
pub(super) fn any(isa: Isa, view: View<'_>, ray: &Ray) -> bool {
    match isa {
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => {
            // SAFETY: as above.
            #[expect(unsafe_code, reason = "the one way into code compiled for more features")]
            unsafe {
                entry::any_avx2(view, ray)
            }
        }
        _ => walk::any::<Scalar>(view, ray),
    }
}
