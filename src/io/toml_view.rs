//! A TOML document as sections that are asked for fields, each with its line.
//!
//! A section remembers what it was asked for, so that [`Section::finish`] can refuse fields that nobody
//! knows and name those that are known.

use std::cell::RefCell;
use std::ops::Range;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{LoadError, quoted};

/// The text of a document and where its lines start.
pub(crate) struct Doc<'a> {
    pub(crate) file: &'a Path,
    line_starts: Vec<usize>,
}

impl<'a> Doc<'a> {
    pub(crate) fn new(file: &'a Path, text: &str) -> Self {
        let line_starts = text.bytes().enumerate().filter(|b| b.1 == b'\n').map(|b| b.0 + 1).collect();
        Self { file, line_starts }
    }

    /// The line of a byte offset, counted from 1.
    pub(crate) fn line(&self, span: &Range<usize>) -> usize {
        1 + self.line_starts.partition_point(|&start| start <= span.start)
    }

    pub(crate) fn parse<'t>(&self, text: &'t str) -> Result<Spanned<DeTable<'t>>, LoadError> {
        DeTable::parse(text).map_err(|e| {
            let err = LoadError::decode(self.file, "TOML", e.message());
            match e.span() {
                Some(span) => err.at(self.line(&span)),
                None => err,
            }
        })
    }
}

/// One table of a document.
pub(crate) struct Section<'a> {
    doc: &'a Doc<'a>,
    /// How messages call it, e.g. `light 2`.
    pub(crate) name: String,
    table: &'a DeTable<'a>,
    /// The line of its header.
    pub(crate) line: usize,
    asked: RefCell<Vec<&'static str>>,
}

/// A field and the line it stands on.
pub(crate) type Lined<T> = (T, usize);

impl<'a> Section<'a> {
    pub(crate) fn new(doc: &'a Doc<'a>, name: String, table: &'a DeTable<'a>, span: Range<usize>) -> Self {
        Self { doc, name, table, line: doc.line(&span), asked: RefCell::default() }
    }

