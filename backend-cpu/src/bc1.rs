//! BC1 over slices of blocks, in the widest registers that the machine has and on all threads.
//!
//! Core's encoder is written over vectors of eight floats. Here they are AVX2 registers where the processor has them;
//! the operations are the same in each lane, and so are the bits.

use etendue_core::codec::bc1::{self, Black, Block, LengthError, Quality, Texels};
use etendue_core::radiosity::blocks::Source;
use rayon::prelude::*;

/// Blocks per task: fixed, so that nothing depends on the number of threads.
const CHUNK: usize = 512;

/// Encodes blocks on this thread: the bits of [`bc1::encode_blocks`].
///
/// # Errors
/// When the slices differ in length.
pub fn encode_blocks(
    texels: &[Texels],
    quality: Quality,
    black: Black,
    out: &mut [Block],
) -> Result<(), LengthError> {
    #[cfg(target_arch = "x86_64")]
    if crate::simd::has_avx2() {
        return avx2::encode_blocks(texels, quality, black, out);
    }
    bc1::encode_blocks(texels, quality, black, out)
}

/// Encodes a row of an operator's blocks on this thread: the bits of core's own lanes.
pub(crate) fn encode_row(source: &Source<'_>, row: usize, out: &mut [Block]) {
    #[cfg(target_arch = "x86_64")]
    if crate::simd::has_avx2() {
        return source.encode_row(row, out, avx2::encode, etendue_core::codec::bc4::encode);
    }
    source.encode_row_portable(row, out);
}

