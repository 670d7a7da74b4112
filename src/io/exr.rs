//! OpenEXR: linear images with their variance (OpenEXR 2.0, technical introduction).
//!
//! What is written: one part; channels `R G B`, then `variance.R` and so on (of the mean) and `samples` where
//! they are known; 32-bit floats, ZIP in blocks of 16 lines, lines from top to bottom, one thread; settings as
//! one JSON text in the attribute `etendue`. No date and no timing: the same image gives the same bytes.

use std::io::Cursor;
use std::path::Path;

use ::exr::meta::MetaData;
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples, Image, Layer,
    LayerAttributes, LineOrder, ReadChannels as _, ReadLayers as _, SmallVec, Text, WritableImage as _,
};

use super::atomic::write_whole;
use super::error::{LoadError, Problem, SaveError};
use super::source::{DiskSource, read_file};

/// Longer files are refused.
const MAX_FILE: u64 = 1 << 32;
/// More samples (pixels times channels, over all parts) are refused: a small file can claim any size.
const MAX_SAMPLES: u64 = 1 << 28;
/// The attribute that holds the settings.
const ATTRIBUTE: &str = "etendue";

/// A linear image and what is known about its error.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderImage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Radiance \[W m^-2 sr^-1\] per pixel, top row first.
    pub radiance: Vec<[f32; 3]>,
    /// Variance of the mean per pixel and channel.
    pub variance: Option<Vec<[f32; 3]>>,
    /// Samples per pixel.
    pub sample_count: Option<Vec<f32>>,
    /// Settings as JSON text; empty for none.
    pub metadata: String,
}

/// Writes an image; see the head of this module for how. Non-finite pixels are written as they are.
pub fn write_exr(path: &Path, image: &RenderImage) -> Result<(), SaveError> {
    write_whole(path, &encode_exr(path, image)?)
}

fn encode_exr(path: &Path, image: &RenderImage) -> Result<Vec<u8>, SaveError> {
    let pixels = u64::from(image.width) * u64::from(image.height);
    let lengths = [
        Some(image.radiance.len()),
        image.variance.as_ref().map(Vec::len),
        image.sample_count.as_ref().map(Vec::len),
    ];
    for length in lengths.into_iter().flatten() {
        if length as u64 != pixels || pixels == 0 {
            let reason = format!("{length} pixels do not fill {} x {}", image.width, image.height);
            return Err(SaveError::new(path, reason));
        }
    }
    let mut channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = SmallVec::new();
    let mut color = |prefix: &str, values: &[[f32; 3]]| {
        for (k, name) in ["R", "G", "B"].into_iter().enumerate() {
            let samples = FlatSamples::F32(values.iter().map(|v| v[k]).collect());
            channels.push(AnyChannel::new(format!("{prefix}{name}").as_str(), samples));
        }
    };
    color("", &image.radiance);
    if let Some(variance) = &image.variance {
        color("variance.", variance);
    }
    if let Some(counts) = &image.sample_count {
        channels.push(AnyChannel::new("samples", FlatSamples::F32(counts.clone())));
    }
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let mut attributes = LayerAttributes::default();
    if !image.metadata.is_empty() {
        let text = Text::from_slice_unchecked(image.metadata.as_bytes());
        attributes.other.insert(Text::from(ATTRIBUTE), AttributeValue::Text(text));
    }
    let size = (image.width as usize, image.height as usize);
    let image = Image::from_layer(Layer::new(size, attributes, encoding, AnyChannels::sort(channels)));
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).map_err(|e| SaveError::new(path, e))?;
    Ok(bytes.into_inner())
}

/// Reads an image written by this or another program: half, float or integer samples; `R G B`, with or without
/// a layer name before them (the unnamed layer first, else the first that is complete), or luminance `Y`;
/// opacity is left out. `variance.R G B` and `samples` beside them are kept.
pub fn read_exr(path: &Path) -> Result<RenderImage, LoadError> {
    parse_exr(&read_file(&DiskSource, path, MAX_FILE)?, path)
}

