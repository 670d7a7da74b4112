//! Links `etendue-core` into a program without std. A static library is a final artefact, so its
//! panic handler must be the only one: std anywhere among the dependencies brings a second, E0152.
#![no_std]

#[cfg(feature = "leak_std")]
extern crate std;

use core::alloc::{GlobalAlloc, Layout};
use core::cell::UnsafeCell;
use core::panic::PanicInfo;
use core::ptr;
use core::sync::atomic::{AtomicUsize, Ordering};

const HEAP: usize = 1 << 16;

/// Hands out memory once and never takes it back.
#[repr(align(16))]
struct Bump {
    memory: UnsafeCell<[u8; HEAP]>,
    used: AtomicUsize,
}

// SAFETY: `used` hands out disjoint ranges of `memory`.
unsafe impl Sync for Bump {}

// SAFETY: every block lies inside `memory`, is aligned as asked and overlaps no other.
unsafe impl GlobalAlloc for Bump {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let base = self.memory.get() as usize;
        let mut taken = 0;
        let fits = self.used.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |used| {
            taken = ((base + used + layout.align() - 1) & !(layout.align() - 1)) - base;
            taken.checked_add(layout.size()).filter(|&end| end <= HEAP)
        });
        if fits.is_err() {
            return ptr::null_mut();
        }
        // SAFETY: taken + size <= HEAP.
        unsafe { self.memory.get().cast::<u8>().add(taken) }
    }

    unsafe fn dealloc(&self, _: *mut u8, _: Layout) {}
}

#[global_allocator]
static ALLOCATOR: Bump = Bump { memory: UnsafeCell::new([0; HEAP]), used: AtomicUsize::new(0) };

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {}
}

/// Uses functions and allocations of core, so that linking is real.
#[unsafe(no_mangle)]
pub extern "C" fn etendue_probe(x: f32) -> f32 {
    let mesh = etendue_core::scene::MeshDesc {
        positions: [[x, 0.0, 0.0], [0.0, x, 0.0], [0.0, 0.0, x]].into(),
        ..Default::default()
    };
    mesh.positions.iter().map(|p| p[0] + p[1] + p[2]).sum()
}
