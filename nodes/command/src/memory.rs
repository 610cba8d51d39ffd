//! Settings of the memory allocator.

/// Largest number of heaps.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const HEAPS: libc::c_int = 2;

/// Allocations of this size, and free memory of this size at the end of a heap, return to the system when freed, bytes.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const RETURNED: libc::c_int = 1 << 20;

/// Bounds what the allocator keeps for itself: with a heap for each thread, a process that runs for days grows by the
/// largest backlog of each of its DDS threads. Other allocators keep their settings.
pub(crate) fn bound() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    for (setting, value) in
        [(libc::M_ARENA_MAX, HEAPS), (libc::M_TRIM_THRESHOLD, RETURNED), (libc::M_MMAP_THRESHOLD, RETURNED)]
    {
        // SAFETY: mallopt takes two integers; no other thread runs yet. Failure leaves the default, which is correct.
        unsafe { libc::mallopt(setting, value) };
    }
}
