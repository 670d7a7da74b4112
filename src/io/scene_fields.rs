//! The tables of a scene file, one function each.

use std::path::Path;

use etendue_core::math;
use etendue_core::scene::{
    CameraDesc, Checker, EnvironmentDesc, EnvironmentImage, GridDesc, LightDesc, MaterialDesc, MaterialKind,
    MediumDesc, Reflectance, Roughness, ShapeDesc, ShapeKind, srgb_to_linear,
};

use super::bitmap::parse_texture;
use super::error::{LoadError, quoted};
use super::exr::parse_exr;
use super::mesh::{Loader, MeshOptions, MtlMode};
use super::scene::Names;
use super::toml_view::Section;
use super::volume;

/// Larger images are refused, in either direction.
const MAX_RESOLUTION: u32 = 65_536;
/// Longer files of pictures are refused.
const MAX_PICTURE: u64 = 1 << 31;
/// How OpenEXR files begin.
const EXR_MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// What a `[[mesh]]` asks for.
pub(crate) struct MeshRequest {
    pub(crate) file: String,
    pub(crate) line: usize,
    pub(crate) options: MeshOptions,
    pub(crate) transform: Option<[[f32; 4]; 3]>,
    pub(crate) shading_normals: bool,
    pub(crate) material: String,
    pub(crate) interior: String,
    pub(crate) exterior: String,
}

fn vector(section: &Section<'_>, key: &'static str) -> Result<[f32; 3], LoadError> {
    let value = section.numbers::<3>(key)?;
    Ok(section.required(value, key, "a list of 3 numbers")?.0)
}

fn vector_or(section: &Section<'_>, key: &'static str, default: [f32; 3]) -> Result<[f32; 3], LoadError> {
    Ok(section.numbers::<3>(key)?.map_or(default, |v| v.0))
}

fn scalar(section: &Section<'_>, key: &'static str) -> Result<f32, LoadError> {
    let value = section.number(key)?;
    Ok(section.required(value, key, "a number")?.0)
}

fn scalar_or(section: &Section<'_>, key: &'static str, default: f32) -> Result<f32, LoadError> {
    Ok(section.number(key)?.map_or(default, |v| v.0))
}

fn name_of(section: &Section<'_>) -> Result<(String, usize), LoadError> {
    let name = section.text("name")?;
    let (name, line) = section.required(name, "name", "a name in quotes")?;
    if name.is_empty() {
        return Err(section.error(line, "name", "an empty name", "at least one letter"));
    }
    Ok((name, line))
}

fn kind_of(section: &Section<'_>, kinds: &[&'static str]) -> Result<&'static str, LoadError> {
    let kind = section.word("kind", kinds)?;
    section.required(kind, "kind", &format!("one of {}", kinds.join(", ")))
}

/// The horizontal field of view of a vertical one, with tan(x/2) = width/height tan(y/2). Through core's math,
/// so that a scene file means the same bits everywhere.
fn horizontal_fov_deg(y: f32, [width, height]: [u32; 2]) -> f32 {
    if width == height {
        return y;
    }
    let (sin, cos) = math::sin_cos(y.to_radians() / 2.0);
    (2.0 * math::atan2(sin * (width as f32 / height as f32), cos)).to_degrees()
}

pub(crate) fn camera(s: &Section<'_>, names: &Names) -> Result<CameraDesc, LoadError> {
    let resolution = s.counts::<2>("resolution", 1..=MAX_RESOLUTION)?.unwrap_or([256, 256]);
    let fov_x_deg = match (s.number("fov_x_deg")?, s.number("fov_y_deg")?) {
        (Some((x, _)), None) => x,
        (None, Some((y, line))) => {
            // The conversion would turn some wrong angles into right ones.
            if !(y > 0.0 && y < 180.0) {
                return Err(s.error(line, "fov_y_deg", y.to_string(), "an angle between 0 and 180 degrees"));
            }
            horizontal_fov_deg(y, resolution)
        }
        (Some(_), Some((_, line))) => {
            return Err(s.error(line, "fov_y_deg", "both fov_x_deg and fov_y_deg", "one of them"));
        }
        (None, None) => return Err(s.error(s.line, "fov_x_deg", "no such field", "fov_x_deg or fov_y_deg")),
    };
    let lens_radius = scalar_or(s, "lens_radius", 0.0)?;
    let focus_distance = s.number("focus_distance")?;
    if lens_radius != 0.0 && focus_distance.is_none() {
        return Err(s.error(
            s.line,
            "focus_distance",
            "no such field",
            "a distance, as there is a lens_radius",
        ));
    }
    let camera = CameraDesc {
        position: vector(s, "position")?,
        look_at: vector(s, "look_at")?,
        up: vector_or(s, "up", [0.0, 1.0, 0.0])?,
        fov_x_deg,
        resolution,
        lens_radius,
        focus_distance: focus_distance.map_or(0.0, |v| v.0),
        medium: Names::reference(s, "medium", &names.media, "medium")?,
    };
    s.finish()?;
    Ok(camera)
}

