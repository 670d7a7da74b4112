// A scene whose arena are the constants of a kernel: one light.
//: use kernel::words

struct OneLightAt {
    light_count: u32,
    lights: u32,
    light_cumulative: u32,
    environment: u32,
    environment_width: u32,
    environment_height: u32,
    environment_light: u32,
    environment_to_world: u32,
    environment_texels: u32,
    environment_rows: u32,
    environment_row_count: u32,
    environment_starts: u32,
    environment_columns: u32,
}

var<private> scene_at: OneLightAt;

fn scene_word(i: u32) -> u32 { return constants[i]; }

fn scene_float(i: u32) -> f32 { return bitcast<f32>(constants[i]); }
