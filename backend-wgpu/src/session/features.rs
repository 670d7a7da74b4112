//! The code that a scene needs, as features of shaders.

use etendue_core::scene::CompiledScene;
use etendue_core::transport::TransportCode;

/// Features of the path tracer's shaders; what is not among them is not compiled.
pub(crate) fn of(scene: &CompiledScene) -> Vec<&'static str> {
    let needs = &scene.needs;
    let code = TransportCode::of(needs);
    let all = [
        (code.lobes, "LOBES"),
        (code.textures, "TEXTURES"),
        (code.shading_normals, "SHADING"),
        (needs.environment_image, "ENVIRONMENT_MAP"),
        (needs.round_shapes, "SHAPES"),
        (needs.volume(), "VOLUME"),
        (needs.grids, "GRIDS"),
        (needs.grids && scene.grids.iter().any(|g| g.channels == 3), "COLOURED_GRIDS"),
    ];
    chosen(&all)
}

fn chosen(all: &[(bool, &'static str)]) -> Vec<&'static str> {
    all.iter().filter(|f| f.0).map(|f| f.1).collect()
}

/// Features of waves from both ends. `DETAIL` is core's choice of formulas: one instance for all media but among diffuse surfaces of one colour.
pub(crate) fn of_both_ends(scene: &CompiledScene, cutoff: bool, search: bool) -> Vec<&'static str> {
    let code = TransportCode::of(&scene.needs);
    let detail = code.textures || code.shading_normals || (scene.needs.volume() && code.lobes);
    let mut all = of(scene);
    all.extend(chosen(&[
        (true, "BIDIRECTIONAL"),
        (detail, "DETAIL"),
        (cutoff, "CUTOFF"),
        (search, "SEARCH"),
    ]));
    all
}
