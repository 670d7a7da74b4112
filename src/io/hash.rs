//! What light's way through a scene depends on, as a hash.

use bytemuck::{NoUninit, cast_slice};
use etendue_core::scene::{CompiledScene, SurfaceRecord};

/// Words that are hashed at a time.
const CHUNK: usize = 1024;

/// A BLAKE3 hash of geometry, materials with their textures, media, and what surfaces emit: of all that an operator is made of. Lights without size, the environment and the camera
/// are left out, so that an operator fits its scene under any light. The same on every machine.
pub fn transport_hash(scene: &CompiledScene) -> [u8; 32] {
    // Exhaustive, so that a new field has to be thought of here.
    let CompiledScene {
        positions,
        triangles,
        shapes,
        surfaces,
        texcoords,
        normals,
        materials,
        material_names: _,
        checkers,
        // Made of materials.
        coats: _,
        textures,
        texels,
        srgb_decode: _,
        lights,
        light_cumulative: _,
        environment: _,
        environment_map: _,
        media,
        grids,
        grid_values,
        camera_medium: _,
        crossings: _,
        glows: _,
        camera: _,
        bounds: _,
        needs: _,
    } = scene;
    let mut hash = blake3::Hasher::new_derive_key("etendue 2026 transport of a scene, version 1");
    part(&mut hash, positions);
    part(&mut hash, triangles);
    part(&mut hash, shapes);
    let indices: Vec<SurfaceRecord> = surfaces.iter().map(|s| SurfaceRecord { light: 0, ..*s }).collect();
    part(&mut hash, &indices);
    // Instead of the index of the light, which counts lights without size too.
    let emitted: Vec<[f32; 3]> =
        surfaces.iter().map(|s| lights.get(s.light as usize).map_or([0.0; 3], |l| l.radiance)).collect();
    part(&mut hash, &emitted);
    part(&mut hash, texcoords);
    part(&mut hash, normals);
    part(&mut hash, materials);
    part(&mut hash, checkers);
    part(&mut hash, textures);
    part(&mut hash, texels);
    part(&mut hash, media);
    if !grids.is_empty() {
        part(&mut hash, grids);
        part(&mut hash, grid_values);
    }
    *hash.finalize().as_bytes()
}

/// An array of records of words, after its length.
fn part<T: NoUninit>(hash: &mut blake3::Hasher, records: &[T]) {
    let words: &[u32] = cast_slice(records);
    hash.update(&(words.len() as u64).to_le_bytes());
    let mut bytes = Vec::with_capacity(4 * CHUNK);
    for chunk in words.chunks(CHUNK) {
        bytes.clear();
        bytes.extend(chunk.iter().flat_map(|w| w.to_le_bytes()));
        hash.update(&bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_core::scene::{SceneDesc, compile};
    use std::path::Path;

    const SCENE: &str = "[camera]\nposition = [0, 1, -3]\nlook_at = [0, 1, 0]\nfov_x_deg = 40\n\
        [[mesh]]\nfile = \"a.obj\"\n[[shape]]\nkind = \"box\"\nmin = [-2, 0, -2]\nmax = [2, 3, 2]\nmaterial = \"wall\"\n\
        [[shape]]\nkind = \"rectangle\"\ncenter = [0, 2.9, 0]\nu = [0.5, 0, 0]\nv = [0, 0, 0.5]\nmaterial = \"lamp\"\n\
        [[light]]\nkind = \"point\"\nposition = [0, 2, 0]\nintensity = [1, 1, 1]\n\
        [[material]]\nname = \"wall\"\nkind = \"diffuse\"\nalbedo = [0.5, 0.5, 0.5]\n\
        [[material]]\nname = \"lamp\"\nkind = \"diffuse\"\nalbedo = [0, 0, 0]\nemission = [3, 3, 3]\n";
    const OBJ: &str =
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";
    const MTL: &str = "newmtl m\nKd 0.5 0.4 0.3\nmap_Kd a.png\n";

    fn hash(scene: &str, obj: &str, texel: u8) -> [u8; 32] {
        let folder = tempfile::tempdir().unwrap();
        let png = folder.path().join("a.png");
        crate::io::write_png(&png, 2, 1, &[[texel, 9, 9], [1, 2, 3]]).unwrap();
        let source = crate::io::MemorySource::new()
            .with("a.obj", obj)
            .with("a.mtl", MTL)
            .with("a.png", std::fs::read(png).unwrap());
        let desc: SceneDesc = crate::io::parse_scene_toml(scene, Path::new("s.toml"), &source).unwrap().desc;
        let (scene, _) = compile(&desc).unwrap();
        transport_hash(&scene)
    }

    /// The hash with a part of the scene's text replaced.
    fn with(from: &str, to: &str) -> [u8; 32] {
        assert!(SCENE.contains(from));
        hash(&SCENE.replace(from, to), OBJ, 7)
    }

    #[test]
    fn lights_and_cameras_do_not_matter() {
        let base = hash(SCENE, OBJ, 7);
        assert_eq!(base, hash(SCENE, OBJ, 7));
        let light = "[[light]]\nkind = \"point\"\nposition = [0, 2, 0]\nintensity = [1, 1, 1]\n";
        let more = "[[light]]\nkind = \"directional\"\ndirection = [0, -1, 0]\nirradiance = [1, 1, 1]\n";
        let sky = "[[light]]\nkind = \"environment\"\nradiance = [1, 2, 3]\n";
        for (from, to) in [
            ("intensity = [1, 1, 1]", "intensity = [5, 1, 1]"),
            ("position = [0, 2, 0]", "position = [1, 2, 0]"),
            (light, ""),
            (light, &format!("{more}{light}{light}")),
            (light, sky),
            ("position = [0, 1, -3]", "position = [0, 1, -2]"),
            ("fov_x_deg = 40", "fov_x_deg = 50"),
            ("\"wall\"", "\"paint\""),
        ] {
            assert_eq!(with(from, to), base, "{from:?} to {to:?}");
        }
    }

    #[test]
    fn surfaces_matter() {
        let base = hash(SCENE, OBJ, 7);
        for (from, to) in [
            ("max = [2, 3, 2]", "max = [2, 3, 2.001]"),
            ("albedo = [0.5, 0.5, 0.5]", "albedo = [0.5, 0.5, 0.6]"),
            ("emission = [3, 3, 3]", "emission = [3, 3, 4]"),
            ("emission = [3, 3, 3]", ""),
        ] {
            assert_ne!(with(from, to), base, "{from:?} to {to:?}");
        }
        assert_ne!(hash(SCENE, &OBJ.replace("v 1 0 0", "v 1.1 0 0"), 7), base, "a vertex");
        assert_ne!(hash(SCENE, &OBJ.replace("vt 1 0", "vt 0.9 0"), 7), base, "texture coordinates");
        assert_ne!(hash(SCENE, OBJ, 8), base, "a texel");
    }
}
