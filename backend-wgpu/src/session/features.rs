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
    all.into_iter().filter(|f| f.0).map(|f| f.1).collect()
}
