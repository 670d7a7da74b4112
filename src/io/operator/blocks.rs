//! Sections of a transport in texture blocks.

use super::Wrong;
use super::container::{Section, Sections, floats, tag, words};
use crate::io::error::LoadError;
use etendue_core::radiosity::blocks::{BlockOperator, Entries, Format, Matrix, Parts};
use etendue_core::radiosity::patches::Patch;
use serde::{Deserialize, Serialize};

/// What the sections need to be understood.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct BlocksHead {
    matrix: MatrixJson,
    half: bool,
    /// Unit of kept entries in f16; absent: they are f32 with columns of 32 bits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    unit: Option<f32>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum MatrixJson {
    Bounces(u32),
    AllBounces,
    Gather,
    FormFactors { bounces: u32 },
}

/// What does not belong to these patches.
pub(super) fn check(operator: &BlockOperator, patches: &[Patch]) -> Result<(), Wrong> {
    if operator.len() == patches.len() {
        Ok(())
    } else {
        Err(("blocks", format!("{} patches", operator.len()), format!("{}", patches.len())))
    }
}

fn shorts(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

pub(super) fn write<'a>(operator: &'a BlockOperator, sections: &mut Vec<Section<'a>>) -> BlocksHead {
    let parts = operator.parts();
    sections.push(Section::new(tag("albedo"), floats(parts.albedo.as_flattened())));
    sections.push(Section::new(tag("order"), words(parts.order.iter().copied())));
    sections.push(Section::new(tag("scales"), floats(parts.scales.as_flattened())));
    sections.push(Section::new(tag("values"), floats(&parts.values)));
    sections.push(Section::new(tag("blocks"), parts.blocks.as_flattened()));
    sections.push(Section::new(tag("starts"), words(parts.starts.iter().copied())));
    let (columns, kept, unit) = match &parts.entries {
        Entries::Full { columns, values } => (words(columns.iter().copied()), floats(values), None),
        Entries::Short { columns, values, unit } => (shorts(columns), shorts(values), Some(*unit)),
    };
    sections.push(Section::new(tag("columns"), columns));
    sections.push(Section::new(tag("kept"), kept));
    let matrix = match parts.matrix {
        Matrix::Bounces(k) => MatrixJson::Bounces(k),
        Matrix::AllBounces => MatrixJson::AllBounces,
        Matrix::Gather => MatrixJson::Gather,
        Matrix::FormFactors { bounces } => MatrixJson::FormFactors { bounces },
    };
    BlocksHead { matrix, half: parts.half, unit }
}

/// Whole groups of K, or what was found.
fn groups<T: Copy, const K: usize>(
    list: &[T],
    name: &'static str,
    file: &Sections<'_>,
) -> Result<Vec<[T; K]>, LoadError> {
    let (groups, rest) = list.as_chunks::<K>();
    if rest.is_empty() {
        return Ok(groups.to_vec());
    }
    let found = format!("{} numbers", list.len());
    Err(LoadError::unexpected(file.file(), found, format!("a multiple of {K}")).field(name))
}

fn take_shorts(sections: &mut Sections<'_>, name: &'static str) -> Result<Vec<u16>, LoadError> {
    let bytes = sections.take(tag(name))?;
    Ok(groups::<u8, 2>(bytes, name, sections)?.into_iter().map(u16::from_le_bytes).collect())
}

pub(super) fn read(head: &BlocksHead, sections: &mut Sections<'_>) -> Result<BlockOperator, LoadError> {
    let matrix = match head.matrix {
        MatrixJson::Bounces(k) => Matrix::Bounces(k),
        MatrixJson::AllBounces => Matrix::AllBounces,
        MatrixJson::Gather => Matrix::Gather,
        MatrixJson::FormFactors { bounces } => Matrix::FormFactors { bounces },
    };
    let albedo = sections.take_floats(tag("albedo"))?;
    let order = sections.take_words(tag("order"))?;
    let scales = sections.take_floats(tag("scales"))?;
    let values = sections.take_floats(tag("values"))?;
    let blocks = sections.take(tag("blocks"))?;
    let starts = sections.take_words(tag("starts"))?;
    let entries = match head.unit {
        None => Entries::Full {
            columns: sections.take_words(tag("columns"))?,
            values: sections.take_floats(tag("kept"))?,
        },
        Some(unit) => Entries::Short {
            columns: take_shorts(sections, "columns")?,
            values: take_shorts(sections, "kept")?,
            unit,
        },
    };
    let parts = Parts {
        matrix,
        format: if matrix.channels() == 1 { Format::Bc4 } else { Format::Bc1 },
        half: head.half,
        order,
        albedo: groups(&albedo, "albedo", sections)?,
        scales: groups(&scales, "scales", sections)?,
        values,
        blocks: groups(blocks, "blocks", sections)?,
        starts,
        entries,
    };
    BlockOperator::from_parts(parts).map_err(|e| LoadError::decode(sections.file(), "operator", e))
}