fn transform(s: &Section<'_>) -> Result<Option<[[f32; 4]; 3]>, LoadError> {
    let translate = s.numbers::<3>("translate")?;
    let scale = s.number("scale")?;
    let matrix = s.numbers::<16>("matrix")?;
    if let Some((m, line)) = matrix {
        if translate.is_some() || scale.is_some() {
            return Err(s.error(line, "matrix", "a matrix beside translate or scale", "one or the other"));
        }
        if m[12..] != [0.0, 0.0, 0.0, 1.0] {
            let found = format!("the last row {:?}", &m[12..]);
            return Err(s.error(line, "matrix", found, "[0, 0, 0, 1] (an affine transform, row by row)"));
        }
        let row = |i: usize| [m[4 * i], m[4 * i + 1], m[4 * i + 2], m[4 * i + 3]];
        return Ok(Some([row(0), row(1), row(2)]));
    }
    if translate.is_none() && scale.is_none() {
        return Ok(None);
    }
    let [x, y, z] = translate.map_or([0.0; 3], |v| v.0);
    let k = scale.map_or(1.0, |v| v.0);
    Ok(Some([[k, 0.0, 0.0, x], [0.0, k, 0.0, y], [0.0, 0.0, k, z]]))
}

pub(crate) fn mesh(s: &Section<'_>, names: &Names) -> Result<MeshRequest, LoadError> {
    let file = s.text("file")?;
    let (file, line) = s.required(file, "file", "the name of a mesh file")?;
    let material = Names::reference(s, "material", &names.materials, "material")?;
    let request = MeshRequest {
        file,
        line,
        options: MeshOptions {
            mtl: match s.word("mtl", &["diffuse", "full"])? {
                Some("full") => MtlMode::Full,
                _ => MtlMode::Diffuse,
            },
            textures: s.flag("textures")?.unwrap_or(true),
            materials: material.is_empty(),
        },
        transform: transform(s)?,
        shading_normals: s.word("normals", &["geometric", "shading"])? == Some("shading"),
        material,
        interior: Names::reference(s, "interior", &names.media, "medium")?,
        exterior: Names::reference(s, "exterior", &names.media, "medium")?,
    };
    s.finish()?;
    Ok(request)
}

pub(crate) fn shape(s: &Section<'_>, names: &Names) -> Result<ShapeDesc, LoadError> {
    let kind = match kind_of(s, &["sphere", "disk", "rectangle", "box"])? {
        "sphere" => ShapeKind::Sphere { center: vector(s, "center")?, radius: scalar(s, "radius")? },
        "disk" => ShapeKind::Disk {
            center: vector(s, "center")?,
            normal: vector(s, "normal")?,
            radius: scalar(s, "radius")?,
        },
        "rectangle" => {
            ShapeKind::Rectangle { center: vector(s, "center")?, u: vector(s, "u")?, v: vector(s, "v")? }
        }
        _ => ShapeKind::Box { min: vector(s, "min")?, max: vector(s, "max")? },
    };
    let shape = ShapeDesc {
        kind,
        material: Names::reference(s, "material", &names.materials, "material")?,
        interior: Names::reference(s, "interior", &names.media, "medium")?,
        exterior: Names::reference(s, "exterior", &names.media, "medium")?,
    };
    s.finish()?;
    Ok(shape)
}

/// The picture of an environment: OpenEXR, or PNG and JPEG decoded from sRGB; turned about +y, from +z towards +x (counter-clockwise seen from above) where `degrees` are positive.
fn picture(
    s: &Section<'_>,
    loader: &mut Loader<'_>,
    file: &Path,
    degrees: f32,
) -> Result<Option<EnvironmentImage>, LoadError> {
    let Some((name, line)) = s.text("file")? else { return Ok(None) };
    let Some(path) = loader.find(file, line, &name) else {
        let expected = "an EXR, PNG or JPEG beside the scene file";
        return Err(s.error(line, "file", quoted(&name), expected));
    };
    if !degrees.is_finite() {
        return Err(s.error(line, "rotate_deg", degrees.to_string(), "a finite angle in degrees"));
    }
    let bytes = loader.bytes(&path, MAX_PICTURE)?;
    let (width, height, texels) = if bytes.starts_with(&EXR_MAGIC) {
        let image = parse_exr(&bytes, &path)?;
        (image.width, image.height, image.radiance)
    } else {
        let image = parse_texture(&bytes, &name, &path)?;
        let linear = |t: &[u8; 3]| t.map(srgb_to_linear);
        (image.width, image.height, image.texels.iter().map(linear).collect())
    };
    let (sin, cos) = math::sin_cos(degrees % 360.0 * (math::PI / 180.0));
    let to_world = [[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]];
    Ok(Some(EnvironmentImage { width, height, texels, to_world }))
}

