//! Wider registers for core's loops, chosen when the program runs.
//!
//! The same source is compiled twice, portable and with AVX2; both do the same operations in the same order (rustc never
//! fuses products into sums), so they give the same bits.

/// Defines a function whose body is compiled for AVX2 too and runs so where the machine has it.
///
/// All that the body calls must be `#[inline(always)]`, or it may stay portable code. Generic parameters stand in brackets.
#[allow(unused_macros, reason = "used by the loops over slices")]
macro_rules! widest {
    ($(#[$meta:meta])* $vis:vis fn $name:ident $([$($generics:tt)*])? ($($arg:ident: $ty:ty),* $(,)?) $(-> $out:ty)? $body:block) => {
        $(#[$meta])*
        $vis fn $name $(<$($generics)*>)? ($($arg: $ty),*) $(-> $out)? {
            #[inline(always)]
            fn body $(<$($generics)*>)? ($($arg: $ty),*) $(-> $out)? $body
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
                fn wide $(<$($generics)*>)? ($($arg: $ty),*) $(-> $out)? {
                    body($($arg),*)
                }
                if $crate::simd::has_avx2() {
                    // SAFETY: the processor has all the features that `wide` is compiled for: they were just asked for.
                    #[expect(unsafe_code, reason = "the one way to call a function compiled for more features")]
                    return unsafe { wide($($arg),*) };
                }
            }
            body($($arg),*)
        }
    };
}
#[allow(unused_imports, reason = "used by the loops over slices")]
pub(crate) use widest;

/// Whether the processor has what [`widest`] compiles for.
#[cfg(target_arch = "x86_64")]
#[allow(dead_code, reason = "used by the loops over slices")]
pub(crate) fn has_avx2() -> bool {
    std::is_x86_feature_detected!("avx2")
        && std::is_x86_feature_detected!("fma")
        && std::is_x86_feature_detected!("bmi1")
        && std::is_x86_feature_detected!("bmi2")
        && std::is_x86_feature_detected!("lzcnt")
        && std::is_x86_feature_detected!("popcnt")
}

/// Whether the processor has what [`widest`] compiles for: not on this architecture.
#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn has_avx2() -> bool {
    false
}

#[cfg(test)]
mod tests {
    widest! {
        /// Sum of squares.
        fn squares(x: &[f32]) -> f32 {
            x.iter().map(|x| x * x).sum()
        }
    }

    #[test]
    fn both_compilations_agree() {
        let x: Vec<f32> = (0..100).map(|i| 1.0 / (i as f32 + 0.3)).collect();
        let portable: f32 = x.iter().map(|x| x * x).sum();
        assert_eq!(squares(&x).to_bits(), portable.to_bits());
    }
}
