//! Shaders whose arithmetic the driver leaves as it is written.
//!
//! WGSL lets a compiler reorder sums and fuse products (WGSL, "Reassociation and Fusion"), and Mesa's does: `(a + b) - a` becomes `b`, which
//! undoes every sum that carries its own rounding error. SPIR-V has a decoration against it, `NoContraction`, that WGSL has no word
//! for. Where the device takes SPIR-V as it is (Vulkan), naga translates the shader here, with the bounds checks that wgpu would
//! ask for, and each sum, difference, product and quotient is decorated. Elsewhere wgpu translates, and results agree within the
//! tolerances for peers.

use super::Gpu;
use etendue_core::backend::BackendError;
use naga::back::spv;
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::borrow::Cow;

impl Gpu {
    /// Whether shaders keep their arithmetic as written.
    pub(crate) fn is_exact(&self) -> bool {
        self.device.features().contains(wgpu::Features::PASSTHROUGH_SHADERS)
            && self.device.adapter_info().backend == wgpu::Backend::Vulkan
    }

    /// A shader module of WGSL text, for one of its entry points, and the bytes that the device is given.
    pub(super) fn module(
        &self,
        name: &str,
        entry: &str,
        text: String,
    ) -> Result<(wgpu::ShaderModule, usize), BackendError> {
        if !self.is_exact() {
            let bytes = text.len();
            let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(name),
                source: wgpu::ShaderSource::Wgsl(text.into()),
            });
            return Ok((module, bytes));
        }
        let (words, [x, y, z]) =
            translate(&text, entry).map_err(|e| self.refused(format!("shader {name}: {e}")))?;
        let bytes = 4 * words.len();
        let entry_points =
            vec![wgpu::PassthroughShaderEntryPoint { name: entry.into(), workgroup_size: (x, y, z) }];
        let descriptor = wgpu::ShaderModuleDescriptorPassthrough {
            label: Some(name),
            entry_points: entry_points.into(),
            spirv: Some(Cow::Owned(words)),
            ..Default::default()
        };
        // SAFETY: the words are naga's translation of a module that naga has validated, with every index checked; decorations change no
        // meaning but that of reordering.
        #[allow(unsafe_code, reason = "wgpu takes SPIR-V by this door alone")]
        let module = unsafe { self.device.create_shader_module_passthrough(descriptor) };
        Ok((module, bytes))
    }
}

/// WGSL to SPIR-V with decorated arithmetic, and the workgroup of the entry point. What the entry point does not reach is left out: some
/// drivers compile all that a module has, for each of its pipelines.
fn translate(text: &str, entry: &str) -> Result<(Vec<u32>, [u32; 3]), String> {
    let module = naga::front::wgsl::parse_str(text).map_err(|e| e.emit_to_string(text))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|e| e.emit_to_string(text))?;
    let binding_map = module
        .global_variables
        .iter()
        .filter_map(|(_, v)| v.binding)
        .map(|b| {
            let info =
                spv::BindingInfo { descriptor_set: b.group, binding: b.binding, binding_array_size: None };
            (b, info)
        })
        .collect();
    let options = spv::Options {
        // What every Vulkan takes.
        lang_version: (1, 0),
        flags: spv::WriterFlags::empty(),
        binding_map,
        bounds_check_policies: BoundsCheckPolicies {
            index: BoundsCheckPolicy::Restrict,
            buffer: BoundsCheckPolicy::Restrict,
            image_load: BoundsCheckPolicy::Restrict,
            binding_array: BoundsCheckPolicy::Unchecked,
        },
        ..spv::Options::default()
    };
    let found = module.entry_points.iter().find(|e| e.name == entry);
    let workgroup = found.ok_or_else(|| format!("no entry point `{entry}`"))?.workgroup_size;
    let one = spv::PipelineOptions { shader_stage: naga::ShaderStage::Compute, entry_point: entry.into() };
    let words = spv::write_vec(&module, &info, &options, Some(&one)).map_err(|e| e.to_string())?;
    Ok((decorated(&words), workgroup))
}

/// Words before the first instruction.
const HEADER: usize = 5;

const OP_EXECUTION_MODE: u32 = 16;
const OP_DECORATE: u32 = 71;
const NO_CONTRACTION: u32 = 42;
/// `OpFNegate`, `OpFAdd`, `OpFSub`, `OpFMul`, `OpFDiv`, `OpVectorTimesScalar`, `OpDot` (SPIR-V 1.0, section 3.32.13).
const ARITHMETIC: [u32; 7] = [127, 129, 131, 133, 136, 142, 148];
/// What comes before annotations: capabilities to `OpModuleProcessed` (section 2.4).
const BEFORE_ANNOTATIONS: [u32; 15] = [17, 10, 11, 14, 15, OP_EXECUTION_MODE, 3, 4, 7, 2, 5, 6, 8, 330, 331];

/// The same module with `NoContraction` on the result of every float operation.
fn decorated(words: &[u32]) -> Vec<u32> {
    let mut results = Vec::new();
    let mut annotations = HEADER;
    let mut at = HEADER;
    while at < words.len() {
        let (op, length) = (words[at] & 0xffff, (words[at] >> 16) as usize);
        if BEFORE_ANNOTATIONS.contains(&op) && annotations == at {
            annotations = at + length;
        }
        if ARITHMETIC.contains(&op) {
            results.push(words[at + 2]);
        }
        at += length.max(1);
    }
    let mut out = words[..annotations].to_vec();
    for id in results {
        out.extend([3 << 16 | OP_DECORATE, id, NO_CONTRACTION]);
    }
    out.extend(&words[annotations..]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_float_operation_is_decorated() {
        let text = "@group(0) @binding(0) var<storage, read_write> x: array<f32>;
            @compute @workgroup_size(64) fn main() { x[0] = (x[1] + x[2]) * x[3] - x[4] / x[5]; }";
        let (words, workgroup) = translate(text, "main").unwrap();
        assert_eq!(workgroup, [64, 1, 1]);
        let decorations =
            words.windows(3).filter(|w| w[0] == (3 << 16 | OP_DECORATE) && w[2] == NO_CONTRACTION).count();
        assert_eq!(decorations, 4);
    }

    #[test]
    fn mistakes_are_told() {
        assert!(translate("fn f() -> f32 { return 1u; }", "f").is_err());
        assert!(translate("fn f() -> f32 { return 1f; }", "f").is_err());
    }
}
