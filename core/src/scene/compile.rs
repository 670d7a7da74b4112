//! `SceneDesc -> CompiledScene`: names become indices, everything is checked once, lights are collected.

use super::check::{finite, not_negative, out_of_range, positive, unit};
use super::compiled::{
    CompiledScene, MaterialRecord, MediumRecord, NO_INDEX, SurfaceRecord, TextureRecord, material_flags,
};
use super::desc::{
    LightDesc, MaterialDesc, MaterialKind, MediumDesc, MeshDesc, Reflectance, SceneDesc, ShapeDesc,
    ShapeKind, TextureDesc,
};
use super::environment;
use super::error::{Cleanup, CompileReport, SceneError};
use super::grid;
use super::lights::{self, LightDraft};
use super::material::{checker_record, coat_record, material_record};
use super::mesh::{MeshTransform, check_mesh, repeated_triangles};
use super::needs::SceneNeeds;
use crate::geometry::{Aabb, BoxTree, RoundShape, geometric_normal, sliver_factor};
use crate::math::Vec3;
use crate::sensor::Camera;
use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

/// Largest number of primitives, vertices or texels: indices are 32 bits, and the last one means "none".
pub(super) const MAX_COUNT: usize = u32::MAX as usize - 1;
/// How near to a boundary something touches it, in radii of the scene.
const TOUCHING: f32 = 1e-5;
/// Name of the material of surfaces that name none: diffuse, albedo 0.5.
const DEFAULT_MATERIAL: &str = "(default)";

/// Validates a scene and makes it ready for a backend.
///
/// # Errors
/// The first defect found, with its place and the numbers. Defects that can be mended without changing what the
/// scene means (triangles without area, lights without power) are mended and counted in the report instead.
pub fn compile(desc: &SceneDesc) -> Result<(CompiledScene, CompileReport), SceneError> {
    let mut b = Builder::default();
    let textures = b.textures(&desc.textures)?;
    b.materials(&desc.materials, &textures)?;
    b.media(&desc.media)?;
    for (i, mesh) in desc.meshes.iter().enumerate() {
        b.mesh(i, mesh)?;
    }
    for (i, shape) in desc.shapes.iter().enumerate() {
        b.shape(i, shape)?;
    }
    b.append_round_shapes();
    if b.out.surfaces.is_empty() {
        return Err(SceneError::Empty);
    }
    if b.out.surfaces.len() > MAX_COUNT || b.out.positions.len() > MAX_COUNT {
        return Err(SceneError::TooLarge { what: "primitives", found: b.out.surfaces.len() });
    }
    let primitives = b.out.primitives();
    let mut bounds = Aabb::EMPTY;
    for id in 0..primitives.count() as u32 {
        bounds = bounds.union(primitives.bounds(id));
    }
    b.out.bounds = bounds;
    for (i, light) in desc.lights.iter().enumerate() {
        b.light(i, light)?;
    }
    if let Some(camera) = &desc.camera {
        b.out.camera = Some(Camera::try_new(camera)?);
        // There are fewer media than a u16 counts.
        b.out.camera_medium = b.medium_index("camera", &camera.medium)? as u16;
    }
    let drafts = core::mem::take(&mut b.lights);
    lights::finish(&mut b.out, drafts, &mut b.report)?;
    let missing = core::mem::take(&mut b.unsupported);
    b.out.glows = super::glow::glows(&b.out);
    b.out.needs = SceneNeeds::of(&b.out, &b.material_drafts, b.media_present, missing);
    b.out.crossings = crossings(&b.out);
    Ok((b.out, b.report))
}

/// See [`CompiledScene::crossings`].
fn crossings(scene: &CompiledScene) -> BoxTree {
    if !scene.needs.null_boundaries && !scene.needs.panes {
        return BoxTree::default();
    }
    let primitives = scene.primitives();
    // Wider than any ray is moved off a surface.
    let reach = Vec3::splat(TOUCHING * scene.bounding_sphere().1);
    let wide = |id: u32| {
        let b = primitives.bounds(id);
        Aabb { lo: b.lo - reach, hi: b.hi + reach }
    };
    let all = 0..primitives.count() as u32;
    let passes = |id: &u32| scene.material_of(*id).flags & material_flags::PASSES != 0;
    let boundaries = BoxTree::new(all.clone().filter(passes).map(|id| (wide(id), id)));
    BoxTree::new(
        all.filter(|id| boundaries.touches(&primitives.bounds(*id))).map(|id| (primitives.bounds(id), id)),
    )
}

