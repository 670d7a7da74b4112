//! Sections under one header: magic, version, lengths, checksums. What they mean is not known here.

use super::super::error::{LoadError, Problem};
use std::borrow::Cow;
use std::path::Path;

/// First bytes of the file.
pub(super) const MAGIC: [u8; 8] = *b"etendue\0";
/// The version that is written, and the newest that is read.
pub(super) const VERSION: u32 = 1;
/// Sections begin at multiples of this.
const ALIGN: usize = 64;
/// Bytes of the header.
const HEADER: usize = 64;
/// Bytes of an entry of the table.
const ENTRY: usize = 64;
/// Where in the header its checksum is.
const SEAL: std::ops::Range<usize> = 32..64;
/// More sections are refused.
const MAX_SECTIONS: usize = 256;
/// Flag of a section without which the file cannot be understood.
const REQUIRED: u32 = 1;

/// Name of a section: at most eight bytes, padded with zeros.
pub(super) type Tag = [u8; 8];

/// The tag of a name.
pub(super) const fn tag(name: &str) -> Tag {
    let (bytes, mut tag) = (name.as_bytes(), [0; 8]);
    let mut i = 0;
    while i < bytes.len() && i < 8 {
        tag[i] = bytes[i];
        i += 1;
    }
    tag
}

/// The name of a tag, for messages.
pub(super) fn name(tag: &Tag) -> String {
    tag.iter().take_while(|b| **b != 0).flat_map(|b| b.escape_ascii()).map(char::from).collect()
}

/// A section.
#[derive(Clone, Debug)]
pub(super) struct Section<'a> {
    /// Its name.
    pub(super) tag: Tag,
    /// Whether a reader that does not know it must give up.
    pub(super) required: bool,
    /// What it holds.
    pub(super) bytes: Cow<'a, [u8]>,
}

impl<'a> Section<'a> {
    /// One that a reader must know.
    pub(super) fn new(tag: Tag, bytes: impl Into<Cow<'a, [u8]>>) -> Self {
        Self { tag, required: true, bytes: bytes.into() }
    }
}

fn seal(header: &[u8], table: &[u8]) -> [u8; 32] {
    let mut hash = blake3::Hasher::new();
    hash.update(&header[..SEAL.start]);
    hash.update(table);
    *hash.finalize().as_bytes()
}

