// A grid whose words and values are the constants of a kernel; behind its values are the majorants of its blocks, which no batch brings.
//: use kernel::words
//: use medium::grid
//: use medium::grid::regular

fn scene_word(i: u32) -> u32 { return constants[i]; }

fn scene_float(i: u32) -> f32 { return bitcast<f32>(constants[i]); }

var<private> kernel_grid_size: vec3<u32>;
var<private> kernel_grid_channels: u32;
var<private> kernel_grid_count: u32;

fn kernel_grid_majorant(block: u32) -> f32 {
    let size = kernel_grid_size;
    let blocks = grid_blocks(size);
    let b = vec3(block % blocks.x, block / blocks.x % blocks.y, block / blocks.x / blocks.y) << vec3(3u);
    let low = b - min(b, vec3(1u));
    let high = min(b + vec3(8u), size);
    var largest = 0.0f;
    for (var z = low.z; z < high.z; z++) {
        for (var y = low.y; y < high.y; y++) {
            for (var x = low.x; x < high.x; x++) {
                for (var c = 0u; c < kernel_grid_channels; c++) {
                    let at = ((z * size.y + y) * size.x + x) * kernel_grid_channels + c;
                    largest = math_max_number(largest, bitcast<f32>(constants[16u + at]));
                }
            }
        }
    }
    return largest;
}

fn grid_value(i: u32) -> f32 {
    if i < kernel_grid_count { return bitcast<f32>(constants[16u + i]); }
    return kernel_grid_majorant(i - kernel_grid_count);
}

fn kernel_grid_grid() -> Grid {
    let size = vec3(constants[0], constants[1], constants[2]);
    let channels = select(1u, 3u, constants[3] == 3u);
    kernel_grid_size = size;
    kernel_grid_channels = channels;
    kernel_grid_count = size.x * size.y * size.z * channels;
    return Grid(grid_float4(4u), grid_float4(8u), grid_float4(12u), size, channels, 0u, kernel_grid_count);
}

// Fewer values than the size says, or none.
fn kernel_grid_is_missing() -> bool {
    var rest = (constant_count - 16u) / select(1u, 3u, constants[3] == 3u);
    for (var k = 0u; k < 3u; k++) {
        if constants[k] == 0u { return true; }
        rest = rest / constants[k];
    }
    return rest == 0u;
}

fn kernel_grid_at() {
    if kernel_grid_is_missing() { return; }
    put3(grid_at(kernel_grid_grid(), triple()));
}

fn kernel_grid_optical_length() {
    if kernel_grid_is_missing() { return; }
    let grid = kernel_grid_grid();
    let origin = triple();
    let line = grid_line(grid, origin, triple());
    put3(regular_optical_length(grid, line, float(), vec3(0.0f)));
}