/// The scene under construction.
#[derive(Default)]
struct Builder {
    out: CompiledScene,
    report: CompileReport,
    material_names: BTreeMap<String, u32>,
    material_drafts: Vec<MaterialDesc>,
    medium_names: BTreeMap<String, u32>,
    lights: Vec<LightDraft>,
    /// Round shapes wait here until all triangles are in: as primitives they come last.
    round: Vec<(RoundShape, SurfaceRecord)>,
    unsupported: Vec<String>,
    media_present: bool,
}

impl Builder {
    fn textures(&mut self, list: &[TextureDesc]) -> Result<BTreeMap<String, u32>, SceneError> {
        let mut names = BTreeMap::new();
        for t in list {
            let place = format!("texture \"{}\"", t.name);
            let expected = t.width as usize * t.height as usize;
            if expected == 0 || t.texels.len() != expected {
                return Err(SceneError::WrongLength {
                    place,
                    field: "texels",
                    found: t.texels.len(),
                    expected: expected.max(1),
                });
            }
            let first_texel = self.out.texels.len();
            if first_texel + expected > MAX_COUNT {
                return Err(SceneError::TooLarge { what: "texels", found: first_texel + expected });
            }
            if names.insert(t.name.clone(), self.out.textures.len() as u32).is_some() {
                return Err(SceneError::DuplicateName { kind: "texture", name: t.name.clone() });
            }
            self.out.textures.push(TextureRecord {
                width: t.width,
                height: t.height,
                first_texel: first_texel as u32,
                pad: 0,
            });
            self.out.texels.extend(
                t.texels.iter().map(|c| u32::from(c[0]) | u32::from(c[1]) << 8 | u32::from(c[2]) << 16),
            );
        }
        self.out.srgb_decode = (0..=255u8).map(super::srgb_to_linear).collect();
        Ok(names)
    }

    fn materials(
        &mut self,
        list: &[MaterialDesc],
        textures: &BTreeMap<String, u32>,
    ) -> Result<(), SceneError> {
        for m in list {
            let record = material_record(m, textures)?;
            self.add_material(m, record)?;
        }
        Ok(())
    }

    fn add_material(&mut self, m: &MaterialDesc, mut record: MaterialRecord) -> Result<u32, SceneError> {
        let index = self.out.materials.len() as u32;
        if let Some(checker) = checker_record(m)? {
            record.checker = self.out.checkers.len() as u32;
            self.out.checkers.push(checker);
        }
        if record.flags & material_flags::PLASTIC != 0 {
            record.coat = self.coat(&record);
        }
        if self.material_names.insert(m.name.clone(), index).is_some() {
            return Err(SceneError::DuplicateName { kind: "material", name: m.name.clone() });
        }
        self.out.materials.push(record);
        self.out.material_names.push(m.name.clone());
        self.material_drafts.push(m.clone());
        Ok(index)
    }

    /// Index of the coat of a plastic: one for all of the same index and surface.
    fn coat(&mut self, record: &MaterialRecord) -> u32 {
        let same =
            |m: &&MaterialRecord| m.coat != NO_INDEX && m.ior == record.ior && m.rough() == record.rough();
        if let Some(known) = self.out.materials.iter().find(same) {
            return known.coat;
        }
        self.out.coats.push(coat_record(record));
        self.out.coats.len() as u32 - 1
    }

