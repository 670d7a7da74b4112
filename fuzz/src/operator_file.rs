//! Operator files, as they are and with their lengths and checksums put right: what lies behind those is to be reached.

use etendue::io::{encode_operator, parse_operator};
use std::path::Path;

/// What is read can be written, and comes back as it is.
pub fn operator_file(bytes: &[u8]) {
    let file = Path::new("a.etd");
    for bytes in [bytes.to_vec(), resealed(bytes)] {
        let Ok(read) = parse_operator(&bytes, file) else { continue };
        let written = encode_operator(&read, file).expect("what was read can be written");
        let again = parse_operator(&written, file).expect("what was written can be read");
        assert!(again == read, "another operator came back");
        assert!(
            encode_operator(&again, file).is_ok_and(|b| b == written),
            "other bytes of the same operator"
        );
    }
}

/// The same with sections laid out as they claim to be long, and with checksums of what they hold.
fn resealed(bytes: &[u8]) -> Vec<u8> {
    const WORD: usize = 64;
    let mut out = bytes.to_vec();
    if out.len() < WORD {
        return out;
    }
    out[..8].copy_from_slice(b"etendue\0");
    out[8..12].copy_from_slice(&1_u32.to_le_bytes());
    out[24..32].fill(0);
    let count = u32::from_le_bytes([out[12], out[13], out[14], out[15]]) as usize % (out.len() / WORD);
    out[12..16].copy_from_slice(&(count as u32).to_le_bytes());
    let mut end = WORD * (1 + count);
    for i in 0..count {
        let entry = WORD * (1 + i);
        let start = end.next_multiple_of(WORD);
        let claimed = u64::from_le_bytes(std::array::from_fn(|k| out[entry + 16 + k]));
        // The last section takes what there is, so that lengths of sections may change.
        let rest = out.len().saturating_sub(start);
        let size = if i + 1 == count { rest } else { rest.min(claimed as usize) };
        out.resize(out.len().max(start), 0);
        out[end..start].fill(0);
        end = start + size;
        let hash = blake3::hash(&out[start..end]);
        out[entry + 8..entry + 16].copy_from_slice(&(start as u64).to_le_bytes());
        out[entry + 16..entry + 24].copy_from_slice(&(size as u64).to_le_bytes());
        out[entry + 24] &= 1;
        out[entry + 25..entry + 32].fill(0);
        out[entry + 32..entry + 64].copy_from_slice(hash.as_bytes());
    }
    out.truncate(end);
    let length = out.len() as u64;
    out[16..24].copy_from_slice(&length.to_le_bytes());
    let mut hash = blake3::Hasher::new();
    hash.update(&out[..32]);
    hash.update(&out[WORD..WORD * (1 + count)]);
    let seal = *hash.finalize().as_bytes();
    out[32..64].copy_from_slice(&seal);
    out
}
