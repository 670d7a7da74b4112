//! The elements of a scene, its includes merged in, `$names` replaced and identifiers known.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use roxmltree::{Document, Node, ParsingOptions};

use super::MitsubaOptions;
use crate::io::error::{LoadError, Note, Problem, quoted};
use crate::io::source::{FileSource, Found, find, read_file};

/// More bytes of XML, all includes together, are refused.
const MAX_BYTES: u64 = 1 << 26;
/// More elements, all includes together, are refused.
const MAX_ELEMENTS: usize = 1 << 20;
/// Longer values are refused where a `$name` was replaced: replacements could multiply.
const MAX_REPLACED: usize = 1 << 16;
/// Deeper includes are refused.
const MAX_INCLUDES: usize = 15;
/// Deeper elements are refused.
const MAX_DEPTH: usize = 64;

/// The elements that are objects; everything else is a value of one.
const OBJECTS: &[&str] = &[
    "scene",
    "sensor",
    "integrator",
    "bsdf",
    "shape",
    "emitter",
    "medium",
    "phase",
    "volume",
    "texture",
    "film",
    "rfilter",
    "sampler",
    "subsurface",
];

/// One element, its values as they stand after replacement.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) tag: String,
    pub(super) attributes: Vec<(String, String)>,
    pub(super) children: Vec<usize>,
    /// Index into [`Tree::files`].
    pub(super) file: usize,
    pub(super) line: usize,
    /// From a file of a version before 2.
    pub(super) old: bool,
}

impl Element {
    pub(super) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(n, _)| n == name).map(|(_, v)| v.as_str())
    }

    pub(super) fn is_object(&self) -> bool {
        OBJECTS.contains(&self.tag.as_str()) || (self.tag == "spectrum" && self.attribute("type").is_some())
    }
}

/// All elements of a scene. The first is the root.
#[derive(Debug, Default)]
pub(super) struct Tree {
    pub(super) elements: Vec<Element>,
    pub(super) files: Vec<PathBuf>,
    pub(super) ids: BTreeMap<String, usize>,
    pub(super) notes: Vec<Note>,
}

impl Tree {
    pub(super) fn file(&self, element: &Element) -> &Path {
        &self.files[element.file]
    }
}

/// Reads the scene and what it includes.
pub(super) fn read_tree(
    bytes: Vec<u8>,
    file: &Path,
    source: &dyn FileSource,
    options: &MitsubaOptions,
) -> Result<Tree, LoadError> {
    let folder = file.parent().unwrap_or(Path::new("")).to_path_buf();
    let mut reader = Reader {
        source,
        options,
        root: source.canonical(&folder).unwrap_or_else(|_| folder.clone()),
        folder,
        tree: Tree::default(),
        parameters: options.parameters.clone(),
        bytes_left: MAX_BYTES,
        replaced_left: MAX_BYTES,
        open: Vec::new(),
    };
    reader.file(bytes, file, None)?;
    Ok(reader.tree)
}

struct Reader<'a> {
    source: &'a dyn FileSource,
    options: &'a MitsubaOptions,
    /// The folder of the scene, as named and without links.
    folder: PathBuf,
    root: PathBuf,
    tree: Tree,
    /// Names and values; the first of a name counts.
    parameters: Vec<(String, String)>,
    bytes_left: u64,
    replaced_left: u64,
    /// The files that are being read, without links.
    open: Vec<PathBuf>,
}

/// What all elements of one file share.
struct Context<'a> {
    path: &'a Path,
    index: usize,
    lines: Vec<usize>,
    old: bool,
}

impl Context<'_> {
    fn line(&self, node: Node<'_, '_>) -> usize {
        self.lines.partition_point(|start| *start <= node.range().start)
    }

    fn error(&self, node: Node<'_, '_>, found: impl Into<String>, expected: impl Into<String>) -> LoadError {
        LoadError::unexpected(self.path, found, expected)
            .at(self.line(node))
            .field(format!("<{}>", node.tag_name().name()))
    }
}