    fn material_index(&mut self, place: &str, name: &str) -> Result<u32, SceneError> {
        if name.is_empty() {
            if let Some(&i) = self.material_names.get(DEFAULT_MATERIAL) {
                return Ok(i);
            }
            let m = MaterialDesc {
                name: DEFAULT_MATERIAL.to_string(),
                kind: MaterialKind::Diffuse { albedo: Reflectance::flat([0.5; 3]) },
                two_sided: true,
                emission: [0.0; 3],
            };
            let record = material_record(&m, &BTreeMap::new())?;
            return self.add_material(&m, record);
        }
        self.material_names.get(name).copied().ok_or_else(|| SceneError::UnknownName {
            place: place.to_string(),
            kind: "material",
            name: name.to_string(),
        })
    }

    fn media(&mut self, list: &[MediumDesc]) -> Result<(), SceneError> {
        for m in list {
            let place = format!("medium \"{}\"", m.name);
            not_negative(&place, "sigma_a", &m.sigma_a)?;
            not_negative(&place, "sigma_s", &m.sigma_s)?;
            not_negative(&place, "emission", &m.emission)?;
            finite(&place, "g", &[m.g])?;
            if m.g <= -1.0 || m.g >= 1.0 {
                return out_of_range(&place, "g", m.g, "a number between -1 and 1, ends excluded");
            }
            if self.medium_names.insert(m.name.clone(), self.out.media.len() as u32).is_some() {
                return Err(SceneError::DuplicateName { kind: "medium", name: m.name.clone() });
            }
            self.unsupported(&m.unsupported);
            let [density_grid, albedo_grid] = grid::add(&mut self.out, &place, m)?;
            self.out.media.push(MediumRecord {
                sigma_a: m.sigma_a,
                g: m.g,
                sigma_s: m.sigma_s,
                priority: m.priority,
                emission: m.emission,
                density_grid,
                albedo_grid,
                pad: [0; 3],
            });
        }
        if self.out.media.len() >= 0xffff {
            return Err(SceneError::TooLarge { what: "media", found: self.out.media.len() });
        }
        Ok(())
    }

    /// Notes what this version does not render; nothing where the name is empty.
    fn unsupported(&mut self, what: &str) {
        if !what.is_empty() && !self.unsupported.iter().any(|u| u == what) {
            self.unsupported.push(what.to_string());
        }
    }

    /// Index + 1 of a medium, 0 for the empty name.
    fn medium_index(&mut self, place: &str, name: &str) -> Result<u32, SceneError> {
        if name.is_empty() {
            return Ok(0);
        }
        self.media_present = true;
        self.medium_names.get(name).map(|i| i + 1).ok_or_else(|| SceneError::UnknownName {
            place: place.to_string(),
            kind: "medium",
            name: name.to_string(),
        })
    }

    fn media_word(&mut self, place: &str, interior: &str, exterior: &str) -> Result<u32, SceneError> {
        Ok(self.medium_index(place, interior)? | self.medium_index(place, exterior)? << 16)
    }

    fn mesh(&mut self, index: usize, mesh: &MeshDesc) -> Result<(), SceneError> {
        let place =
            if mesh.name.is_empty() { format!("mesh {index}") } else { format!("mesh \"{}\"", mesh.name) };
        let media = self.media_word(&place, &mesh.interior, &mesh.exterior)?;
        let materials = self.mesh_materials(&place, mesh)?;
        check_mesh(&place, mesh, materials.len())?;

        let transform = MeshTransform::new(&place, mesh.transform)?;
        let base = self.out.positions.len() as u32;
        for p in &mesh.positions {
            let q = transform.point(*p);
            finite(&place, "a transformed vertex", &q)?;
            self.out.positions.push(q);
        }
        self.vertex_attributes(mesh, &transform, base as usize);

        let shading = mesh.shading_normals && !mesh.normals.is_empty();
        let flags = if shading { material_flags::SHADING_NORMALS } else { 0 };
        let repeats = repeated_triangles(mesh);
        let (mut degenerate, mut duplicate) = (0, 0);
        for (i, t) in mesh.triangles.iter().enumerate() {
            let mut t = t.map(|v| v + base);
            if transform.mirrors {
                t.swap(1, 2);
            }
            let corners = t.map(|v| Vec3::from_array(self.out.positions[v as usize]));
            if geometric_normal(corners).is_none() {
                degenerate += 1;
                continue;
            }
            if repeats.get(i).copied().unwrap_or(false) {
                duplicate += 1;
                continue;
            }
            let material = materials[mesh.face_materials.get(i).copied().unwrap_or(0) as usize];
            let record = surface_record(material, media, flags);
            self.triangle(t, record, true);
        }
        self.report.count(Cleanup::DegenerateTriangles, degenerate);
        self.report.count(Cleanup::DuplicateTriangles, duplicate);
        Ok(())
    }

