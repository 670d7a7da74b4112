//! Global illumination that states its error.
//!
//! The facade of the workspace: it re-exports the exact math ([`core`]), chooses a backend at run time
//! ([`engine`]), drives jobs to a number of samples, a time or an error ([`driver`]), reads and writes files ([`io`])
//! and compares images ([`metrics`]).
//!
//! ```
//! # #[cfg(feature = "cpu")] {
//! use etendue::core::scene::{LightDesc, SceneDesc, ShapeDesc, ShapeKind, compile};
//! use etendue::core::backend::Probe;
//! use etendue::{driver, engine};
//! use std::sync::Arc;
//!
//! // A lamp of 100 W/sr three metres above a floor.
//! let floor = ShapeKind::Rectangle { center: [0.0; 3], u: [0.0, 0.0, 9.0], v: [9.0, 0.0, 0.0] };
//! let desc = SceneDesc {
//!     shapes: vec![ShapeDesc { kind: floor, material: "".into(), interior: "".into(), exterior: "".into() }],
//!     lights: vec![LightDesc::Point { position: [0.0, 3.0, 0.0], intensity: [100.0; 3] }],
//!     ..SceneDesc::default()
//! };
//! let (scene, _) = compile(&desc)?;
//! let backend = engine::open_backend(engine::BackendKind::Cpu, Some(1))?;
//! let session = backend.open(Arc::new(scene))?;
//! let probe = Probe { position: [1.0, 0.0, 0.0], normal: [0.0, 1.0, 0.0] };
//! let result = driver::probes(&*session, &[probe], &driver::Settings::default(), &driver::Silent)?;
//! let truth = 100.0 * 3.0 / 10.0_f64.powf(1.5); // I cos / d^2 = I h / d^3
//! assert!((result.film.mean(0)[0] - truth).abs() <= 1e-5 * truth);
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use etendue_core as core;

#[cfg(feature = "cpu")]
pub use etendue_cpu as cpu;
#[cfg(feature = "wgpu")]
pub use etendue_wgpu as wgpu;

pub mod driver;
pub mod engine;
#[cfg(feature = "io")]
pub mod io;
pub mod metrics;

#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