/// Encodes blocks on the threads of the current pool: the bits of [`bc1::encode_blocks`].
///
/// # Errors
/// When the slices differ in length.
pub fn encode_blocks_parallel(
    texels: &[Texels],
    quality: Quality,
    black: Black,
    out: &mut [Block],
) -> Result<(), LengthError> {
    if texels.len() != out.len() {
        return Err(LengthError { texels: texels.len(), blocks: out.len() });
    }
    texels
        .par_chunks(CHUNK)
        .zip(out.par_chunks_mut(CHUNK))
        .try_for_each(|(texels, out)| encode_blocks(texels, quality, black, out))
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    #![expect(unsafe_code, reason = "registers have no safe operations outside functions compiled for them")]

    use core::arch::x86_64::*;
    use etendue_core::codec::bc1::{self, Black, Block, Eight, LengthError, Quality, Texels, Vector};

    /// Eight floats in a register. It is made and used only below `wide`, which runs only where AVX2 is.
    #[derive(Clone, Copy)]
    struct Register(__m256);

    /// The operation, which SAFETY: needs AVX2, that every caller of this module's private functions has.
    macro_rules! avx2 {
        ($operation:expr) => {
            unsafe { $operation }
        };
    }

    impl Vector for Register {
        type Words = __m256i;
        type Blocks = [Texels; 8];

        #[inline(always)]
        fn splat(x: f32) -> Self {
            Self(avx2!(_mm256_set1_ps(x)))
        }
        #[inline(always)]
        fn add(self, other: Self) -> Self {
            Self(avx2!(_mm256_add_ps(self.0, other.0)))
        }
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            Self(avx2!(_mm256_sub_ps(self.0, other.0)))
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            Self(avx2!(_mm256_mul_ps(self.0, other.0)))
        }
        #[inline(always)]
        fn div(self, other: Self) -> Self {
            Self(avx2!(_mm256_div_ps(self.0, other.0)))
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            Self(avx2!(_mm256_min_ps(self.0, other.0)))
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(avx2!(_mm256_max_ps(self.0, other.0)))
        }
        #[inline(always)]
        fn round(self) -> Self {
            const NEAREST: i32 = _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC;
            Self(avx2!(_mm256_round_ps::<NEAREST>(self.0)))
        }
        #[inline(always)]
        fn pick(self, other: Self, yes: Self, no: Self) -> Self {
            Self(avx2!(_mm256_blendv_ps(no.0, yes.0, _mm256_cmp_ps::<_CMP_GT_OQ>(self.0, other.0))))
        }
        #[inline(always)]
        fn bits(self) -> __m256i {
            avx2!(_mm256_castps_si256(self.0))
        }
        #[inline(always)]
        fn float(words: __m256i) -> Self {
            Self(avx2!(_mm256_cvtepi32_ps(words)))
        }
        #[inline(always)]
        fn load(blocks: &[Texels; 8]) -> [__m256i; 12] {
            // Rows of 16 bytes from blocks l and l + 4, in the halves of a register, turned over four at a time.
            // SAFETY: 48 bytes per block, 8 blocks: every row lies within them.
            avx2!({
                let mut out = [_mm256_setzero_si256(); 12];
                let start = blocks.as_ptr().cast::<u8>();
                for g in 0..3 {
                    let row = |l: usize| {
                        let at = |l: usize| start.add(48 * l + 16 * g).cast::<__m128i>();
                        _mm256_loadu2_m128i(at(l + 4), at(l))
                    };
                    let (p, q, r, s) = (row(0), row(1), row(2), row(3));
                    let (a, b) = (_mm256_unpacklo_epi32(p, q), _mm256_unpackhi_epi32(p, q));
                    let (c, d) = (_mm256_unpacklo_epi32(r, s), _mm256_unpackhi_epi32(r, s));
                    out[4 * g] = _mm256_unpacklo_epi64(a, c);
                    out[4 * g + 1] = _mm256_unpackhi_epi64(a, c);
                    out[4 * g + 2] = _mm256_unpacklo_epi64(b, d);
                    out[4 * g + 3] = _mm256_unpackhi_epi64(b, d);
                }
                out
            })
        }
        #[inline(always)]
        fn word(x: u32) -> __m256i {
            avx2!(_mm256_set1_epi32(x as i32))
        }
        #[inline(always)]
        fn and(a: __m256i, b: __m256i) -> __m256i {
            avx2!(_mm256_and_si256(a, b))
        }
        #[inline(always)]
        fn or(a: __m256i, b: __m256i) -> __m256i {
            avx2!(_mm256_or_si256(a, b))
        }
        #[inline(always)]
        fn xor(a: __m256i, b: __m256i) -> __m256i {
            avx2!(_mm256_xor_si256(a, b))
        }
        #[inline(always)]
        fn left<const BITS: i32>(a: __m256i) -> __m256i {
            avx2!(_mm256_slli_epi32::<BITS>(a))
        }
        #[inline(always)]
        fn right<const BITS: i32>(a: __m256i) -> __m256i {
            avx2!(_mm256_srli_epi32::<BITS>(a))
        }
    }

    impl Eight for Register {
        #[inline(always)]
        fn read(x: &[f32; 8]) -> Self {
            // SAFETY: eight floats are there.
            Self(avx2!(_mm256_loadu_ps(x.as_ptr())))
        }
        #[inline(always)]
        fn write(self) -> [f32; 8] {
            let mut out = [0.0; 8];
            // SAFETY: eight floats have room there.
            avx2!(_mm256_storeu_ps(out.as_mut_ptr(), self.0));
            out
        }
        #[inline(always)]
        fn blocks([ends, indices]: [__m256i; 2]) -> [Block; 8] {
            let mut out = [[0; 8]; 8];
            // SAFETY: 64 bytes have room there.
            avx2!({
                let (low, high) =
                    (_mm256_unpacklo_epi32(ends, indices), _mm256_unpackhi_epi32(ends, indices));
                let to = out.as_mut_ptr().cast::<__m256i>();
                _mm256_storeu_si256(to, _mm256_permute2x128_si256::<0x20>(low, high));
                _mm256_storeu_si256(to.add(1), _mm256_permute2x128_si256::<0x31>(low, high));
            });
            out
        }
    }

    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
    fn wide(texels: &[Texels], quality: Quality, black: Black, out: &mut [Block]) -> Result<(), LengthError> {
        bc1::encode_blocks_as::<Register>(texels, quality, black, out)
    }

    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
    fn wide_one(texels: &Texels, weights: &[f32; 16], quality: Quality) -> Block {
        bc1::encode_as::<Register>(texels, weights, quality, Black::Allowed)
    }

    /// Call it only where [`crate::simd::has_avx2`].
    pub(super) fn encode(texels: &Texels, weights: &[f32; 16], quality: Quality) -> Block {
        debug_assert!(crate::simd::has_avx2());
        // SAFETY: the one caller has asked for the features that `wide_one` is compiled for.
        unsafe { wide_one(texels, weights, quality) }
    }

    /// Call it only where [`crate::simd::has_avx2`].
    pub(super) fn encode_blocks(
        texels: &[Texels],
        quality: Quality,
        black: Black,
        out: &mut [Block],
    ) -> Result<(), LengthError> {
        debug_assert!(crate::simd::has_avx2());
        // SAFETY: the one caller has asked for the features that `wide` is compiled for.
        unsafe { wide(texels, quality, black, out) }
    }
}