    /// Indices of the materials that a mesh's faces may refer to; at least one.
    fn mesh_materials(&mut self, place: &str, mesh: &MeshDesc) -> Result<Vec<u32>, SceneError> {
        if !mesh.material.is_empty() {
            let one = self.material_index(place, &mesh.material)?;
            return Ok(alloc::vec![one; mesh.material_names.len().max(1)]);
        }
        let mut list = Vec::new();
        for name in &mesh.material_names {
            let mut i = self.material_index(place, name)?;
            if !mesh.textures && self.out.materials[i as usize].is_textured() {
                i = self.untextured(i);
            }
            list.push(i);
        }
        if list.is_empty() {
            list.push(self.material_index(place, "")?);
        }
        Ok(list)
    }

    /// A copy of a material without its bitmap or pattern.
    fn untextured(&mut self, index: u32) -> u32 {
        let name = format!("{} (untextured)", self.out.material_names[index as usize]);
        if let Some(&i) = self.material_names.get(&name) {
            return i;
        }
        let record =
            MaterialRecord { texture: NO_INDEX, checker: NO_INDEX, ..self.out.materials[index as usize] };
        let i = self.out.materials.len() as u32;
        self.material_names.insert(name.clone(), i);
        self.out.materials.push(record);
        self.out.material_names.push(name);
        self.material_drafts.push(self.material_drafts[index as usize].clone());
        i
    }

    /// Texture coordinates and shading normals run parallel to the positions once any mesh has them.
    fn vertex_attributes(&mut self, mesh: &MeshDesc, transform: &MeshTransform, base: usize) {
        let end = self.out.positions.len();
        if !mesh.texcoords.is_empty() {
            self.out.texcoords.resize(base, [0.0; 2]);
            self.out.texcoords.extend_from_slice(&mesh.texcoords);
        }
        if !self.out.texcoords.is_empty() {
            self.out.texcoords.resize(end, [0.0; 2]);
        }
        if mesh.shading_normals && !mesh.normals.is_empty() {
            self.out.normals.resize(base, [0.0; 3]);
            let mut zero = 0;
            for n in &mesh.normals {
                let n = transform.normal(*n);
                zero += u64::from(n == Vec3::ZERO);
                self.out.normals.push(n.to_array());
            }
            self.report.count(Cleanup::ZeroNormals, zero);
        }
        if !self.out.normals.is_empty() {
            self.out.normals.resize(end, [0.0; 3]);
        }
    }

    fn triangle(&mut self, t: [u32; 3], mut record: SurfaceRecord, own_light: bool) {
        let primitive = self.out.triangles.len() as u32;
        let corners = t.map(|v| Vec3::from_array(self.out.positions[v as usize]));
        // Found non-degenerate by the callers.
        record.normal = geometric_normal(corners).unwrap_or(Vec3::ZERO).to_array();
        record.sliver = sliver_factor(corners);
        self.out.triangles.push(t);
        self.out.surfaces.push(record);
        let emission = self.out.materials[record.material as usize].emission;
        if own_light && emission != [0.0; 3] {
            let [a, b, c] = corners;
            self.lights.push(LightDraft::triangle(primitive, a, b - a, c - a, emission));
        }
    }

