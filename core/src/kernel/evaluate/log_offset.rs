//! Kernels of `log_offset`.

use super::{Reader, Shared, Writer};
use crate::codec::log_offset::{mean_at, search_in, value_at};
use crate::kernel::Kernel;

pub(super) fn one(kernel: Kernel, shared: &Shared<'_>, mut r: Reader<'_>, w: &mut Writer<'_>) {
    use Kernel as K;
    let mut c = Reader(shared.constants);
    match kernel {
        K::LogOffsetEncode => {
            // The words as they are: copying the thresholds would cost more than searching them.
            let thresholds = bytemuck::cast_slice::<u32, f32>(shared.constants);
            if let Some(thresholds) = thresholds.first_chunk() {
                w.word(u32::from(search_in(thresholds, r.float())));
            }
        }
        K::LogOffsetLookUp => {
            let code = (r.word() & 255) as usize;
            w.word(shared.constants.get(code).copied().unwrap_or(0));
        }
        K::LogOffsetDecode => w.float(value_at(c.float(), c.float(), r.float())),
        K::LogOffsetDecodeMean => w.float(mean_at(c.float(), c.float(), r.float())),
        _ => {}
    }
}
