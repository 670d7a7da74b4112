//! Integer stages, written once more from their papers.

use super::{Answer, Expect, Words};
use etendue_core::kernel::Kernel;

pub(super) fn truth(kernel: Kernel, constants: &[u32], r: &mut Words<'_>) -> Answer {
    let words = |w: &[u32]| Answer::Is(w.iter().map(|x| Expect::Word(*x)).collect());
    match kernel {
        Kernel::U32ToUnit => {
            let unit = f64::from(r.word() / 256) / 16_777_216.0;
            words(&[(unit as f32).to_bits()])
        }
        Kernel::CounterBits4 => {
            let (stream, sample, group) = (r.word(), r.word(), r.word());
            words(&philox([group, sample, stream, 0], [constants[0], constants[1]]))
        }
        Kernel::SobolBits4 => {
            let (stream, block, index, group) = (r.word(), r.word(), r.word(), r.word());
            let key = key([constants[0], constants[1]], [stream, block, 0, 1]);
            let at = shuffle(index, seed_of(key, 8 * group));
            let mut out = [0; 4];
            for (d, out) in out.iter_mut().enumerate() {
                *out = owen(sobol(at, d), seed_of(key, 8 * group + 1 + d as u32));
            }
            words(&out)
        }
        Kernel::SobolSet => {
            let (index, d) = (r.word(), r.word());
            let key = key([constants[0], constants[1]], [0, 0, 0, 2]);
            let (pad, d) = (d / 64, d % 64);
            if d as usize > JOE_KUO.len() {
                // The table of direction numbers ends here; the other backend still has to agree.
                return Answer::Undecided;
            }
            let at = shuffle(index, seed_of(key, pad * 128));
            words(&[owen(sobol(at, d as usize), seed_of(key, pad * 128 + 1 + d))])
        }
        Kernel::CdfPick => {
            let x = u64::from(r.word());
            let end = |i: usize| constants.get(i + 1).map_or(1 << 32, |c| u64::from(*c));
            // The entry whose half-open run of counts holds x, by looking at all of them.
            let found = (0..constants.len())
                .find(|&i| u64::from(constants[i]) <= x && x < end(i))
                .expect("runs cover every word");
            let start = u64::from(constants[found]);
            let count = end(found) - start;
            let pmf = (count as f64 / 4_294_967_296.0) as f32;
            words(&[found as u32, pmf.to_bits(), (((x - start) << 32) / count) as u32])
        }
        Kernel::EvenWord => {
            let (index, shift, bits) = (u64::from(r.word()), u64::from(r.word()), r.word().min(32));
            // Parts of equal length, each the whole scaled down.
            let parts = 1_u64 << bits;
            let length = (1_u64 << 32) / parts;
            words(&[(index % parts * length + shift / parts) as u32])
        }
        _ => {
            let i = r.word() as usize;
            let start = constants.get(i).map(|c| u64::from(*c));
            let end = constants.get(i + 1).map_or(1 << 32, |c| u64::from(*c));
            let pmf = start.map_or(0.0, |s| (end - s) as f64 / 4_294_967_296.0) as f32;
            words(&[pmf.to_bits()])
        }
    }
}

/// Philox4x32-10 (Salmon et al. 2011, figure 2), keys precomputed.
fn philox(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    let mut x = counter.map(u64::from);
    for round in 0..10_u64 {
        let k = |i: usize, w: u64| (u64::from(key[i]) + round * w) & 0xffff_ffff;
        let (a, b) = (0xD251_1F53 * x[0], 0xCD9E_8D57 * x[2]);
        x = [
            (b >> 32) ^ x[1] ^ k(0, 0x9E37_79B9),
            b & 0xffff_ffff,
            (a >> 32) ^ x[3] ^ k(1, 0xBB67_AE85),
            a & 0xffff_ffff,
        ];
    }
    x.map(|v| v as u32)
}

/// A set's key: the first two words of Philox under the seed, its name the counter.
fn key(seed: [u32; 2], name: [u32; 4]) -> [u32; 2] {
    let [a, b, ..] = philox(name, seed);
    [a, b]
}

