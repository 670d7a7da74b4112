//! Large pages for large arrays: a walk jumps about, and with small pages most of its loads also look up a page.

/// Smallest array worth asking for, in bytes; the size of a large page.
#[cfg(target_os = "linux")]
const LARGE: usize = 1 << 21;

/// The same items in memory for which the system was asked for large pages, where it has them. It may refuse; nothing but
/// speed depends on it.
pub(super) fn in_large_pages<T: Copy>(items: Vec<T>) -> Vec<T> {
    #[cfg(target_os = "linux")]
    if size_of_val(&*items) >= LARGE {
        // With room to spare, so that a whole number of large pages lies within.
        let mut moved = Vec::<T>::with_capacity(items.len() + LARGE.div_ceil(size_of::<T>()));
        let start = moved.as_ptr().addr();
        let first = start.next_multiple_of(LARGE);
        let length = (moved.capacity() * size_of::<T>()).saturating_sub(first - start) / 4096 * 4096;
        let address = moved.as_mut_ptr().cast::<u8>().wrapping_add(first - start);
        // SAFETY: the range lies within the vector's own allocation and starts at a page; the advice changes no content.
        #[expect(unsafe_code, reason = "the system's call")]
        unsafe {
            libc::madvise(address.cast(), length, libc::MADV_HUGEPAGE);
        }
        moved.extend_from_slice(&items);
        return moved;
    }
    items
}
