//! Wavefront OBJ: the polygons of a file as indexed triangles (Wavefront, Advanced Visualizer manual,
//! appendix B1, 1989).
//!
//! What deviates from a literal reading, and why: free-form geometry, lines and points are not surfaces and
//! are left out; `v x y z w` and `v x y z r g b` keep the position only (w weighs free-form curves, and
//! vertex colours are an extension that no material reads); objects, groups and smoothing groups change
//! nothing. An index may refer to a vertex further down.

use std::collections::HashMap;
use std::path::Path;

use super::error::{LoadError, Note, Problem, quoted};
use super::polygon::Triangulator;

/// The triangles of an OBJ file, and the names of what its materials need.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Obj {
    /// Positions; equal triples of position, texture coordinate and normal share an entry.
    pub positions: Vec<[f32; 3]>,
    /// Texture coordinates per entry, (0, 0) where a face had none; empty when no face had any.
    pub texcoords: Vec<[f32; 2]>,
    /// Normals per entry, zero where a face had none; empty when no face had any.
    pub normals: Vec<[f32; 3]>,
    /// Indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle an index into `materials`.
    pub face_materials: Vec<u32>,
    /// The names that `usemtl` gave to at least one face, and the line of the first such `usemtl`;
    /// an empty name for faces before any.
    pub materials: Vec<(String, usize)>,
    /// What `mtllib` lines say, and the line.
    pub libraries: Vec<(String, usize)>,
    /// What was mended or left out.
    pub notes: Vec<Note>,
}

/// "No index": OBJ counts from 1, so that the last number is never a valid index.
const NONE: u32 = u32::MAX;

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Corner {
    position: u32,
    texcoord: u32,
    normal: u32,
}

struct Face {
    first: usize,
    corners: usize,
    material: u32,
    line: usize,
}

#[derive(Default)]
struct Raw {
    positions: Vec<[f32; 3]>,
    texcoords: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    corners: Vec<Corner>,
    faces: Vec<Face>,
}

