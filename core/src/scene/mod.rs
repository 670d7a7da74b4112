//! The scene: what a user writes ([`SceneDesc`]), what estimators read and what light transport it needs.

mod desc;
mod error;

pub use desc::{
    CameraDesc, EnvironmentDesc, LightDesc, MaterialDesc, MaterialKind, MediumDesc, MeshDesc, Reflectance,
    SceneDesc, ShapeDesc, ShapeKind, TextureDesc, Wrap,
};
pub use error::{Cleanup, CompileReport, SceneError};
