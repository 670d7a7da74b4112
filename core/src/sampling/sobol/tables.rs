//! The generator matrices of Sobol' points, built at compile time.
//!
//! Primitive polynomials and initial direction numbers: S. Joe, F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional
//! projections", SIAM J. Sci. Comput. 30, 2635-2654 (2008), set `new-joe-kuo-6` as corrected in 2010, dimensions 2 to 64 of their numbering
//! (copyright 2008 F. Y. Kuo and S. Joe, distributed by them under a three-clause BSD licence).

/// Dimensions of one set, the first being the van der Corput sequence.
pub const DIMENSIONS: u32 = 64;

/// One primitive polynomial x^degree + a_1 x^(degree-1) + .. + a_(degree-1) x + 1 with its initial numbers.
struct Polynomial {
    /// Degree s.
    degree: usize,
    /// The inner coefficients a_1 .. a_(s-1), a_1 in the highest bit.
    coefficients: u32,
    /// The odd numbers m_1 .. m_s, m_k < 2^k; the rest is 0.
    initial: [u32; 9],
}

/// The row (s, a, m) of the published table.
const fn row(degree: usize, coefficients: u32, initial: [u32; 9]) -> Polynomial {
    Polynomial { degree, coefficients, initial }
}

/// Dimensions 1 to 63, counted from 0.
#[rustfmt::skip]
const POLYNOMIALS: [Polynomial; 63] = [
    row(1, 0, [1, 0, 0, 0, 0, 0, 0, 0, 0]),
    row(2, 1, [1, 3, 0, 0, 0, 0, 0, 0, 0]),
    row(3, 1, [1, 3, 1, 0, 0, 0, 0, 0, 0]),
    row(3, 2, [1, 1, 1, 0, 0, 0, 0, 0, 0]),
    row(4, 1, [1, 1, 3, 3, 0, 0, 0, 0, 0]),
    row(4, 4, [1, 3, 5, 13, 0, 0, 0, 0, 0]),
    row(5, 2, [1, 1, 5, 5, 17, 0, 0, 0, 0]),
    row(5, 4, [1, 1, 5, 5, 5, 0, 0, 0, 0]),
    row(5, 7, [1, 1, 7, 11, 19, 0, 0, 0, 0]),
    row(5, 11, [1, 1, 5, 1, 1, 0, 0, 0, 0]),
    row(5, 13, [1, 1, 1, 3, 11, 0, 0, 0, 0]),
    row(5, 14, [1, 3, 5, 5, 31, 0, 0, 0, 0]),
    row(6, 1, [1, 3, 3, 9, 7, 49, 0, 0, 0]),
    row(6, 13, [1, 1, 1, 15, 21, 21, 0, 0, 0]),
    row(6, 16, [1, 3, 1, 13, 27, 49, 0, 0, 0]),
    row(6, 19, [1, 1, 1, 15, 7, 5, 0, 0, 0]),
    row(6, 22, [1, 3, 1, 15, 13, 25, 0, 0, 0]),
    row(6, 25, [1, 1, 5, 5, 19, 61, 0, 0, 0]),
    row(7, 1, [1, 3, 7, 11, 23, 15, 103, 0, 0]),
    row(7, 4, [1, 3, 7, 13, 13, 15, 69, 0, 0]),
    row(7, 7, [1, 1, 3, 13, 7, 35, 63, 0, 0]),
    row(7, 8, [1, 3, 5, 9, 1, 25, 53, 0, 0]),
    row(7, 14, [1, 3, 1, 13, 9, 35, 107, 0, 0]),
    row(7, 19, [1, 3, 1, 5, 27, 61, 31, 0, 0]),
    row(7, 21, [1, 1, 5, 11, 19, 41, 61, 0, 0]),
    row(7, 28, [1, 3, 5, 3, 3, 13, 69, 0, 0]),
    row(7, 31, [1, 1, 7, 13, 1, 19, 1, 0, 0]),
    row(7, 32, [1, 3, 7, 5, 13, 19, 59, 0, 0]),
    row(7, 37, [1, 1, 3, 9, 25, 29, 41, 0, 0]),
    row(7, 41, [1, 3, 5, 13, 23, 1, 55, 0, 0]),
    row(7, 42, [1, 3, 7, 3, 13, 59, 17, 0, 0]),
    row(7, 50, [1, 3, 1, 3, 5, 53, 69, 0, 0]),
    row(7, 55, [1, 1, 5, 5, 23, 33, 13, 0, 0]),
    row(7, 56, [1, 1, 7, 7, 1, 61, 123, 0, 0]),
    row(7, 59, [1, 1, 7, 9, 13, 61, 49, 0, 0]),
    row(7, 62, [1, 3, 3, 5, 3, 55, 33, 0, 0]),
    row(8, 14, [1, 3, 1, 15, 31, 13, 49, 245, 0]),
    row(8, 21, [1, 3, 5, 15, 31, 59, 63, 97, 0]),
    row(8, 22, [1, 3, 1, 11, 11, 11, 77, 249, 0]),
    row(8, 38, [1, 3, 1, 11, 27, 43, 71, 9, 0]),
    row(8, 47, [1, 1, 7, 15, 21, 11, 81, 45, 0]),
    row(8, 49, [1, 3, 7, 3, 25, 31, 65, 79, 0]),
    row(8, 50, [1, 3, 1, 1, 19, 11, 3, 205, 0]),
    row(8, 52, [1, 1, 5, 9, 19, 21, 29, 157, 0]),
    row(8, 56, [1, 3, 7, 11, 1, 33, 89, 185, 0]),
    row(8, 67, [1, 3, 3, 3, 15, 9, 79, 71, 0]),
    row(8, 70, [1, 3, 7, 11, 15, 39, 119, 27, 0]),
    row(8, 84, [1, 1, 3, 1, 11, 31, 97, 225, 0]),
    row(8, 97, [1, 1, 1, 3, 23, 43, 57, 177, 0]),
    row(8, 103, [1, 3, 7, 7, 17, 17, 37, 71, 0]),
    row(8, 115, [1, 3, 1, 5, 27, 63, 123, 213, 0]),
    row(8, 122, [1, 1, 3, 5, 11, 43, 53, 133, 0]),
    row(9, 8, [1, 3, 5, 5, 29, 17, 47, 173, 479]),
    row(9, 13, [1, 3, 3, 11, 3, 1, 109, 9, 69]),
    row(9, 16, [1, 1, 1, 5, 17, 39, 23, 5, 343]),
    row(9, 22, [1, 3, 1, 5, 25, 15, 31, 103, 499]),
    row(9, 25, [1, 1, 1, 11, 11, 17, 63, 105, 183]),
    row(9, 44, [1, 1, 5, 11, 9, 29, 97, 231, 363]),
    row(9, 47, [1, 1, 5, 15, 19, 45, 41, 7, 383]),
    row(9, 52, [1, 3, 7, 7, 31, 19, 83, 137, 221]),
    row(9, 55, [1, 1, 1, 3, 23, 15, 111, 223, 83]),
    row(9, 59, [1, 1, 5, 13, 31, 15, 55, 25, 161]),
    row(9, 62, [1, 1, 3, 13, 25, 47, 39, 87, 257]),
];

