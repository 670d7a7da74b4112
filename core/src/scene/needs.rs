//! What light transport a scene needs, so that everything else costs it nothing.

use super::compiled::{CompiledScene, MaterialRecord, NO_INDEX, material_flags as flags};
use super::desc::MaterialDesc;
use super::glow;
use crate::light::emit::is_point_like;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

/// The light transport that occurs in a scene. A flag that is false names code that need not run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneNeeds {
    /// Some albedo is a bitmap or a checker.
    pub textures: bool,
    /// Some surface has a perfect mirror, or a smooth coat.
    pub mirrors: bool,
    /// Some surface has a Phong lobe.
    pub glossy: bool,
    /// Some surface is black from behind.
    pub one_sided: bool,
    /// Some surface is shaded by interpolated normals.
    pub shading_normals: bool,
    /// Spheres or disks beside triangles.
    pub round_shapes: bool,
    /// Point, spot or directional lights: only light sampling finds them.
    pub point_like_lights: bool,
    /// Emissive surfaces.
    pub area_lights: bool,
    /// Light from infinity in all directions.
    pub environment: bool,
    /// Some of it by a picture.
    pub environment_image: bool,
    /// More than one light to choose from.
    pub light_choice: bool,
    /// The camera has a lens.
    pub thin_lens: bool,
    /// Participating media.
    pub media: bool,
    /// Media whose density or albedo lies on a grid.
    pub grids: bool,
    /// Media that emit light.
    pub glowing_media: bool,
    /// Some of them may reach to infinity.
    pub endless_glow: bool,
    /// Boundaries that are no surfaces.
    pub null_boundaries: bool,
    /// Dielectrics that refract.
    pub refraction: bool,
    /// Thin plates and films.
    pub panes: bool,
    /// Rough metals or dielectrics.
    pub rough: bool,
    /// Diffuse bodies under a coat.
    pub plastic: bool,
    /// Films that scatter to both sides.
    pub scattering_films: bool,
    /// Kinds of material or medium that this version does not render, by name, each once.
    pub unsupported: Vec<String>,
}

impl SceneNeeds {
    /// What the parts of a scene need; `materials` are those that `scene.materials` were made of, `unsupported` what else is known to be missing.
    pub(super) fn of(
        scene: &CompiledScene,
        materials: &[MaterialDesc],
        media: bool,
        unsupported: Vec<String>,
    ) -> Self {
        let mut needs = Self {
            round_shapes: !scene.shapes.is_empty(),
            environment: scene.environment != [0.0; 3] || scene.environment_map.is_some(),
            environment_image: scene.environment_map.is_some(),
            light_choice: scene.lights.len() > 1,
            thin_lens: scene.camera.is_some_and(|c| c.lens_radius > 0.0),
            media,
            grids: media && !scene.grids.is_empty(),
            glowing_media: media && scene.media.iter().any(|m| m.emission != [0.0; 3]),
            endless_glow: media && glow::unbounded(scene),
            unsupported,
            ..Self::default()
        };
        let mut used = alloc::vec![false; scene.materials.len()];
        for s in &scene.surfaces {
            used[s.material as usize] = true;
            needs.shading_normals |= s.flags & flags::SHADING_NORMALS != 0;
        }
        for ((m, desc), _) in scene.materials.iter().zip(materials).zip(&used).filter(|e| *e.1) {
            needs.add_material(m, desc);
        }
        for l in &scene.lights {
            needs.area_lights |= l.primitive != NO_INDEX;
            needs.point_like_lights |= is_point_like(l);
        }
        needs
    }