/// Counts events of one kind, and remembers the line of the first.
#[derive(Default)]
struct Tally(Vec<(&'static str, usize, usize)>);

impl Tally {
    fn add(&mut self, message: &'static str, line: usize) {
        match self.0.iter_mut().find(|e| e.0 == message) {
            Some(e) => e.2 += 1,
            None => self.0.push((message, line, 1)),
        }
    }

    fn notes(self, file: &Path) -> impl Iterator<Item = Note> {
        self.0.into_iter().map(move |(message, line, count)| {
            Note::new(file, Some(line), format!("{count} {message} (this is the first)"))
        })
    }
}

const THIN: &str = "faces with fewer than three corners, dropped";
const DEGENERATE: &str = "faces without area, dropped";
const CROSSING: &str = "faces that cross themselves, cut as well as can be";
const NOT_SURFACES: &str = "lines and points, left out because they are no surfaces";
const FREE_FORM: &str = "statements of free-form curves and surfaces, left out";
const COLOURS: &str = "vertices with colours, which are ignored";
const WEIGHTS: &str = "vertices with a fourth coordinate, which is ignored";
const NO_TEXCOORD: &str = "corners that refer to no existing texture coordinate, which use (0, 0)";
const NO_NORMAL: &str = "corners that refer to no existing normal, which use that of their triangle";
const BAD_TEXCOORD: &str = "texture coordinates that are not finite, set to 0";
const BAD_NORMAL: &str = "normals that are not finite, set to 0";

/// Parses an OBJ file. `file` appears in messages only.
pub fn parse_obj(bytes: &[u8], file: &Path) -> Result<Obj, LoadError> {
    let text = decode(bytes);
    let mut obj = Obj::default();
    let mut raw = Raw::default();
    let mut tally = Tally::default();
    let mut names: HashMap<String, u32> = HashMap::new();
    let mut material: Option<u32> = None;

    for (line, text) in LogicalLines::new(&text) {
        let fail = |found: String, expected: &str| LoadError::unexpected(file, found, expected).at(line);
        let (keyword, rest) = split_keyword(&text);
        match keyword {
            "v" => {
                let (values, count) = parse_numbers::<6>(rest)
                    .map_err(|token| fail(quoted(token), "a number").field("vertex"))?;
                if count < 3 {
                    return Err(fail(format!("{count} numbers"), "3 coordinates").field("vertex"));
                }
                if let Some(bad) = values[..3].iter().find(|v| !v.is_finite()) {
                    return Err(fail(bad.to_string(), "a finite coordinate").field("vertex"));
                }
                match count {
                    4 => tally.add(WEIGHTS, line),
                    6.. => tally.add(COLOURS, line),
                    _ => {}
                }
                raw.positions.push([values[0], values[1], values[2]]);
            }
            "vt" => {
                let (mut values, count) = parse_numbers::<3>(rest)
                    .map_err(|token| fail(quoted(token), "a number").field("texture coordinate"))?;
                if count < 1 {
                    return Err(fail("nothing".into(), "1 to 3 numbers").field("texture coordinate"));
                }
                if values.iter().any(|v| !v.is_finite()) {
                    tally.add(BAD_TEXCOORD, line);
                    values = [0.0; 3];
                }
                raw.texcoords.push([values[0], values[1]]);
            }
            "vn" => {
                let (mut values, count) = parse_numbers::<3>(rest)
                    .map_err(|token| fail(quoted(token), "a number").field("normal"))?;
                if count < 3 {
                    return Err(fail(format!("{count} numbers"), "3 coordinates").field("normal"));
                }
                if values.iter().any(|v| !v.is_finite()) {
                    tally.add(BAD_NORMAL, line);
                    values = [0.0; 3];
                }
                raw.normals.push(values);
            }
            "f" | "fo" => {
                let first = raw.corners.len();
                for token in tokens(rest) {
                    let corner = raw.corner(token).map_err(|e| match e {
                        BadCorner::Zero => fail(quoted(token), "indices that count from 1 (or back from -1)"),
                        BadCorner::Text => fail(quoted(token), "v, v/vt, v//vn or v/vt/vn"),
                        BadCorner::TooFarBack => {
                            fail(quoted(token), "a negative index that stays within what precedes the face")
                        }
                    });
                    raw.corners.push(corner.map_err(|e| e.field("face"))?);
                }
                let corners = raw.corners.len() - first;
                if corners < 3 {
                    tally.add(THIN, line);
                    raw.corners.truncate(first);
                    continue;
                }
                let material = *material.get_or_insert_with(|| {
                    obj.materials.push((String::new(), line));
                    names.insert(String::new(), 0);
                    0
                });
                raw.faces.push(Face { first, corners, material, line });
            }
            "usemtl" => {
                let name = rest.trim();
                material = Some(match names.get(name) {
                    Some(&i) => i,
                    None => {
                        let i = obj.materials.len() as u32;
                        names.insert(name.to_owned(), i);
                        obj.materials.push((name.to_owned(), line));
                        i
                    }
                });
            }
            "mtllib" => obj.libraries.push((rest.trim().to_owned(), line)),
            "l" | "p" => tally.add(NOT_SURFACES, line),
            "curv" | "curv2" | "surf" => tally.add(FREE_FORM, line),
            // Groups, names, smoothing, parameters of free-form geometry, extensions.
            _ => {}
        }
    }
    let limit = u64::from(u32::MAX - 1);
    for (what, found) in [("vertices", raw.positions.len()), ("corners", raw.corners.len())] {
        if found as u64 > limit {
            return Err(LoadError::new(file, Problem::TooLarge { what, found: found as u64, limit }));
        }
    }
    raw.export(file, &mut obj, &mut tally)?;
    drop_unused_materials(&mut obj);
    obj.notes.extend(tally.notes(file));
    Ok(obj)
}

enum BadCorner {
    Zero,
    Text,
    TooFarBack,
}

impl Raw {
    fn corner(&self, token: &str) -> Result<Corner, BadCorner> {
        let mut parts = token.split('/');
        let mut index = |len: usize, required: bool| match parts.next() {
            None | Some("") if !required => Ok(NONE),
            None => Err(BadCorner::Text),
            Some(text) => {
                let i: i64 = text.parse().map_err(|_| BadCorner::Text)?;
                match i {
                    0 => Err(BadCorner::Zero),
                    1.. => Ok(u32::try_from(i - 1).unwrap_or(NONE - 1)),
                    // Saturates: `i64::MIN` has no counterpart.
                    _ => {
                        match usize::try_from(i.saturating_neg()).ok().and_then(|back| len.checked_sub(back))
                        {
                            Some(i) => Ok(u32::try_from(i).unwrap_or(NONE - 1)),
                            None => Err(BadCorner::TooFarBack),
                        }
                    }
                }
            }
        };
        let corner = Corner {
            position: index(self.positions.len(), true)?,
            texcoord: index(self.texcoords.len(), false)?,
            normal: index(self.normals.len(), false)?,
        };
        match parts.next() {
            Some(_) => Err(BadCorner::Text),
            None => Ok(corner),
        }
    }

    fn export(&mut self, file: &Path, obj: &mut Obj, tally: &mut Tally) -> Result<(), LoadError> {
        let mut entries: HashMap<Corner, u32> = HashMap::with_capacity(self.positions.len());
        let mut triangulator = Triangulator::new();
        let mut outline = Vec::new();
        let mut any = (false, false);
        for face in &self.faces {
            let corners = &mut self.corners[face.first..face.first + face.corners];
            outline.clear();
            for corner in corners.iter_mut() {
                let Some(position) = self.positions.get(corner.position as usize) else {
                    let found = format!("vertex {}", u64::from(corner.position) + 1);
                    let expected =
                        format!("at most {}, the number of vertices in the file", self.positions.len());
                    return Err(LoadError::unexpected(file, found, expected).at(face.line).field("face"));
                };
                outline.push(*position);
                if corner.texcoord != NONE && corner.texcoord as usize >= self.texcoords.len() {
                    tally.add(NO_TEXCOORD, face.line);
                    corner.texcoord = NONE;
                }
                if corner.normal != NONE && corner.normal as usize >= self.normals.len() {
                    tally.add(NO_NORMAL, face.line);
                    corner.normal = NONE;
                }
                any.0 |= corner.texcoord != NONE;
                any.1 |= corner.normal != NONE;
            }
            let corners = &*corners;
            let has_area = triangulator.cut(&outline, |t| {
                let triangle = t.map(|i| {
                    *entries.entry(corners[i]).or_insert_with(|| {
                        let c = corners[i];
                        obj.positions.push(self.positions[c.position as usize]);
                        obj.texcoords
                            .push(self.texcoords.get(c.texcoord as usize).copied().unwrap_or_default());
                        obj.normals.push(self.normals.get(c.normal as usize).copied().unwrap_or_default());
                        (obj.positions.len() - 1) as u32
                    })
                });
                obj.triangles.push(triangle);
                obj.face_materials.push(face.material);
            });
            let has_area = has_area.map_err(|p| LoadError::new(file, p).at(face.line).field("face"))?;
            if triangulator.crossing {
                tally.add(CROSSING, face.line);
            }
            if !has_area {
                tally.add(DEGENERATE, face.line);
            }
        }
        if !any.0 {
            obj.texcoords.clear();
        }
        if !any.1 {
            obj.normals.clear();
        }
        Ok(())
    }
}

fn drop_unused_materials(obj: &mut Obj) {
    let mut new_index = vec![NONE; obj.materials.len()];
    let mut kept = Vec::new();
    for m in &mut obj.face_materials {
        let slot = &mut new_index[*m as usize];
        if *slot == NONE {
            *slot = kept.len() as u32;
            kept.push(std::mem::take(&mut obj.materials[*m as usize]));
        }
        *m = *slot;
    }
    obj.materials = kept;
}

/// Text of an OBJ or MTL file: what is not UTF-8 (old comments, mostly) becomes replacement characters,
/// a byte order mark goes, and lines that end with CR alone get LF.
pub(super) fn decode(bytes: &[u8]) -> std::borrow::Cow<'_, str> {
    use std::borrow::Cow;
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = String::from_utf8_lossy(bytes);
    if text.contains('\r') && !text.contains('\n') { Cow::Owned(text.replace('\r', "\n")) } else { text }
}

/// Lines with their number, where a backslash at the end joins the next line.
pub(super) struct LogicalLines<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
}

