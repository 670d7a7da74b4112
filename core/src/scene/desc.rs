//! What a user writes: plain data, names instead of indices, nothing derived.
//!
//! Every field is public and every collection may be empty. Nothing here is trusted:
//! [`compile`](super::compile) checks it all and says what is wrong.

use alloc::string::String;
use alloc::vec::Vec;

/// A scene as described by a file or by a host program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneDesc {
    /// The camera; absent where no image is asked for.
    pub camera: Option<CameraDesc>,
    /// Triangle meshes.
    pub meshes: Vec<MeshDesc>,
    /// Analytic shapes.
    pub shapes: Vec<ShapeDesc>,
    /// Lights other than emissive surfaces.
    pub lights: Vec<LightDesc>,
    /// Materials; meshes and shapes refer to them by name.
    pub materials: Vec<MaterialDesc>,
    /// Participating media; meshes, shapes and the camera refer to them by name.
    pub media: Vec<MediumDesc>,
    /// Bitmaps; materials refer to them by name.
    pub textures: Vec<TextureDesc>,
}

/// A pinhole or thin-lens camera. Right is forward x up; the pixel filter is a box.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraDesc {
    /// Position of the pinhole or of the lens centre \[m\].
    pub position: [f32; 3],
    /// A point on the optical axis, different from `position`.
    pub look_at: [f32; 3],
    /// A direction that is up in the image, not parallel to the axis.
    pub up: [f32; 3],
    /// Horizontal field of view \[degrees\], in (0, 180).
    pub fov_x_deg: f32,
    /// Width and height in pixels.
    pub resolution: [u32; 2],
    /// Radius of the thin lens \[m\]; 0 is a pinhole.
    pub lens_radius: f32,
    /// Distance along the axis that is in focus \[m\]; ignored by a pinhole.
    pub focus_distance: f32,
    /// Name of the medium the camera stands in; empty for none.
    pub medium: String,
}

/// A triangle mesh in its own coordinates, with one material per face.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshDesc {
    /// A name for messages (usually the file's).
    pub name: String,
    /// Vertex positions \[m\] before `transform`.
    pub positions: Vec<[f32; 3]>,
    /// Shading normals per vertex, or empty. Used only where `shading_normals` is set.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates per vertex, or empty; v = 0 is the bottom row of an image.
    pub texcoords: Vec<[f32; 2]>,
    /// Vertex indices of each triangle; the front is where they run counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle an index into `material_names`; empty means 0 for all.
    pub face_materials: Vec<u32>,
    /// Names of the materials that faces use. Empty means the default: diffuse, albedo 0.5.
    pub material_names: Vec<String>,
    /// Overrides the material of every face where it is not empty.
    pub material: String,
    /// Use `normals` for shading where they are present.
    pub shading_normals: bool,
    /// False: use the plain colours of the materials.
    pub textures: bool,
    /// Row-major affine transform applied to positions; the fourth column is the translation.
    /// A mirroring transform keeps each triangle's front on the same side of the surface.
    pub transform: Option<[[f32; 4]; 3]>,
    /// Medium behind the surface (against the normals); empty for none.
    pub interior: String,
    /// Medium in front of the surface; empty for none.
    pub exterior: String,
}

/// The geometry of an analytic shape.
#[derive(Clone, Debug, PartialEq)]
pub enum ShapeKind {
    /// A sphere; the front is outside.
    Sphere {
        /// Centre \[m\].
        center: [f32; 3],
        /// Radius \[m\], positive.
        radius: f32,
    },
    /// A flat disk; the front is where `normal` points.
    Disk {
        /// Centre \[m\].
        center: [f32; 3],
        /// Normal, any length but zero.
        normal: [f32; 3],
        /// Radius \[m\], positive.
        radius: f32,
    },
    /// A parallelogram with corners center ± u ± v; the front is along u x v.
    Rectangle {
        /// Centre \[m\].
        center: [f32; 3],
        /// First half-edge \[m\].
        u: [f32; 3],
        /// Second half-edge \[m\].
        v: [f32; 3],
    },
    /// An axis-aligned box; the front is outside.
    Box {
        /// Lower corner \[m\].
        min: [f32; 3],
        /// Upper corner \[m\].
        max: [f32; 3],
    },
}

/// An analytic shape with its surface.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeDesc {
    /// Geometry.
    pub kind: ShapeKind,
    /// Name of the material; empty means the default: diffuse, albedo 0.5.
    pub material: String,
    /// Medium behind the surface; empty for none.
    pub interior: String,
    /// Medium in front of the surface; empty for none.
    pub exterior: String,
}

