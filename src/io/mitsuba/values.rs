//! Objects of a scene and their values: each is asked for by name, and what nobody asked for is named.

use std::cell::RefCell;
use std::fmt::Write as _;
use std::path::Path;

use super::transform::Transform;
use super::tree::{Element, Tree};
use crate::io::error::{LoadError, Problem, quoted};

/// References may follow references so far.
const MAX_DEPTH: usize = 16;

/// An object, and which of its children were asked for.
pub(super) struct Object<'t> {
    pub(super) tree: &'t Tree,
    pub(super) index: usize,
    /// The name that the object around it calls it by; empty for none.
    pub(super) role: &'t str,
    depth: usize,
    used: RefCell<Vec<bool>>,
    asked: RefCell<Vec<&'static str>>,
}

impl<'t> Object<'t> {
    pub(super) fn root(tree: &'t Tree) -> Self {
        Self::new(tree, 0, "", 0)
    }

    fn new(tree: &'t Tree, index: usize, role: &'t str, depth: usize) -> Self {
        let used = RefCell::new(vec![false; tree.elements[index].children.len()]);
        Self { tree, index, role, depth, used, asked: RefCell::default() }
    }

    pub(super) fn element(&self) -> &'t Element {
        &self.tree.elements[self.index]
    }

    /// The `type` of the object; empty where there is none.
    pub(super) fn kind(&self) -> &'t str {
        self.element().attribute("type").unwrap_or_default()
    }

    pub(super) fn id(&self) -> Option<&'t str> {
        self.element().attribute("id").filter(|id| !id.is_empty())
    }

    pub(super) fn file(&self) -> &'t Path {
        self.tree.file(self.element())
    }

    pub(super) fn line(&self) -> usize {
        self.element().line
    }

    /// From a file of a version before 2.
    pub(super) fn old(&self) -> bool {
        self.element().old
    }

    fn words(&self) -> String {
        let element = self.element();
        match element.attribute("type") {
            Some(kind) => format!("<{} type={}>", element.tag, quoted(kind)),
            None => format!("<{}>", element.tag),
        }
    }

    /// An error about the object as a whole.
    pub(super) fn error(&self, found: impl Into<String>, expected: impl Into<String>) -> LoadError {
        LoadError::unexpected(self.file(), found, expected).at(self.line()).field(self.words())
    }

    /// An error about a value of the object.
    pub(super) fn error_at(
        &self,
        at: &Element,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> LoadError {
        let name = at.attribute("name").unwrap_or(&at.tag);
        LoadError::unexpected(self.tree.file(at), found, expected)
            .at(at.line)
            .field(format!("{} {name}", self.words()))
    }

    /// An error about the object as a whole: well-formed, and not read by this version.
    pub(super) fn unsupported(&self, what: impl Into<String>) -> LoadError {
        LoadError::new(self.file(), Problem::Unsupported(what.into())).at(self.line()).field(self.words())
    }

    /// The `type` is none that is read.
    pub(super) fn unknown_kind(&self, known: &str) -> LoadError {
        if self.kind().is_empty() {
            return self.error("no type", format!("one of {known}"));
        }
        self.unsupported(format!("this type (expected one of {known})"))
    }

    /// The value of a name. Its element must have one of the tags.
    pub(super) fn value(&self, name: &'static str, tags: &[&str]) -> Result<Option<&'t Element>, LoadError> {
        self.asked.borrow_mut().push(name);
        let mut found: Option<&'t Element> = None;
        for (i, &child) in self.element().children.iter().enumerate() {
            let element = &self.tree.elements[child];
            if element.attribute("name") != Some(name) || element.is_object() || element.tag == "ref" {
                continue;
            }
            if !tags.contains(&element.tag.as_str()) {
                let found = format!("<{}>", element.tag);
                return Err(self.error_at(element, found, format!("<{}>", tags.join("> or <"))));
            }
            if let Some(first) = found {
                let found = format!("a second value (the first is in line {})", first.line);
                return Err(self.error_at(element, found, "one"));
            }
            self.used.borrow_mut()[i] = true;
            found = Some(element);
        }
        Ok(found)
    }

    fn text_of(&self, element: &'t Element) -> Result<&'t str, LoadError> {
        element.attribute("value").ok_or_else(|| self.error_at(element, "no value", "value=\"...\""))
    }

    /// The numbers of a text, separated by blanks or commas.
    pub(super) fn numbers(&self, element: &'t Element, text: &str) -> Result<Vec<f64>, LoadError> {
        text.split([' ', '\t', '\n', '\r', ','])
            .filter(|t| !t.is_empty())
            .map(|t| self.number(element, t))
            .collect()
    }

    fn number(&self, element: &'t Element, text: &str) -> Result<f64, LoadError> {
        match text.trim().parse::<f64>() {
            Ok(x) if (x as f32).is_finite() => Ok(x),
            _ => Err(self.error_at(element, quoted(text), "a finite number")),
        }
    }

    /// A number, and where it stands.
    pub(super) fn float_at(&self, name: &'static str) -> Result<Option<(f64, &'t Element)>, LoadError> {
        let Some(element) = self.value(name, &["float", "integer"])? else { return Ok(None) };
        Ok(Some((self.number(element, self.text_of(element)?)?, element)))
    }

    pub(super) fn float(&self, name: &'static str) -> Result<Option<f64>, LoadError> {
        Ok(self.float_at(name)?.map(|v| v.0))
    }

    pub(super) fn integer(&self, name: &'static str) -> Result<Option<i64>, LoadError> {
        let Some(element) = self.value(name, &["integer"])? else { return Ok(None) };
        let text = self.text_of(element)?;
        match text.trim().parse() {
            Ok(value) => Ok(Some(value)),
            Err(_) => Err(self.error_at(element, quoted(text), "a whole number")),
        }
    }

    pub(super) fn flag(&self, name: &'static str) -> Result<Option<bool>, LoadError> {
        let Some(element) = self.value(name, &["boolean"])? else { return Ok(None) };
        let text = self.text_of(element)?;
        match text.trim().to_ascii_lowercase().as_str() {
            "true" => Ok(Some(true)),
            "false" => Ok(Some(false)),
            _ => Err(self.error_at(element, quoted(text), "true or false")),
        }
    }

    pub(super) fn string(&self, name: &'static str) -> Result<Option<(&'t str, &'t Element)>, LoadError> {
        let Some(element) = self.value(name, &["string"])? else { return Ok(None) };
        Ok(Some((self.text_of(element)?, element)))
    }

    /// One of a few words; the first where none is said.
    pub(super) fn word(&self, name: &'static str, words: &[&'static str]) -> Result<&'static str, LoadError> {
        let Some((text, element)) = self.string(name)? else { return Ok(words[0]) };
        let text = text.trim().to_ascii_lowercase();
        words
            .iter()
            .copied()
            .find(|w| *w == text)
            .ok_or_else(|| self.error_at(element, quoted(&text), format!("one of {}", words.join(", "))))
    }

    /// A name of a file.
    pub(super) fn filename(&self) -> Result<(&'t str, &'t Element), LoadError> {
        self.string("filename")?.ok_or_else(|| self.error("no filename", "<string name=\"filename\" ...>"))
    }

    pub(super) fn vector(&self, name: &'static str) -> Result<Option<[f64; 3]>, LoadError> {
        let Some(element) = self.value(name, &["point", "vector"])? else { return Ok(None) };
        self.xyz(element, None).map(Some)
    }

    /// The three numbers of `x`, `y`, `z` or of `value`; missing ones take the default, if there is any.
    pub(super) fn xyz(&self, element: &'t Element, default: Option<f64>) -> Result<[f64; 3], LoadError> {
        if let Some(text) = element.attribute("value") {
            return match self.numbers(element, text)?[..] {
                [v] => Ok([v; 3]),
                [x, y, z] => Ok([x, y, z]),
                _ => Err(self.error_at(element, quoted(text), "one number or three")),
            };
        }
        let mut out = [0.0; 3];
        for (name, value) in ["x", "y", "z"].into_iter().zip(&mut out) {
            *value = match (element.attribute(name), default) {
                (Some(text), _) => self.number(element, text)?,
                (None, Some(default)) => default,
                (None, None) => return Err(self.error_at(element, format!("no {name}"), "x, y and z")),
            };
        }
        Ok(out)
    }

    /// A colour, or a number for a grey, and where it stands. Textures are not colours.
    pub(super) fn color_at(&self, name: &'static str) -> Result<Option<([f32; 3], &'t Element)>, LoadError> {
        let Some(element) = self.value(name, &["rgb", "spectrum", "float", "integer"])? else {
            return Ok(None);
        };
        let Some(text) = element.attribute("value") else {
            let expected = "value=\"...\" (spectra from files are not read)";
            return Err(self.error_at(element, "no value", expected));
        };
        if element.tag == "spectrum" && text.contains(':') {
            let expected = "three numbers for red, green and blue, or one for a grey: this program renders \
                            in three colours, and what a spectrum becomes in them depends on the illuminant";
            return Err(self.error_at(element, "a spectrum by wavelength", expected));
        }
        match self.numbers(element, text)?[..] {
            [v] => Ok(Some(([v as f32; 3], element))),
            [r, g, b] if element.tag == "rgb" => Ok(Some(([r as f32, g as f32, b as f32], element))),
            _ => Err(self.error_at(element, quoted(text), "one number or three")),
        }
    }

    pub(super) fn color(&self, name: &'static str) -> Result<Option<[f32; 3]>, LoadError> {
        Ok(self.color_at(name)?.map(|v| v.0))
    }

    /// A colour that this program can't render unless it is 1.
    pub(super) fn only_one(&self, name: &'static str) -> Result<(), LoadError> {
        match self.color_at(name)? {
            Some((color, element)) if color != [1.0; 3] => {
                let found = format!("{color:?}");
                Err(self.error_at(element, found, "1, as nothing else is supported by this version"))
            }
            _ => Ok(()),
        }
    }

    /// A transform, identity where there is none.
    pub(super) fn transform(&self, name: &'static str) -> Result<Transform, LoadError> {
        match self.value(name, &["transform"])? {
            Some(element) => Transform::read(self, element),
            None => Ok(Transform::IDENTITY),
        }
    }

    /// The objects within it of one tag, references followed, whose name will do.
    fn select(&self, tag: &str, wanted: impl Fn(&str) -> bool) -> Result<Vec<Object<'t>>, LoadError> {
        let mut out = Vec::new();
        for (i, &child) in self.element().children.iter().enumerate() {
            let element = &self.tree.elements[child];
            let target = if element.tag == "ref" {
                let Some(id) = element.attribute("id") else {
                    return Err(self.error_at(element, "no id", "id=\"...\""));
                };
                *self.tree.ids.get(id).ok_or_else(|| {
                    let known: Vec<&str> = self.tree.ids.keys().take(20).map(String::as_str).collect();
                    self.error_at(element, quoted(id), format!("an id; there are: {}", known.join(", ")))
                })?
            } else {
                child
            };
            let role = element.attribute("name").unwrap_or_default();
            if self.tree.elements[target].tag != tag || !wanted(role) {
                continue;
            }
            if self.depth >= MAX_DEPTH {
                let expected = "objects that do not refer to themselves";
                return Err(self.error_at(element, "references that go round", expected));
            }
            self.used.borrow_mut()[i] = true;
            out.push(Object::new(self.tree, target, role, self.depth + 1));
        }
        Ok(out)
    }

    /// The objects within it of one tag, references followed.
    pub(super) fn objects(&self, tag: &str) -> Result<Vec<Object<'t>>, LoadError> {
        self.select(tag, |_| true)
    }

    /// The object of one tag and name, if there is one.
    pub(super) fn object(&self, tag: &str, role: &'static str) -> Result<Option<Object<'t>>, LoadError> {
        self.asked.borrow_mut().push(role);
        let mut all = self.select(tag, |r| r == role)?;
        match all.len() {
            0 | 1 => Ok(all.pop()),
            n => Err(self.error(format!("{n} of the name {role}"), "at most one")),
        }
    }

    /// At most one object of a tag.
    pub(super) fn at_most_one(&self, tag: &'static str) -> Result<Option<Object<'t>>, LoadError> {
        let mut all = self.objects(tag)?;
        match all.len() {
            0 | 1 => Ok(all.pop()),
            n => Err(self.error(format!("{n} <{tag}>"), "at most one")),
        }
    }

    /// Values that change no light: they are not asked for, and they may be there.
    pub(super) fn ignore(&self, names: &[&str]) {
        for (i, &child) in self.element().children.iter().enumerate() {
            let name = self.tree.elements[child].attribute("name");
            if name.is_some_and(|n| names.contains(&n)) {
                self.used.borrow_mut()[i] = true;
            }
        }
    }

    /// The first child that nobody asked for.
    pub(super) fn rest(&self) -> Option<&'t Element> {
        let used = self.used.borrow();
        let (_, &child) = self.element().children.iter().enumerate().find(|(i, _)| !used[*i])?;
        Some(&self.tree.elements[child])
    }

    /// Passes over one child.
    pub(super) fn pass(&self, element: &Element) {
        let children = &self.element().children;
        if let Some(i) = children.iter().position(|&c| std::ptr::eq(&self.tree.elements[c], element)) {
            self.used.borrow_mut()[i] = true;
        }
    }

    /// Refuses what nobody asked for: it might change the light.
    pub(super) fn finish(&self) -> Result<(), LoadError> {
        let Some(element) = self.rest() else { return Ok(()) };
        let mut asked = self.asked.borrow().clone();
        asked.sort_unstable();
        asked.dedup();
        let mut found = format!("<{}>", element.tag);
        if let Some(kind) = element.attribute("type").or(element.attribute("id")) {
            let _ = write!(found, " {}", quoted(kind));
        }
        let expected = if asked.is_empty() {
            "nothing".to_owned()
        } else {
            format!("what this version reads of it: {}", asked.join(", "))
        };
        Err(self.error_at(element, found, expected))
    }
}
