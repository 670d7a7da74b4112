//! Stanford PLY: meshes in, meshes with numbers per vertex and per face out (Turk 1994).
//!
//! In: ASCII and binary of either byte order; `x y z`, optional `nx ny nz` and texture coordinates (`u v`,
//! `s t`, `texture_u texture_v`), polygons in `vertex_indices` or `vertex_index`. Other properties are left out.
//! Out: binary, little-endian, 32-bit floats; the same arrays give the same bytes.

use std::io::Cursor;
use std::path::Path;

use etendue_core::scene::MeshDesc;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Property, PropertyAccess, PropertyAccessResult};

use super::atomic::write_whole;
use super::error::{LoadError, Note, Problem, SaveError};
use super::polygon::Triangulator;

/// Any element: PLY has one record type per file position, and the crate reads them all alike.
#[derive(Default)]
struct Element {
    position: [f32; 3],
    normal: [f32; 3],
    texcoord: [f32; 2],
    corners: Vec<u32>,
    /// The list of corners held a negative number, or was no list of whole numbers.
    bad_corners: bool,
}

impl PropertyAccess for Element {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let slot = match name {
            "x" => &mut self.position[0],
            "y" => &mut self.position[1],
            "z" => &mut self.position[2],
            "nx" => &mut self.normal[0],
            "ny" => &mut self.normal[1],
            "nz" => &mut self.normal[2],
            "u" | "s" | "texture_u" => &mut self.texcoord[0],
            "v" | "t" | "texture_v" => &mut self.texcoord[1],
            "vertex_indices" | "vertex_index" => {
                match value.to_u32_list() {
                    Some(list) => self.corners = list,
                    None => self.bad_corners = true,
                }
                return PropertyAccessResult::Set;
            }
            _ => return PropertyAccessResult::Ignored,
        };
        // What is no number counts as one that is not finite, and is refused where that matters.
        *slot = value.to_f32_lossy().unwrap_or(f32::NAN);
        PropertyAccessResult::Set
    }
}

/// Parses a PLY file into a mesh without material, transform or media. `file` appears in messages only.
pub fn parse_ply(bytes: &[u8], file: &Path) -> Result<(MeshDesc, Vec<Note>), LoadError> {
    let failed = |e: ply_rs_bw::parser::ParseError| {
        let err = LoadError::decode(file, "PLY", &e);
        match e.line() {
            Some(line) => err.at(line),
            None => err,
        }
    };
    let mut reader = Reader::new(Cursor::new(bytes));
    let parser = Parser::<Element>::new();
    let header = parser.read_header(&mut reader).map_err(failed)?;
    for element in header.elements.values() {
        // Every element takes a byte at least, so a count beyond the file's length is a lie; without
        // properties it takes none, and could be counted for ever.
        let limit = if element.properties.is_empty() { 0 } else { bytes.len() };
        if element.count > limit {
            let problem =
                Problem::TooLarge { what: "elements", found: element.count as u64, limit: limit as u64 };
            return Err(LoadError::new(file, problem).field(element.name.clone()));
        }
    }
    let missing =
        |what: &str| LoadError::unexpected(file, format!("no {what}"), format!("an element with {what}"));
    let has = |e: &ElementDef, name: &str| e.properties.contains_key(name);
    let mut vertices = None;
    let mut faces = Vec::new();
    let mut has_normals = false;
    let mut has_texcoords = false;
    let mut notes = Vec::new();
    for element in header.elements.values() {
        let read = parser.read_payload_for_element(&mut reader, element, &header).map_err(failed)?;
        match element.name.as_str() {
            "vertex" => {
                if !["x", "y", "z"].into_iter().all(|name| has(element, name)) {
                    return Err(missing("x, y and z").field("vertex"));
                }
                has_normals = ["nx", "ny", "nz"].into_iter().all(|name| has(element, name));
                has_texcoords = [("u", "v"), ("s", "t"), ("texture_u", "texture_v")]
                    .into_iter()
                    .any(|(u, v)| has(element, u) && has(element, v));
                if has(element, "red") {
                    notes.push(Note::new(file, None, "vertex colours are ignored"));
                }
                vertices = Some(read);
            }
            "face" => faces = read,
            _ => {}
        }
    }
    let vertices = vertices.ok_or_else(|| missing("vertices"))?;
    let mesh = build(file, vertices, &faces, has_normals, has_texcoords, &mut notes)?;
    Ok((mesh, notes))
}

