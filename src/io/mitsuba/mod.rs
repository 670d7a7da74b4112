//! Mitsuba 3 scenes in XML.
//!
//! What is read is what this program can render the same way; what could change the light and is not known is
//! refused with its file, line and element, and what can't is noted or passed over. Defaults are those of the
//! format: surfaces are black from behind unless they are `twosided`, a shape without a `bsdf` is diffuse 0.5 (0
//! where it emits), meshes without normals get smooth ones unless they ask for `face_normals`.
//!
//! Scenes of versions before 2 are read too where they say the same things in other words (`camelCase`,
//! `sigmaS`, a `density` volume in the file's own bounds, a boundary of media without a `bsdf`).

mod emitter;
mod medium;
mod names;
mod sensor;
mod shape;
mod surface;
mod transform;
mod tree;
mod values;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use etendue_core::scene::MaterialDesc;

use self::shape::MaterialNames;
use self::surface::{Surface, UvMap};
use self::tree::{Element, read_tree};
use self::values::Object;
use super::error::{LoadError, quoted};
use super::mesh::Loader;
use super::scene::LoadedScene;
use super::source::{FileSource, Found, find};

/// What decides how a Mitsuba scene is read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MitsubaOptions {
    /// Values of `$names`; they win over the `<default>` of the scene.
    pub parameters: Vec<(String, String)>,
    /// Lets `<include>` read files outside the folder of the scene.
    pub outside_includes: bool,
}

/// Parses a Mitsuba 3 scene; the files it names are relative to `file` and come from `source`.
///
/// Limits: 64 MiB of XML and 2^20 elements with all includes, which lie in the folder of the scene and are at most
/// 15 deep.
pub fn parse_scene_mitsuba(
    bytes: &[u8],
    file: &Path,
    source: &dyn FileSource,
    options: &MitsubaOptions,
) -> Result<LoadedScene, LoadError> {
    let tree = read_tree(bytes.to_vec(), file, source, options)?;
    let root = Object::root(&tree);
    if root.element().tag != "scene" {
        return Err(root.error(format!("<{}>", root.element().tag), "<scene>"));
    }
    let mut builder = Builder {
        loader: Loader::new(source, file),
        scene: file,
        folder: file.parent().unwrap_or(Path::new("")).to_path_buf(),
        surfaces: BTreeMap::new(),
        materials: MaterialNames::new(),
        media: BTreeMap::new(),
        max_depth: None,
    };
    builder.loader.notes.extend(tree.notes.iter().cloned());
    builder.scene(&root)?;
    Ok(LoadedScene { desc: builder.loader.desc, notes: builder.loader.notes, max_depth: builder.max_depth })
}

/// A scene as it grows.
struct Builder<'a, 's> {
    loader: Loader<'a>,
    scene: &'s Path,
    folder: PathBuf,
    /// Surfaces that were read, by their element.
    surfaces: BTreeMap<usize, Surface>,
    materials: MaterialNames,
    /// Names of media that were read, by their element.
    media: BTreeMap<usize, String>,
    max_depth: Option<u32>,
}

impl Builder<'_, '_> {
    fn scene(&mut self, root: &Object<'_>) -> Result<(), LoadError> {
        let sensors = root.objects("sensor")?;
        if let Some(sensor) = sensors.first() {
            self.loader.desc.camera = Some(self.camera(sensor)?);
        }
        if let Some(second) = sensors.get(1) {
            let message = format!("{} sensors: the first is the camera", sensors.len());
            self.loader.note(second.file(), Some(second.line()), message);
        }
        for integrator in root.objects("integrator")? {
            self.integrator(&integrator)?;
        }
        for shape in root.objects("shape")? {
            self.shape(&shape)?;
        }
        for emitter in root.objects("emitter")? {
            self.light(&emitter)?;
        }
        // What others refer to is read when they do.
        for tag in ["bsdf", "medium", "texture", "volume", "phase", "film", "rfilter", "sampler", "spectrum"]
        {
            root.objects(tag)?;
        }
        while let Some(element) = root.rest() {
            // Of another renderer's dialect: what kind of run is meant.
            if element.tag != "mode" {
                return root.finish();
            }
            let message = "<mode> is ignored";
            self.loader.note(root.tree.file(element), Some(element.line), message);
            root.pass(element);
        }
        Ok(())
    }

    /// The file of a name: beside the scene, else beside the included file that says it.
    fn find(&mut self, o: &Object<'_>, element: &Element, name: &str) -> Option<PathBuf> {
        let own = o.tree.file(element).parent().unwrap_or(Path::new(""));
        let found = [self.folder.as_path(), own].into_iter().find_map(|folder| {
            match find(self.loader.source, folder, name) {
                Found::Exact(path) => Some((path, false)),
                Found::OtherCase(path) => Some((path, true)),
                Found::Missing => None,
            }
        });
        let (path, other_case) = found?;
        if other_case {
            let message = format!("{} was found as {} (letter case)", quoted(name), path.display());
            self.loader.note(o.tree.file(element), Some(element.line), message);
        }
        Some(path)
    }

    /// The name of the material of a shape, and where its texture lies. `boundary`: without a surface it is none.
    fn material(
        &mut self,
        bsdf: Option<&Object<'_>>,
        emission: Option<[f32; 3]>,
        boundary: bool,
    ) -> Result<(String, Option<UvMap>), LoadError> {
        let (which, plain) = match (bsdf, emission, boundary) {
            (Some(bsdf), ..) => (
                bsdf.index,
                bsdf.id().map_or_else(|| format!("{}:{}", bsdf.kind(), bsdf.line()), str::to_owned),
            ),
            (None, Some(_), _) => (usize::MAX, "black".to_owned()),
            (None, None, true) => (usize::MAX - 1, "boundary".to_owned()),
            (None, None, false) => (usize::MAX - 2, "grey".to_owned()),
        };
        let radiance = emission.unwrap_or([0.0; 3]);
        let key = (which, radiance.map(f32::to_bits));
        if let Some((name, uv)) = self.materials.get(&key) {
            return Ok((name.clone(), *uv));
        }
        let surface = match bsdf {
            Some(bsdf) => match self.surfaces.get(&bsdf.index) {
                Some(surface) => surface.clone(),
                None => {
                    let surface = self.surface(bsdf)?;
                    self.surfaces.insert(bsdf.index, surface.clone());
                    surface
                }
            },
            None if emission.is_some() => Surface::diffuse(0.0),
            None if boundary => Surface::null(),
            None => Surface::diffuse(0.5),
        };
        let plain = if radiance == [0.0; 3] { plain } else { format!("{plain} (light)") };
        let mut name = plain.clone();
        let mut n = 2;
        while !self.loader.material_names.insert(name.clone()) {
            name = format!("{plain}#{n}");
            n += 1;
        }
        self.loader.desc.materials.push(MaterialDesc {
            name: name.clone(),
            kind: surface.kind,
            two_sided: surface.two_sided,
            emission: radiance,
        });
        self.materials.insert(key, (name.clone(), surface.uv));
        Ok((name, surface.uv))
    }
}
