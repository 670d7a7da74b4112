//! Kernels of `bc1` and `bc4`.

use super::{Reader, Shared, Writer};
use crate::codec::{bc1, bc4};
use crate::kernel::Kernel;

pub(super) fn one(kernel: Kernel, shared: &Shared<'_>, mut r: Reader<'_>, w: &mut Writer<'_>) {
    let block = |r: &mut Reader<'_>| (u64::from(r.word()) | u64::from(r.word()) << 32).to_le_bytes();
    let put = |w: &mut Writer<'_>, block: [u8; 8]| {
        let bits = u64::from_le_bytes(block);
        w.words([bits as u32, (bits >> 32) as u32]);
    };
    match kernel {
        Kernel::Bc1Decode => {
            w.words(bc1::decode(block(&mut r)).map(|[r, g, b]| u32::from_le_bytes([r, g, b, 0])))
        }
        Kernel::Bc1DecodeWith => {
            let code = shared.constants.first().copied().unwrap_or(0);
            let rule = bc1::Rule::ALL.get(code as usize).copied().unwrap_or(bc1::Rule::Nearest);
            w.words(bc1::decode_with(block(&mut r), rule).map(u32::from_le_bytes));
        }
        Kernel::Bc1EncodeRangeFit => {
            let texels = [(); 16].map(|()| {
                let [r, g, b, _] = r.word().to_le_bytes();
                [r, g, b]
            });
            put(w, bc1::encode_range_fit(&texels, r.word()));
        }
        Kernel::Bc4Decode => w.words(bc4::decode(block(&mut r)).map(u32::from)),
        Kernel::Bc4EncodeRangeFit => {
            let texels = [(); 16].map(|()| r.word() as u8);
            put(w, bc4::encode_range_fit(&texels, r.word()));
        }
        _ => {}
    }
}
