//! The compiled scene: flat arrays, indices instead of names, finite and energy-conserving by construction.
//!
//! Arenas, in the order in which a GPU backend binds them (eight storage buffers at most):
//! positions, triangles, surfaces, vertex attributes, shapes, materials + textures + checkers + coats, lights + their CDF, texels. Media and grids follow.

use super::needs::SceneNeeds;
use crate::bsdf::plastic;
use crate::geometry::{Aabb, BoxTree, Primitives, RoundShape};
use crate::light::EnvironmentMap;
use crate::math::{self, Vec3};
use crate::sensor::Camera;
use alloc::string::String;
use alloc::vec::Vec;
use bytemuck::{Pod, Zeroable};

/// "No such thing" in every index of the compiled scene.
pub const NO_INDEX: u32 = u32::MAX;

/// Flags of a [`MaterialRecord`].
pub mod material_flags {
    /// Both sides scatter.
    pub const TWO_SIDED: u32 = 1;
    /// `albedo` is the reflectance of a perfect mirror instead of a diffuse albedo.
    pub const MIRROR: u32 = 2;
    /// There is a Phong lobe.
    pub const GLOSSY: u32 = 4;
    /// Not a surface but a boundary between media.
    pub const NULL: u32 = 8;
    /// Shade with interpolated normals (a flag of surfaces, kept beside the others).
    pub const SHADING_NORMALS: u32 = 16;
    /// A smooth boundary between dielectrics; with [`THIN`], a plate of one.
    pub const DIELECTRIC: u32 = 32;
    /// Light passes straight on.
    pub const THIN: u32 = 64;
    /// A thin film: `albedo` is reflected, `specular` passes straight on.
    pub const FILM: u32 = 128;
    /// A metal: a mirror whose reflectance is that of the index `ior` + i `specular`.
    pub const CONDUCTOR: u32 = 256;
    /// Reflectances by Schlick's fit.
    pub const SCHLICK: u32 = 512;
    /// Rough by `roughness`: GGX microfacets unless one of the next two says otherwise.
    pub const ROUGH: u32 = 1024;
    /// Rough by Beckmann's microfacets.
    pub const BECKMANN: u32 = 2048;
    /// Rough by a Phong lobe of the exponent `exponent`.
    pub const PHONG: u32 = 4096;
    /// A diffuse body under a coat of index `ior`.
    pub const PLASTIC: u32 = 8192;
    /// A coated body's colours deepen by what goes back and forth.
    pub const NONLINEAR: u32 = 16384;
    /// A film that scatters: `albedo` is reflected, `specular` is transmitted.
    pub const SCATTERS: u32 = 32768;
    /// Light passes it straight on.
    pub const PASSES: u32 = NULL | THIN;
}

/// What a primitive's surface is: one record per triangle, then one per round shape.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct SurfaceRecord {
    /// Index of the material.
    pub material: u32,
    /// Index of the light that this primitive is (part of), or [`NO_INDEX`].
    pub light: u32,
    /// Medium behind (low 16 bits) and in front (high 16 bits), each index + 1, 0 for none.
    pub media: u32,
    /// [`material_flags::SHADING_NORMALS`] or 0.
    pub flags: u32,
    /// Unit geometric normal of the front of a triangle; zero for round shapes.
    pub normal: [f32; 3],
    /// [`sliver_factor`](crate::geometry::sliver_factor) of a triangle; 1 for round shapes.
    pub sliver: f32,
}

/// A surface's scattering and emission.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct MaterialRecord {
    /// Diffuse albedo or mirror reflectance per channel.
    pub albedo: [f32; 3],
    /// Bitmap that multiplies `albedo`, or [`NO_INDEX`].
    pub texture: u32,
    /// Specular coefficient of the Phong lobe per channel.
    pub specular: [f32; 3],
    /// Exponent of the Phong lobe.
    pub exponent: f32,
    /// Radiance emitted from the front \[W m^-2 sr^-1\] per channel.
    pub emission: [f32; 3],
    /// [`material_flags`].
    pub flags: u32,
    /// Index of refraction behind the surface over that in front, per channel; 1 where there is none.
    pub ior: [f32; 3],
    /// Scale of the slopes of microfacets.
    pub roughness: f32,
    /// Pattern that multiplies `albedo`, or [`NO_INDEX`].
    pub checker: u32,
    /// Coat of a plastic, or [`NO_INDEX`].
    pub coat: u32,
    /// Zero.
    pub pad: [u32; 2],
}

/// A pattern of squares, as [`Checker`](super::Checker) has it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct CheckerRecord {
    /// The two colours.
    pub colors: [[f32; 3]; 2],
    /// Pairs of squares per unit of u and of v.
    pub repeat: [f32; 2],
}

