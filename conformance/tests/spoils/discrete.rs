//! Wrong `discrete`: picks of pairs, their chances, and the words that walk along them.

use super::Mutant;
use etendue_core::kernel::{Kernel, evaluate};

/// One count as a probability.
const COUNT: f32 = 1.0 / 4_294_967_296.0;

/// Counts before an entry, as a float; the whole beyond the last one.
fn before(constants: &[u32], i: usize) -> f32 {
    constants.get(i).map_or(4_294_967_296.0, |c| *c as f32)
}

pub(crate) const MUTANTS: &[Mutant] = &[
    ("entries without counts are picked", Kernel::CdfPick, |constants, _, out| {
        // The first of those that begin at the same count instead of the last.
        let start = constants[out[0] as usize];
        out[0] = constants.partition_point(|c| *c < start) as u32;
    }),
    ("the next entry from one count early", Kernel::CdfPick, |constants, item, out| {
        if item[0] < u32::MAX {
            evaluate(Kernel::CdfPick, constants, &[item[0] + 1], out).expect("same lengths");
        }
    }),
    ("a picked chance from rounded sums", Kernel::CdfPick, |constants, _, out| {
        let i = out[0] as usize;
        out[1] = ((before(constants, i + 1) - before(constants, i)) * COUNT).to_bits();
    }),
    ("an index of 16 bits", Kernel::CdfPick, |_, _, out| out[0] &= 0xffff),
    ("the whole of the word as what is left of it", Kernel::CdfPick, |_, item, out| out[2] = item[0]),
    ("a chance from rounded sums", Kernel::CdfPmf, |constants, item, out| {
        let i = item[0] as usize;
        out[0] = ((before(constants, i + 1) - before(constants, i)) * COUNT).to_bits();
    }),
    ("a chance beyond the run", Kernel::CdfPmf, |constants, item, out| {
        let last = [item[0].min(constants.len() as u32 - 1)];
        evaluate(Kernel::CdfPmf, constants, &last, out).expect("same lengths");
    }),
    ("the shift of the whole for that of a part", Kernel::EvenWord, |_, item, out| {
        if (1..32).contains(&item[2]) {
            out[0] = (item[0] << (32 - item[2])) ^ item[1];
        }
    }),
    ("places in the low bits", Kernel::EvenWord, |_, item, out| {
        if (1..32).contains(&item[2]) {
            out[0] = item[1] << item[2] | item[0] & ((1 << item[2]) - 1);
        }
    }),
    ("a photon alone at the start", Kernel::EvenWord, |_, item, out| {
        if item[2] == 0 {
            out[0] = 0;
        }
    }),
    ("parts twice as long", Kernel::EvenWord, |_, item, out| {
        let mut wide = [item[0], item[1], item[2].saturating_sub(1)];
        wide[2] = wide[2].max(1);
        evaluate(Kernel::EvenWord, &[], &wide, out).expect("same lengths");
    }),
];