/// As [`read_exr`], from bytes. `file` appears in messages only.
pub fn parse_exr(bytes: &[u8], file: &Path) -> Result<RenderImage, LoadError> {
    let failed = |e: ::exr::error::Error| LoadError::decode(file, "EXR", e);
    let header = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(failed)?;
    let samples = header.headers.iter().fold(0u64, |sum, h| {
        let area = (h.layer_size.width() as u64).saturating_mul(h.layer_size.height() as u64);
        sum.saturating_add(area.saturating_mul(h.channels.list.len() as u64))
    });
    if samples > MAX_SAMPLES {
        let problem =
            Problem::TooLarge { what: "samples (pixels times channels)", found: samples, limit: MAX_SAMPLES };
        return Err(LoadError::new(file, problem));
    }
    let image = ::exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(failed)?;

    // The unnamed layer of any part first, else the first layer that is complete.
    let parts = &image.layer_data;
    let mut groups: Vec<(usize, String)> = Vec::new();
    for (i, part) in parts.iter().enumerate() {
        for channel in &part.channel_data.list {
            let name = String::from_utf8_lossy(channel.name.as_slice()).into_owned();
            let prefix = name.rfind('.').map_or("", |dot| &name[..=dot]).to_owned();
            if !groups.contains(&(i, prefix.clone())) {
                groups.push((i, prefix));
            }
        }
    }
    groups.sort_by_key(|g| !g.1.is_empty());
    let found = groups.iter().find_map(|(i, prefix)| {
        let color = color_of(&parts[*i].channel_data.list, prefix)?;
        Some((*i, color))
    });
    let Some((index, radiance)) = found else {
        let all: Vec<String> = parts
            .iter()
            .flat_map(|p| &p.channel_data.list)
            .take(20)
            .map(|c| String::from_utf8_lossy(c.name.as_slice()).into_owned())
            .collect();
        let found = format!("the channels {}", all.join(", "));
        return Err(LoadError::unexpected(file, found, "channels R, G and B, or Y"));
    };
    let part = &parts[index];
    let (width, height) = (part.size.width() as u32, part.size.height() as u32);
    let metadata = part
        .attributes
        .other
        .get(&Text::from(ATTRIBUTE))
        .or_else(|| image.attributes.other.get(&Text::from(ATTRIBUTE)));
    let metadata = match metadata {
        Some(AttributeValue::Text(text)) => String::from_utf8_lossy(text.as_slice()).into_owned(),
        _ => String::new(),
    };
    let list = &part.channel_data.list;
    Ok(RenderImage {
        width,
        height,
        radiance,
        variance: color_of(list, "variance."),
        sample_count: values(list, "samples"),
        metadata,
    })
}

fn values(list: &[AnyChannel<FlatSamples>], name: &str) -> Option<Vec<f32>> {
    let channel = list.iter().find(|c| c.name.as_slice().eq_ignore_ascii_case(name.as_bytes()))?;
    // A channel with fewer samples than pixels is another kind of thing (chroma, at half the rate).
    (channel.sampling.x() == 1 && channel.sampling.y() == 1)
        .then(|| channel.sample_data.values_as_f32().collect())
}

fn color_of(list: &[AnyChannel<FlatSamples>], prefix: &str) -> Option<Vec<[f32; 3]>> {
    let get = |name: &str| values(list, &format!("{prefix}{name}"));
    match (get("R"), get("G"), get("B")) {
        (Some(r), Some(g), Some(b)) => {
            Some(r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect())
        }
        // Luminance alone is grey; beside chroma it would need a conversion that nobody asked for.
        _ if list.iter().any(|c| c.sampling.x() != 1 || c.sampling.y() != 1) => None,
        _ => get("Y").map(|y| y.into_iter().map(|y| [y; 3]).collect()),
    }
}