/// What is computed of a plastic's coat once.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct CoatRecord {
    /// Reflectance of diffuse light from within.
    pub internal: f32,
    /// Mean transmittance of diffuse light from outside.
    pub mean: f32,
    /// Zero.
    pub pad: [f32; 2],
    /// Transmittance of a coat of microfacets, see [`plastic::TABLE`].
    pub transmittance: [f32; plastic::TABLE],
}

/// A bitmap's place in the texel arena.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct TextureRecord {
    /// Width in texels, at least 1.
    pub width: u32,
    /// Height in texels, at least 1.
    pub height: u32,
    /// Index of the top left texel.
    pub first_texel: u32,
    /// Zero.
    pub pad: u32,
}

/// The kinds of light that are sampled. The constant environment is not among them: scattering draws its directions
/// from the same density that light sampling would.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightKind {
    /// `point`, `radiance` = intensity \[W/sr\].
    Point = 0,
    /// As point; `edge1` is the axis, `params` = \[cos of cone, cos of falloff\].
    Spot = 1,
    /// `normal` is the direction of travel, `radiance` = irradiance on a facing surface \[W/m^2\].
    Directional = 2,
    /// Corner `point` and two edges.
    Triangle = 3,
    /// Corner `point` and two edges: two triangles sampled as one.
    Parallelogram = 4,
    /// Centre `point`, `params[0]` = radius.
    Sphere = 5,
    /// Centre `point`, `normal`, `params[0]` = radius.
    Disk = 6,
    /// The picture of an environment, of which there is one: `radiance` = the largest, `edge1` = integral of radiance over all directions \[W m^-2\].
    Environment = 7,
}

/// One light. Fields that a kind does not name are zero.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct LightRecord {
    /// A [`LightKind`] as a number.
    pub kind: u32,
    /// First primitive of an emissive surface, or [`NO_INDEX`].
    pub primitive: u32,
    /// Probability of being picked, as the integer CDF realises it.
    pub pmf: f32,
    /// Area of an emissive surface \[m^2\].
    pub area: f32,
    /// Position, corner or centre \[m\].
    pub point: [f32; 3],
    /// Kind-specific numbers.
    pub params: [f32; 2],
    /// Zero.
    pub pad: [f32; 3],
    /// Radiance \[W m^-2 sr^-1\], intensity \[W/sr\] or irradiance \[W/m^2\] per channel.
    pub radiance: [f32; 3],
    /// First edge, or the axis of a spot.
    pub edge1: [f32; 3],
    /// Second edge.
    pub edge2: [f32; 3],
    /// Unit normal of the front, or the direction of travel.
    pub normal: [f32; 3],
}

/// A participating medium.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct MediumRecord {
    /// Absorption \[1/m\] per channel.
    pub sigma_a: [f32; 3],
    /// Henyey-Greenstein mean cosine.
    pub g: f32,
    /// Scattering \[1/m\] per channel.
    pub sigma_s: [f32; 3],
    /// Where media overlap, the one with the highest counts.
    pub priority: i32,
    /// Emitted radiance per metre.
    pub emission: [f32; 3],
    /// Grid that scales absorption and scattering, or [`NO_INDEX`].
    pub density_grid: u32,
    /// Grid of the single-scattering albedo, or [`NO_INDEX`].
    pub albedo_grid: u32,
    /// Zero.
    pub pad: [u32; 3],
}

/// Values on a grid, and its place in the arena of values; see [`crate::medium::grid`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GridRecord {
    /// Three rows of the map from the world to cells: (row . (point - corner)) + 1/2 is the coordinate along an axis, the corner being the last column \[m\].
    pub to_cells: [[f32; 4]; 3],
    /// Cells along x, y and z, each at least 1.
    pub size: [u32; 3],
    /// One value per cell, or three.
    pub channels: u32,
    /// Index of the first value: x runs fastest, then y, then z, channels together.
    pub first_value: u32,
    /// Index of the largest value of the first block of cells.
    pub first_majorant: u32,
    /// Zero.
    pub pad: [u32; 2],
}

