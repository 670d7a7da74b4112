// Scrambled sets of many dimensions.
//: use sampling::sobol

const SOBOL_DIMENSIONS: u32 = 64u;

// Joe and Kuo's polynomials of dimensions 1 to 63: degree, inner coefficients, initial numbers.
const SOBOL_POLYNOMIALS = array<array<u32, 11>, 63>(
    array(1u, 0u, 1u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u),
    array(2u, 1u, 1u, 3u, 0u, 0u, 0u, 0u, 0u, 0u, 0u),
    array(3u, 1u, 1u, 3u, 1u, 0u, 0u, 0u, 0u, 0u, 0u),
    array(3u, 2u, 1u, 1u, 1u, 0u, 0u, 0u, 0u, 0u, 0u),
    array(4u, 1u, 1u, 1u, 3u, 3u, 0u, 0u, 0u, 0u, 0u),
    array(4u, 4u, 1u, 3u, 5u, 13u, 0u, 0u, 0u, 0u, 0u),
    array(5u, 2u, 1u, 1u, 5u, 5u, 17u, 0u, 0u, 0u, 0u),
    array(5u, 4u, 1u, 1u, 5u, 5u, 5u, 0u, 0u, 0u, 0u),
    array(5u, 7u, 1u, 1u, 7u, 11u, 19u, 0u, 0u, 0u, 0u),
    array(5u, 11u, 1u, 1u, 5u, 1u, 1u, 0u, 0u, 0u, 0u),
    array(5u, 13u, 1u, 1u, 1u, 3u, 11u, 0u, 0u, 0u, 0u),
    array(5u, 14u, 1u, 3u, 5u, 5u, 31u, 0u, 0u, 0u, 0u),
    array(6u, 1u, 1u, 3u, 3u, 9u, 7u, 49u, 0u, 0u, 0u),
    array(6u, 13u, 1u, 1u, 1u, 15u, 21u, 21u, 0u, 0u, 0u),
    array(6u, 16u, 1u, 3u, 1u, 13u, 27u, 49u, 0u, 0u, 0u),
    array(6u, 19u, 1u, 1u, 1u, 15u, 7u, 5u, 0u, 0u, 0u),
    array(6u, 22u, 1u, 3u, 1u, 15u, 13u, 25u, 0u, 0u, 0u),
    array(6u, 25u, 1u, 1u, 5u, 5u, 19u, 61u, 0u, 0u, 0u),
    array(7u, 1u, 1u, 3u, 7u, 11u, 23u, 15u, 103u, 0u, 0u),
    array(7u, 4u, 1u, 3u, 7u, 13u, 13u, 15u, 69u, 0u, 0u),
    array(7u, 7u, 1u, 1u, 3u, 13u, 7u, 35u, 63u, 0u, 0u),
    array(7u, 8u, 1u, 3u, 5u, 9u, 1u, 25u, 53u, 0u, 0u),
    array(7u, 14u, 1u, 3u, 1u, 13u, 9u, 35u, 107u, 0u, 0u),
    array(7u, 19u, 1u, 3u, 1u, 5u, 27u, 61u, 31u, 0u, 0u),
    array(7u, 21u, 1u, 1u, 5u, 11u, 19u, 41u, 61u, 0u, 0u),
    array(7u, 28u, 1u, 3u, 5u, 3u, 3u, 13u, 69u, 0u, 0u),
    array(7u, 31u, 1u, 1u, 7u, 13u, 1u, 19u, 1u, 0u, 0u),
    array(7u, 32u, 1u, 3u, 7u, 5u, 13u, 19u, 59u, 0u, 0u),
    array(7u, 37u, 1u, 1u, 3u, 9u, 25u, 29u, 41u, 0u, 0u),
    array(7u, 41u, 1u, 3u, 5u, 13u, 23u, 1u, 55u, 0u, 0u),
    array(7u, 42u, 1u, 3u, 7u, 3u, 13u, 59u, 17u, 0u, 0u),
    array(7u, 50u, 1u, 3u, 1u, 3u, 5u, 53u, 69u, 0u, 0u),
    array(7u, 55u, 1u, 1u, 5u, 5u, 23u, 33u, 13u, 0u, 0u),
    array(7u, 56u, 1u, 1u, 7u, 7u, 1u, 61u, 123u, 0u, 0u),
    array(7u, 59u, 1u, 1u, 7u, 9u, 13u, 61u, 49u, 0u, 0u),
    array(7u, 62u, 1u, 3u, 3u, 5u, 3u, 55u, 33u, 0u, 0u),
    array(8u, 14u, 1u, 3u, 1u, 15u, 31u, 13u, 49u, 245u, 0u),
    array(8u, 21u, 1u, 3u, 5u, 15u, 31u, 59u, 63u, 97u, 0u),
    array(8u, 22u, 1u, 3u, 1u, 11u, 11u, 11u, 77u, 249u, 0u),
    array(8u, 38u, 1u, 3u, 1u, 11u, 27u, 43u, 71u, 9u, 0u),
    array(8u, 47u, 1u, 1u, 7u, 15u, 21u, 11u, 81u, 45u, 0u),
    array(8u, 49u, 1u, 3u, 7u, 3u, 25u, 31u, 65u, 79u, 0u),
    array(8u, 50u, 1u, 3u, 1u, 1u, 19u, 11u, 3u, 205u, 0u),
    array(8u, 52u, 1u, 1u, 5u, 9u, 19u, 21u, 29u, 157u, 0u),
    array(8u, 56u, 1u, 3u, 7u, 11u, 1u, 33u, 89u, 185u, 0u),
    array(8u, 67u, 1u, 3u, 3u, 3u, 15u, 9u, 79u, 71u, 0u),
    array(8u, 70u, 1u, 3u, 7u, 11u, 15u, 39u, 119u, 27u, 0u),
    array(8u, 84u, 1u, 1u, 3u, 1u, 11u, 31u, 97u, 225u, 0u),
    array(8u, 97u, 1u, 1u, 1u, 3u, 23u, 43u, 57u, 177u, 0u),
    array(8u, 103u, 1u, 3u, 7u, 7u, 17u, 17u, 37u, 71u, 0u),
    array(8u, 115u, 1u, 3u, 1u, 5u, 27u, 63u, 123u, 213u, 0u),
    array(8u, 122u, 1u, 1u, 3u, 5u, 11u, 43u, 53u, 133u, 0u),
    array(9u, 8u, 1u, 3u, 5u, 5u, 29u, 17u, 47u, 173u, 479u),
    array(9u, 13u, 1u, 3u, 3u, 11u, 3u, 1u, 109u, 9u, 69u),
    array(9u, 16u, 1u, 1u, 1u, 5u, 17u, 39u, 23u, 5u, 343u),
    array(9u, 22u, 1u, 3u, 1u, 5u, 25u, 15u, 31u, 103u, 499u),
    array(9u, 25u, 1u, 1u, 1u, 11u, 11u, 17u, 63u, 105u, 183u),
    array(9u, 44u, 1u, 1u, 5u, 11u, 9u, 29u, 97u, 231u, 363u),
    array(9u, 47u, 1u, 1u, 5u, 15u, 19u, 45u, 41u, 7u, 383u),
    array(9u, 52u, 1u, 3u, 7u, 7u, 31u, 19u, 83u, 137u, 221u),
    array(9u, 55u, 1u, 1u, 1u, 3u, 23u, 15u, 111u, 223u, 83u),
    array(9u, 59u, 1u, 1u, 5u, 13u, 31u, 15u, 55u, 25u, 161u),
    array(9u, 62u, 1u, 1u, 3u, 13u, 25u, 47u, 39u, 87u, 257u),
);

