//! Eight floats in one AVX2 register.
//!
//! Values of [`F8`] live only inside entry points compiled for AVX2 and FMA, which are entered only where the processor has
//! them ([`super::isa`]); everything here is inlined into those.
#![expect(unsafe_code, reason = "vector instructions")]

use super::floats::{Eight, Floats, Fused};
use super::layout::WIDTH;
use core::arch::x86_64::*;
use core::mem::MaybeUninit;

/// Eight floats.
#[derive(Clone, Copy)]
pub(super) struct F8(__m256);

/// For each mask its set bits, the highest first.
static FALLING: [[u8; WIDTH]; 256] = {
    let mut all = [[0; WIDTH]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut slot, mut count) = (WIDTH, 0);
        while slot > 0 {
            slot -= 1;
            if mask >> slot & 1 != 0 {
                all[mask][count] = slot as u8;
                count += 1;
            }
        }
        mask += 1;
    }
    all
};

/// An instruction on registers alone.
macro_rules! op {
    ($call:expr) => {
        // SAFETY: no memory is touched; the caller is compiled for AVX2 and FMA (see the head of this file).
        unsafe { $call }
    };
}

impl Floats for F8 {
    type Mask = __m256;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self(op!(_mm256_set1_ps(x)))
    }

    #[inline(always)]
    fn load(row: &[f32; WIDTH]) -> Self {
        // SAFETY: the row has eight floats; alignment is not required.
        Self(unsafe { _mm256_loadu_ps(row.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, to: &mut Eight) {
        // SAFETY: room for eight floats, aligned to 64.
        unsafe { _mm256_store_ps(to.0.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(op!(_mm256_add_ps(self.0, other.0)))
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(op!(_mm256_sub_ps(self.0, other.0)))
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(op!(_mm256_mul_ps(self.0, other.0)))
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(op!(_mm256_div_ps(self.0, other.0)))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(op!(_mm256_min_ps(self.0, other.0)))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(op!(_mm256_max_ps(self.0, other.0)))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(op!(_mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0)))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> __m256 {
        op!(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0))
    }

    #[inline(always)]
    fn le(self, other: Self) -> __m256 {
        op!(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0))
    }

    #[inline(always)]
    fn both(a: __m256, b: __m256) -> __m256 {
        op!(_mm256_and_ps(a, b))
    }

    #[inline(always)]
    fn either(a: __m256, b: __m256) -> __m256 {
        op!(_mm256_or_ps(a, b))
    }

    #[inline(always)]
    fn bits(mask: __m256) -> u32 {
        op!(_mm256_movemask_ps(mask)) as u32
    }

    #[inline(always)]
    fn all(truth: bool) -> __m256 {
        op!(_mm256_castsi256_ps(_mm256_set1_epi32(-i32::from(truth))))
    }

    #[inline(always)]
    fn pick(mask: __m256, a: Self, b: Self) -> Self {
        Self(op!(_mm256_blendv_ps(b.0, a.0, mask)))
    }

    #[inline(always)]
    fn gather(words: &[u32; WIDTH], bits: u32, to: &mut [MaybeUninit<u32>; WIDTH]) {
        let order = &FALLING[(bits & 0xff) as usize];
        // SAFETY: eight bytes are read of the eight of `order`, eight words of the eight of `words`, and eight words are written
        // to the eight of `to`; the caller is compiled for AVX2.
        unsafe {
            let order = _mm256_cvtepu8_epi32(_mm_loadl_epi64(order.as_ptr().cast()));
            let words = _mm256_loadu_si256(words.as_ptr().cast());
            _mm256_storeu_si256(to.as_mut_ptr().cast(), _mm256_permutevar8x32_epi32(words, order));
        }
    }
}

impl Fused for F8 {
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(op!(_mm256_fmadd_ps(self.0, factor.0, term.0)))
    }

    #[inline(always)]
    fn least_of(self, bits: u32) -> f32 {
        // SAFETY: no memory is touched; the caller is compiled for AVX2.
        unsafe {
            let lanes = _mm256_set_epi32(128, 64, 32, 16, 8, 4, 2, 1);
            let taken = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(bits as i32), lanes), lanes);
            let x = _mm256_blendv_ps(_mm256_set1_ps(f32::INFINITY), self.0, _mm256_castsi256_ps(taken));
            let x = _mm_min_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps::<1>(x));
            let x = _mm_min_ps(x, _mm_movehl_ps(x, x));
            _mm_cvtss_f32(_mm_min_ss(x, _mm_shuffle_ps::<1>(x, x)))
        }
    }

    #[inline(always)]
    fn at_most_and_ulps<const ULPS: i32>(self, other: Self) -> u32 {
        // As integers: an addition is quicker than a product, and a number that is not negative is in the same order. A negative
        // one is a negative integer, and stays one.
        let more = op!({
            let other = _mm256_add_epi32(_mm256_castps_si256(other.0), _mm256_set1_epi32(ULPS));
            _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpgt_epi32(_mm256_castps_si256(self.0), other)))
        });
        !more as u32 & 0xff
    }
}
