//! Four and eight lanes on x86-64 processors.

mod memory;
mod registers;
mod shuffle;

pub(super) use registers::{Avx2, Avx512};