/// The n-th seed of a key, as `sobol` states it.
fn seed_of(key: [u32; 2], n: u32) -> u32 {
    let m = |x: u64| x & 0xffff_ffff;
    let mut x = m(u64::from(key[0]) + u64::from(n) * 0x9E37_79B9);
    x = m((x ^ (x >> 16)) * 0x7FEB_352D) ^ u64::from(key[1]);
    x = m((x ^ (x >> 15)) * 0x846C_A68B);
    (x ^ (x >> 16)) as u32
}

/// Vegdahl's form of the Laine-Karras hash on the reversed word.
fn owen_reversed(x: u32, seed: u32) -> u32 {
    let mut x = x;
    x ^= x.wrapping_mul(0x3D20_ADEA);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6C56);
    x ^= x.wrapping_mul(0x53A2_2864);
    x
}

fn owen(fraction: u32, seed: u32) -> u32 {
    owen_reversed(fraction.reverse_bits(), seed).reverse_bits()
}

/// An index is shuffled as the fraction that its reversed bits are.
fn shuffle(index: u32, seed: u32) -> u32 {
    owen_reversed(index.reverse_bits(), seed).reverse_bits()
}

/// Degree, coefficients and first direction numbers of dimensions 1 to 9 (Joe and Kuo 2008, new-joe-kuo-6.21201).
const JOE_KUO: [(u32, u32, [u32; 5]); 9] = [
    (1, 0, [1, 0, 0, 0, 0]),
    (2, 1, [1, 3, 0, 0, 0]),
    (3, 1, [1, 3, 1, 0, 0]),
    (3, 2, [1, 1, 1, 0, 0]),
    (4, 1, [1, 1, 3, 3, 0]),
    (4, 4, [1, 3, 5, 13, 0]),
    (5, 2, [1, 1, 5, 5, 17]),
    (5, 4, [1, 1, 5, 5, 5]),
    (5, 7, [1, 1, 7, 11, 19]),
];

/// Dimension `d` of the unscrambled point `index` by the recurrence of the direction numbers (Bratley and Fox 1988).
fn sobol(index: u32, d: usize) -> u32 {
    let mut v = [0_u32; 32];
    if d == 0 {
        for (i, v) in v.iter_mut().enumerate() {
            *v = 1 << (31 - i);
        }
    } else {
        let (s, a, m) = JOE_KUO[d - 1];
        let s = s as usize;
        for i in 0..32 {
            v[i] = if i < s {
                m[i] << (31 - i)
            } else {
                let mut x = v[i - s] ^ (v[i - s] >> s);
                for k in 1..s {
                    if (a >> (s - 1 - k)) & 1 == 1 {
                        x ^= v[i - k];
                    }
                }
                x
            };
        }
    }
    (0..32).filter(|i| (index >> i) & 1 == 1).fold(0, |x, i| x ^ v[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn philox_meets_the_authors_known_answers() {
        // Random123, kat_vectors: philox4x32 10.
        assert_eq!(philox([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(
            philox([u32::MAX; 4], [u32::MAX; 2]),
            [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]
        );
    }

    #[test]
    fn sobol_points_are_the_published_ones() {
        // Joe and Kuo's first points in natural order: 0, 1/2, (3/4, 1/4, 1/4, 1/4), (1/4, 3/4, 3/4, 3/4).
        let unit = |i, d| f64::from(sobol(i, d)) / 4_294_967_296.0;
        assert_eq!((0..4).map(|d| unit(1, d)).collect::<Vec<_>>(), [0.5; 4]);
        for d in 0..10 {
            // Every dimension is a permutation of the multiples of 2^-k.
            let mut seen: Vec<u32> = (0..256).map(|i| sobol(i, d) >> 24).collect();
            seen.sort_unstable();
            assert!(seen.iter().enumerate().all(|(i, x)| i as u32 == *x), "dimension {d}");
        }
    }
}
