//! What shaders of photons ask of a job: a few numbers in a uniform, and tables behind the states.

use crate::session::elements::ElementBuffers;
use crate::session::scene::light_media_words;
use bytemuck::{Pod, Zeroable};
use etendue_core::backend::{PhotonJob, PhotonStart};
use etendue_core::geometry::HilbertGrid;
use etendue_core::illumination::{Basis, FluxUnit, Sides};
use etendue_core::light::emit;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::first_shot::{FirstShot, FirstShotParts};
use etendue_core::transport::photon::{LightPlan, Replicate, Sequence};
use etendue_core::transport::volume::LightMedia;

/// The numbers of a job, as `wavefront/photons/job.wgsl` has them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub(super) struct Numbers {
    pub(super) seed: [u32; 2],
    pub(super) replicate: u32,
    pub(super) slots: u32,
    pub(super) count: u32,
    pub(super) first: u32,
    pub(super) window: u32,
    pub(super) flags: u32,
    pub(super) shift: u32,
    pub(super) bits: u32,
    pub(super) max_hits: u32,
    pub(super) elements_at: u32,
    pub(super) nodes: u32,
    pub(super) per_side: u32,
    pub(super) elements: u32,
    pub(super) power: i32,
    pub(super) plan_at: u32,
    pub(super) plan_count: u32,
    pub(super) group: u32,
    pub(super) offset: u32,
    pub(super) sphere: [f32; 4],
    pub(super) grid: [f32; 4],
    pub(super) lists: u32,
    pub(super) shot_at: u32,
    pub(super) pieces: u32,
    pub(super) entries: u32,
    pub(super) media_at: u32,
    pub(super) media_count: u32,
    pub(super) glows_at: u32,
    pub(super) glows: u32,
    pub(super) zero: u32,
    pub(super) pad: [u32; 3],
}

/// Words of [`Numbers`].
pub(super) const JOB_WORDS: usize = size_of::<Numbers>() / 4;

/// Where tables lie behind the rows of states, and what they hold beside the elements.
#[derive(Debug)]
pub(super) struct Tables {
    /// Words of the elements, which a buffer of their own has, and where they begin.
    pub(super) elements_at: u64,
    element_words: u64,
    /// All other words, behind them.
    pub(super) words: Vec<u32>,
    pub(super) numbers: Numbers,
}

impl Tables {
    /// Tables behind `rows` words of `slots` states.
    pub(super) fn new(
        (scene, media): (&CompiledScene, &LightMedia),
        plan: &LightPlan,
        buffers: &ElementBuffers,
        (job, unit, caustics): (&PhotonJob, FluxUnit, bool),
        shot: Option<&FirstShot>,
        (rows, slots): (u64, u64),
    ) -> Self {
        let elements = &buffers.elements;
        let settings = elements.settings();
        let (counts, (centre, radius)) = plan.parts();
        let (low, scale) = HilbertGrid::new(&scene.bounds).parts();
        let mut words = counts.to_vec();
        let tables_at = rows + buffers.word_count;
        let shot_at = tables_at as u32 + words.len() as u32;
        let (pieces, entries) = shot.map_or((0, 0), |shot| {
            let parts = shot.parts();
            words.extend(shot_words(shot, &parts));
            (shot.pairs() as u32, parts.entries.len() as u32)
        });
        let media_at = tables_at as u32 + words.len() as u32;
        words.extend(media.outside().packed());
        let lights = if scene.needs.media { scene.lights.len() } else { 0 };
        words.extend((0..lights).flat_map(|light| light_media_words(media, light)));
        let glows_at = tables_at as u32 + words.len() as u32;
        for (glow, index) in scene.glows.iter().zip(scene.lights.len() + 1..) {
            words.push(u32::from(glow.medium));
            for v in [glow.bounds.lo, glow.bounds.hi, emit::entry_flux(scene, index)] {
                words.extend(v.to_array().map(f32::to_bits));
            }
        }
        let (direct, first) = match job.start {
            PhotonStart::Lights { registers_direct, survives_first } => (registers_direct, survives_first),
            PhotonStart::Surfaces { .. } => (false, false),
        };
        let flags = [
            job.sequence == Sequence::Random,
            plan.has_choice(),
            direct,
            first,
            settings.basis == Basis::Linear,
            settings.sides == Sides::Apart,
            caustics,
        ];
        let numbers = Numbers {
            seed: [job.seed as u32, (job.seed >> 32) as u32],
            slots: slots as u32,
            flags: flags.iter().zip(0..).map(|(f, i)| u32::from(*f) << i).sum(),
            max_hits: job.max_hits,
            elements_at: rows as u32,
            nodes: buffers.nodes,
            per_side: elements.per_side() as u32,
            elements: elements.count() as u32,
            // There is one: numbers of photons are powers of two.
            power: unit.power().unwrap_or(0),
            plan_at: tables_at as u32,
            plan_count: counts.len() as u32,
            sphere: [centre.x, centre.y, centre.z, radius],
            grid: [low.x, low.y, low.z, scale],
            shot_at,
            pieces,
            entries,
            media_at,
            media_count: lights as u32,
            glows_at,
            glows: scene.glows.len() as u32,
            ..Numbers::default()
        };
        Self { elements_at: rows, element_words: buffers.word_count, words, numbers }
    }

    /// Words of states and tables together.
    pub(super) fn end(&self) -> u64 {
        self.words_at() + self.words.len() as u64
    }

    /// Where all but the elements begins.
    pub(super) fn words_at(&self) -> u64 {
        self.elements_at + self.element_words
    }

    /// The numbers of a replicate.
    pub(super) fn replicate(&mut self, number: u32, replicate: &Replicate) {
        let (shift, bits) = replicate.even().unwrap_or((0, 0));
        self.numbers = Numbers { replicate: number, shift, bits, ..self.numbers };
    }
}

/// Words of the first shot before its tables.
const SHOT_HEAD: usize = 10;

/// The tables of a first shot, as `wavefront/photons/shot.wgsl` has them.
fn shot_words(shot: &FirstShot, parts: &FirstShotParts<'_>) -> Vec<u32> {
    let mut words = vec![0; SHOT_HEAD];
    let mut at = Vec::with_capacity(SHOT_HEAD);
    let per_watt: Vec<u32> = parts.per_watt.iter().map(|x| x.to_bits()).collect();
    for table in [parts.ranges, parts.ranks, parts.slots, &per_watt] {
        at.push(words.len() as u32);
        words.extend(table);
    }
    at.push(words.len() as u32);
    for piece in shot.pieces() {
        words.extend([piece.triangle, piece.light]);
        for [_, b1, b2] in piece.corners.map(|c| c.steps()) {
            words.extend([b1, b2]);
        }
        let [a, b, c] = piece.weights;
        words.extend([a, b, c, piece.area, piece.looks].map(f32::to_bits));
    }
    at.push(words.len() as u32);
    words.extend(parts.entries.iter().flat_map(|(light, shared)| [*light, u32::from(*shared)]));
    at.push(words.len() as u32);
    words.extend(parts.cumulative);
    at.extend([parts.ranks.len() as u32, parts.slots.len() as u32, u32::from(parts.exact)]);
    words[..SHOT_HEAD].copy_from_slice(&at);
    words
}
