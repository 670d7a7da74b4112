// The scene is one bitmap, and its table of codes their own formula.
//: use kernel::words
//: use scene::bitmap

struct BitmapAt { srgb_decode: u32 }

var<private> scene_at: BitmapAt;

fn scene_word(i: u32) -> u32 { return constants[i]; }

fn scene_float(i: u32) -> f32 { return bitmap_srgb_to_linear(i); }

fn texel(i: u32) -> u32 {
    if 2u + i < constant_count { return constants[2u + i]; }
    return 0u;
}

fn kernel_bitmap_srgb_to_linear() { put(bitmap_srgb_to_linear(word() & 255u)); }

fn kernel_bitmap_sample_bitmap() {
    let width = max(constants[0], 1u);
    let height = max(constants[1], 1u);
    put3(bitmap_sample_bitmap(width, height, 0u, pair()));
}