    /// A parallelogram as two triangles that are one light.
    fn parallelogram(&mut self, corner: Vec3, e1: Vec3, e2: Vec3, record: SurfaceRecord) {
        let base = self.out.positions.len() as u32;
        for p in [corner, corner + e1, corner + e1 + e2, corner + e2] {
            self.out.positions.push(p.to_array());
        }
        if !self.out.texcoords.is_empty() || self.out.materials[record.material as usize].is_textured() {
            self.out.texcoords.resize(base as usize, [0.0; 2]);
            self.out.texcoords.extend([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        }
        if !self.out.normals.is_empty() {
            self.out.normals.resize(self.out.positions.len(), [0.0; 3]);
        }
        let emission = self.out.materials[record.material as usize].emission;
        let primitive = self.out.triangles.len() as u32;
        self.triangle([base, base + 1, base + 2], record, false);
        self.triangle([base, base + 2, base + 3], record, false);
        if emission != [0.0; 3] {
            self.lights.push(LightDraft::parallelogram(primitive, corner, e1, e2, emission));
        }
    }

    fn shape(&mut self, index: usize, shape: &ShapeDesc) -> Result<(), SceneError> {
        let place = format!("shape {index}");
        let media = self.media_word(&place, &shape.interior, &shape.exterior)?;
        let material = self.material_index(&place, &shape.material)?;
        let record = surface_record(material, media, 0);
        match &shape.kind {
            ShapeKind::Sphere { center, radius } => {
                finite(&place, "center", center)?;
                positive(&place, "radius", *radius)?;
                self.round.push((RoundShape::sphere(*center, *radius), record));
            }
            ShapeKind::Disk { center, normal, radius } => {
                finite(&place, "center", center)?;
                positive(&place, "radius", *radius)?;
                let n = unit(&place, "normal", *normal)?;
                self.round.push((RoundShape::disk(*center, n.to_array(), *radius), record));
            }
            ShapeKind::Rectangle { center, u, v } => {
                finite(&place, "center", center)?;
                finite(&place, "u", u)?;
                finite(&place, "v", v)?;
                let (c, u, v) = (Vec3::from_array(*center), Vec3::from_array(*u), Vec3::from_array(*v));
                if geometric_normal([c, c + u, c + v]).is_none() {
                    return out_of_range(&place, "u x v", 0.0, "half-edges that span an area");
                }
                self.parallelogram(c - u - v, u * 2.0, v * 2.0, record);
            }
            ShapeKind::Box { min, max } => {
                finite(&place, "min", min)?;
                finite(&place, "max", max)?;
                let size = Vec3::from_array(*max) - Vec3::from_array(*min);
                for axis in size.to_array() {
                    positive(&place, "max - min", axis)?;
                }
                let (o, f) = (Vec3::from_array(*min), Vec3::from_array(*max));
                let (x, y, z) = (Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z);
                // Three faces at the lower corner, three at the upper; every front is outside.
                for (corner, e1, e2) in
                    [(o, y, x), (o, z, y), (o, x, z), (f, -x, -y), (f, -y, -z), (f, -z, -x)]
                {
                    self.parallelogram(corner, e1, e2, record);
                }
            }
        }
        Ok(())
    }

    fn append_round_shapes(&mut self) {
        for (shape, record) in core::mem::take(&mut self.round) {
            let primitive = self.out.surfaces.len() as u32;
            self.out.shapes.push(shape);
            self.out.surfaces.push(record);
            let emission = self.out.materials[record.material as usize].emission;
            if emission != [0.0; 3] {
                self.lights.push(LightDraft::round(primitive, &shape, emission));
            }
        }
    }

    fn light(&mut self, index: usize, light: &LightDesc) -> Result<(), SceneError> {
        if let LightDesc::Environment(e) = light {
            let place = format!("light {index} (environment)");
            not_negative(&place, "radiance", &e.radiance)?;
            if let Some(image) = &e.image {
                self.lights.push(environment::draft(&mut self.out, &place, e.radiance, image)?);
                return Ok(());
            }
            for (sum, x) in self.out.environment.iter_mut().zip(e.radiance) {
                *sum += x;
            }
            return Ok(());
        }
        self.lights.push(lights::draft(index, light, &self.out.bounds)?);
        Ok(())
    }
}

/// A record that is no light yet, of a round shape until a triangle fills in its normal.
fn surface_record(material: u32, media: u32, flags: u32) -> SurfaceRecord {
    SurfaceRecord { material, light: NO_INDEX, media, flags, normal: [0.0; 3], sliver: 1.0 }
}
