//! One colour: the endpoints between which an entry lies nearest to it.

use super::palette::widen;
use super::score::Mode;

/// Endpoints whose entry two thirds (or half) of the way from the second is nearest to each value; the least far apart
/// among equals.
const fn table<const THIRDS: bool>(five: bool) -> [[u8; 2]; 256] {
    let last = if five { 31 } else { 63 };
    let mut out = [[0; 2]; 256];
    let mut error = [u32::MAX; 256];
    let mut a = 0;
    while a <= last {
        let mut b = 0;
        while b <= last {
            let (p, q) = (widen(a, five), widen(b, five));
            let entry = if THIRDS { (2 * p + q + 1) / 3 } else { (p + q).div_ceil(2) };
            // What entry serves which value: only values within 8 of it can have it as their nearest.
            let mut x = entry.saturating_sub(8);
            while x < 256 && x <= entry + 8 {
                let cost = x.abs_diff(entry) * 256 + a.abs_diff(b);
                if cost < error[x as usize] {
                    error[x as usize] = cost;
                    out[x as usize] = [a as u8, b as u8];
                }
                x += 1;
            }
            b += 1;
        }
        a += 1;
    }
    out
}

static THIRD5: [[u8; 2]; 256] = table::<true>(true);
static THIRD6: [[u8; 2]; 256] = table::<true>(false);
static HALF5: [[u8; 2]; 256] = table::<false>(true);
static HALF6: [[u8; 2]; 256] = table::<false>(false);

/// The codes of one channel for a constant value.
#[inline(always)]
pub(super) fn ends(x: u32, five: bool, mode: Mode) -> [u32; 2] {
    let table = match (mode, five) {
        (Mode::Four, true) => &THIRD5,
        (Mode::Four, false) => &THIRD6,
        (_, true) => &HALF5,
        (_, false) => &HALF6,
    };
    table[(x & 255) as usize].map(u32::from)
}
