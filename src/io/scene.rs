//! Scenes from files: the TOML scene file, or a bare mesh.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use etendue_core::scene::{EnvironmentDesc, LightDesc, MaterialKind, SceneDesc};

use super::error::{LoadError, Note, Problem, quoted};
use super::frame::frame;
use super::mesh::{Loader, MeshOptions, MtlMode};
use super::mitsuba::{MitsubaOptions, parse_scene_mitsuba};
use super::scene_fields as fields;
use super::source::{DiskSource, FileSource, read_file};
use super::toml_view::{Doc, Section};

/// Longer scene files are refused.
const MAX_SCENE_FILE: u64 = 1 << 26;

/// A scene and what is worth telling about its files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadedScene {
    /// The scene, with every file it names read.
    pub desc: SceneDesc,
    /// What was mended, left out or assumed, in the order of reading.
    pub notes: Vec<Note>,
    /// How long the file means paths to be at most, in edges; for whoever renders it.
    pub max_depth: Option<u32>,
}

/// Reads a scene by the end of its name: a TOML scene file, a Mitsuba scene in XML, or a mesh (see
/// [`parse_mesh_scene`]).
///
/// Shape, names and files are checked here; ranges (angles, energy, finite numbers) when it is compiled.
pub fn load_scene(path: &Path) -> Result<LoadedScene, LoadError> {
    let source = DiskSource;
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match extension.as_str() {
        "toml" => {
            let bytes = read_file(&source, path, MAX_SCENE_FILE)?;
            match std::str::from_utf8(&bytes) {
                Ok(text) => parse_scene_toml(text, path, &source),
                Err(e) => {
                    let line = 1 + bytes[..e.valid_up_to()].iter().filter(|b| **b == b'\n').count();
                    Err(LoadError::unexpected(path, "bytes that are not UTF-8", "text in UTF-8").at(line))
                }
            }
        }
        "obj" | "ply" => parse_mesh_scene(path, &source),
        "xml" => {
            let bytes = read_file(&source, path, MAX_SCENE_FILE)?;
            parse_scene_mitsuba(&bytes, path, &source, &MitsubaOptions::default())
        }
        "gltf" | "glb" => {
            Err(LoadError::new(path, Problem::Unsupported(format!("a scene in the format .{extension}"))))
        }
        _ => Err(LoadError::unexpected(
            path,
            quoted(path.file_name().and_then(|n| n.to_str()).unwrap_or_default()),
            "a scene: .toml, .xml, .obj or .ply",
        )),
    }
}

/// Reads a mesh file as a whole scene: its emissive faces are the lights, its MTL is read as `"diffuse"`,
/// textures are on, normals geometric.
///
/// The camera looks along -z at the centre of the bounding box with 40 degrees both ways, up is +y, so far in
/// front of the box that its nearest side fills 1/1.05 of the picture in the wider direction. Without any
/// emission an environment of radiance 1 is added. The notes say both.
pub fn parse_mesh_scene(path: &Path, source: &dyn FileSource) -> Result<LoadedScene, LoadError> {
    let mut loader = Loader::new(source, path);
    let options = MeshOptions { mtl: MtlMode::Diffuse, textures: true, materials: true };
    let mesh = loader.mesh(path, options)?;
    let camera = frame(&mesh);
    let [x, y, z] = camera.position;
    let [a, b, c] = camera.look_at;
    loader.note(
        path,
        None,
        format!("the file has no camera: one was framed at ({x}, {y}, {z}) that looks at ({a}, {b}, {c})"),
    );
    loader.desc.camera = Some(camera);
    loader.desc.meshes.push(mesh);
    if loader.desc.materials.iter().all(|m| m.emission == [0.0; 3]) {
        loader.note(path, None, "nothing emits light: an environment of radiance 1 was added");
        let radiance = [1.0; 3];
        loader.desc.lights.push(LightDesc::Environment(EnvironmentDesc::uniform(radiance)));
    }
    Ok(LoadedScene { desc: loader.desc, notes: loader.notes, max_depth: None })
}

