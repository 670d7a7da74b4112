//! The WGSL twins of core's modules, and how a shader is put together of them.
//!
//! A file stands for the core module of the same path; its functions are core's, with the module's name before
//! theirs: `warp::sample_cone` is `warp_sample_cone`. A file is plain WGSL with directives in comments that begin with `//:`
//!
//! - `//: use math::bits` needs another file;
//! - `//: if LOBES` ... `//: else` ... `//: end` is there only where the feature is on (or `not LOBES`); nested as one likes.
//!
//! Functions that loops call return once, by `select` and by `&` and `|` where they have to choose: each early return within a loop is a loop
//! of its own to SwiftShader, and compiling takes hours and all memory.
//!
//! What the roots of a shader do not need is not in it. Files are text in the program, so a shader is made at run time,
//! for just the features that a scene asks for.

use std::collections::HashSet;
use std::fmt::Write as _;

include!(concat!(env!("OUT_DIR"), "/files.rs"));

/// The feature of devices whose compilers reorder sums and fuse products: `math_kept` hides from them what must be as written.
pub(crate) const REORDERED: &str = "REORDERED";

/// A part of a shader that a test replaces, to see that the suite notices.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mutation {
    /// The file, as directives name it (`math::bits`).
    pub module: &'static str,
    /// Text that occurs in it exactly once.
    pub from: &'static str,
    /// What stands there instead.
    pub to: &'static str,
}

/// Why a shader cannot be put together: a fault of this crate's files, which its tests find.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum LinkError {
    NoFile { wanted: String, by: String },
    Directive { module: String, line: usize, text: String },
    Mutation { module: &'static str, occurrences: usize },
}

impl std::fmt::Display for LinkError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoFile { wanted, by } => write!(f, "shader `{by}` uses `{wanted}`, which is no file"),
            Self::Directive { module, line, text } => {
                write!(f, "shader `{module}`, line {line}: directive `{text}` is not understood here")
            }
            Self::Mutation { module, occurrences } => {
                write!(
                    f,
                    "the text to replace in shader `{module}` occurs {occurrences} times, expected once"
                )
            }
        }
    }
}

/// Text and features of a shader.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link<'a> {
    /// The text that uses files; directives work in it as well.
    pub root: &'a str,
    /// Features that are on.
    pub features: &'a [&'a str],
    /// Replaced before anything is read.
    pub mutations: &'a [Mutation],
}

impl Link<'_> {
    /// The whole shader: each file once, after what it uses.
    pub(crate) fn text(&self) -> Result<String, LinkError> {
        for m in self.mutations {
            let text = find(m.module).unwrap_or_default();
            let occurrences = text.matches(m.from).count();
            if occurrences != 1 {
                return Err(LinkError::Mutation { module: m.module, occurrences });
            }
        }
        let mut out = String::new();
        self.add("root", self.root, &mut HashSet::new(), &mut out)?;
        Ok(out)
    }

    fn add(
        &self,
        module: &str,
        text: &str,
        seen: &mut HashSet<String>,
        out: &mut String,
    ) -> Result<(), LinkError> {
        // Whether each open `if` holds.
        let mut open: Vec<bool> = Vec::new();
        let mut own = String::new();
        for (number, line) in text.lines().enumerate() {
            let wrong =
                || LinkError::Directive { module: module.into(), line: number + 1, text: line.trim().into() };
            let Some(directive) = line.trim_start().strip_prefix("//:") else {
                if open.iter().all(|on| *on) {
                    own.push_str(line);
                    own.push('\n');
                }
                continue;
            };
            match *directive.split_whitespace().collect::<Vec<_>>() {
                ["use", wanted] if open.iter().all(|on| *on) => {
                    if seen.insert(wanted.into()) {
                        let text = self
                            .file(wanted)
                            .ok_or_else(|| LinkError::NoFile { wanted: wanted.into(), by: module.into() })?;
                        self.add(wanted, &text, seen, out)?;
                    }
                }
                ["use", _] => {}
                ["if", feature] => open.push(self.features.contains(&feature)),
                ["if", "not", feature] => open.push(!self.features.contains(&feature)),
                ["else"] => match open.last_mut() {
                    Some(on) => *on = !*on,
                    None => return Err(wrong()),
                },
                ["end"] => {
                    open.pop().ok_or_else(wrong)?;
                }
                _ => return Err(wrong()),
            }
        }
        if !open.is_empty() {
            let line = text.lines().count();
            return Err(LinkError::Directive {
                module: module.into(),
                line,
                text: "an `if` without `end`".into(),
            });
        }
        let _ = write!(out, "\n// ---- {module}\n{own}");
        Ok(())
    }

    fn file(&self, module: &str) -> Option<String> {
        let text = find(module)?;
        let edits = self.mutations.iter().filter(|m| m.module == module);
        Some(edits.fold(text.to_string(), |text, m| text.replacen(m.from, m.to, 1)))
    }
}

/// The text of a file; modules are named `a::b`, files `a/b`.
pub(crate) fn find(module: &str) -> Option<&'static str> {
    let path = module.replace("::", "/");
    FILES.iter().find(|f| f.0 == path).map(|f| f.1)
}

#[cfg(test)]
mod tests;