/// The 32 direction numbers of dimension `d` (column k of its generator matrix, the first binary digit of the point in bit 31).
///
/// Recurrence: m_k = 2 a_1 m_(k-1) ^ .. ^ 2^(s-1) a_(s-1) m_(k-s+1) ^ 2^s m_(k-s) ^ m_(k-s) and v_k = m_k 2^(32-k), k counted from 1.
const fn directions(d: usize) -> [u32; 32] {
    let mut v = [0_u32; 32];
    let mut k = 0;
    if d == 0 {
        while k < 32 {
            v[k] = 1 << (31 - k);
            k += 1;
        }
        return v;
    }
    let p = &POLYNOMIALS[d - 1];
    while k < 32 {
        if k < p.degree {
            v[k] = p.initial[k] << (31 - k);
        } else {
            let mut word = v[k - p.degree] ^ (v[k - p.degree] >> p.degree);
            let mut j = 1;
            while j < p.degree {
                if (p.coefficients >> (p.degree - 1 - j)) & 1 == 1 {
                    word ^= v[k - j];
                }
                j += 1;
            }
            v[k] = word;
        }
        k += 1;
    }
    v
}

/// Sums of bit-reversed direction numbers over every value of each of the index's eight nibbles: 512 bytes for one dimension.
pub(super) type Nibbles = [[u32; 16]; 8];

/// The table of dimension `d`.
const fn nibbles(d: usize) -> Nibbles {
    let v = directions(d);
    let mut table = [[0; 16]; 8];
    let mut nibble = 0;
    while nibble < 8 {
        let mut value = 0;
        while value < 16 {
            let mut bit = 0;
            while bit < 4 {
                if (value >> bit) & 1 == 1 {
                    table[nibble][value] ^= v[4 * nibble + bit].reverse_bits();
                }
                bit += 1;
            }
            value += 1;
        }
        nibble += 1;
    }
    table
}

/// The tables of all dimensions: 32 KiB. (Dimensions 0 and 1 have closed forms; they are here so that tests and shaders may do without.)
pub static REVERSED: [Nibbles; DIMENSIONS as usize] = {
    let mut all = [[[0; 16]; 8]; DIMENSIONS as usize];
    let mut d = 0;
    while d < DIMENSIONS as usize {
        all[d] = nibbles(d);
        d += 1;
    }
    all
};