fn build(
    file: &Path,
    vertices: Vec<Element>,
    faces: &[Element],
    has_normals: bool,
    has_texcoords: bool,
    notes: &mut Vec<Note>,
) -> Result<MeshDesc, LoadError> {
    if vertices.len() as u64 > u64::from(u32::MAX) {
        let (found, limit) = (vertices.len() as u64, u64::from(u32::MAX));
        return Err(LoadError::new(file, Problem::TooLarge { what: "vertices", found, limit }));
    }
    if let Some(i) = vertices.iter().position(|v| v.position.iter().any(|x| !x.is_finite())) {
        let err = LoadError::unexpected(file, "a coordinate that is not finite", "a finite number");
        return Err(err.field(format!("vertex {i}")));
    }
    let finite = |values: &[f32]| values.iter().all(|x| x.is_finite());
    let mut mesh = MeshDesc::default();
    let mut mended = 0;
    for v in &vertices {
        mesh.positions.push(v.position);
        if has_normals {
            let good = finite(&v.normal);
            mended += usize::from(!good);
            mesh.normals.push(if good { v.normal } else { [0.0; 3] });
        }
        if has_texcoords {
            let good = finite(&v.texcoord);
            mended += usize::from(!good);
            mesh.texcoords.push(if good { v.texcoord } else { [0.0; 2] });
        }
    }
    if mended > 0 {
        let message = format!("{mended} normals or texture coordinates that are not finite were set to 0");
        notes.push(Note::new(file, None, message));
    }
    let mut triangulator = Triangulator::new();
    let mut outline = Vec::new();
    let mut dropped = 0;
    let mut crossing = 0;
    for (i, face) in faces.iter().enumerate() {
        let fail = |found: String, expected: &str| {
            Err(LoadError::unexpected(file, found, expected).field(format!("face {i}")))
        };
        if face.bad_corners {
            return fail("an index that is not a whole number from 0".into(), "indices of vertices");
        }
        outline.clear();
        for &corner in &face.corners {
            match mesh.positions.get(corner as usize) {
                Some(p) => outline.push(*p),
                None => {
                    let expected = format!("less than {}, the number of vertices", mesh.positions.len());
                    return fail(format!("vertex {corner}"), &expected);
                }
            }
        }
        let has_area = triangulator
            .cut(&outline, |t| mesh.triangles.push(t.map(|k| face.corners[k])))
            .map_err(|p| LoadError::new(file, p).field(format!("face {i}")))?;
        dropped += usize::from(!has_area);
        crossing += usize::from(triangulator.crossing);
    }
    if dropped > 0 {
        let message = format!("{dropped} faces without area, dropped");
        notes.push(Note::new(file, None, message));
    }
    if crossing > 0 {
        let message = format!("{crossing} faces that cross themselves, cut as well as can be");
        notes.push(Note::new(file, None, message));
    }
    Ok(mesh)
}

/// Writes a mesh with named numbers per vertex and per face, as binary little-endian PLY.
///
/// Names are single words, different from each other and from `x y z vertex_indices`; each array has one number
/// per vertex or triangle; triangles refer to existing vertices.
pub fn write_ply(
    path: &Path,
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    vertex_properties: &[(&str, Vec<f32>)],
    face_properties: &[(&str, Vec<f32>)],
) -> Result<(), SaveError> {
    let fail = |reason: String| Err(SaveError::new(path, reason));
    for (what, count, properties) in
        [("vertices", positions.len(), vertex_properties), ("faces", triangles.len(), face_properties)]
    {
        let mut names = vec!["x", "y", "z", "vertex_indices"];
        for (name, values) in properties {
            if name.is_empty() || !name.bytes().all(|b| b.is_ascii_graphic()) {
                return fail(format!("\"{name}\" is not one plain word and cannot name a property"));
            }
            if names.contains(name) {
                return fail(format!("two properties are named {name}"));
            }
            if values.len() != count {
                return fail(format!("property {name} has {} numbers for {count} {what}", values.len()));
            }
            names.push(name);
        }
    }
    // The format's customary index type is a signed integer.
    let limit = positions.len().min(i32::MAX as usize);
    if let Some(index) = triangles.iter().flatten().find(|i| **i as usize >= limit) {
        return fail(format!("a triangle refers to vertex {index}, but there are only {limit}"));
    }
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", positions.len());
    for name in ["x", "y", "z"].iter().chain(vertex_properties.iter().map(|p| &p.0)) {
        header += &format!("property float {name}\n");
    }
    header += &format!("element face {}\nproperty list uchar int vertex_indices\n", triangles.len());
    for (name, _) in face_properties {
        header += &format!("property float {name}\n");
    }
    header += "end_header\n";
    let mut bytes = header.into_bytes();
    for (i, p) in positions.iter().enumerate() {
        for value in p.iter().chain(vertex_properties.iter().map(|v| &v.1[i])) {
            bytes.extend(value.to_le_bytes());
        }
    }
    for (i, t) in triangles.iter().enumerate() {
        bytes.push(3);
        for index in t {
            bytes.extend(index.to_le_bytes());
        }
        for (_, values) in face_properties {
            bytes.extend(values[i].to_le_bytes());
        }
    }
    write_whole(path, &bytes)
}
