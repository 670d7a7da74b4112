//! Contenders for `bc1`: encoders of the same texels, all with uniform channel weights, each on one thread.
#![allow(clippy::disallowed_methods, reason = "inputs are made and errors summed in f64")]

use crate::figure::{Contender, Contest};
use block_compression::CompressionVariant;
use etendue_conformance::statistics::Random;
use etendue_conformance::truth::empty_box::EmptyBox;
use etendue_core::codec::bc1::{self, Black, Block, Quality, Texels};
use std::rc::Rc;
use texpresso::{Algorithm, COLOUR_WEIGHTS_UNIFORM, Format, Params};

/// A picture with sides that are multiples of four.
pub struct Picture {
    /// Texels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Rows of red, green, blue, 255.
    pub rgba: Vec<u8>,
    /// The same as blocks, row by row.
    pub blocks: Vec<Texels>,
}

impl Picture {
    fn new(width: usize, height: usize, texel: impl FnMut(usize, usize) -> [f64; 3]) -> Self {
        let mut texel = texel;
        let mut rgba = Vec::with_capacity(4 * width * height);
        for y in 0..height {
            for x in 0..width {
                rgba.extend(texel(x, y).map(|v| v.round().clamp(0.0, 255.0) as u8));
                rgba.push(255);
            }
        }
        let mut this = Self { width, height, rgba, blocks: vec![[[0; 3]; 16]; width * height / 16] };
        gather(&this.rgba, width, &mut this.blocks);
        this
    }
}

/// Cuts rows of red, green, blue, alpha into blocks.
pub fn gather(rgba: &[u8], width: usize, out: &mut [Texels]) {
    for (strip, out) in rgba.chunks_exact(16 * width).zip(out.chunks_exact_mut(width / 4)) {
        for (y, row) in strip.chunks_exact(4 * width).enumerate() {
            let (cells, _) = row.as_chunks::<16>();
            for (cell, out) in cells.iter().zip(&mut *out) {
                let (texels, _) = cell.as_chunks::<4>();
                for (x, [r, g, b, _]) in texels.iter().enumerate() {
                    out[4 * y + x] = [*r, *g, *b];
                }
            }
        }
    }
}

/// The operator of an empty box of coloured walls, 6 `cells`^2 patches, natural order or shuffled: form factor times
/// colour of the sender, over the largest, its logarithm over 25 units in 8 bits.
pub fn operator(cells: usize, shuffled: bool) -> Picture {
    let b = EmptyBox::new([4.0, 2.5, 3.0], cells);
    let n = b.len();
    let mut random = Random::new(0xb0c5);
    const WALLS: [[f64; 3]; 6] = [
        [0.63, 0.06, 0.05],
        [0.14, 0.45, 0.09],
        [0.7, 0.7, 0.68],
        [0.35, 0.25, 0.15],
        [0.7; 3],
        [0.1, 0.2, 0.6],
    ];
    let colours: Vec<[f64; 3]> = (0..n)
        .map(|j| {
            let stain = random.range(0.85, 1.0);
            WALLS[j / (cells * cells)].map(|c| c * stain)
        })
        .collect();
    let mut order: Vec<usize> = (0..n).collect();
    if shuffled {
        for i in (1..n).rev() {
            order.swap(i, random.below(i as u32 + 1) as usize);
        }
    }
    let value = |x: usize, y: usize| {
        let (i, j) = (order[y], order[x]);
        colours[j].map(|c| c * b.form_factors[i * n + j])
    };
    let mut largest = 0.0_f64;
    for y in 0..n {
        for x in 0..n {
            largest = value(x, y).into_iter().fold(largest, f64::max);
        }
    }
    Picture::new(n, n, |x, y| {
        value(x, y).map(|v| if v > 0.0 { ((v / largest).ln() + 25.0).max(0.0) * (255.0 / 25.0) } else { 0.0 })
    })
}

/// Four pictures, one below the other: gradients, noise, edges, and something like a photograph (blobs and texture).
pub fn pictures(side: usize) -> Picture {
    let mut random = Random::new(0x1ea5);
    let blobs: Vec<[f64; 6]> = (0..40)
        .map(|_| {
            let mut at = |high: f64| random.range(0.0, high);
            [at(1.0), at(1.0), 0.02 + at(0.2), at(255.0), at(255.0), at(255.0)]
        })
        .collect();
    let lines: Vec<[f64; 6]> = (0..12)
        .map(|_| {
            let angle = random.range(0.0, std::f64::consts::TAU);
            let mut at = |high: f64| random.range(0.0, high);
            [angle.cos(), angle.sin(), at(1.4) - 0.7, at(255.0), at(255.0), at(255.0)]
        })
        .collect();
    Picture::new(side, 4 * side, |x, y| {
        let (kind, u, v) = (y / side, x as f64 / side as f64, (y % side) as f64 / side as f64);
        let mut noise = |spread: f64| [0; 3].map(|_| random.range(-spread, spread));
        match kind {
            0 => [255.0 * u, 255.0 * v, 200.0 * (u * v) + 20.0],
            1 => noise(127.5).map(|n| 127.5 + n),
            2 => {
                let mut colour = [30.0, 60.0, 90.0];
                for l in &lines {
                    if (u - 0.5) * l[0] + (v - 0.5) * l[1] > l[2] {
                        colour = [l[3], l[4], l[5]];
                    }
                }
                colour
            }
            _ => {
                let (mut sum, mut colour) = (0.3, [40.0, 36.0, 30.0]);
                for b in &blobs {
                    let w = (-((u - b[0]).powi(2) + (v - b[1]).powi(2)) / (2.0 * b[2] * b[2])).exp();
                    sum += w;
                    for c in 0..3 {
                        colour[c] += w * b[3 + c];
                    }
                }
                let light = 1.0 + 0.08 * (90.0 * u + 20.0 * v).sin() * (70.0 * v).cos();
                let n = noise(5.0);
                [0, 1, 2].map(|c| colour[c] / sum * light + n[c])
            }
        }
    })
}

