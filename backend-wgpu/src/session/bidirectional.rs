//! What waves of samples from both ends have beside those of paths: annexes for what their states are too short for, what lands in other pixels, and what lights send into.

use super::features;
use super::scene::light_media_words;
use super::wave::Form;
use etendue_core::backend::{BidirectionalJob, PathJob};
use etendue_core::film::FilmSettings;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::bidirectional::{Heuristic, SplatUnit, VERTICES_MAX};
use etendue_core::transport::volume::LightMedia;
use std::ops::Range;

/// Vertices of a walk that a state has room for (`wavefront/bidirectional/rows.wgsl`), and an annex.
const BASE: u64 = 16;
const ANNEX: u64 = VERTICES_MAX as u64 - BASE;
/// Slots that share an annex: few walks are longer than the base, and those wait for each other.
const SHARING: u64 = 32;
/// Words of a pixel's sums, three a channel.
const SUMS: u64 = 9;
/// What shaders ask of a job behind what all waves do.
pub(super) const JOB_WORDS: usize = 16;
/// Stands for all strategies.
const ALL: u32 = u32::MAX;

/// Samples from both ends, as a job asks for them.
#[derive(Clone, Debug)]
pub(crate) struct BothEnds {
    heuristic: Heuristic,
    only: Option<[u32; 2]>,
    /// Words of each light: whether it is known what it sends into, and that, or what lies around the scene.
    lights: Vec<u32>,
    search: bool,
}

impl BothEnds {
    pub(super) fn new(job: &BidirectionalJob, scene: &CompiledScene, media: &LightMedia) -> Self {
        let lights = 0..scene.lights.len();
        Self {
            heuristic: job.heuristic,
            only: job.only,
            lights: lights.clone().flat_map(|light| light_media_words(media, light)).collect(),
            search: lights.clone().any(|light| media.all_over(light).is_none()),
        }
    }
}

/// What a wave needs, before it is known how many slots it has.
#[derive(Debug)]
pub(super) struct Plan {
    ends: BothEnds,
    pub(super) form: Form,
    /// Words of an annex; 0 where no walk can be so long.
    annex_words: u64,
}

impl Plan {
    pub(super) fn new(scene: &CompiledScene, ends: &BothEnds, max_depth: u32) -> Self {
        let cutoff = matches!(ends.heuristic, Heuristic::Cutoff(_));
        let features = features::of_both_ends(scene, cutoff, ends.search);
        let has = |feature| u64::from(features.contains(&feature));
        let [volume, lobes, shading, cutoff] = ["VOLUME", "LOBES", "SHADING", "CUTOFF"].map(has);
        // As `rows.wgsl` has them.
        let vertex = 22 + 3 * shading + 9 * volume + 10 * lobes;
        let (rows, lists) = (50 + volume * (14 + 13 * cutoff), 4 * cutoff);
        let form = Form::both_ends(scene, features, rows + lists * BASE + vertex * (BASE + 1));
        let is_deep = u64::from(max_depth) > BASE;
        Self { ends: ends.clone(), form, annex_words: if is_deep { (vertex + lists) * ANNEX } else { 0 } }
    }

    /// Words of a slot among the states, and those that there are beside the slots.
    pub(super) fn words(&self) -> (u64, u64) {
        (
            self.form.rows + self.annex_words.div_ceil(SHARING),
            self.annex_words + self.ends.lights.len() as u64,
        )
    }

    /// Where all of it lies behind so many words of states and of the queue.
    pub(super) fn room(
        &self,
        scene: &CompiledScene,
        (job, film): (&PathJob, &FilmSettings),
        (slots, is_image): (u64, bool),
        (states, queue): (u64, u64),
    ) -> Room {
        let annexes = if self.annex_words > 0 { slots.div_ceil(SHARING) } else { 0 };
        let first_annex = states + self.ends.lights.len() as u64;
        let splats_at = queue + 1 + annexes;
        let elements = u64::from(film.width) * u64::from(film.height);
        let splats = is_image.then(|| Splats {
            unit: SplatUnit::new(film.scale_exponent),
            at: splats_at,
            elements,
            blocks: blocks_of_a_wave(job, elements, slots),
        });
        let (center, radius) = scene.bounding_sphere();
        let (heuristic, least_part) = match self.ends.heuristic {
            Heuristic::Power => (0, 0.0),
            Heuristic::Balance => (1, 0.0),
            Heuristic::Cutoff(part) => (2, part),
        };
        let [s, t] = self.ends.only.unwrap_or([ALL; 2]);
        let [x, y, z] = center.to_array().map(f32::to_bits);
        let words = [
            x,
            y,
            z,
            radius.to_bits(),
            heuristic,
            least_part.to_bits(),
            s,
            t,
            splats.as_ref().map_or(0.0, |s| s.unit.per_unit()).to_bits(),
            splats_at as u32,
            splats.as_ref().map_or(1, |s| s.blocks) as u32,
            queue as u32,
            first_annex as u32,
            states as u32,
            0,
            0,
        ];
        Room {
            words,
            lights: self.ends.lights.clone(),
            free: [annexes as u32].into_iter().chain(1..=annexes as u32).collect(),
            states: first_annex + annexes * self.annex_words,
            queue: splats_at + splats.as_ref().map_or(0, |s| SUMS * s.elements * s.blocks),
            splats,
        }
    }
}

