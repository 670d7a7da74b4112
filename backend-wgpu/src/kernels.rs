//! [`map`]: one kernel over a batch, in as many dispatches as the device's limits make it.

use crate::gpu::{Binding, Gpu, PipelineKey};
use crate::shaders::{Link, find};
use etendue_core::backend::BackendError;
use etendue_core::kernel::Kernel;

/// Invocations of a workgroup.
const WORKGROUP: u32 = 64;
/// Items of one dispatch at most: a kernel that searches takes microseconds an item on a software device.
const SLICE: u64 = 1 << 16;

/// Kernels have all of the code: no scene says what it does without.
pub(crate) const FEATURES: &[&str] = &[
    "LOBES",
    "TEXTURES",
    "SHADING",
    "SHAPES",
    "ENVIRONMENT_MAP",
    "VOLUME",
    "GRIDS",
    "COLOURED_GRIDS",
    "AIRLIGHT",
    "BIDIRECTIONAL",
    "DETAIL",
    "CUTOFF",
    "SEARCH",
];

/// The file that has a kernel's adaptor: core's `evaluate` in WGSL.
fn adaptor(kernel: Kernel) -> String {
    format!("kernel::{}", kernel.module())
}

/// Whether there is a shader for it.
pub(crate) fn is_here(kernel: Kernel) -> bool {
    find(&adaptor(kernel)).is_some_and(|text| text.contains(&format!("fn {}(", entry(kernel))))
}

fn entry(kernel: Kernel) -> String {
    format!("kernel_{}", kernel.name().replace("::", "_"))
}

/// The text that runs a kernel over the items of a batch.
pub(crate) fn root(kernel: Kernel) -> String {
    let shape = kernel.shape();
    root_of(&adaptor(kernel), &entry(kernel), [shape.item, shape.out])
}

/// The text that runs `entry` of a file over the items of a batch; words of an item and of its result.
fn root_of(module: &str, entry: &str, [item, out]: [usize; 2]) -> String {
    format!(
        "//: use kernel::words
//: use math::bits
//: use {module}
struct Batch {{ count: u32, constants: u32, zero: u32, pad: u32 }}
@group(0) @binding(0) var<uniform> batch: Batch;
@compute @workgroup_size({WORKGROUP})
fn main(@builtin(global_invocation_id) id: vec3<u32>) {{
    if id.x >= batch.count {{ return; }}
    constant_count = batch.constants;
//: if REORDERED
    math_opaque = batch.zero;
//: end
    start_item(id.x * {item}u, id.x * {out}u, {out}u);
    {entry}();
}}
"
    )
}

/// Evaluates a kernel over a batch.
///
/// # Errors
/// When a slice has the wrong length, there is no such kernel, or the device refuses.
pub(crate) fn map(
    gpu: &Gpu,
    kernel: Kernel,
    constants: &[u32],
    items: &[u32],
    out: &mut [u32],
) -> Result<(), BackendError> {
    let shape = kernel.check(constants, items, out)?;
    if !is_here(kernel) {
        return Err(crate::unsupported(format!("kernel {}", kernel.name())));
    }
    let link = Link { root: &root(kernel), features: FEATURES, mutations: &[] };
    run(gpu, kernel.name(), link, [shape.item, shape.out], constants, items, out)
}

/// Runs the text of [`root_of`] over a batch; lengths fit.
fn run(
    gpu: &Gpu,
    name: &str,
    link: Link<'_>,
    [item, result]: [usize; 2],
    constants: &[u32],
    items: &[u32],
    out: &mut [u32],
) -> Result<(), BackendError> {
    let key = PipelineKey { name: name.into(), entry: "main" };
    let bindings = [Binding::Uniform, Binding::Read, Binding::Read, Binding::Write];
    let pipeline = gpu.pipeline(key, link, &bindings)?;
    let widest = item.max(result).max(1) as u64;
    let slice = SLICE.min(gpu.binding_bytes() / (4 * widest)).min(gpu.dispatch_items(WORKGROUP)) as usize;
    gpu.scoped(|| {
        let constant_count = constants.len() as u32;
        let constants = gpu.upload("constants", constants)?;
        let pairs = items.chunks(slice * item).zip(out.chunks_mut(slice * result));
        for (items, out) in pairs {
            let count = (items.len() / item) as u32;
            let uniform = gpu.uniform("batch", &[count, constant_count, 0, 0]);
            let input = gpu.upload("items", items)?;
            let output = gpu.room("results", out.len() as u64)?;
            let group = gpu.bind(&pipeline, &[&uniform, &constants, &input, &output]);
            let mut encoder = gpu.encoder();
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&pipeline.raw);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups(count.div_ceil(WORKGROUP), 1, 1);
            }
            let words = gpu.submit_and_read(encoder, &output, out.len() as u64).wait(gpu)?;
            out.copy_from_slice(&words);
        }
        Ok(())
    })
}

#[cfg(test)]
mod grid;
#[cfg(test)]
mod sums;
#[cfg(test)]
mod twins;
