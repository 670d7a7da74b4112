// Words in and out of a kernel, in order: core's Reader and Writer.

@group(0) @binding(1) var<storage, read> constants: array<u32>;
@group(0) @binding(2) var<storage, read> items: array<u32>;
@group(0) @binding(3) var<storage, read_write> results: array<u32>;

// How many constants there are: the buffer may be longer, as none is shorter than 16 bytes.
var<private> constant_count: u32;
var<private> item_at: u32;
var<private> constant_at: u32;
var<private> result_at: u32;

fn start_item(item: u32, result: u32, words: u32) {
    item_at = item;
    result_at = result;
    // What is not written is zero.
    for (var i = 0u; i < words; i++) { results[result + i] = 0u; }
}

fn word() -> u32 {
    item_at += 1u;
    return items[item_at - 1u];
}

fn float() -> f32 { return bitcast<f32>(word()); }

fn pair() -> vec2<f32> {
    let x = float();
    return vec2(x, float());
}

fn triple() -> vec3<f32> {
    let x = float();
    let y = float();
    return vec3(x, y, float());
}

// The next word of the constants.
fn constant_word() -> u32 {
    constant_at += 1u;
    return constants[constant_at - 1u];
}

fn constant_float() -> f32 { return bitcast<f32>(constant_word()); }

fn constant_triple() -> vec3<f32> {
    let x = constant_float();
    let y = constant_float();
    return vec3(x, y, constant_float());
}

fn put_word(x: u32) {
    results[result_at] = x;
    result_at += 1u;
}

fn put(x: f32) { put_word(bitcast<u32>(x)); }

fn put2(v: vec2<f32>) {
    put(v.x);
    put(v.y);
}

fn put3(v: vec3<f32>) {
    put(v.x);
    put(v.y);
    put(v.z);
}

fn put_words4(x: vec4<u32>) {
    put_word(x.x);
    put_word(x.y);
    put_word(x.z);
    put_word(x.w);
}