    /// An error at a line of this section.
    pub(crate) fn error(
        &self,
        line: usize,
        key: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> LoadError {
        LoadError::unexpected(self.doc.file, found, expected).at(line).field(self.place(key))
    }

    /// How messages call a field.
    pub(crate) fn place(&self, key: &str) -> String {
        match (self.name.is_empty(), key.is_empty()) {
            (true, _) => key.to_owned(),
            (false, true) => self.name.clone(),
            (false, false) => format!("{}: {key}", self.name),
        }
    }

    fn missing(&self, key: &str, expected: &str) -> LoadError {
        self.error(self.line, key, "no such field", expected)
    }

    fn get(&self, key: &'static str) -> Option<(&'a DeValue<'a>, usize)> {
        self.asked.borrow_mut().push(key);
        let value = self.table.get(key)?;
        Some((value.get_ref(), self.doc.line(&value.span())))
    }

    /// A value that must exist.
    pub(crate) fn required<T>(
        &self,
        value: Option<T>,
        key: &'static str,
        expected: &str,
    ) -> Result<T, LoadError> {
        value.ok_or_else(|| self.missing(key, expected))
    }

    /// Text.
    pub(crate) fn text(&self, key: &'static str) -> Result<Option<Lined<String>>, LoadError> {
        let Some((value, line)) = self.get(key) else { return Ok(None) };
        match value {
            DeValue::String(s) => Ok(Some((s.to_string(), line))),
            other => Err(self.error(line, key, describe(other), "text in quotes")),
        }
    }

    /// One of a few words.
    pub(crate) fn word(
        &self,
        key: &'static str,
        words: &[&'static str],
    ) -> Result<Option<&'static str>, LoadError> {
        let Some((text, line)) = self.text(key)? else { return Ok(None) };
        match words.iter().find(|w| **w == text) {
            Some(word) => Ok(Some(word)),
            None => {
                let expected = format!("one of {}", words.join(", "));
                Err(self.error(line, key, quoted(&text), expected))
            }
        }
    }

    /// True or false.
    pub(crate) fn flag(&self, key: &'static str) -> Result<Option<bool>, LoadError> {
        let Some((value, line)) = self.get(key) else { return Ok(None) };
        match value.as_bool() {
            Some(flag) => Ok(Some(flag)),
            None => Err(self.error(line, key, describe(value), "true or false")),
        }
    }

    /// A number. Its range is checked when the scene is compiled.
    pub(crate) fn number(&self, key: &'static str) -> Result<Option<Lined<f32>>, LoadError> {
        let Some((value, line)) = self.get(key) else { return Ok(None) };
        match number(value) {
            Some(x) => Ok(Some((x as f32, line))),
            None => Err(self.error(line, key, describe(value), "a number")),
        }
    }

    /// A list of `N` numbers.
    pub(crate) fn numbers<const N: usize>(
        &self,
        key: &'static str,
    ) -> Result<Option<Lined<[f32; N]>>, LoadError> {
        let Some((value, line)) = self.get(key) else { return Ok(None) };
        let expected = || format!("a list of {N} numbers");
        let Some(list) = value.as_array() else {
            return Err(self.error(line, key, describe(value), expected()));
        };
        let mut out = [0.0; N];
        if list.len() != N {
            return Err(self.error(line, key, format!("a list of {}", list.len()), expected()));
        }
        for (slot, item) in out.iter_mut().zip(list.iter()) {
            let Some(x) = number(item.get_ref()) else {
                let line = self.doc.line(&item.span());
                return Err(self.error(line, key, describe(item.get_ref()), expected()));
            };
            *slot = x as f32;
        }
        Ok(Some((out, line)))
    }

    /// Two lists of 3 numbers: the corners of a box.
    pub(crate) fn corners(&self, key: &'static str) -> Result<Option<Lined<[[f32; 3]; 2]>>, LoadError> {
        let Some((value, line)) = self.get(key) else { return Ok(None) };
        let wrong = |found: &DeValue<'_>| {
            self.error(line, key, describe(found), "two lists of 3 numbers: the lower and the upper corner")
        };
        let list = value.as_array().filter(|l| l.len() == 2).ok_or_else(|| wrong(value))?;
        let mut out = [[0.0; 3]; 2];
        for (corner, item) in out.iter_mut().zip(list.iter()) {
            let item = item.get_ref();
            let numbers = item.as_array().filter(|l| l.len() == 3).ok_or_else(|| wrong(item))?;
            for (slot, x) in corner.iter_mut().zip(numbers.iter()) {
                *slot = number(x.get_ref()).ok_or_else(|| wrong(x.get_ref()))? as f32;
            }
        }
        Ok(Some((out, line)))
    }

    /// One number, or three of them.
    pub(crate) fn one_or_three(&self, key: &'static str) -> Result<Option<[f32; 3]>, LoadError> {
        match self.get(key) {
            Some((DeValue::Array(_), _)) => Ok(self.numbers::<3>(key)?.map(|v| v.0)),
            Some((value, line)) => match number(value) {
                Some(x) => Ok(Some([x as f32; 3])),
                None => Err(self.error(line, key, describe(value), "a number or a list of 3 numbers")),
            },
            None => Ok(None),
        }
    }

    /// A list of `N` whole numbers within a range.
    pub(crate) fn counts<const N: usize>(
        &self,
        key: &'static str,
        range: std::ops::RangeInclusive<u32>,
    ) -> Result<Option<[u32; N]>, LoadError> {
        let Some((value, line)) = self.get(key) else { return Ok(None) };
        let expected = || format!("a list of {N} whole numbers from {} to {}", range.start(), range.end());
        let wrong = |found: String| Err(self.error(line, key, found, expected()));
        let Some(list) = value.as_array() else { return wrong(describe(value)) };
        if list.len() != N {
            return wrong(format!("a list of {}", list.len()));
        }
        let mut out = [0; N];
        for (slot, item) in out.iter_mut().zip(list.iter()) {
            match whole(item.get_ref()).and_then(|n| u32::try_from(n).ok()).filter(|n| range.contains(n)) {
                Some(n) => *slot = n,
                None => return wrong(describe(item.get_ref())),
            }
        }
        Ok(Some(out))
    }

