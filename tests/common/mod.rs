//! What the tests of the command and of the shared scenes have in common.
#![allow(
    dead_code,
    unreachable_pub,
    unused_imports,
    reason = "each test binary has this module to itself and uses its part"
)]

use std::path::{Path, PathBuf};

/// The root of the workspace.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folder of the shared scenes, absolute or relative to the root of the workspace; nothing when
/// `ETENDUE_SCENES` is not set, which is said. Set but missing is a failure: a typing error must not look like
/// a pass.
pub fn shared_scenes() -> Option<PathBuf> {
    let Ok(value) = std::env::var("ETENDUE_SCENES") else {
        println!("skipped: ETENDUE_SCENES does not name the folder of the shared scenes");
        return None;
    };
    let path = root().join(value);
    assert!(path.is_dir(), "ETENDUE_SCENES is set, but {} is not a folder", path.display());
    Some(path)
}

/// The wgpu backend on the best adapter; nothing where there is none, which is said, and is a failure under `ETENDUE_REQUIRE_WGPU=1`.
#[cfg(feature = "wgpu")]
pub fn device() -> Option<Box<dyn etendue::core::backend::Backend>> {
    use etendue::core::backend::BackendError;
    use etendue::engine::{BackendKind, open_backend};
    match open_backend(BackendKind::Wgpu, None) {
        Ok(backend) => Some(backend),
        Err(BackendError::NoAdapter { wanted }) => {
            let required = std::env::var("ETENDUE_REQUIRE_WGPU").is_ok_and(|x| x == "1");
            assert!(!required, "no adapter ({wanted}), and ETENDUE_REQUIRE_WGPU=1 wants one");
            eprintln!("SKIPPED: no adapter ({wanted})");
            None
        }
        Err(e) => panic!("an adapter without a device: {e}"),
    }
}

#[cfg(feature = "cli")]
pub use command::*;

#[cfg(feature = "cli")]
mod command {
    use serde_json::Value;
    use std::ffi::OsStr;
    use std::path::{Path, PathBuf};
    use std::process::{Command, Output, Stdio};
    use tempfile::TempDir;

    /// The command with these arguments.
    pub fn command<S: AsRef<OsStr>>(args: &[S]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_etendue"));
        command.args(args).stdin(Stdio::null()).env_remove("ETENDUE_LOG");
        command
    }

    /// What a run of the command left.
    pub struct Run {
        pub code: Option<i32>,
        pub stdout: String,
        pub stderr: String,
        line: String,
    }

    impl From<(Output, String)> for Run {
        fn from((output, line): (Output, String)) -> Self {
            Self {
                code: output.status.code(),
                stdout: String::from_utf8(output.stdout).unwrap(),
                stderr: String::from_utf8(output.stderr).unwrap(),
                line,
            }
        }
    }

    impl Run {
        /// Asserts the exit code.
        #[track_caller]
        pub fn exits(self, code: i32) -> Self {
            assert_eq!(self.code, Some(code), "{}\n{}{}", self.line, self.stdout, self.stderr);
            self
        }

        /// Asserts that stderr holds each of these texts.
        #[track_caller]
        pub fn says(self, texts: &[&str]) -> Self {
            for text in texts {
                assert!(self.stderr.contains(text), "{}\nno `{text}` in\n{}", self.line, self.stderr);
            }
            self
        }

        /// Asserts that stdout is exactly one JSON object and returns it.
        #[track_caller]
        pub fn json(&self) -> Value {
            let value: Value = serde_json::from_str(&self.stdout).unwrap_or_else(|e| {
                panic!("{}\nstdout is not one JSON value ({e}):\n{}", self.line, self.stdout)
            });
            assert!(value.is_object(), "{value}");
            value
        }
    }

    /// Runs the command to its end.
    pub fn run<S: AsRef<OsStr>>(args: &[S]) -> Run {
        let mut command = command(args);
        let line = format!("{command:?}");
        (command.output().unwrap(), line).into()
    }

    /// A folder that disappears, and paths in it.
    pub struct Folder(TempDir);

    impl Folder {
        pub fn new() -> Self {
            Self(tempfile::tempdir().unwrap())
        }

        pub fn join(&self, name: &str) -> PathBuf {
            self.0.path().join(name)
        }

        /// The path as an argument.
        pub fn arg(&self, name: &str) -> String {
            self.join(name).to_str().unwrap().to_owned()
        }

        /// Writes a file and returns its path as an argument.
        pub fn write(&self, name: &str, text: &str) -> String {
            std::fs::write(self.join(name), text).unwrap();
            self.arg(name)
        }

        /// The names in the folder, sorted: nothing half-written may be among them.
        pub fn names(&self) -> Vec<String> {
            let mut names: Vec<String> = std::fs::read_dir(self.0.path())
                .unwrap()
                .map(|entry| entry.unwrap().file_name().into_string().unwrap())
                .collect();
            names.sort();
            names
        }
    }

    /// The closed Cornell box that ships with the project.
    pub fn closed_cornell() -> String {
        path_text(&super::root().join("scenes/cornell/closed.toml"))
    }

    /// A path as text.
    pub fn path_text(path: &Path) -> String {
        path.to_str().unwrap().to_owned()
    }

    /// A floor under a lamp, without a camera.
    pub const FLOOR: &str = r#"
[[shape]]
kind = "rectangle"
center = [0, 0, 0]
u = [0, 0, 9]
v = [9, 0, 0]

[[light]]
kind = "point"
position = [0, 3, 0]
intensity = [100, 100, 100]
"#;

    /// Two points on [`FLOOR`].
    pub const POINTS: &str = r#"{"note": "other fields are ignored", "probes": [
{"position": [1, 0, 0], "normal": [0, 1, 0], "triangle": 7},
{"position": [0, 0, 4], "normal": [0, 2, 0]}]}"#;

    /// A box of fog before a camera.
    pub const FOG: &str = r#"
[camera]
position = [0, 0, -3]
look_at = [0, 0, 0]
fov_x_deg = 60.0
resolution = [8, 8]

[[medium]]
name = "fog"
sigma_a = [0.05, 0.05, 0.05]
sigma_s = [0.2, 0.2, 0.2]

[[material]]
name = "boundary"
kind = "null"

[[shape]]
kind = "box"
min = [-1, -1, -1]
max = [1, 1, 1]
material = "boundary"
interior = "fog"

[[light]]
kind = "environment"
radiance = [1, 1, 1]
"#;

    /// The same outside of the box, without end, and aglow.
    pub fn endless_glow() -> String {
        FOG.replace("sigma_a", "emission = [1, 1, 1]\nsigma_a").replace("interior", "exterior")
    }
}