/// The bytes of a file.
pub(super) fn assemble(sections: &[Section<'_>]) -> Vec<u8> {
    let end = HEADER + ENTRY * sections.len();
    let length = sections.iter().fold(end, |at, s| at.next_multiple_of(ALIGN) + s.bytes.len());
    let mut out = Vec::with_capacity(length);
    out.extend(MAGIC);
    out.extend(VERSION.to_le_bytes());
    out.extend((sections.len() as u32).to_le_bytes());
    out.extend((length as u64).to_le_bytes());
    out.resize(HEADER, 0);
    let mut at = end;
    for s in sections {
        at = at.next_multiple_of(ALIGN);
        out.extend(s.tag);
        out.extend((at as u64).to_le_bytes());
        out.extend((s.bytes.len() as u64).to_le_bytes());
        out.extend(if s.required { REQUIRED } else { 0 }.to_le_bytes());
        out.extend([0; 4]);
        out.extend(blake3::hash(&s.bytes).as_bytes());
        at += s.bytes.len();
    }
    let seal = seal(&out[..HEADER], &out[HEADER..]);
    out[SEAL].copy_from_slice(&seal);
    for s in sections {
        out.resize(out.len().next_multiple_of(ALIGN), 0);
        out.extend(&*s.bytes);
    }
    out
}

/// The sections of a file whose checksums are right.
#[derive(Debug)]
pub(super) struct Sections<'a> {
    file: &'a Path,
    list: Vec<(Tag, bool, &'a [u8])>,
}

/// Little-endian integers at a place that is known to be there.
fn u32_at(bytes: &[u8], at: usize) -> u32 {
    bytes.get(at..).and_then(|b| b.first_chunk()).map_or(0, |b| u32::from_le_bytes(*b))
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    bytes.get(at..).and_then(|b| b.first_chunk()).map_or(0, |b| u64::from_le_bytes(*b))
}

impl<'a> Sections<'a> {
    /// Takes a file apart.
    pub(super) fn read(bytes: &'a [u8], file: &'a Path) -> Result<Self, LoadError> {
        let damaged = |what: String| LoadError::new(file, Problem::Damaged(what));
        if !bytes.starts_with(&MAGIC) {
            let start =
                bytes.iter().take(8).flat_map(|b| b.escape_ascii()).map(char::from).collect::<String>();
            return Err(LoadError::unexpected(
                file,
                format!("a file that begins with \"{start}\""),
                format!("an operator file, which begins with \"{}\"", MAGIC.escape_ascii()),
            ));
        }
        // Before anything else: a newer version may have another header.
        if let Some(version) = bytes.get(8..12) {
            let version = u32_at(version, 0);
            if version > VERSION {
                return Err(LoadError::new(file, Problem::Newer { found: version, known: VERSION }));
            }
            if version == 0 {
                return Err(damaged("its version is 0".into()));
            }
        }
        if bytes.len() < HEADER {
            return Err(damaged(format!("it ends after {} bytes, within its header", bytes.len())));
        }
        let (count, length) = (u32_at(bytes, 12) as usize, u64_at(bytes, 16));
        if bytes.len() as u64 != length {
            return Err(damaged(format!("it has {} bytes, its header says {length}", bytes.len())));
        }
        if count > MAX_SECTIONS {
            let (found, limit) = (count as u64, MAX_SECTIONS as u64);
            return Err(LoadError::new(file, Problem::TooLarge { what: "sections", found, limit }));
        }
        let table = count.checked_mul(ENTRY).and_then(|n| bytes.get(HEADER..)?.get(..n));
        let Some(table) = table else {
            return Err(damaged(format!("its table of {count} sections does not fit into {length} bytes")));
        };
        if seal(bytes, table) != bytes[SEAL] {
            return Err(damaged("the checksum of its header is wrong".into()));
        }
        if bytes[24..SEAL.start].iter().any(|b| *b != 0) {
            return Err(damaged("its header has bytes that must be zero and are not".into()));
        }
        let mut list: Vec<(Tag, bool, &[u8])> = Vec::with_capacity(count);
        let mut end = HEADER + table.len();
        for entry in table.chunks_exact(ENTRY) {
            let tag: Tag = std::array::from_fn(|i| entry[i]);
            let named = || format!("section \"{}\"", name(&tag));
            let start = end.next_multiple_of(ALIGN);
            let (offset, size) = (u64_at(entry, 8), u64_at(entry, 16));
            let found = usize::try_from(size)
                .ok()
                .and_then(|n| bytes.get(start..)?.get(..n))
                .filter(|_| offset == start as u64);
            let Some(found) = found else {
                return Err(damaged(format!("{} of {size} bytes cannot begin at byte {offset}", named())));
            };
            if bytes[end..start].iter().any(|b| *b != 0) {
                return Err(damaged(format!(
                    "there are bytes before {} that must be zero and are not",
                    named()
                )));
            }
            if *blake3::hash(found).as_bytes() != entry[32..] {
                return Err(damaged(format!("the checksum of {} is wrong", named())));
            }
            let flags = u32_at(entry, 24);
            if flags & !REQUIRED != 0 || u32_at(entry, 28) != 0 {
                return Err(damaged(format!("{} has flags {flags:#x}", named())));
            }
            if list.iter().any(|(t, ..)| *t == tag) {
                return Err(damaged(format!("{} is there twice", named())));
            }
            list.push((tag, flags & REQUIRED != 0, found));
            end = start + found.len();
        }
        if end != bytes.len() {
            return Err(damaged(format!("{} bytes follow its last section", bytes.len() - end)));
        }
        Ok(Self { file, list })
    }

    /// The file, for messages.
    pub(super) fn file(&self) -> &'a Path {
        self.file
    }

    /// Takes a section out.
    pub(super) fn take(&mut self, tag: Tag) -> Result<&'a [u8], LoadError> {
        match self.list.iter().position(|(t, ..)| *t == tag) {
            Some(at) => Ok(self.list.remove(at).2),
            None => Err(LoadError::unexpected(
                self.file,
                "no such section",
                "one: the operator is not whole without it",
            )
            .field(name(&tag))),
        }
    }

    /// Takes out a section of little-endian words of 32 bits.
    pub(super) fn take_words(&mut self, tag: Tag) -> Result<Vec<u32>, LoadError> {
        let bytes = self.take(tag)?;
        let (words, rest) = bytes.as_chunks::<4>();
        if !rest.is_empty() {
            let found = format!("{} bytes", bytes.len());
            return Err(LoadError::unexpected(self.file, found, "a multiple of 4").field(name(&tag)));
        }
        Ok(words.iter().map(|w| u32::from_le_bytes(*w)).collect())
    }

    /// Takes out a section of little-endian f32.
    pub(super) fn take_floats(&mut self, tag: Tag) -> Result<Vec<f32>, LoadError> {
        Ok(self.take_words(tag)?.into_iter().map(f32::from_bits).collect())
    }

    /// Refuses what is left and cannot be skipped.
    pub(super) fn finish(self) -> Result<(), LoadError> {
        match self.list.iter().find(|(_, required, _)| *required) {
            Some((tag, ..)) => {
                let what = format!("section \"{}\"", name(tag));
                Err(LoadError::new(self.file, Problem::Unsupported(what)))
            }
            None => Ok(()),
        }
    }
}

/// Words as bytes.
pub(super) fn words(words: impl ExactSizeIterator<Item = u32>) -> Vec<u8> {
    let mut out = Vec::with_capacity(4 * words.len());
    for w in words {
        out.extend(w.to_le_bytes());
    }
    out
}

/// Numbers as bytes.
pub(super) fn floats<'v>(values: impl IntoIterator<Item = &'v f32, IntoIter: ExactSizeIterator>) -> Vec<u8> {
    words(values.into_iter().map(|x| x.to_bits()))
}
