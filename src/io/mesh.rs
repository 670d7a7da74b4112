//! Meshes with their materials, whatever the file format.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use etendue_core::scene::{IOR_RANGE, MaterialDesc, MaterialKind, MeshDesc, Reflectance, SceneDesc};

use super::bitmap;
use super::error::{LoadError, Note, Problem, quoted};
use super::mtl::{MtlMap, MtlMaterial, parse_mtl};
use super::obj::{Obj, parse_obj};
use super::ply::parse_ply;
use super::scene_fields::GLASS;
use super::source::{FileSource, Found, find, read_file};

/// Longer mesh files are refused.
const MAX_MESH_FILE: u64 = 1 << 32;
/// Longer MTL files are refused.
const MAX_MTL_FILE: u64 = 1 << 26;

/// How an MTL file is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum MtlMode {
    /// Kd and Ke only.
    Diffuse,
    /// Also Ks, Ns and the illumination models.
    Full,
}

/// What decides how a mesh file is read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshOptions {
    pub(crate) mtl: MtlMode,
    pub(crate) textures: bool,
    /// The file's own materials count (no override by the scene).
    pub(crate) materials: bool,
}

/// A scene as it grows, and what its files have in common.
pub(crate) struct Loader<'a> {
    pub(crate) source: &'a dyn FileSource,
    /// The folder of the scene file.
    pub(crate) folder: PathBuf,
    pub(crate) desc: SceneDesc,
    pub(crate) notes: Vec<Note>,
    /// Bitmaps that were read, by path.
    textures: BTreeMap<PathBuf, String>,
    /// Names that materials bear already.
    pub(crate) material_names: BTreeSet<String>,
    /// Names in the scene of what `usemtl` says, per OBJ file.
    mtl_names: BTreeMap<(PathBuf, MtlMode), BTreeMap<String, String>>,
}

impl<'a> Loader<'a> {
    pub(crate) fn new(source: &'a dyn FileSource, scene: &Path) -> Self {
        Self {
            source,
            folder: scene.parent().unwrap_or(Path::new("")).to_path_buf(),
            desc: SceneDesc::default(),
            notes: Vec::new(),
            textures: BTreeMap::new(),
            material_names: BTreeSet::new(),
            mtl_names: BTreeMap::new(),
        }
    }

    pub(crate) fn note(&mut self, file: &Path, line: Option<usize>, message: impl Into<String>) {
        self.notes.push(Note::new(file, line, message));
    }

    /// The file that a name stands for, relative to the file that names it.
    pub(crate) fn find(&mut self, by: &Path, line: usize, name: &str) -> Option<PathBuf> {
        let folder = by.parent().unwrap_or(Path::new(""));
        match find(self.source, folder, name) {
            Found::Exact(path) => Some(path),
            Found::OtherCase(path) => {
                let message = format!("{} was found as {} (letter case)", quoted(name), path.display());
                // Once per file, however often it says that name.
                if !self.notes.iter().any(|n| n.file == by && n.message == message) {
                    self.note(by, Some(line), message);
                }
                Some(path)
            }
            Found::Missing => None,
        }
    }

    /// The bytes of a file.
    pub(crate) fn bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>, LoadError> {
        read_file(self.source, path, limit)
    }

    /// Reads a bitmap once; returns its name in the scene.
    pub(crate) fn texture(&mut self, path: &Path) -> Result<String, LoadError> {
        if let Some(name) = self.textures.get(path) {
            return Ok(name.clone());
        }
        let bytes = read_file(self.source, path, bitmap::MAX_FILE)?;
        let short = path.strip_prefix(&self.folder).unwrap_or(path);
        let name = short.display().to_string();
        self.desc.textures.push(bitmap::parse_texture(&bytes, &name, path)?);
        self.textures.insert(path.to_path_buf(), name.clone());
        Ok(name)
    }

