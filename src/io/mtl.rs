//! Wavefront MTL: the colours that a scene can use (Wavefront, MTL file format, 1995).
//!
//! `map_Kd` multiplies `Kd`, as the format says. Options of `map_Kd` (offset, scale, clamp, colour space) are
//! parsed to find the file name, and not applied. Other maps and extensions are left out.

use std::path::Path;

use super::error::{LoadError, Note, quoted};
use super::obj::{LogicalLines, decode, parse_numbers, split_keyword, tokens};

/// A bitmap that a material names.
#[derive(Clone, Debug, PartialEq)]
pub struct MtlMap {
    /// File names to try in order: the rest of the line, then the same without options that follow.
    pub files: Vec<String>,
    /// The line.
    pub line: usize,
    /// Options before or after the name, which are not applied.
    pub options: bool,
}

/// A material of an MTL file, as written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MtlMaterial {
    /// Its name.
    pub name: String,
    /// The line of its `newmtl`.
    pub line: usize,
    /// Diffuse colour, linear.
    pub kd: Option<[f32; 3]>,
    /// Specular colour.
    pub ks: Option<[f32; 3]>,
    /// Emitted radiance.
    pub ke: Option<[f32; 3]>,
    /// Phong exponent.
    pub ns: Option<f32>,
    /// Index of refraction.
    pub ni: Option<f32>,
    /// Illumination model.
    pub illum: Option<u32>,
    /// Bitmap of the diffuse colour.
    pub map_kd: Option<MtlMap>,
}

/// An MTL file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mtl {
    /// The materials in the order of the file; names are unique.
    pub materials: Vec<MtlMaterial>,
    /// The file has maps that are not read (bump, specular, opacity, ...).
    pub other_maps: bool,
    /// What was mended or left out.
    pub notes: Vec<Note>,
}

/// Parses an MTL file. `file` appears in messages only.
pub fn parse_mtl(bytes: &[u8], file: &Path) -> Result<Mtl, LoadError> {
    let text = decode(bytes);
    let mut mtl = Mtl::default();
    let mut names = std::collections::HashSet::new();
    let mut current: Option<MtlMaterial> = None;
    let mut close = |m: Option<MtlMaterial>, mtl: &mut Mtl| {
        let Some(m) = m else { return };
        if names.insert(m.name.clone()) {
            mtl.materials.push(m);
        } else {
            let message = format!("a second material named {} is left out", quoted(&m.name));
            mtl.notes.push(Note::new(file, Some(m.line), message));
        }
    };
    for (line, text) in LogicalLines::new(&text) {
        let (keyword, rest) = split_keyword(&text);
        let keyword = keyword.to_ascii_lowercase();
        if keyword == "newmtl" {
            close(current.take(), &mut mtl);
            current = Some(MtlMaterial { name: rest.trim().to_owned(), line, ..Default::default() });
            continue;
        }
        // Settings before the first `newmtl` belong to nothing.
        let Some(m) = current.as_mut() else { continue };
        match keyword.as_str() {
            "kd" | "ks" | "ke" => {
                let value = match color(rest) {
                    Ok(value) => Some(value),
                    Err(Color::Curve) => {
                        let message = format!("{keyword} as a spectral curve or in CIE XYZ is left out");
                        mtl.notes.push(Note::new(file, Some(line), message));
                        None
                    }
                    Err(Color::Bad(found)) => {
                        let expected = "1 or 3 finite numbers";
                        return Err(LoadError::unexpected(file, found, expected).at(line).field(keyword));
                    }
                };
                let slot = match keyword.as_str() {
                    "kd" => &mut m.kd,
                    "ks" => &mut m.ks,
                    _ => &mut m.ke,
                };
                *slot = value.or(*slot);
            }
            "ns" | "ni" => {
                let value = match parse_numbers::<1>(rest) {
                    Ok((v, n)) if n >= 1 && v[0].is_finite() => v[0],
                    _ => {
                        let err = LoadError::unexpected(file, quoted(rest), "a finite number");
                        return Err(err.at(line).field(keyword));
                    }
                };
                *(if keyword == "ns" { &mut m.ns } else { &mut m.ni }) = Some(value);
            }
            "illum" => match tokens(rest).next().and_then(|t| t.parse().ok()) {
                Some(model) => m.illum = Some(model),
                None => {
                    let err = LoadError::unexpected(file, quoted(rest), "a whole number");
                    return Err(err.at(line).field("illum"));
                }
            },
            "map_kd" => {
                if let Some(map) = parse_map(rest, line) {
                    m.map_kd = Some(map);
                }
            }
            other => {
                mtl.other_maps |= other.starts_with("map_") && other != "map_ka"
                    || matches!(other, "bump" | "norm" | "disp" | "decal" | "refl");
            }
        }
    }
    close(current, &mut mtl);
    Ok(mtl)
}

