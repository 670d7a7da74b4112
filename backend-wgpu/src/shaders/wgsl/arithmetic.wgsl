// Operations that show how a device rounds; the host does the same ones and compares.
//: use math::bits

// Three ordinary numbers, a subnormal one, and two whose product is subnormal.
@group(0) @binding(0) var<storage, read> given: array<f32>;
@group(0) @binding(1) var<storage, read_write> found: array<f32>;

@compute @workgroup_size(64)
fn arithmetic(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = 6u * id.x;
    if i + 5u >= arrayLength(&given) { return; }
    let a = given[i];
    let b = given[i + 1u];
    let c = given[i + 2u];
    let o = 7u * id.x;
    found[o] = a * b + c;
    found[o + 1u] = (a + b) - a;
    found[o + 2u] = a / b;
    found[o + 3u] = sqrt(math_abs(a));
    found[o + 4u] = a * b - a * c;
    found[o + 5u] = given[i + 3u] * 1073741824.0f;
    found[o + 6u] = given[i + 4u] * given[i + 5u];
}