/// Blocks of which a wave has any samples, at most.
fn blocks_of_a_wave(job: &PathJob, elements: u64, slots: u64) -> u64 {
    let whole = slots / u64::from(job.block_length).max(1) / elements.max(1);
    (whole + 2).min(u64::from(job.blocks.end - job.blocks.start)).max(1)
}

/// What lands in pixels from elsewhere, of a few blocks in turn.
#[derive(Debug)]
struct Splats {
    unit: SplatUnit,
    /// Where they begin among the words of the queue.
    at: u64,
    elements: u64,
    blocks: u64,
}

impl Splats {
    /// Words of a block's sums.
    fn words(&self) -> u64 {
        SUMS * self.elements
    }

    fn of_block(&self, block: u32) -> u64 {
        self.at + self.words() * (u64::from(block) % self.blocks)
    }
}

/// The words of a wave behind those that all waves have.
#[derive(Debug)]
pub(super) struct Room {
    pub(super) words: [u32; JOB_WORDS],
    /// What stands first behind the probes, and behind the lists of the queue.
    pub(super) lights: Vec<u32>,
    pub(super) free: Vec<u32>,
    /// Words of the states and of the queue, all together.
    pub(super) states: u64,
    pub(super) queue: u64,
    splats: Option<Splats>,
}

impl Room {
    /// Runs of words in which the sums of a block lie, to be set to 0 before its first sample and to be read after its last one: where and how many.
    pub(super) fn sums(&self, blocks: Range<u32>) -> Vec<(u64, u64)> {
        let run = |s: &Splats| blocks.map(|b| (s.of_block(b), s.words())).collect();
        self.splats.as_ref().map_or_else(Vec::new, run)
    }

    /// Adds what landed in a block to the means of its samples; `words` begins with the block's sums. What is left of them.
    pub(super) fn add<'a>(&self, means: &mut [[f64; 3]], words: &'a [u32], block_length: u32) -> &'a [u32] {
        let Some(splats) = &self.splats else { return words };
        let (own, rest) = words.split_at((splats.words() as usize).min(words.len()));
        for (mean, sums) in means.iter_mut().zip(own.as_chunks::<{ SUMS as usize }>().0) {
            let sums = [0, 3, 6].map(|k| saturated([sums[k], sums[k + 1], sums[k + 2]]));
            let landed = splats.unit.mean(&sums, block_length);
            for (m, x) in mean.iter_mut().zip(landed) {
                *m += x;
            }
        }
        rest
    }
}

/// A sum of three words, the lowest first, as far as 64 bits hold it.
fn saturated([low, middle, high]: [u32; 3]) -> i64 {
    let sum = i128::from(low) | i128::from(middle) << 32 | i128::from(high.cast_signed()) << 64;
    sum.clamp(i128::from(i64::MIN), i128::from(i64::MAX)) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_beyond_64_bits_are_clipped() {
        for (words, sum) in [
            ([5, 0, 0], 5),
            ([u32::MAX; 3], -1),
            ([0, 1, 0], 1 << 32),
            ([u32::MAX, 0x7fff_ffff, 0], i64::MAX),
            ([0, 0x8000_0000, 0], i64::MAX),
            ([0, 0, 1], i64::MAX),
            ([0, 0x8000_0000, u32::MAX], i64::MIN),
            ([u32::MAX, 0x7fff_ffff, u32::MAX], i64::MIN),
        ] {
            assert_eq!(saturated(words), sum, "{words:x?}");
        }
    }
}