    /// A whole number.
    pub(crate) fn whole(&self, key: &'static str) -> Result<Option<Lined<i64>>, LoadError> {
        let Some((value, line)) = self.get(key) else { return Ok(None) };
        match whole(value) {
            Some(n) => Ok(Some((n, line))),
            None => Err(self.error(line, key, describe(value), "a whole number")),
        }
    }

    /// A table of its own, as in `[camera]`.
    pub(crate) fn section(&self, key: &'static str) -> Result<Option<Section<'a>>, LoadError> {
        self.asked.borrow_mut().push(key);
        let Some(value) = self.table.get(key) else { return Ok(None) };
        match value.get_ref() {
            DeValue::Table(t) => Ok(Some(Section::new(self.doc, key.to_owned(), t, value.span()))),
            other => {
                let line = self.doc.line(&value.span());
                Err(self.error(line, key, describe(other), format!("one table [{key}]")))
            }
        }
    }

    /// A list of tables, as in `[[light]]`, named `light 1`, `light 2`, ...
    pub(crate) fn sections(&self, key: &'static str) -> Result<Vec<Section<'a>>, LoadError> {
        self.asked.borrow_mut().push(key);
        let Some(value) = self.table.get(key) else { return Ok(Vec::new()) };
        let expected = || format!("tables [[{key}]]");
        let line = self.doc.line(&value.span());
        let Some(list) = value.get_ref().as_array() else {
            return Err(self.error(line, key, describe(value.get_ref()), expected()));
        };
        let mut out = Vec::new();
        for (i, item) in list.iter().enumerate() {
            match item.get_ref() {
                DeValue::Table(t) => {
                    out.push(Section::new(self.doc, format!("{key} {}", i + 1), t, item.span()));
                }
                other => {
                    let line = self.doc.line(&item.span());
                    return Err(self.error(line, key, describe(other), expected()));
                }
            }
        }
        Ok(out)
    }

    /// Refuses fields that nobody asked for.
    pub(crate) fn finish(&self) -> Result<(), LoadError> {
        let mut asked = self.asked.borrow().clone();
        asked.sort_unstable();
        asked.dedup();
        let mut unknown: Vec<_> =
            self.table.keys().filter(|k| !asked.contains(&k.get_ref().as_ref())).collect();
        unknown.sort_by_key(|k| k.span().start);
        match unknown.first() {
            None => Ok(()),
            Some(key) => Err(LoadError::unexpected(
                self.doc.file,
                format!("the unknown field {}", quoted(key.get_ref())),
                format!("one of {}", asked.join(", ")),
            )
            .at(self.doc.line(&key.span()))
            .field(if self.name.is_empty() { "scene".to_owned() } else { self.name.clone() })),
        }
    }
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(f) => f.as_str().replace('_', "").parse().ok(),
        DeValue::Integer(_) => whole(value).map(|n| n as f64),
        _ => None,
    }
}

fn whole(value: &DeValue<'_>) -> Option<i64> {
    let n = value.as_integer()?;
    i64::from_str_radix(&n.as_str().replace('_', ""), n.radix()).ok()
}

fn describe(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(s) => quoted(s),
        DeValue::Integer(n) => n.as_str().to_owned(),
        DeValue::Float(x) => x.as_str().to_owned(),
        DeValue::Boolean(b) => b.to_string(),
        DeValue::Datetime(_) => "a date".into(),
        DeValue::Array(a) => format!("a list of {}", a.len()),
        DeValue::Table(_) => "a table".into(),
    }
}
