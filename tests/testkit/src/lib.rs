//! What tests of the kernels share.
//!
//! - [`Random`]: random numbers, the same in every run
//! - [`golden`]: files, tables and packings of `tests/golden`
//! - [`packings`]: packings that need no simulation, and the contacts of a packing by brute force
//! - [`engine`]: grains in motion, and packings that they came to rest in

pub mod engine;
pub mod golden;
pub mod packings;
mod random;

pub use random::Random;

/// Returns `all` if `GRAINLAB_NIGHTLY` is set, as by `.ci/nightly`, and else `few`: the size of an ensemble that takes minutes.
pub fn nightly<T>(few: T, all: T) -> T {
    if std::env::var_os("GRAINLAB_NIGHTLY").is_some() { all } else { few }
}
