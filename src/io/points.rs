//! Lists of surface points: `{"probes": [{"position": [x,y,z], "normal": [x,y,z]}, ...]}`.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::atomic::write_whole;
use super::error::{LoadError, SaveError};
use super::source::{DiskSource, read_file};

/// Longer files are refused.
const MAX_FILE: u64 = 1 << 30;

/// A point on a surface, and its irradiance where that is known. Other fields of a file are ignored.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Wide")]
pub struct Probe {
    /// Position \[m\].
    pub position: [f32; 3],
    /// Normal on the side that is asked about, any length but zero.
    pub normal: [f32; 3],
    /// Irradiance, direct and indirect \[W/m^2\] per channel.
    #[serde(rename = "E", skip_serializing_if = "Option::is_none")]
    pub irradiance: Option<[f32; 3]>,
    /// Standard error of `irradiance`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stderr: Option<[f32; 3]>,
}

/// As a file has it: what lies beyond f32 is found by [`parse_points`], which can say where.
#[derive(Deserialize)]
struct Wide {
    position: [f64; 3],
    normal: [f64; 3],
    #[serde(rename = "E", default)]
    irradiance: Option<[f64; 3]>,
    #[serde(default)]
    stderr: Option<[f64; 3]>,
}

impl From<Wide> for Probe {
    fn from(wide: Wide) -> Self {
        let narrow = |v: [f64; 3]| v.map(|x| x as f32);
        Self {
            position: narrow(wide.position),
            normal: narrow(wide.normal),
            irradiance: wide.irradiance.map(narrow),
            stderr: wide.stderr.map(narrow),
        }
    }
}

#[derive(Deserialize)]
struct Document {
    probes: Vec<Probe>,
}

/// Reads a list of points.
pub fn read_points(path: &Path) -> Result<Vec<Probe>, LoadError> {
    parse_points(&read_file(&DiskSource, path, MAX_FILE)?, path)
}

/// As [`read_points`], from bytes. `file` appears in messages only.
pub fn parse_points(bytes: &[u8], file: &Path) -> Result<Vec<Probe>, LoadError> {
    let document: Document = serde_json::from_slice(bytes).map_err(|e| {
        let message = e.to_string();
        // The place stands before the message already.
        let message = message.split(" at line ").next().unwrap_or_default();
        let err = LoadError::decode(file, "list of points in JSON", message);
        if e.line() > 0 { err.at(e.line()) } else { err }
    })?;
    for (i, p) in document.probes.iter().enumerate() {
        let expected =
            |what| LoadError::unexpected(file, "a number beyond f32", what).field(format!("probe {}", i + 1));
        // JSON has no infinity, but 1e60 is one as an f32.
        if !p.position.iter().chain(&p.normal).all(|x| x.is_finite()) {
            return Err(expected("a finite position and normal"));
        }
        if p.normal == [0.0; 3] {
            let err = LoadError::unexpected(file, "a zero normal", "a direction");
            return Err(err.field(format!("probe {}", i + 1)));
        }
    }
    Ok(document.probes)
}

/// Irradiance over a whole surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeterReading {
    /// The material whose surfaces they are.
    pub surface: String,
    /// At their fronts or at their backs.
    pub side: &'static str,
    /// Area \[m^2\].
    pub area: f64,
    /// Mean irradiance, direct and indirect \[W/m^2\] per channel.
    #[serde(rename = "E")]
    pub irradiance: [f32; 3],
    /// Standard error of `irradiance`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stderr: Option<[f32; 3]>,
}

/// Writes readings of meters, one a line: `{"meters": [...]}`. Refuses numbers that are not finite, for JSON has none.
pub fn write_meters(path: &Path, readings: &[MeterReading]) -> Result<(), SaveError> {
    write_list(path, "meter", readings, |r| {
        r.irradiance.iter().chain(r.stderr.iter().flatten()).all(|x| x.is_finite())
    })
}

/// Writes a list of points, one a line. The same list gives the same bytes; numbers are the shortest that read
/// back as the same f32. Refuses numbers that are not finite, for JSON has none.
pub fn write_points(path: &Path, probes: &[Probe]) -> Result<(), SaveError> {
    write_list(path, "probe", probes, |p| {
        let optional = p.irradiance.iter().chain(&p.stderr).flatten();
        p.position.iter().chain(&p.normal).chain(optional).all(|x| x.is_finite())
    })
}

/// An object of one list, that of these things, one a line.
fn write_list<T: Serialize>(
    path: &Path,
    thing: &str,
    list: &[T],
    is_finite: impl Fn(&T) -> bool,
) -> Result<(), SaveError> {
    let mut text = format!("{{\"{thing}s\": [\n");
    for (i, item) in list.iter().enumerate() {
        if !is_finite(item) {
            let reason = format!("{thing} {} holds a number that is not finite", i + 1);
            return Err(SaveError::new(path, reason));
        }
        text += &serde_json::to_string(item).map_err(|e| SaveError::new(path, e))?;
        text += if i + 1 < list.len() { ",\n" } else { "\n" };
    }
    text += "]}\n";
    write_whole(path, text.as_bytes())
}
