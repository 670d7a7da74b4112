//! Wider registers for core's loops, chosen when the program runs.
//!
//! The same source is compiled twice, portable and with AVX2, and where it gains by it a third time with AVX-512; all do the same operations in the same order (rustc never
//! fuses products into sums), so they give the same bits.

/// Defines a function whose body is compiled for AVX2 too and runs so where the machine has it; after `sixteen:`, for AVX-512 as well.
///
/// All that the body calls must be `#[inline(always)]`, or it may stay portable code. Generic parameters stand in brackets.
#[allow(unused_macros, reason = "used by the loops over slices")]
macro_rules! widest {
    (@if $has:ident $features:literal $([$($generics:tt)*])? ($($arg:ident: $ty:ty),*) $(-> $out:ty)?) => {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = $features)]
            fn wide $(<$($generics)*>)? ($($arg: $ty),*) $(-> $out)? {
                body($($arg),*)
            }
            if $crate::simd::$has() {
                // SAFETY: the processor has all the features that `wide` is compiled for: they were just asked for.
                #[expect(unsafe_code, reason = "the one way to call a function compiled for more features")]
                return unsafe { wide($($arg),*) };
            }
        }
    };
    (sixteen: $(#[$meta:meta])* $vis:vis fn $name:ident $([$($generics:tt)*])? ($($arg:ident: $ty:ty),* $(,)?) $(-> $out:ty)? $body:block) => {
        $(#[$meta])*
        $vis fn $name $(<$($generics)*>)? ($($arg: $ty),*) $(-> $out)? {
            #[inline(always)]
            fn body $(<$($generics)*>)? ($($arg: $ty),*) $(-> $out)? $body
            $crate::simd::widest!(@if has_avx512 "avx512f,avx512vl,avx512bw,avx512dq,avx2,fma,bmi1,bmi2,lzcnt,popcnt"
                $([$($generics)*])? ($($arg: $ty),*) $(-> $out)?);
            $crate::simd::widest!(@if has_avx2 "avx2,fma,bmi1,bmi2,lzcnt,popcnt" $([$($generics)*])? ($($arg: $ty),*) $(-> $out)?);
            body($($arg),*)
        }
    };
    ($(#[$meta:meta])* $vis:vis fn $name:ident $([$($generics:tt)*])? ($($arg:ident: $ty:ty),* $(,)?) $(-> $out:ty)? $body:block) => {
        $(#[$meta])*
        $vis fn $name $(<$($generics)*>)? ($($arg: $ty),*) $(-> $out)? {
            #[inline(always)]
            fn body $(<$($generics)*>)? ($($arg: $ty),*) $(-> $out)? $body
            $crate::simd::widest!(@if has_avx2 "avx2,fma,bmi1,bmi2,lzcnt,popcnt" $([$($generics)*])? ($($arg: $ty),*) $(-> $out)?);
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
    #[cfg(test)]
    if tests::MOST.get() < 8 {
        return false;
    }
    etendue_tree::Isa::Avx2.is_here()
}

/// Whether it also has registers of sixteen.
#[cfg(target_arch = "x86_64")]
pub(crate) fn has_avx512() -> bool {
    #[cfg(test)]
    if tests::MOST.get() < 16 {
        return false;
    }
    has_avx2()
        && std::is_x86_feature_detected!("avx512f")
        && std::is_x86_feature_detected!("avx512vl")
        && std::is_x86_feature_detected!("avx512bw")
        && std::is_x86_feature_detected!("avx512dq")
}

/// Whether the processor has what [`widest`] compiles for: not on this architecture.
#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn has_avx2() -> bool {
    false
}

#[cfg(test)]
pub(crate) mod tests {
    use std::cell::Cell;

    thread_local! {
        /// Floats of the widest registers that this thread may use.
        pub(crate) static MOST: Cell<u32> = const { Cell::new(16) };
    }

    widest! {
        /// Sum of squares.
        fn squares(x: &[f32]) -> f32 {
            x.iter().map(|x| x * x).sum()
        }
    }

    widest! {
        sixteen:
        /// Sum of cubes.
        fn cubes[const N: usize](x: &[f32; N]) -> f32 {
            x.iter().map(|x| x * x * x).sum()
        }
    }

    #[test]
    fn all_compilations_agree() {
        let x: [f32; 100] = std::array::from_fn(|i| 1.0 / (i as f32 + 0.3));
        let portable: [f32; 2] = [x.iter().map(|x| x * x).sum(), x.iter().map(|x| x * x * x).sum()];
        for most in [1, 8, 16] {
            MOST.set(most);
            assert_eq!([squares(&x), cubes(&x)].map(f32::to_bits), portable.map(f32::to_bits));
        }
        MOST.set(16);
    }
}