    /// Reads a mesh file into a mesh without transform or media, and its materials into the scene.
    pub(crate) fn mesh(&mut self, path: &Path, options: MeshOptions) -> Result<MeshDesc, LoadError> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let mut mesh = match extension.as_str() {
            "obj" => {
                let mut obj = parse_obj(&read_file(self.source, path, MAX_MESH_FILE)?, path)?;
                self.notes.append(&mut obj.notes);
                let material_names =
                    if options.materials { self.obj_materials(path, &mut obj, options)? } else { Vec::new() };
                let face_materials = if material_names.is_empty() { Vec::new() } else { obj.face_materials };
                MeshDesc {
                    positions: obj.positions,
                    normals: obj.normals,
                    texcoords: obj.texcoords,
                    triangles: obj.triangles,
                    face_materials,
                    material_names,
                    ..MeshDesc::default()
                }
            }
            "ply" => {
                let (mesh, notes) = parse_ply(&read_file(self.source, path, MAX_MESH_FILE)?, path)?;
                self.notes.extend(notes);
                mesh
            }
            "gltf" | "glb" => {
                return Err(LoadError::new(path, Problem::Unsupported("a glTF mesh".into())));
            }
            _ => return Err(LoadError::unexpected(path, quoted(&name), "a mesh file: .obj or .ply")),
        };
        if mesh.triangles.is_empty() {
            self.note(path, None, "the file has no triangles");
        }
        mesh.name = name;
        mesh.textures = options.textures;
        Ok(mesh)
    }

    /// Names in the scene of the materials of an OBJ file, in the order of its face indices; empty when all
    /// faces use the default. Materials that no face uses are not read.
    fn obj_materials(
        &mut self,
        path: &Path,
        obj: &mut Obj,
        options: MeshOptions,
    ) -> Result<Vec<String>, LoadError> {
        let key = (path.to_path_buf(), options.mtl);
        if !self.mtl_names.contains_key(&key) {
            let names = self.read_libraries(path, obj, options)?;
            self.mtl_names.insert(key.clone(), names);
        }
        let known = &self.mtl_names[&key];
        let names: Vec<Option<String>> = obj.materials.iter().map(|m| known.get(&m.0).cloned()).collect();
        if names.iter().all(Option::is_none) {
            return Ok(Vec::new());
        }
        // Some faces have a material and some do not: the default needs a name.
        let mut default = None;
        let names = names.into_iter().map(|name| {
            name.unwrap_or_else(|| {
                default
                    .get_or_insert_with(|| self.add_material(path, "(default)", default_material()))
                    .clone()
            })
        });
        Ok(names.collect())
    }

    /// Reads the libraries of an OBJ file and adds the materials its faces use.
    fn read_libraries(
        &mut self,
        path: &Path,
        obj: &Obj,
        options: MeshOptions,
    ) -> Result<BTreeMap<String, String>, LoadError> {
        let mut library: BTreeMap<String, (PathBuf, MtlMaterial)> = BTreeMap::new();
        let mut other_maps = None;
        for (files, line) in &obj.libraries {
            for found in self.library_files(path, files, *line) {
                let mtl = parse_mtl(&read_file(self.source, &found, MAX_MTL_FILE)?, &found)?;
                self.notes.extend(mtl.notes);
                for material in mtl.materials {
                    library.entry(material.name.clone()).or_insert_with(|| (found.clone(), material));
                }
                if mtl.other_maps {
                    other_maps.get_or_insert(found);
                }
            }
        }
        if let Some(file) = other_maps {
            self.note(&file, None, "maps other than map_Kd (bump, specular, opacity, ...) are ignored");
        }
        let mut names = BTreeMap::new();
        let mut unknown = Vec::new();
        for (said, line) in &obj.materials {
            // A comment may follow the name, and a name may hold a '#'.
            let short = said.split(" #").next().unwrap_or_default().trim_end();
            match library.get(said).or_else(|| library.get(short)) {
                Some((file, material)) => {
                    let desc = self.material(file, material, options)?;
                    names.insert(said.clone(), self.add_material(path, &material.name, desc));
                }
                None if said.is_empty() => {}
                None => unknown.push((said, *line)),
            }
        }
        if let Some((first, line)) = unknown.first() {
            let others = match unknown.len() - 1 {
                0 => String::new(),
                n => format!(" (and {n} more)"),
            };
            let message = format!(
                "no MTL file has a material named {}{others}: its faces use the default, diffuse 0.5",
                quoted(first)
            );
            self.note(path, Some(*line), message);
        }
        Ok(names)
    }

    /// An `mtllib` line holds one name with blanks, or several names.
    fn library_files(&mut self, path: &Path, files: &str, line: usize) -> Vec<PathBuf> {
        if let Some(found) = self.find(path, line, files) {
            return vec![found];
        }
        let mut out = Vec::new();
        for name in files.split_whitespace().take_while(|t| !t.starts_with('#')) {
            match self.find(path, line, name) {
                Some(found) => out.push(found),
                None => self.note(path, Some(line), format!("there is no material file {}", quoted(name))),
            }
        }
        out
    }

    /// Adds a material under the name `<file>:<name>`, made unique.
    fn add_material(&mut self, path: &Path, name: &str, mut desc: MaterialDesc) -> String {
        let file = path.file_name().map(|n| n.to_string_lossy()).unwrap_or_default();
        let plain = format!("{file}:{name}");
        let mut unique = plain.clone();
        let mut n = 2;
        while !self.material_names.insert(unique.clone()) {
            unique = format!("{plain}#{n}");
            n += 1;
        }
        desc.name.clone_from(&unique);
        self.desc.materials.push(desc);
        unique
    }

    fn material(
        &mut self,
        file: &Path,
        m: &MtlMaterial,
        options: MeshOptions,
    ) -> Result<MaterialDesc, LoadError> {
        let texture = match &m.map_kd {
            Some(map) if options.textures => self.map_kd(file, map),
            _ => None,
        };
        let kd = m.kd.unwrap_or_else(|| if m.map_kd.is_some() { [1.0; 3] } else { [0.5; 3] });
        if m.kd.is_none() && m.map_kd.is_none() {
            let message = format!("material {} has no Kd: 0.5 is used", quoted(&m.name));
            self.note(file, Some(m.line), message);
        }
        let mut kd = self.reflectance(file, m, "Kd", kd);
        let emission = m.ke.unwrap_or_default();
        if emission.iter().any(|e| *e < 0.0) {
            self.note(
                file,
                Some(m.line),
                format!("the Ke of material {} is negative: 0 is used", quoted(&m.name)),
            );
        }
        let emission = emission.map(|e| e.max(0.0));
        if texture.is_some() && kd == [0.0; 3] {
            let message = format!("Kd is 0 and multiplies map_Kd: material {} is black", quoted(&m.name));
            self.note(file, Some(m.line), message);
        }
        let albedo =
            |color| Reflectance { color, texture: texture.clone().unwrap_or_default(), checker: None };
        let kind = match (options.mtl, m.illum) {
            (MtlMode::Diffuse, _) => MaterialKind::Diffuse { albedo: albedo(kd) },
            (MtlMode::Full, Some(3)) => {
                let ks = self.reflectance(file, m, "Ks", m.ks.unwrap_or_default());
                MaterialKind::Mirror { albedo: Reflectance::flat(ks) }
            }
            (MtlMode::Full, Some(4..=7)) => {
                let ni = m.ni.filter(|n| IOR_RANGE.contains(n));
                if ni.is_none() {
                    let message =
                        format!("material {} refracts without a valid Ni: {GLASS} is used", quoted(&m.name));
                    self.note(file, Some(m.line), message);
                }
                MaterialKind::Dielectric { ior: [ni.unwrap_or(GLASS); 3], schlick: false }
            }
            (MtlMode::Full, _) => {
                let mut ks = self.reflectance(file, m, "Ks", m.ks.unwrap_or_default());
                let mut scaled = false;
                for (d, s) in kd.iter_mut().zip(&mut ks) {
                    let sum = *d + *s;
                    if sum > 1.0 {
                        *d /= sum;
                        // The rest, rather than a quotient of its own: the sum must not round above 1.
                        *s = 1.0 - *d;
                        scaled = true;
                    }
                }
                if scaled {
                    let message = format!("material {}: Kd + Ks were scaled down to 1", quoted(&m.name));
                    self.note(file, Some(m.line), message);
                }
                let exponent = m.ns.unwrap_or(0.0).max(0.0);
                if ks != [0.0; 3] && m.ns.is_none_or(|n| n < 0.0) {
                    let message =
                        format!("material {} has Ks without a valid Ns: 0 is used", quoted(&m.name));
                    self.note(file, Some(m.line), message);
                }
                match (kd == [0.0; 3], ks == [0.0; 3]) {
                    (_, true) => MaterialKind::Diffuse { albedo: albedo(kd) },
                    (true, false) => MaterialKind::Phong { specular: ks, exponent },
                    (false, false) => {
                        MaterialKind::DiffusePhong { albedo: albedo(kd), specular: ks, exponent }
                    }
                }
            }
        };
        Ok(MaterialDesc { name: String::new(), kind, two_sided: true, emission })
    }

    /// Clamps to \[0, 1\], and says so.
    fn reflectance(&mut self, file: &Path, m: &MtlMaterial, key: &str, value: [f32; 3]) -> [f32; 3] {
        let clamped = value.map(|v| v.clamp(0.0, 1.0));
        if clamped != value {
            let [r, g, b] = value;
            let message =
                format!("the {key} {r} {g} {b} of material {} was clamped to 0..1", quoted(&m.name));
            self.note(file, Some(m.line), message);
        }
        clamped
    }

    /// The bitmap of a `map_Kd` line. One that is missing or unreadable is said and left out: such files
    /// are common, and the colour is still there.
    fn map_kd(&mut self, file: &Path, map: &MtlMap) -> Option<String> {
        let found = map.files.iter().find_map(|name| self.find(file, map.line, name));
        let Some(path) = found else {
            let name = map.files.last().map(String::as_str).unwrap_or_default();
            let message = format!("there is no bitmap {}: Kd is used alone", quoted(name));
            self.note(file, Some(map.line), message);
            return None;
        };
        match self.texture(&path) {
            Ok(name) => {
                if map.options {
                    self.note(file, Some(map.line), "options of map_Kd are ignored");
                }
                Some(name)
            }
            Err(e) => {
                self.note(file, Some(map.line), format!("a bitmap is left out, Kd is used alone: {e}"));
                None
            }
        }
    }
}

/// What a surface without a material is.
pub(crate) fn default_material() -> MaterialDesc {
    MaterialDesc {
        name: String::new(),
        kind: MaterialKind::Diffuse { albedo: Reflectance::flat([0.5; 3]) },
        two_sided: true,
        emission: [0.0; 3],
    }
}