/// A validated scene, ready for any backend.
#[derive(Clone, Debug)]
pub struct CompiledScene {
    /// Vertex positions \[m\].
    pub positions: Vec<[f32; 3]>,
    /// Vertex indices of each triangle, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Spheres and disks; as primitives they follow the triangles.
    pub shapes: Vec<RoundShape>,
    /// One record per primitive.
    pub surfaces: Vec<SurfaceRecord>,
    /// Texture coordinates per vertex, or empty.
    pub texcoords: Vec<[f32; 2]>,
    /// Shading normals per vertex (unit, or zero where there is none), or empty.
    pub normals: Vec<[f32; 3]>,
    /// Materials.
    pub materials: Vec<MaterialRecord>,
    /// Names of the materials, for messages.
    pub material_names: Vec<String>,
    /// Patterns of squares.
    pub checkers: Vec<CheckerRecord>,
    /// Coats of plastics.
    pub coats: Vec<CoatRecord>,
    /// Bitmaps.
    pub textures: Vec<TextureRecord>,
    /// Texels of all bitmaps, 0x00BBGGRR, sRGB.
    pub texels: Vec<u32>,
    /// Linear value of each sRGB code.
    pub srgb_decode: Vec<f32>,
    /// Lights that are sampled.
    pub lights: Vec<LightRecord>,
    /// Cumulative integer counts over `lights` (see `sampling::discrete`); empty without lights.
    pub light_cumulative: Vec<u32>,
    /// Radiance of the constant environment \[W m^-2 sr^-1\]; zero without one.
    pub environment: [f32; 3],
    /// The picture of the environment, which is added to the constant one.
    pub environment_map: Option<EnvironmentMap>,
    /// Media.
    pub media: Vec<MediumRecord>,
    /// Those of them that emit, and where.
    pub glows: Vec<super::Glow>,
    /// Grids that media refer to.
    pub grids: Vec<GridRecord>,
    /// Values of all grids, and the largest of each of their blocks.
    pub grid_values: Vec<f32>,
    /// Number, counted from 1, of the medium that the camera is said to stand in; 0 where nothing is said.
    pub camera_medium: u16,
    /// The camera, if the scene has one.
    pub camera: Option<Camera>,
    /// A box around all surfaces.
    pub bounds: Aabb,
    /// Boundaries that light passes straight on, and all that touches them: what may lie where one is crossed.
    pub crossings: BoxTree,
    /// The transport that occurs.
    pub needs: SceneNeeds,
}

impl Default for CompiledScene {
    fn default() -> Self {
        Self {
            positions: Vec::new(),
            triangles: Vec::new(),
            shapes: Vec::new(),
            surfaces: Vec::new(),
            texcoords: Vec::new(),
            normals: Vec::new(),
            materials: Vec::new(),
            material_names: Vec::new(),
            checkers: Vec::new(),
            coats: Vec::new(),
            textures: Vec::new(),
            texels: Vec::new(),
            srgb_decode: Vec::new(),
            lights: Vec::new(),
            light_cumulative: Vec::new(),
            environment: [0.0; 3],
            environment_map: None,
            media: Vec::new(),
            glows: Vec::new(),
            grids: Vec::new(),
            grid_values: Vec::new(),
            camera_medium: 0,
            camera: None,
            bounds: Aabb::EMPTY,
            crossings: BoxTree::default(),
            needs: SceneNeeds::default(),
        }
    }
}

impl CompiledScene {
    /// The geometry alone, as intersectors want it.
    pub fn primitives(&self) -> Primitives<'_> {
        Primitives { positions: &self.positions, triangles: &self.triangles, shapes: &self.shapes }
    }

    /// The material of a primitive.
    #[inline]
    pub fn material_of(&self, primitive: u32) -> &MaterialRecord {
        &self.materials[self.surfaces[primitive as usize].material as usize]
    }

    /// Centre and radius of a sphere around all surfaces \[m\].
    pub fn bounding_sphere(&self) -> (Vec3, f32) {
        bounding_sphere(&self.bounds)
    }

    /// Area of a primitive, one side \[m^2\]; 0 for what is none.
    pub fn primitive_area(&self, id: u32) -> f32 {
        let primitives = self.primitives();
        match (primitives.vertices(id), primitives.shape(id)) {
            (Some(v), _) => crate::geometry::triangle_area(v),
            (_, Some(s)) => super::lights::shape_area(s),
            _ => 0.0,
        }
    }

    /// Total area of all surfaces, one side each \[m^2\].
    pub fn area(&self) -> f64 {
        let mut sum = crate::math::Compensated::<f64>::new(0.0);
        for id in 0..self.primitives().count() as u32 {
            sum.add(f64::from(self.primitive_area(id)));
        }
        sum.value()
    }
}

/// Centre and radius of a sphere around a box \[m\]; an empty box gives radius 0.
pub(super) fn bounding_sphere(bounds: &Aabb) -> (Vec3, f32) {
    let half = (bounds.hi - bounds.lo) * 0.5;
    if half.x >= 0.0 && half.y >= 0.0 && half.z >= 0.0 {
        (bounds.lo + half, math::sqrt(half.dot(half)))
    } else {
        (Vec3::ZERO, 0.0)
    }
}
