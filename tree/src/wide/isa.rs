//! Which instruction set walks: asked for once per tree, entered here and nowhere else.

use super::floats::Portable;
use super::lanes::Plain;
use super::packet::{self, RAYS};
use super::walk::{self, View};
use etendue_core::geometry::{Hit, PreparedRay, Ray};

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
            Self::Avx2 => has_avx2(),
        }
    }

    /// The widest that this processor has.
    pub fn widest() -> Self {
        if Self::Avx2.is_here() { Self::Avx2 } else { Self::Portable }
    }
}

/// All that the walk is compiled for.
fn has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        std::is_x86_feature_detected!("avx2")
            && std::is_x86_feature_detected!("fma")
            && std::is_x86_feature_detected!("bmi1")
            && std::is_x86_feature_detected!("bmi2")
            && std::is_x86_feature_detected!("lzcnt")
            && std::is_x86_feature_detected!("popcnt")
    }
    #[cfg(not(target_arch = "x86_64"))]
    false
}

#[cfg(target_arch = "x86_64")]
mod entry {
    use super::super::avx2::F8;
    use super::super::lanes::Lean;
    use super::*;

    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    pub(super) fn closest_avx2(view: View<'_>, ray: &Ray) -> Option<Hit> {
        let prepared = PreparedRay::new(ray);
        if view.fit.holds(&prepared) {
            walk::closest::<F8, Lean<F8>>(view, &prepared, ray.t_max)
        } else {
            closest_plain(view, &prepared, ray.t_max)
        }
    }

    #[cold]
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn closest_plain(view: View<'_>, ray: &PreparedRay, t_max: f32) -> Option<Hit> {
        walk::closest::<F8, Plain<F8>>(view, ray, t_max)
    }

    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    pub(super) fn any_avx2(view: View<'_>, ray: &Ray) -> bool {
        let prepared = PreparedRay::new(ray);
        if view.fit.holds(&prepared) {
            walk::any::<F8, Lean<F8>>(view, &prepared, ray.t_max)
        } else {
            any_plain(view, &prepared, ray.t_max)
        }
    }

    /// `None` where the rays do not run alike.
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    pub(super) fn closest_packet_avx2(view: View<'_>, rays: &[Ray; RAYS]) -> Option<[Option<Hit>; RAYS]> {
        let (prepared, t_max) = packet::prepare(rays);
        if packet::alike(&view, &prepared) {
            Some(packet::closest::<F8>(&view, &prepared, t_max))
        } else {
            None
        }
    }

    /// `None` where the rays do not run alike.
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    pub(super) fn any_packet_avx2(view: View<'_>, rays: &[Ray; RAYS]) -> Option<u32> {
        let (prepared, t_max) = packet::prepare(rays);
        if packet::alike(&view, &prepared) { Some(packet::any::<F8>(&view, &prepared, t_max)) } else { None }
    }

    #[cold]
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn any_plain(view: View<'_>, ray: &PreparedRay, t_max: f32) -> bool {
        walk::any::<F8, Plain<F8>>(view, ray, t_max)
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
        _ => walk::closest::<Portable, Plain<Portable>>(view, &PreparedRay::new(ray), ray.t_max),
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
        _ => walk::any::<Portable, Plain<Portable>>(view, &PreparedRay::new(ray), ray.t_max),
    }
}

/// The closest hits of eight rays, together where they run alike; precondition as for [`closest`].
#[inline]
pub(super) fn closest_packet(isa: Isa, view: View<'_>, rays: &[Ray; RAYS]) -> [Option<Hit>; RAYS] {
    #[cfg(target_arch = "x86_64")]
    if isa == Isa::Avx2 {
        // SAFETY: as above.
        #[expect(unsafe_code, reason = "the one way into code compiled for more features")]
        let together = unsafe { entry::closest_packet_avx2(view, rays) };
        if let Some(hits) = together {
            return hits;
        }
    }
    rays.each_ref().map(|ray| closest(isa, view, ray))
}

/// A bit for each of eight rays that hits anything; precondition as for [`closest`].
#[inline]
pub(super) fn any_packet(isa: Isa, view: View<'_>, rays: &[Ray; RAYS]) -> u32 {
    #[cfg(target_arch = "x86_64")]
    if isa == Isa::Avx2 {
        // SAFETY: as above.
        #[expect(unsafe_code, reason = "the one way into code compiled for more features")]
        let together = unsafe { entry::any_packet_avx2(view, rays) };
        if let Some(hits) = together {
            return hits;
        }
    }
    rays.iter().enumerate().fold(0, |bits, (i, ray)| bits | u32::from(any(isa, view, ray)) << i)
}