// Dimension `d` of the point `index`, as a fraction. Direction numbers are made as they are needed: a table of all would
// be eight times as long as that of the polynomials.
fn sobol_fraction(index: u32, d: u32) -> u32 {
    if d == 0u { return reverseBits(index); }
    var polynomials = SOBOL_POLYNOMIALS;
    let row = d - 1u;
    let degree = polynomials[row][0];
    let coefficients = polynomials[row][1];
    var v: array<u32, 32>;
    var point = 0u;
    for (var k = 0u; k < 32u; k++) {
        if k < degree {
            v[k] = polynomials[row][2u + k] << (31u - k);
        } else {
            var number = v[k - degree] ^ (v[k - degree] >> degree);
            for (var j = 1u; j < degree; j++) {
                if ((coefficients >> (degree - 1u - j)) & 1u) == 1u { number ^= v[k - j]; }
            }
            v[k] = number;
        }
        if ((index >> k) & 1u) == 1u { point ^= v[k]; }
    }
    return point;
}

fn sobol_sobol(index: u32, d: u32) -> u32 { return sobol_fraction(index, d % SOBOL_DIMENSIONS); }

struct SobolSet { key: vec2<u32> }

fn sobol_set(seed: vec2<u32>) -> SobolSet { return SobolSet(sobol_key(seed, vec4(0u, 0u, 0u, 2u))); }

struct SetPoint { key: vec2<u32>, reversed_index: u32, shuffled: u32 }

fn sobol_set_point(points: SobolSet, index: u32) -> SetPoint {
    let reversed = reverseBits(index);
    let shuffled = reverseBits(sobol_scramble_reversed(reversed, sobol_derive(points.key, 0u)));
    return SetPoint(points.key, reversed, shuffled);
}

fn sobol_point_dimension(p: SetPoint, d: u32) -> u32 {
    let pad = d / SOBOL_DIMENSIONS;
    let own = d % SOBOL_DIMENSIONS;
    var i = p.shuffled;
    if pad != 0u {
        i = reverseBits(sobol_scramble_reversed(p.reversed_index, sobol_derive(p.key, pad << 7u)));
    }
    let seed = sobol_derive(p.key, (pad << 7u) | (1u + own));
    return sobol_nested_uniform_scramble(sobol_fraction(i, own), seed);
}

fn sobol_point_unit(p: SetPoint, d: u32) -> f32 { return math_u32_to_unit(sobol_point_dimension(p, d)); }

fn sobol_set_dimension(points: SobolSet, index: u32, d: u32) -> u32 {
    return sobol_point_dimension(sobol_set_point(points, index), d);
}
