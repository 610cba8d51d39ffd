//! Length prefixes are not trusted.

use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::msg::{Microstructure, Packing, Waveform};
use grainlab_msgs::{Message, from_cdr, to_cdr};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

struct Largest;

static LARGEST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is passed unchanged to the allocator of the system.
unsafe impl GlobalAlloc for Largest {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LARGEST.fetch_max(layout.size(), Relaxed);
        // SAFETY: the caller guarantees the conditions of `System`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above; `pointer` came from `System`.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        LARGEST.fetch_max(size, Relaxed);
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Largest = Largest;

/// Every aligned word of a small message in turn becomes a length of four billion elements.
#[test]
fn an_absurd_length_reserves_no_memory() {
    LARGEST.store(0, Relaxed);
    absurd::<Packing>();
    absurd::<Microstructure>();
    absurd::<Waveform>();
    absurd::<DiagnosticArray>();
    // The messages and the texts of their errors have some 300 bytes; memory for a false length would be
    // gigabytes.
    let largest = LARGEST.load(Relaxed);
    assert!(largest < 100_000, "{largest} bytes in one piece");
}

fn absurd<T: Message + Default>() {
    let good = to_cdr(&T::default());
    let mut truncated = 0;
    for at in (4..good.len() - 3).step_by(4) {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&[0xff; 4]);
        let fault = from_cdr::<T>(&bytes).err();
        truncated += usize::from(fault.is_some_and(|e| e.problem.contains("end within the message")));
    }
    assert!(truncated > 0, "{} has sequences or strings", T::TYPE);
}
