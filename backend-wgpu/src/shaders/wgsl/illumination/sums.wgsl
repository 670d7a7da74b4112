// Sums of arrivals in fixed point, six words an element: three sums of two words, among `sums`, the atomic words of the shader that uses
// this file. They are core's whole numbers, in whatever order they are made.
//: use illumination
//: use illumination::elements

fn sums_add(at: u32, x: vec2<u32>) {
    if (x.x | x.y) != 0u {
        let old = atomicAdd(&sums[at], x.x);
        let high = x.y + u32(old + x.x < old);
        if high != 0u { atomicAdd(&sums[at + 1u], high); }
    }
}

// Adds flux in units of 2^-power W to elements below `count`, the first of which is at `at`.
fn sums_deposit(deposit: Deposit, at: u32, count: u32, flux: vec3<f32>, power: i32) {
    for (var k = 0u; k < deposit.count; k++) {
        let element = deposit.elements[k];
        if element < count {
            let share = flux * deposit.factors[k];
            let sum = at + 6u * element;
            sums_add(sum, illumination_units(share.x, power));
            sums_add(sum + 2u, illumination_units(share.y, power));
            sums_add(sum + 4u, illumination_units(share.z, power));
        }
    }
}