/// Root of the mean square over all values, in units of 1/255, by the reference decoder.
pub fn rmse(texels: &[Texels], blocks: &[Block]) -> f64 {
    let sum: f64 = texels.iter().zip(blocks).map(|(t, b)| bc1::error(t, &bc1::ALIKE, *b)).sum();
    (sum / (48 * texels.len()) as f64).sqrt()
}

/// Peak signal to noise ratio \[dB\] of a root mean square error in units of 1/255.
pub fn psnr(rmse: f64) -> f64 {
    20.0 * (255.0 / rmse).log10()
}

type Encoder = Box<dyn FnMut(&mut [Block])>;

fn contender(picture: &Rc<Picture>, name: &str, ours: bool, mut encode: Encoder) -> Contender {
    let mut out = vec![[0; 8]; picture.blocks.len()];
    encode(&mut out);
    let error = rmse(&picture.blocks, &out);
    let work = move || {
        encode(&mut out);
        std::hint::black_box(&out);
    };
    Contender { name: name.to_string(), ours, error, work: Box::new(work) }
}

/// All encoders on one picture.
pub fn contenders(picture: &Rc<Picture>) -> Vec<Contender> {
    let mut list = Vec::new();
    for (algorithm, name) in [
        (Algorithm::RangeFit, "texpresso 2.0 range fit"),
        (Algorithm::ClusterFit, "texpresso 2.0 cluster fit"),
        (Algorithm::IterativeClusterFit, "texpresso 2.0 iterative cluster fit"),
    ] {
        let p = picture.clone();
        let params = Params { algorithm, weights: COLOUR_WEIGHTS_UNIFORM, weigh_colour_by_alpha: false };
        let encode = move |out: &mut [Block]| {
            Format::Bc1.compress(&p.rgba, p.width, p.height, params, out.as_flattened_mut());
        };
        list.push(contender(picture, name, false, Box::new(encode)));
    }
    let p = picture.clone();
    let encode = move |out: &mut [Block]| {
        let (width, height, stride) = (p.width as u32, p.height as u32, 4 * p.width as u32);
        let surface = intel_tex_2::RgbaSurface { width, height, stride, data: &p.rgba };
        intel_tex_2::bc1::compress_blocks_into(&surface, out.as_flattened_mut());
    };
    list.push(contender(picture, "intel_tex_2 0.5", false, Box::new(encode)));
    let p = picture.clone();
    let encode = move |out: &mut [Block]| {
        let (width, height, stride) = (p.width as u32, p.height as u32, 4 * p.width as u32);
        let variant = CompressionVariant::BC1;
        block_compression::encode::compress_rgba8(
            variant,
            &p.rgba,
            out.as_flattened_mut(),
            width,
            height,
            stride,
        );
    };
    list.push(contender(picture, "block_compression 0.11", false, Box::new(encode)));
    // Blocks are what the operator's tiles are; the rivals read rows, and so does this one.
    let p = picture.clone();
    let mut blocks = p.blocks.clone();
    let encode = move |out: &mut [Block]| {
        gather(&p.rgba, p.width, &mut blocks);
        let _ = etendue_cpu::bc1::encode_blocks(&blocks, Quality::LeastSquares, Black::Allowed, out);
    };
    list.push(contender(picture, "LeastSquares, from rows", true, Box::new(encode)));
    for quality in Quality::ALL {
        for black in [Black::Allowed, Black::Avoided] {
            if black == Black::Avoided && quality <= Quality::LeastSquares {
                continue;
            }
            let p = picture.clone();
            let encode = move |out: &mut [Block]| {
                let _ = etendue_cpu::bc1::encode_blocks(&p.blocks, quality, black, out);
            };
            let name = format!("{quality:?}{}", if black == Black::Avoided { ", opaque" } else { "" });
            list.push(contender(picture, &name, true, Box::new(encode)));
        }
    }
    list
}

fn contest(title: &'static str, file: &'static str, picture: Picture) -> Contest {
    let items = picture.blocks.len() as u64;
    let contenders = contenders(&Rc::new(picture));
    let error_label = "root mean square error [1/255]";
    Contest { title, file, error_label, item: "block", items, contenders }
}

/// The operator in natural order, the operator shuffled, and pictures.
pub fn contests() -> Vec<Contest> {
    vec![
        contest("BC1 of the operator of an empty box", "bc1_operator", operator(6, false)),
        contest("BC1 of the same operator, patches shuffled", "bc1_shuffled", operator(6, true)),
        contest("BC1 of generated pictures", "bc1_pictures", pictures(96)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_core::codec::bc1::{Rule, decode_with};

    #[test]
    fn a_rival_decodes_as_the_truncating_rule_does() {
        let mut random = Random::new(3);
        for _ in 0..100_000 {
            let block = random.bits().to_le_bytes();
            assert_eq!(Format::Bc1.decompress_block(&block), decode_with(block, Rule::Truncated));
        }
    }
}