/// Parses a scene file; nested files are relative to `file` and come from `source`.
///
/// Defaults: `version` 1; camera `up` +y, `resolution` 256 x 256, pinhole; mesh without transform,
/// `normals = "geometric"`, `textures = true`, `mtl = "diffuse"`; materials `two_sided = true`, no emission,
/// albedo of a mirror 1; spot `falloff_deg` = `cone_deg` (a hard edge); media without absorption, scattering
/// or emission, `g = 0`.
pub fn parse_scene_toml(text: &str, file: &Path, source: &dyn FileSource) -> Result<LoadedScene, LoadError> {
    let doc = Doc::new(file, text);
    let table = doc.parse(text)?;
    let root = Section::new(&doc, String::new(), table.get_ref(), 0..0);
    if let Some((version, line)) = root.whole("version")?
        && version != 1
    {
        return Err(root.error(line, "version", version.to_string(), "1"));
    }
    let camera = root.section("camera")?;
    let meshes = root.sections("mesh")?;
    let shapes = root.sections("shape")?;
    let lights = root.sections("light")?;
    let materials = root.sections("material")?;
    let media = root.sections("medium")?;
    root.finish()?;

    let mut loader = Loader::new(source, file);
    // Materials first: meshes and shapes refer to them, and MTL files must not take their names.
    for section in &materials {
        let (material, line) = fields::material(section, &mut loader, file)?;
        if !loader.material_names.insert(material.name.clone()) {
            let found = format!("a second material {}", quoted(&material.name));
            return Err(section.error(line, "name", found, "a name of its own"));
        }
        loader.desc.materials.push(material);
    }
    let mut media_names = BTreeSet::new();
    for section in &media {
        let (medium, line) = fields::medium(section, &mut loader, file)?;
        if !media_names.insert(medium.name.clone()) {
            let found = format!("a second medium {}", quoted(&medium.name));
            return Err(section.error(line, "name", found, "a name of its own"));
        }
        loader.desc.media.push(medium);
    }
    let names = Names { materials: loader.material_names.clone(), media: media_names };
    if let Some(section) = &camera {
        loader.desc.camera = Some(fields::camera(section, &names)?);
    }
    for section in &shapes {
        loader.desc.shapes.push(fields::shape(section, &names)?);
    }
    for section in &lights {
        let light = fields::light(section, &mut loader, file)?;
        loader.desc.lights.push(light);
    }
    let mut requests = Vec::new();
    for section in &meshes {
        requests.push((section, fields::mesh(section, &names)?));
    }
    load_meshes(&mut loader, file, requests)?;
    let unsupported =
        loader.desc.materials.iter().filter(|m| matches!(m.kind, MaterialKind::Unsupported(_))).count();
    if unsupported > 0 {
        let message = format!("{unsupported} materials are of kinds that this version does not render");
        loader.note(file, None, message);
    }
    Ok(LoadedScene { desc: loader.desc, notes: loader.notes, max_depth: None })
}

/// The names that fields may refer to.
pub(crate) struct Names {
    pub(crate) materials: BTreeSet<String>,
    pub(crate) media: BTreeSet<String>,
}

impl Names {
    /// The name in a field, or none; refuses names that nothing has.
    pub(crate) fn reference(
        section: &Section<'_>,
        key: &'static str,
        known: &BTreeSet<String>,
        kind: &str,
    ) -> Result<String, LoadError> {
        let Some((name, line)) = section.text(key)? else { return Ok(String::new()) };
        if name.is_empty() || known.contains(&name) {
            return Ok(name);
        }
        let expected = if known.is_empty() {
            format!("the name of a [[{kind}]], of which there are none")
        } else {
            format!("one of {}", known.iter().take(20).map(String::as_str).collect::<Vec<_>>().join(", "))
        };
        Err(section.error(line, key, quoted(&name), expected))
    }
}

/// Reads the mesh files. Meshes that share a file share its materials, with bitmaps if any of them wants some.
fn load_meshes(
    loader: &mut Loader<'_>,
    file: &Path,
    requests: Vec<(&Section<'_>, fields::MeshRequest)>,
) -> Result<(), LoadError> {
    let mut found: Vec<PathBuf> = Vec::new();
    for (section, request) in &requests {
        match loader.find(file, request.line, &request.file) {
            Some(path) => found.push(path),
            None => {
                let expected = format!("a file beside {}", file.display());
                return Err(section.error(request.line, "file", quoted(&request.file), expected));
            }
        }
    }
    let wants: BTreeSet<(PathBuf, MtlMode)> = requests
        .iter()
        .zip(&found)
        .filter(|((_, r), _)| r.options.textures && r.options.materials)
        .map(|((_, r), path)| (path.clone(), r.options.mtl))
        .collect();
    for ((_, request), path) in requests.into_iter().zip(found) {
        let textures = wants.contains(&(path.clone(), request.options.mtl));
        let mut mesh = loader.mesh(&path, MeshOptions { textures, ..request.options })?;
        mesh.textures = request.options.textures;
        mesh.transform = request.transform;
        mesh.shading_normals = request.shading_normals;
        mesh.material = request.material;
        mesh.interior = request.interior;
        mesh.exterior = request.exterior;
        if mesh.shading_normals && mesh.normals.is_empty() {
            loader.note(&path, None, "normals = \"shading\", but the file has no normals");
        }
        loader.desc.meshes.push(mesh);
    }
    Ok(())
}