pub(crate) fn light(s: &Section<'_>, loader: &mut Loader<'_>, file: &Path) -> Result<LightDesc, LoadError> {
    let light = match kind_of(s, &["point", "spot", "directional", "environment"])? {
        "point" => LightDesc::Point { position: vector(s, "position")?, intensity: vector(s, "intensity")? },
        "spot" => {
            let cone_deg = scalar(s, "cone_deg")?;
            LightDesc::Spot {
                position: vector(s, "position")?,
                direction: vector(s, "direction")?,
                intensity: vector(s, "intensity")?,
                cone_deg,
                falloff_deg: scalar_or(s, "falloff_deg", cone_deg)?,
            }
        }
        "directional" => LightDesc::Directional {
            direction: vector(s, "direction")?,
            irradiance: vector(s, "irradiance")?,
        },
        _ => {
            // Turning an environment that is the same all round changes nothing.
            let degrees = scalar_or(s, "rotate_deg", 0.0)?;
            let image = picture(s, loader, file, degrees)?;
            let radiance =
                if image.is_some() { vector_or(s, "radiance", [1.0; 3])? } else { vector(s, "radiance")? };
            LightDesc::Environment(EnvironmentDesc { radiance, image })
        }
    };
    s.finish()?;
    Ok(light)
}

const MATERIAL_KINDS: &[&str] = &[
    "diffuse",
    "mirror",
    "conductor",
    "phong",
    "diffuse_phong",
    "dielectric",
    "thin_dielectric",
    "thin_film",
    "plastic",
    "null",
];

/// Index of refraction where none is said.
pub(crate) const GLASS: f32 = 1.5;

/// `albedo`, `texture` and `checker`, of which all that are there multiply.
fn albedo(
    s: &Section<'_>,
    loader: &mut Loader<'_>,
    file: &Path,
    default: Option<[f32; 3]>,
) -> Result<Reflectance, LoadError> {
    let color = s.numbers::<3>("albedo")?.map(|v| v.0);
    let texture = s.text("texture")?;
    let checker = s.section("checker")?.map(|c| checker(&c)).transpose()?;
    let texture = match texture {
        Some((name, line)) => match loader.find(file, line, &name) {
            Some(path) => Some(loader.texture(&path)?),
            None => {
                return Err(s.error(line, "texture", quoted(&name), "a PNG or JPEG beside the scene file"));
            }
        },
        None => None,
    };
    let default = if texture.is_some() || checker.is_some() { Some([1.0; 3]) } else { default };
    let color = s.required(color.or(default), "albedo", "albedo = [r, g, b], texture or checker")?;
    Ok(Reflectance { color, texture: texture.unwrap_or_default(), checker })
}

fn checker(s: &Section<'_>) -> Result<Checker, LoadError> {
    let colors = [vector(s, "a")?, vector(s, "b")?];
    let repeat = s.numbers::<2>("repeat")?.map_or([1.0; 2], |v| v.0);
    s.finish()?;
    Ok(Checker { colors, repeat })
}

