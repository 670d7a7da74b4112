use super::*;
use etendue_core::kernel::Kernel;
use naga::valid::GlobalUse;

/// Parses and validates; where sums may be reordered (`REORDERED`), an entry point that keeps some must know the zero that hides them.
fn validate(name: &str, text: &str) {
    let module = match naga::front::wgsl::parse_str(text) {
        Ok(module) => module,
        Err(e) => panic!("{name} does not parse:\n{}", e.emit_to_string(text)),
    };
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    let info = match validator.validate(&module) {
        Ok(info) => info,
        Err(e) => panic!("{name} is not valid:\n{}", e.emit_to_string(text)),
    };
    let opaque = module.global_variables.iter().find(|(_, v)| v.name.as_deref() == Some("math_opaque"));
    let Some((opaque, _)) = opaque else { return };
    for (i, entry) in module.entry_points.iter().enumerate() {
        let used = info.get_entry_point(i)[opaque];
        let (read, written) = (GlobalUse::READ, GlobalUse::WRITE);
        assert!(
            !used.contains(read) || used.contains(written),
            "{name}: `{}` does not set math_opaque",
            entry.name
        );
    }
}

/// Both kinds of devices.
fn with_and_without(features: &[&'static str]) -> [Vec<&'static str>; 2] {
    [features.to_vec(), [features, &[REORDERED]].concat()]
}

fn link(root: &str, features: &[&str]) -> Result<String, LinkError> {
    Link { root, features, mutations: &[] }.text()
}

#[test]
fn every_kernel_is_valid() {
    for kernel in Kernel::ALL.iter().filter(|k| crate::kernels::is_here(**k)) {
        for features in with_and_without(crate::kernels::FEATURES) {
            let text = link(&crate::kernels::root(*kernel), &features).unwrap();
            validate(kernel.name(), &text);
        }
    }
}

/// What files leave to the shader that uses them: as it is used, as it is defined, a definition.
const ELSEWHERE: &[[&str; 3]] = &[
    ["discrete_count(", "fn discrete_count(", "fn discrete_count(i: u32) -> u32 { return i; }"],
    ["scene_word(", "fn scene_word(", "fn scene_word(i: u32) -> u32 { return i; }"],
    ["scene_float(", "fn scene_float(", "fn scene_float(i: u32) -> f32 { return f32(i); }"],
    ["grid_value(", "fn grid_value(", "fn grid_value(i: u32) -> f32 { return f32(i); }"],
    ["element_word(", "fn element_word(", "fn element_word(i: u32) -> u32 { return i; }"],
    ["job_word(", "fn job_word(", "fn job_word(i: u32) -> u32 { return i; }"],
    [
        "map_value(",
        "fn map_value(",
        "fn map_value(at: u32, i: u32) -> vec3<f32> { return vec3(f32(at + i)); }",
    ],
    [
        "photon_glow(",
        "fn photon_glow(",
        "fn photon_glow(i: u32, u: vec4<f32>) -> Emission { return Emission(Ray(u.xyz, u.xyz, f32(i)), u.xyz); }",
    ],
    ["COUNTS_OF_JOB", "const COUNTS_OF_JOB", "const COUNTS_OF_JOB: u32 = 0x80000000u;"],
    ["counts_at", "> counts_at:", "var<private> counts_at: u32;"],
    ["states[", "> states:", "@group(0) @binding(7) var<storage, read_write> states: array<u32>;"],
    ["job.slots", "> job:", "struct OnlySlots { slots: u32 }\nvar<private> job: OnlySlots;"],
    ["ROW_ORIGIN", "const ROW_ORIGIN", "const ROW_ORIGIN: u32 = 0u;"],
    ["ROW_DIRECTION", "const ROW_DIRECTION", "const ROW_DIRECTION: u32 = 3u;"],
    ["ROW_T_MAX", "const ROW_T_MAX", "const ROW_T_MAX: u32 = 6u;"],
    ["ROW_HIT)", "const ROW_HIT:", "const ROW_HIT: u32 = 7u;"],
    ["&sums[", "> sums:", "@group(0) @binding(8) var<storage, read_write> sums: array<atomic<u32>>;"],
    ["texel(", "fn texel(", "fn texel(i: u32) -> u32 { return i; }"],
    ["scene_at.", "> scene_at:", "var<private> scene_at: SceneOffsets;"],
    ["TREE_STACK", "const TREE_STACK", "const TREE_STACK: u32 = 8u;"],
    ["SceneOffsets", "struct SceneOffsets", crate::session::OFFSETS],
];

#[test]
fn every_file_is_valid_with_what_it_uses() {
    for (path, _) in FILES {
        for features in [&[], crate::kernels::FEATURES].into_iter().flat_map(with_and_without) {
            // Adaptors of kernels read words, and say so here alone.
            let root = format!("//: use kernel::words\n//: use {}\n", path.replace('/', "::"));
            let mut linked = link(&root, &features).unwrap();
            for [used, defined, definition] in ELSEWHERE {
                if linked.contains(used) && !linked.contains(defined) {
                    linked.push_str(definition);
                }
            }
            validate(path, &linked);
        }
    }
}

#[test]
fn features_choose_text() {
    let root = "a\n//: if X\nb\n//: if Y\nc\n//: end\n//: else\nd\n//: end\n//: if not Y\ne\n//: end\n";
    let lines = |features: &[&str]| -> String {
        link(root, features).unwrap().lines().filter(|l| l.len() == 1).collect()
    };
    assert_eq!(lines(&[]), "ade");
    assert_eq!(lines(&["X"]), "abe");
    assert_eq!(lines(&["X", "Y"]), "abc");
    assert_eq!(lines(&["Y"]), "ad");
}

#[test]
fn mistakes_are_named() {
    assert!(matches!(link("//: use nowhere", &[]), Err(LinkError::NoFile { .. })));
    assert!(matches!(link("//: if X", &[]), Err(LinkError::Directive { line: 1, .. })));
    assert!(matches!(link("\n//: end", &[]), Err(LinkError::Directive { line: 2, .. })));
    assert!(matches!(link("//: frobnicate", &[]), Err(LinkError::Directive { .. })));
    let mutation = Mutation { module: "math::bits", from: "no such text", to: "" };
    let wrong = Link { root: "", features: &[], mutations: &[mutation] }.text();
    assert!(matches!(wrong, Err(LinkError::Mutation { occurrences: 0, .. })));
}

#[test]
fn an_entry_point_without_the_hidden_zero_is_found() {
    let text = "//: use math::sums\n@group(0) @binding(0) var<storage, read_write> x: array<f32>;
        @compute @workgroup_size(1) fn main() { x[0] = math_two_sum(x[1], x[2]).error; }";
    let reordered = link(text, &[REORDERED]).unwrap();
    assert!(std::panic::catch_unwind(|| validate("it", &reordered)).is_err());
    validate("it", &link(text, &[]).unwrap());
}