impl<'a> LogicalLines<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { lines: text.lines().enumerate() }
    }
}

impl<'a> Iterator for LogicalLines<'a> {
    type Item = (usize, std::borrow::Cow<'a, str>);

    fn next(&mut self) -> Option<Self::Item> {
        use std::borrow::Cow;
        let (number, line) = self.lines.next()?;
        let Some(mut part) = line.strip_suffix('\\') else { return Some((number + 1, Cow::Borrowed(line))) };
        let mut joined = String::new();
        loop {
            joined.push_str(part);
            joined.push(' ');
            match self.lines.next() {
                Some((_, next)) => match next.strip_suffix('\\') {
                    Some(more) => part = more,
                    None => {
                        joined.push_str(next);
                        break;
                    }
                },
                None => break,
            }
        }
        Some((number + 1, Cow::Owned(joined)))
    }
}

/// The first word, and the rest without the blanks between. A comment has the keyword `#`.
pub(super) fn split_keyword(line: &str) -> (&str, &str) {
    let line = line.trim();
    if line.starts_with('#') {
        return ("#", "");
    }
    line.split_once(char::is_whitespace).map_or((line, ""), |(k, rest)| (k, rest.trim_start()))
}

/// The words of a line up to a comment.
pub(super) fn tokens(rest: &str) -> impl Iterator<Item = &str> {
    rest.split_whitespace().take_while(|t| !t.starts_with('#'))
}

/// Up to `N` numbers and how many there were (more than `N` are counted but not kept), or the first word
/// that is not a number.
pub(super) fn parse_numbers<const N: usize>(rest: &str) -> Result<([f32; N], usize), &str> {
    let mut values = [0.0; N];
    let mut count = 0;
    for token in tokens(rest) {
        let value = token.parse().map_err(|_| token)?;
        if let Some(slot) = values.get_mut(count) {
            *slot = value;
        }
        count += 1;
    }
    Ok((values, count))
}