enum Color {
    Curve,
    Bad(String),
}

fn color(rest: &str) -> Result<[f32; 3], Color> {
    if matches!(tokens(rest).next(), Some("spectral" | "xyz")) {
        return Err(Color::Curve);
    }
    match parse_numbers::<3>(rest) {
        Ok((v, _)) if v.iter().any(|x| !x.is_finite()) => Err(Color::Bad(quoted(rest))),
        Ok((v, 3..)) => Ok(v),
        // One number stands for all three.
        Ok((v, 1)) => Ok([v[0]; 3]),
        Ok((_, n)) => Err(Color::Bad(format!("{n} numbers"))),
        Err(token) => Err(Color::Bad(quoted(token))),
    }
}

/// How many words follow an option: at least, and at most where further ones are numbers.
fn option_words(option: &str) -> Option<(usize, usize)> {
    Some(match option {
        "-o" | "-s" | "-t" => (1, 3),
        "-mm" => (2, 2),
        "-blendu" | "-blendv" | "-cc" | "-clamp" | "-texres" | "-boost" | "-bm" | "-imfchan" | "-type"
        | "-colorspace" => (1, 1),
        _ => return None,
    })
}

fn parse_map(rest: &str, line: usize) -> Option<MtlMap> {
    let mut name = rest.trim();
    let mut options = false;
    while let Some((option, mut tail)) = name.split_once(char::is_whitespace) {
        let Some((least, most)) = option_words(option) else { break };
        options = true;
        for taken in 0..most {
            let t = tail.trim_start();
            let Some((word, next)) = t.split_once(char::is_whitespace) else { break };
            if taken >= least && word.parse::<f32>().is_err() {
                break;
            }
            tail = next;
        }
        name = tail.trim_start();
    }
    if name.is_empty() {
        return None;
    }
    let mut files = vec![name.to_owned()];
    // `texture.png -bm 2` and `texture.png # wood`: names may hold blanks, so these are second guesses.
    let cut = name
        .match_indices(" -")
        .find(|(i, _)| option_words(name[i + 1..].split_whitespace().next().unwrap_or_default()).is_some())
        .or_else(|| name.match_indices(" #").next());
    if let Some((i, _)) = cut {
        options |= name[i..].starts_with(" -");
        files.push(name[..i].trim_end().to_owned());
    }
    Some(MtlMap { files, line, options })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_a_map_do_not_hide_its_name() {
        let name = |rest| parse_map(rest, 1).map(|m| (m.files, m.options)).unwrap();
        let one = |s: &str| vec![s.to_owned()];
        assert_eq!(name("wood.png"), (one("wood.png"), false));
        assert_eq!(name("oak floor 01.png"), (one("oak floor 01.png"), false));
        assert_eq!(name("-o 0.1 wood.png"), (one("wood.png"), true));
        assert_eq!(name("-s 1 2 3 -clamp on -mm 0 1 my wood.png"), (one("my wood.png"), true));
        assert_eq!(name("-colorspace sRGB -o 0.1 d.jpg"), (one("d.jpg"), true));
        assert_eq!(name("d.jpg -bm 1.5"), (vec!["d.jpg -bm 1.5".into(), "d.jpg".into()], true));
        assert_eq!(name("a -b.png"), (one("a -b.png"), false));
        assert!(parse_map("-bm", 1).is_some_and(|m| m.files == ["-bm"]));
        assert!(parse_map("", 1).is_none());
    }
}