/// A light that is not a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum LightDesc {
    /// Isotropic point light.
    Point {
        /// Position \[m\].
        position: [f32; 3],
        /// Intensity \[W/sr\] per channel.
        intensity: [f32; 3],
    },
    /// A point light within a cone: full inside `falloff_deg`, none outside `cone_deg`,
    /// smoothstep in the cosine between.
    Spot {
        /// Position \[m\].
        position: [f32; 3],
        /// Axis of the cone, the way light travels.
        direction: [f32; 3],
        /// Intensity on the axis \[W/sr\] per channel.
        intensity: [f32; 3],
        /// Half-angle where light ends \[degrees\], in (0, 180].
        cone_deg: f32,
        /// Half-angle where light starts to fall \[degrees\], in \[0, cone_deg\].
        falloff_deg: f32,
    },
    /// Parallel light from infinity.
    Directional {
        /// Direction of travel.
        direction: [f32; 3],
        /// Irradiance on a surface that faces the light \[W/m^2\] per channel.
        irradiance: [f32; 3],
    },
    /// Light from everywhere at infinity.
    Environment(EnvironmentDesc),
}

/// An environment: the same radiance from every direction, or a picture of it.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentDesc {
    /// Radiance \[W m^-2 sr^-1\] per channel; multiplies the picture where there is one.
    pub radiance: [f32; 3],
    /// The picture.
    pub image: Option<EnvironmentImage>,
}

impl EnvironmentDesc {
    /// The same radiance \[W m^-2 sr^-1\] from every direction.
    pub fn uniform(radiance: [f32; 3]) -> Self {
        Self { radiance, image: None }
    }
}

/// A picture of all directions: columns are longitudes, rows latitudes from +y (top) to -y, and the centre is -z.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentImage {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// width * height linear colours, row by row, top row first.
    pub texels: Vec<[f32; 3]>,
    /// Rotation from the picture's axes to the world's, row by row.
    pub to_world: [[f32; 3]; 3],
}

/// A colour; a bitmap by name or a checker multiplies it.
#[derive(Clone, Debug, PartialEq)]
pub struct Reflectance {
    /// Linear reflectance per channel, in \[0, 1\].
    pub color: [f32; 3],
    /// Name of a bitmap whose decoded texels multiply `color`; empty for none.
    pub texture: String,
    /// A pattern of squares that multiplies `color`.
    pub checker: Option<Checker>,
}

impl Reflectance {
    /// The same colour everywhere.
    pub fn flat(color: [f32; 3]) -> Self {
        Self { color, texture: String::new(), checker: None }
    }
}

/// Squares of two colours: the first where floor(2 u') + floor(2 v') is even, (u', v') the texture coordinates times `repeat`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checker {
    /// The two colours, linear, per channel in \[0, 1\].
    pub colors: [[f32; 3]; 2],
    /// Pairs of squares per unit of u and of v.
    pub repeat: [f32; 2],
}

/// How rough a surface is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Roughness {
    /// Microfacets distributed as Trowbridge and Reitz (GGX) have it; alpha is the slope scale.
    Ggx(f32),
    /// Microfacets of a Gaussian distribution of slopes (Beckmann); alpha is the slope scale.
    Beckmann(f32),
    /// No microfacets: a Phong lobe of this exponent about the mirror direction and, where light passes, about the refracted one (source C).
    Phong(f32),
}

