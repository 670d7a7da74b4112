//! Operators to files and back.

use super::radiosity::{BakeSettings, Baked, Codec, Operator};
use crate::io::{OperatorFile, OperatorInfo, transport_hash};
use etendue_core::backend::Session;
use etendue_core::illumination::Clusters;
use etendue_core::radiosity::patches::{PatchMap, Patches};
use etendue_core::scene::CompiledScene;
use std::fmt::Write as _;

/// Why an operator is not one of a scene.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum OpenError {
    /// Baked from another scene, or this one has changed.
    #[error(
        "the operator was baked from other geometry or materials: its scene has the hash {}, this one {}",
        hexadecimal(.operator), hexadecimal(.scene)
    )]
    OtherScene {
        /// Hash in the file.
        operator: [u8; 32],
        /// Hash of the scene.
        scene: [u8; 32],
    },
    /// The scene is divided into another number of elements.
    #[error(
        "the operator has {operator} elements, the scene {scene}: another version of this program divided it"
    )]
    Elements {
        /// Elements in the file.
        operator: usize,
        /// Elements of the scene.
        scene: usize,
    },
    /// The elements make other patches.
    #[error("patch {patch} of the operator is another in the scene: another version of this program made it")]
    Patch {
        /// The first that differs.
        patch: usize,
    },
}

fn hexadecimal(hash: &[u8; 32]) -> String {
    hash.iter().fold(String::new(), |mut text, b| {
        let _ = write!(text, "{b:02x}");
        text
    })
}

/// A bake of a scene as a file holds it.
pub fn operator_file(baked: &Baked, settings: &BakeSettings, scene: &CompiledScene) -> OperatorFile {
    let operator = &baked.operator;
    let (codec, max_error) = match settings.codec {
        Codec::Auto { max_error } => ("auto", Some(max_error)),
        Codec::Tiles => ("tiles", None),
        Codec::F16 => ("f16", None),
        Codec::F32 => ("f32", None),
        Codec::Published { .. } => ("published", None),
        Codec::Bc1 { .. } => ("bc1", None),
        Codec::Bc4 { .. } => ("bc4", None),
    };
    OperatorFile {
        info: OperatorInfo {
            program: env!("CARGO_PKG_VERSION").into(),
            transport_hash: transport_hash(scene),
            patches_asked: settings.patches.count,
            rays_per_patch: settings.rays,
            rays: baked.rays,
            seed: settings.patches.seed,
            bounces: match settings.codec {
                Codec::Published { bounces, .. } => bounces,
                _ => settings.bounces,
            },
            passes: operator.passes,
            codec: codec.into(),
            max_error,
            error: baked.error,
            elements: *operator.map.elements.settings(),
        },
        patches: operator.map.patches.list().to_vec(),
        of: operator.map.patches.of().to_vec(),
        escaped: operator.escaped.clone(),
        seen: operator.seen.clone(),
        transport: operator.transport.clone(),
    }
}

/// The operator of a file for a session's scene, whose lights may be others than it was baked with.
///
/// # Errors
/// [`OpenError`]: the scene is not the one that was baked.
pub fn open_operator(file: OperatorFile, session: &dyn Session) -> Result<Operator, OpenError> {
    let scene = session.scene();
    let found = transport_hash(scene);
    if found != file.info.transport_hash {
        return Err(OpenError::OtherScene { operator: file.info.transport_hash, scene: found });
    }
    let elements = session.elements(&file.info.elements);
    if elements.count() != file.of.len() {
        return Err(OpenError::Elements { operator: file.of.len(), scene: elements.count() });
    }
    let clusters = Clusters { count: file.patches.len(), of: file.of, size: 0.0 };
    let patches = Patches::new(scene, &elements, &clusters);
    if patches.list() != file.patches || patches.of() != clusters.of {
        let differs = |(a, b)| a != b;
        let same = patches.list().iter().zip(&file.patches).position(differs);
        let patch = same.unwrap_or(patches.len().min(file.patches.len()));
        return Err(OpenError::Patch { patch });
    }
    Ok(Operator {
        map: PatchMap { elements, patches },
        transport: file.transport,
        escaped: file.escaped,
        seen: file.seen,
        passes: file.info.passes,
    })
}