/// The material and the line of its name.
pub(crate) fn material(
    s: &Section<'_>,
    loader: &mut Loader<'_>,
    file: &Path,
) -> Result<(MaterialDesc, usize), LoadError> {
    let (name, line) = name_of(s)?;
    let kind = match kind_of(s, MATERIAL_KINDS)? {
        "diffuse" => MaterialKind::Diffuse { albedo: albedo(s, loader, file, None)? },
        "mirror" => MaterialKind::Mirror { albedo: Reflectance::flat(vector_or(s, "albedo", [1.0; 3])?) },
        "phong" => MaterialKind::Phong { specular: vector(s, "specular")?, exponent: scalar(s, "exponent")? },
        "diffuse_phong" => {
            let (specular, exponent) = (vector(s, "specular")?, scalar(s, "exponent")?);
            MaterialKind::DiffusePhong { albedo: albedo(s, loader, file, None)?, specular, exponent }
        }
        "null" => MaterialKind::Null,
        "thin_film" => {
            let (reflect, transmit) =
                (vector_or(s, "reflect", [0.0; 3])?, vector_or(s, "transmit", [0.0; 3])?);
            if s.flag("scatter")?.unwrap_or(false) {
                MaterialKind::ScatteringFilm { reflect, transmit }
            } else {
                MaterialKind::ThinFilm { reflect, transmit }
            }
        }
        "conductor" => {
            let eta = s.one_or_three("eta")?;
            let k = s.one_or_three("k")?;
            let expected = "eta and k, one number or three each";
            let (eta, k) = (s.required(eta, "eta", expected)?, s.required(k, "k", expected)?);
            match roughness(s)? {
                None => MaterialKind::Conductor { eta, k },
                Some(roughness) => MaterialKind::RoughConductor { eta, k, roughness },
            }
        }
        "plastic" => MaterialKind::Plastic {
            albedo: albedo(s, loader, file, Some([0.5; 3]))?,
            ior: scalar_or(s, "ior", GLASS)?,
            roughness: roughness(s)?,
            nonlinear: s.flag("nonlinear")?.unwrap_or(false),
        },
        // dielectric, thin_dielectric
        other => {
            let ior = s.one_or_three("ior")?.unwrap_or([GLASS; 3]);
            let schlick = s.word("fresnel", &["exact", "schlick"])? == Some("schlick");
            match (other, roughness(s)?) {
                ("dielectric", None) => MaterialKind::Dielectric { ior, schlick },
                ("dielectric", Some(roughness)) => MaterialKind::RoughDielectric { ior, schlick, roughness },
                (_, None) => MaterialKind::ThinDielectric { ior, schlick },
                (_, Some(_)) => MaterialKind::Unsupported("rough thin_dielectric".into()),
            }
        }
    };
    let desc = MaterialDesc {
        name,
        kind,
        two_sided: s.flag("two_sided")?.unwrap_or(true),
        emission: vector_or(s, "emission", [0.0; 3])?,
    };
    s.finish()?;
    Ok((desc, line))
}

/// How rough the surface is; `None` where it is smooth.
fn roughness(s: &Section<'_>) -> Result<Option<Roughness>, LoadError> {
    let (alpha, exponent) = (s.number("roughness")?, s.number("exponent")?);
    let beckmann = s.word("distribution", &["ggx", "beckmann"])? == Some("beckmann");
    match (alpha, exponent) {
        (Some(_), Some((_, line))) => {
            Err(s.error(line, "exponent", "both roughness and exponent", "one of them"))
        }
        (None, Some((exponent, _))) => Ok(Some(Roughness::Phong(exponent))),
        (Some((alpha, _)), None) if alpha != 0.0 => {
            Ok(Some(if beckmann { Roughness::Beckmann(alpha) } else { Roughness::Ggx(alpha) }))
        }
        _ => Ok(None),
    }
}

/// The grid of a file that a field names, in `bounds` or in the box of the file.
fn grid(
    s: &Section<'_>,
    key: &'static str,
    bounds: Option<[[f32; 3]; 2]>,
    loader: &mut Loader<'_>,
    file: &Path,
) -> Result<Option<GridDesc>, LoadError> {
    let Some((name, line)) = s.text(key)? else { return Ok(None) };
    let Some(path) = loader.find(file, line, &name) else {
        return Err(s.error(line, key, quoted(&name), "a .vol file beside the scene file"));
    };
    let volume = volume::parse_vol(&loader.bytes(&path, volume::MAX_FILE)?, &path)?;
    Ok(Some(volume.into_grid(bounds)))
}

/// The medium and the line of its name.
pub(crate) fn medium(
    s: &Section<'_>,
    loader: &mut Loader<'_>,
    file: &Path,
) -> Result<(MediumDesc, usize), LoadError> {
    let (name, line) = name_of(s)?;
    let zero = [0.0; 3];
    let bounds = s.corners("bounds")?;
    let mut read = |key| grid(s, key, bounds.map(|b| b.0), loader, file);
    let (density, albedo) = (read("density")?, read("albedo_grid")?);
    if let Some((_, line)) = bounds.filter(|_| density.is_none() && albedo.is_none()) {
        return Err(s.error(line, "bounds", "a box without a grid", "density or albedo_grid beside it"));
    }
    let priority = match s.whole("priority")? {
        Some((value, line)) => {
            let expected = "a whole number that 32 bits hold";
            i32::try_from(value).map_err(|_| s.error(line, "priority", value.to_string(), expected))?
        }
        None => 0,
    };
    let (sigma_a, sigma_s) = (vector_or(s, "sigma_a", zero)?, vector_or(s, "sigma_s", zero)?);
    let desc = MediumDesc {
        emission: vector_or(s, "emission", zero)?,
        priority,
        density,
        albedo,
        ..MediumDesc::new(&name, sigma_a, sigma_s, scalar_or(s, "g", 0.0)?)
    };
    s.finish()?;
    Ok((desc, line))
}