/// How a surface scatters.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialKind {
    /// Lambert: albedo / pi.
    Diffuse {
        /// Albedo.
        albedo: Reflectance,
    },
    /// A perfect mirror.
    Mirror {
        /// Reflectance.
        albedo: Reflectance,
    },
    /// The Phong lobe of source C: specular (n+1)/(2 pi) cos^n about the mirror direction.
    Phong {
        /// Specular coefficient per channel.
        specular: [f32; 3],
        /// Exponent n >= 0.
        exponent: f32,
    },
    /// Lambert plus Phong, albedo + specular <= 1 per channel.
    DiffusePhong {
        /// Albedo of the diffuse part.
        albedo: Reflectance,
        /// Specular coefficient per channel.
        specular: [f32; 3],
        /// Exponent n >= 0.
        exponent: f32,
    },
    /// A smooth metal of refractive index eta + i k.
    Conductor {
        /// Real part per channel, above 0.
        eta: [f32; 3],
        /// Imaginary part per channel.
        k: [f32; 3],
    },
    /// A smooth boundary: behind it is a dielectric of this index, relative to what is in front.
    Dielectric {
        /// Index per channel, above 0; different ones disperse.
        ior: [f32; 3],
        /// Reflectance by Schlick's fit instead of Fresnel's equations.
        schlick: bool,
    },
    /// A plate of a dielectric, so thin that light passes straight on.
    ThinDielectric {
        /// Index per channel, above 0.
        ior: [f32; 3],
        /// Reflectance by Schlick's fit instead of Fresnel's equations.
        schlick: bool,
    },
    /// A film that reflects like a mirror and that light passes straight on, reflect + transmit <= 1 per channel.
    ThinFilm {
        /// What is reflected.
        reflect: [f32; 3],
        /// What passes.
        transmit: [f32; 3],
    },
    /// As [`Self::Conductor`], rough.
    RoughConductor {
        /// Real part per channel, above 0.
        eta: [f32; 3],
        /// Imaginary part per channel.
        k: [f32; 3],
        /// How rough.
        roughness: Roughness,
    },
    /// As [`Self::Dielectric`], rough.
    RoughDielectric {
        /// Index per channel, above 0; different ones disperse.
        ior: [f32; 3],
        /// Reflectance by Schlick's fit instead of Fresnel's equations.
        schlick: bool,
        /// How rough.
        roughness: Roughness,
    },
    /// A diffuse body under a clear coat of a dielectric.
    Plastic {
        /// Albedo of the body, seen without the coat.
        albedo: Reflectance,
        /// Index of the coat, above 0.
        ior: f32,
        /// How rough the coat is; `None` is smooth.
        roughness: Option<Roughness>,
        /// Count how colours deepen by light that goes back and forth within the coat.
        nonlinear: bool,
    },
    /// A film that scatters evenly to both of its sides, reflect + transmit <= 1 per channel.
    ScatteringFilm {
        /// Reflected albedo.
        reflect: [f32; 3],
        /// Transmitted albedo.
        transmit: [f32; 3],
    },
    /// No surface at all: a boundary between media.
    Null,
    /// A kind that the scene file knows and this version does not render; the name is kept for messages.
    Unsupported(String),
}

impl MaterialKind {
    /// What this version does not render of it, in the words of the scene file.
    pub fn unsupported(&self) -> Option<&str> {
        match self {
            Self::Unsupported(what) => Some(what),
            _ => None,
        }
    }
}

/// A named material.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialDesc {
    /// Name, unique in the scene.
    pub name: String,
    /// How it scatters.
    pub kind: MaterialKind,
    /// Both sides scatter; otherwise the back is black.
    pub two_sided: bool,
    /// Radiance emitted from the front \[W m^-2 sr^-1\] per channel.
    pub emission: [f32; 3],
}

/// A named participating medium.
#[derive(Clone, Debug, PartialEq)]
pub struct MediumDesc {
    /// Name, unique in the scene.
    pub name: String,
    /// Absorption coefficient \[1/m\] per channel.
    pub sigma_a: [f32; 3],
    /// Scattering coefficient \[1/m\] per channel.
    pub sigma_s: [f32; 3],
    /// Henyey-Greenstein mean cosine, in (-1, 1); positive is forward.
    pub g: f32,
    /// Radiance emitted per metre \[W m^-3 sr^-1\] per channel.
    pub emission: [f32; 3],
    /// Where media overlap, the one with the highest counts; among equals the one entered last.
    pub priority: i32,
    /// Names a grid (or another extension) that this version does not render; empty for none.
    pub unsupported: String,
    /// Scales absorption and scattering from place to place.
    pub density: Option<GridDesc>,
    /// Single-scattering albedo from place to place: of the extinction sigma_a + sigma_s it takes this share as scattering.
    pub albedo: Option<GridDesc>,
}

/// Values in a box, linear between the centres of its cells, 0 outside.
#[derive(Clone, Debug, PartialEq)]
pub struct GridDesc {
    /// Cells along x, y and z.
    pub size: [u32; 3],
    /// One value per cell, or three.
    pub channels: u32,
    /// The values: x runs fastest, then y, then z, channels together.
    pub values: Vec<f32>,
    /// Row-major affine transform from the unit cube that the cells fill to the world; the fourth column is the translation.
    pub to_world: [[f32; 4]; 3],
}

impl MediumDesc {
    /// A medium that does not emit: absorption and scattering \[1/m\] per channel, and the mean cosine.
    pub fn new(name: &str, sigma_a: [f32; 3], sigma_s: [f32; 3], g: f32) -> Self {
        let (name, unsupported) = (String::from(name), String::new());
        Self {
            name,
            sigma_a,
            sigma_s,
            g,
            emission: [0.0; 3],
            priority: 0,
            unsupported,
            density: None,
            albedo: None,
        }
    }
}

/// What lies beyond the edge of a bitmap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The bitmap repeats.
    #[default]
    Repeat,
}

/// A named 8-bit bitmap in sRGB, first row on top.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureDesc {
    /// Name, unique in the scene.
    pub name: String,
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// width * height texels, row by row, top row first.
    pub texels: Vec<[u8; 3]>,
    /// What lies beyond the edge.
    pub wrap: Wrap,
}