    fn add_material(&mut self, m: &MaterialRecord, desc: &MaterialDesc) {
        let has = |flag: u32| m.flags & flag != 0;
        self.textures |= m.is_textured();
        self.rough |= has(flags::ROUGH) && !has(flags::PLASTIC);
        self.plastic |= has(flags::PLASTIC);
        self.scattering_films |= has(flags::SCATTERS);
        self.mirrors |= has(flags::MIRROR) || has(flags::PLASTIC) && !has(flags::ROUGH);
        self.glossy |= has(flags::GLOSSY);
        self.one_sided |= !has(flags::TWO_SIDED);
        self.null_boundaries |= has(flags::NULL);
        self.refraction |= has(flags::DIELECTRIC) && !has(flags::THIN);
        self.panes |= has(flags::THIN);
        if let Some(kind) = desc.kind.unsupported() {
            let name = format!("material kind \"{kind}\"");
            if !self.unsupported.contains(&name) {
                self.unsupported.push(name);
            }
        }
    }

    /// Something beyond two-sided diffuse surfaces has to be evaluated at a hit.
    pub fn lobes(&self) -> bool {
        self.mirrors
            || self.glossy
            || self.one_sided
            || self.refraction
            || self.panes
            || self.rough
            || self.plastic
            || self.scattering_films
    }

    /// Some surface reflects more than albedo / pi, or light that depends on its direction.
    pub fn beyond_diffuse(&self) -> bool {
        self.mirrors || self.glossy || self.rough || self.plastic
    }

    /// Nothing in the scene emits light.
    pub fn dark(&self) -> bool {
        !(self.point_like_lights || self.area_lights || self.environment || self.glowing_media)
    }

    /// Light is changed on its way or passes surfaces.
    pub fn volume(&self) -> bool {
        self.media || self.null_boundaries || self.refraction || self.panes || self.scattering_films
    }

    /// Why path tracing cannot render this scene; `None` where it can.
    pub fn beyond_paths(&self) -> Option<String> {
        (!self.unsupported.is_empty()).then(|| self.unsupported.join(", "))
    }

    /// Why photons cannot render this scene; `None` where they can.
    pub fn beyond_photons(&self) -> Option<String> {
        if self.endless_glow {
            return Some("media that emit light without bounds".into());
        }
        self.beyond_paths()
    }

    /// Why what knows surfaces alone cannot render this scene; `None` where it can.
    pub fn beyond_surfaces(&self) -> Option<String> {
        let parts = [
            (self.media, "participating media"),
            (self.null_boundaries, "null boundaries"),
            (self.refraction, "dielectrics"),
            (self.panes, "thin plates or films"),
            (self.scattering_films, "films that scatter"),
        ];
        let mut missing: Vec<&str> = parts.iter().filter(|p| p.0).map(|p| p.1).collect();
        missing.extend(self.unsupported.iter().map(String::as_str));
        (!missing.is_empty()).then(|| missing.join(", "))
    }
}

impl fmt::Display for SceneNeeds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = [
            (self.textures, "textures"),
            (self.mirrors, "mirrors"),
            (self.glossy, "Phong lobes"),
            (self.one_sided, "one-sided surfaces"),
            (self.shading_normals, "shading normals"),
            (self.round_shapes, "spheres or disks"),
            (self.point_like_lights, "point-like lights"),
            (self.area_lights, "area lights"),
            (self.environment, "environment light"),
            (self.environment_image, "a picture of the environment"),
            (self.light_choice, "a choice of lights"),
            (self.thin_lens, "thin lens"),
            (self.media, "participating media"),
            (self.grids, "media on grids"),
            (self.glowing_media, "media that emit"),
            (self.null_boundaries, "null boundaries"),
            (self.refraction, "dielectrics"),
            (self.panes, "thin plates or films"),
            (self.rough, "rough metals or dielectrics"),
            (self.plastic, "plastic"),
            (self.scattering_films, "films that scatter"),
        ];
        let mut first = true;
        for name in
            named.iter().filter(|n| n.0).map(|n| n.1).chain(self.unsupported.iter().map(String::as_str))
        {
            write!(f, "{}{name}", if first { "" } else { ", " })?;
            first = false;
        }
        if first {
            f.write_str("diffuse surfaces only")?;
        }
        Ok(())
    }
}
