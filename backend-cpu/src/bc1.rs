//! x
use etendue_core::codec::bc1::{self, Vector, Texels, Block};
use core::arch::x86_64::*;

#[derive(Clone, Copy)]
struct Wide(__m256);

macro_rules! u { ($e:expr) => { #[allow(unsafe_code)] unsafe { $e } } }

impl Vector for Wide {
    type Words = __m256i;
    type Blocks = [Texels; 8];
    #[inline(always)] fn splat(x: f32) -> Self { Self(u!(_mm256_set1_ps(x))) }
    #[inline(always)] fn add(self, o: Self) -> Self { Self(u!(_mm256_add_ps(self.0, o.0))) }
    #[inline(always)] fn sub(self, o: Self) -> Self { Self(u!(_mm256_sub_ps(self.0, o.0))) }
    #[inline(always)] fn mul(self, o: Self) -> Self { Self(u!(_mm256_mul_ps(self.0, o.0))) }
    #[inline(always)] fn div(self, o: Self) -> Self { Self(u!(_mm256_div_ps(self.0, o.0))) }
    #[inline(always)] fn min(self, o: Self) -> Self { Self(u!(_mm256_min_ps(self.0, o.0))) }
    #[inline(always)] fn max(self, o: Self) -> Self { Self(u!(_mm256_max_ps(self.0, o.0))) }
    #[inline(always)] fn round(self) -> Self { Self(u!(_mm256_round_ps::<{_MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC}>(self.0))) }
    #[inline(always)] fn pick(self, o: Self, y: Self, n: Self) -> Self { Self(u!(_mm256_blendv_ps(n.0, y.0, _mm256_cmp_ps::<_CMP_GT_OQ>(self.0, o.0)))) }
    #[inline(always)] fn bits(self) -> __m256i { u!(_mm256_castps_si256(self.0)) }
    #[inline(always)] fn float(w: __m256i) -> Self { Self(u!(_mm256_cvtepi32_ps(w))) }
    #[inline(always)] fn word(x: u32) -> __m256i { u!(_mm256_set1_epi32(x as i32)) }
    #[inline(always)] fn and(a: __m256i, b: __m256i) -> __m256i { u!(_mm256_and_si256(a, b)) }
    #[inline(always)] fn or(a: __m256i, b: __m256i) -> __m256i { u!(_mm256_or_si256(a, b)) }
    #[inline(always)] fn xor(a: __m256i, b: __m256i) -> __m256i { u!(_mm256_xor_si256(a, b)) }
    #[inline(always)] fn left<const B: i32>(a: __m256i) -> __m256i { u!(_mm256_slli_epi32::<B>(a)) }
    #[inline(always)] fn right<const B: i32>(a: __m256i) -> __m256i { u!(_mm256_srli_epi32::<B>(a)) }
    #[inline(always)] fn load(b: &[Texels; 8]) -> [__m256i; 12] {
        u!({
            let mut out = [_mm256_setzero_si256(); 12];
            let p = b.as_ptr().cast::<u8>();
            for g in 0..3 {
                let row = |l: usize| _mm256_loadu2_m128i(p.add(48 * (l + 4) + 16 * g).cast(), p.add(48 * l + 16 * g).cast());
                let r = [row(0), row(1), row(2), row(3)];
                let a = _mm256_unpacklo_epi32(r[0], r[1]);
                let b = _mm256_unpackhi_epi32(r[0], r[1]);
                let c = _mm256_unpacklo_epi32(r[2], r[3]);
                let d = _mm256_unpackhi_epi32(r[2], r[3]);
                out[4 * g] = _mm256_unpacklo_epi64(a, c);
                out[4 * g + 1] = _mm256_unpackhi_epi64(a, c);
                out[4 * g + 2] = _mm256_unpacklo_epi64(b, d);
                out[4 * g + 3] = _mm256_unpackhi_epi64(b, d);
            }
            out
        })
    }
}

#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn wide(texels: &[Texels], out: &mut [Block]) {
    let (groups, rest) = texels.as_chunks::<8>();
    let (og, or) = out.as_chunks_mut::<8>();
    for (t, o) in groups.iter().zip(og) {
        let [a, b] = bc1::fit::<Wide>(t);
        u!({
            let lo = _mm256_unpacklo_epi32(a, b);
            let hi = _mm256_unpackhi_epi32(a, b);
            let p = o.as_mut_ptr().cast::<u8>();
            _mm256_storeu_si256(p.cast(), _mm256_permute2x128_si256::<0x20>(lo, hi));
            _mm256_storeu_si256(p.add(32).cast(), _mm256_permute2x128_si256::<0x31>(lo, hi));
        });
    }
    bc1::ls_blocks(rest, or);
}
/// x
pub fn ls_blocks(texels: &[Texels], out: &mut [Block]) {
    #[allow(unsafe_code)]
    unsafe { wide(texels, out) }
}
crate::simd::widest! {
    /// x
    pub fn ls_arrays(texels: &[Texels], out: &mut [Block]) { bc1::ls_blocks(texels, out); }
}

impl bc1::Eight for Wide {
    #[inline(always)] fn read(x: &[f32; 8]) -> Self { Self(u!(_mm256_loadu_ps(x.as_ptr()))) }
    #[inline(always)] fn write(self) -> [f32; 8] { let mut o = [0.0; 8]; u!(_mm256_storeu_ps(o.as_mut_ptr(), self.0)); o }
}
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn wide_search(texels: &[Texels], quality: bc1::Quality, black: bc1::Black, out: &mut [Block]) { bc1::encode_blocks::<Wide>(texels, quality, black, out); }
/// x
pub fn encode_blocks(texels: &[Texels], quality: bc1::Quality, black: bc1::Black, out: &mut [Block]) { u!(wide_search(texels, quality, black, out)) }
