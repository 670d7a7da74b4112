//! Files in and out: scenes, meshes, bitmaps, images, probe lists and operators. No light transport happens here.
//!
//! - [`load_scene`] reads a TOML scene file, a Mitsuba 3 scene in XML, or a bare `.obj` or `.ply` mesh, into a
//!   [`SceneDesc`](etendue_core::scene::SceneDesc) and the [`Note`]s worth telling.
//! - [`read_exr`] and [`write_exr`] move images; [`write_png`] and [`read_mask`] move 8-bit ones.
//! - [`read_points`] and [`write_points`] move lists of surface points.
//! - [`read_operator`] and [`write_operator`] move baked operators; [`transport_hash`] says whether a scene is theirs.
//! - [`read_vol`] and [`write_vol`] move grids of values, for media.
//! - [`write_ktx2`] writes blocks of textures for a GPU.
//! - [`write_ply`] writes a mesh with numbers per vertex and per face.
//!
//! Input is not trusted: whatever the bytes, a reader returns a value or a [`LoadError`] that names the
//! file, the line and the field where there is one. It does not panic, and it allocates in proportion to
//! the bytes it was given. Every reader has a twin on bytes (`parse_...`), with nested files behind
//! [`FileSource`], so that tests and fuzzers need no disk.
//!
//! Output appears whole or not at all, and the same value gives the same bytes.

mod atomic;
mod bitmap;
mod error;
mod exr;
mod frame;
mod hash;
mod ktx2;
mod mesh;
mod mitsuba;
mod mtl;
mod obj;
mod operator;
mod ply;
mod points;
mod polygon;
mod scene;
mod scene_fields;
mod source;
mod toml_view;
mod volume;

pub use atomic::write_whole;
pub use bitmap::{Mask, parse_texture, read_mask, read_png, write_png};
pub use error::{LoadError, Note, Problem, SaveError};
pub use exr::{RenderImage, parse_exr, read_exr, write_exr};
pub use hash::transport_hash;
pub use ktx2::{BlockFormat, encode_ktx2, write_ktx2};
pub use mitsuba::{MitsubaOptions, parse_scene_mitsuba};
pub use mtl::{Mtl, MtlMap, MtlMaterial, parse_mtl};
pub use obj::{Obj, parse_obj};
pub use operator::{
    OperatorFile, OperatorInfo, encode_operator, parse_operator, read_operator, write_operator,
};
pub use ply::{parse_ply, write_ply};
pub use points::{MeterReading, Probe, parse_points, read_points, write_meters, write_points};
pub use scene::{LoadedScene, load_scene, parse_mesh_scene, parse_scene_toml};
pub use source::{DiskSource, FileSource, MemorySource};
pub use volume::{Volume, encode_vol, parse_vol, read_vol, write_vol};