impl Reader<'_> {
    /// Reads a file whose elements become children of `parent`, or the root.
    fn file(&mut self, bytes: Vec<u8>, path: &Path, parent: Option<usize>) -> Result<(), LoadError> {
        let size = bytes.len() as u64;
        let Some(left) = self.bytes_left.checked_sub(size) else {
            return Err(too_large(path, "bytes of XML", MAX_BYTES - self.bytes_left + size, MAX_BYTES));
        };
        self.bytes_left = left;
        let text = match std::str::from_utf8(&bytes) {
            Ok(text) => text,
            Err(e) => {
                let line = 1 + bytes[..e.valid_up_to()].iter().filter(|b| **b == b'\n').count();
                return Err(LoadError::unexpected(path, "bytes that are not UTF-8", "text in UTF-8").at(line));
            }
        };
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let limit = (2 * MAX_ELEMENTS) as u32;
        let options = ParsingOptions { nodes_limit: limit, ..ParsingOptions::default() };
        let document = Document::parse_with_options(text, options)
            .map_err(|e| LoadError::decode(path, "XML", &e).at((e.pos().row as usize).max(1)))?;
        let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect();
        let mut context = Context { path, index: self.tree.files.len(), lines, old: false };
        let root = document.root_element();
        let Some(version) = root.attribute("version") else {
            return Err(context.error(root, "no version", "version=\"3.0.0\" or another"));
        };
        let Some(major) = version.split('.').next().and_then(|m| m.trim().parse::<u32>().ok()) else {
            return Err(context.error(root, quoted(version), "a version such as 3.0.0"));
        };
        context.old = major < 2;
        self.tree.files.push(path.to_path_buf());
        self.open.push(self.canonical(path));
        match parent {
            Some(parent) if root.tag_name().name() == "scene" => {
                for child in root.children().filter(Node::is_element) {
                    self.element(&context, child, Some(parent), 1)?;
                }
            }
            _ => {
                self.element(&context, root, parent, 0)?;
            }
        }
        self.open.pop();
        Ok(())
    }

    fn canonical(&self, path: &Path) -> PathBuf {
        self.source.canonical(path).unwrap_or_else(|_| path.to_path_buf())
    }

    fn element(
        &mut self,
        context: &Context<'_>,
        node: Node<'_, '_>,
        parent: Option<usize>,
        depth: usize,
    ) -> Result<(), LoadError> {
        if depth > MAX_DEPTH {
            return Err(too_large(
                context.path,
                "elements within each other",
                depth as u64,
                MAX_DEPTH as u64,
            )
            .at(context.line(node)));
        }
        if self.tree.elements.len() >= MAX_ELEMENTS {
            let found = self.tree.elements.len() as u64 + 1;
            return Err(too_large(context.path, "elements", found, MAX_ELEMENTS as u64));
        }
        let mut attributes = Vec::new();
        for attribute in node.attributes() {
            let mut value = self.replace(context, node, attribute.value())?;
            if context.old && attribute.name() == "name" {
                value = words_of(&value);
            }
            attributes.push((attribute.name().to_owned(), value));
        }
        let mut element = Element {
            tag: node.tag_name().name().to_owned(),
            attributes,
            children: Vec::new(),
            file: context.index,
            line: context.line(node),
            old: context.old,
        };
        match element.tag.as_str() {
            "lookAt" => element.tag = "lookat".into(),
            "default" => return self.default(context, node, &element),
            "include" => return self.include(context, node, &element, parent),
            "alias" => return self.alias(context, node, &element),
            "path" => {
                let message = "<path> is ignored: files are looked for beside the scene";
                self.tree.notes.push(Note::new(context.path, Some(element.line), message));
                return Ok(());
            }
            _ => {}
        }
        let index = self.tree.elements.len();
        if element.is_object()
            && let Some(id) = element.attribute("id")
            && let Some(before) = self.tree.ids.insert(id.to_owned(), index)
        {
            let first = &self.tree.elements[before];
            let found = format!("a second id {}", quoted(id));
            let expected = format!(
                "an id of its own (the first is in {}:{})",
                self.tree.file(first).display(),
                first.line
            );
            return Err(context.error(node, found, expected));
        }
        self.tree.elements.push(element);
        if let Some(parent) = parent {
            self.tree.elements[parent].children.push(index);
        }
        for child in node.children().filter(Node::is_element) {
            self.element(context, child, Some(index), depth + 1)?;
        }
        Ok(())
    }

    fn default(
        &mut self,
        context: &Context<'_>,
        node: Node<'_, '_>,
        element: &Element,
    ) -> Result<(), LoadError> {
        let (Some(name), Some(value)) = (element.attribute("name"), element.attribute("value")) else {
            return Err(context.error(node, "something missing", "a name and a value"));
        };
        // Names of parameters stay as they are written, whatever the version.
        let name = node.attribute("name").unwrap_or(name);
        if name.is_empty() {
            return Err(context.error(node, "an empty name", "at least one letter"));
        }
        if !self.parameters.iter().any(|(n, _)| n == name) {
            self.parameters.push((name.to_owned(), value.to_owned()));
        }
        Ok(())
    }

    fn alias(
        &mut self,
        context: &Context<'_>,
        node: Node<'_, '_>,
        element: &Element,
    ) -> Result<(), LoadError> {
        let (Some(id), Some(other)) = (element.attribute("id"), element.attribute("as")) else {
            return Err(context.error(node, "something missing", "an id and as=\"another name\""));
        };
        let Some(&target) = self.tree.ids.get(id) else {
            return Err(context.error(node, quoted(id), "an id that stands further up"));
        };
        if self.tree.ids.contains_key(other) {
            let found = format!("a second id {}", quoted(other));
            return Err(context.error(node, found, "an id of its own"));
        }
        self.tree.ids.insert(other.to_owned(), target);
        Ok(())
    }

    fn include(
        &mut self,
        context: &Context<'_>,
        node: Node<'_, '_>,
        element: &Element,
        parent: Option<usize>,
    ) -> Result<(), LoadError> {
        let Some(name) = element.attribute("filename") else {
            return Err(context.error(node, "no filename", "filename=\"a scene file\""));
        };
        if self.open.len() > MAX_INCLUDES {
            let (found, limit) = (self.open.len() as u64, MAX_INCLUDES as u64);
            return Err(too_large(context.path, "includes within each other", found, limit).at(element.line));
        }
        // Backslashes separate folders too, where names are looked for.
        let slashes = name.replace('\\', "/");
        let written = Path::new(&slashes);
        let leaves = written.is_absolute()
            || written.components().any(|c| !matches!(c, Component::Normal(_) | Component::CurDir));
        let outside = || {
            let expected = format!("a file in {} or in a folder of it", self.folder.display());
            context.error(node, quoted(name), expected)
        };
        if leaves && !self.options.outside_includes {
            return Err(outside());
        }
        let own = context.path.parent().unwrap_or(Path::new(""));
        let found =
            [own, &self.folder].into_iter().find_map(|folder| match find(self.source, folder, name) {
                Found::Exact(path) | Found::OtherCase(path) => Some(path),
                Found::Missing => None,
            });
        let Some(path) = found else {
            let expected = format!("a file beside {}", context.path.display());
            return Err(context.error(node, quoted(name), expected));
        };
        let real = self.canonical(&path);
        // A link could lead out of the folder where no name does.
        if !self.options.outside_includes && !real.starts_with(&self.root) {
            return Err(outside());
        }
        if self.open.contains(&real) {
            return Err(context.error(node, quoted(name), "a file that does not include itself"));
        }
        let bytes = read_file(self.source, &path, self.bytes_left)?;
        self.file(bytes, &path, parent)
    }

    /// Replaces each `$name` by its value; `\$` is a dollar sign.
    fn replace(
        &mut self,
        context: &Context<'_>,
        node: Node<'_, '_>,
        value: &str,
    ) -> Result<String, LoadError> {
        if !value.contains('$') {
            return Ok(value.to_owned());
        }
        let mut out = String::new();
        let mut rest = value;
        while let Some(at) = rest.find('$') {
            let (before, after) = (&rest[..at], &rest[at + 1..]);
            if let Some(before) = before.strip_suffix('\\') {
                out += before;
                out.push('$');
                rest = after;
                continue;
            }
            out += before;
            let hit = self.parameters.iter().filter(|(n, _)| after.starts_with(n.as_str()));
            let Some((name, text)) = hit.max_by_key(|(n, _)| n.len()) else {
                let end = after.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(after.len());
                let found = quoted(&format!("${}", &after[..end]));
                let all: Vec<&str> = self.parameters.iter().take(20).map(|(n, _)| n.as_str()).collect();
                let expected = format!("a <default> of that name further up; there are: {}", all.join(", "));
                return Err(context.error(node, found, expected));
            };
            out += text;
            if out.len() > MAX_REPLACED || out.len() as u64 > self.replaced_left {
                return Err(too_large(
                    context.path,
                    "bytes in a value",
                    out.len() as u64,
                    MAX_REPLACED as u64,
                )
                .at(context.line(node)));
            }
            rest = &after[name.len()..];
        }
        out += rest;
        self.replaced_left = self.replaced_left.saturating_sub(out.len() as u64);
        Ok(out)
    }
}

fn too_large(file: &Path, what: &'static str, found: u64, limit: u64) -> LoadError {
    LoadError::new(file, Problem::TooLarge { what, found, limit })
}

/// `maxDepth` as `max_depth`, `intIOR` as `int_ior`: how names were written before version 2.
fn words_of(name: &str) -> String {
    let mut out = String::new();
    let mut before = ' ';
    let mut capitals = false;
    for c in name.chars() {
        if c.is_ascii_uppercase() && (before.is_ascii_lowercase() || capitals) {
            if !capitals {
                out.push('_');
            }
            capitals = true;
            out.push(c.to_ascii_lowercase());
        } else {
            capitals = false;
            out.push(c);
        }
        before = c;
    }
    out
}

#[cfg(test)]
mod tests {
    #[test]
    fn old_names_become_words() {
        for (old, new) in [
            ("maxDepth", "max_depth"),
            ("intIOR", "int_ior"),
            ("toWorld", "to_world"),
            ("sigmaS", "sigma_s"),
            ("radius", "radius"),
            ("use_grid_bbox", "use_grid_bbox"),
            ("A", "A"),
            ("", ""),
        ] {
            assert_eq!(super::words_of(old), new);
        }
    }
}
