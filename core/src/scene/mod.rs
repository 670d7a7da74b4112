//! The scene: what a user writes ([`SceneDesc`]), what estimators read ([`CompiledScene`]) and the
//! list of light transport that it needs ([`SceneNeeds`]).
//!
//! Data flows one way: `SceneDesc -> compile() -> CompiledScene`. Compilation validates everything once, so
//! that no inner loop has to: a compiled scene holds finite numbers, resolved indices and energy-conserving
//! materials only.

mod bitmap;
mod check;
mod compile;
mod compiled;
mod desc;
mod environment;
mod error;
mod glow;
mod grid;
mod lights;
mod material;
mod mesh;
mod needs;

pub use bitmap::{SRGB_CODES, sample_bitmap, srgb_to_linear};
pub use compile::compile;
pub use compiled::{
    CheckerRecord, CoatRecord, CompiledScene, GridRecord, LightKind, LightRecord, MaterialRecord,
    MediumRecord, NO_INDEX, SurfaceRecord, TextureRecord, material_flags,
};
pub use desc::{
    CameraDesc, Checker, EnvironmentDesc, EnvironmentImage, GridDesc, LightDesc, MaterialDesc, MaterialKind,
    MediumDesc, MeshDesc, Reflectance, Roughness, SceneDesc, ShapeDesc, ShapeKind, TextureDesc, Wrap,
};
pub use error::{Cleanup, CompileReport, SceneError};
pub use glow::Glow;
pub use material::{IOR_RANGE, ROUGHNESS_MAX};
pub use needs::SceneNeeds;
