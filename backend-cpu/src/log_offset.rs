//! Log/offset codes of slices, in the widest registers that the machine has.
//!
//! Core's own loops, compiled twice: the codes and the numbers are core's.

use crate::simd::widest;
use etendue_core::codec::log_offset::{LogOffset, LogOffsetError, Quantiser};

widest! {
    /// [`Quantiser::encode`] of each number.
    ///
    /// # Errors
    /// [`LogOffsetError::Lengths`] unless the slices are equally long; nothing is written then.
    pub fn encode(map: &LogOffset, values: &[f32], codes: &mut [u8]) -> Result<(), LogOffsetError> {
        map.encode_slice(values, codes)
    }
}

widest! {
    /// [`Quantiser::decode`] of each code.
    ///
    /// # Errors
    /// As for [`encode`].
    pub fn decode(map: &LogOffset, codes: &[u8], values: &mut [f32]) -> Result<(), LogOffsetError> {
        map.decode_slice(codes, values)
    }
}
