//! Instruction sets: the same arithmetic in one, four or eight lanes.
//!
//! - `lanes`: arithmetic, all that a contact law needs
//! - `simd_f64`: access to blocks of pairs and tables of grains
//! - `scalar`, `x86`: the widths
//! - `kernel`, `instruction_set`: work compiled for each, and the choice at run time

pub(crate) mod instruction_set;
pub(crate) mod kernel;
pub(crate) mod lanes;
mod scalar;
pub(crate) mod simd_f64;
#[cfg(target_arch = "x86_64")]
mod x86;
