//! Structure and stiffness of a packing: fabric, coordination, and the moduli of the frozen contact network.
//!
//! [`analyse()`] is the one entry that node and command line share. The parts are public for those who need one alone:
//!
//! - [`mod@analyse`]: everything that is measured on one packing
//! - [`rattlers`]: who carries force
//! - [`fabric`]: coordination, fabric tensors, ε
//! - [`anisotropy`]: the three ratios γ/Δ
//! - [`balance`]: how far the packing is from equilibrium
//! - [`network`]: the frozen contact network as a linear operator, for any number of right-hand sides at once
//! - [`preconditioner`], [`mod@solve`]: conjugate gradients on the singular operator
//! - [`direct`]: the same by a sparse Cholesky factorisation
//! - [`stiffness`]: C = A − ΞᵀK⁺Ξ/V and the checks that every result must pass
//! - [`mod@probe`]: the same stiffness by straining the packing with the whole contact law; [`mod@column`] and [`relax`]
//!   serve it
//! - [`error`]: what can go wrong, typed

pub mod analyse;
pub mod anisotropy;
pub mod balance;
pub mod column;
mod descent;
pub mod direct;
pub mod error;
pub mod fabric;
mod lanes;
pub mod network;
pub mod preconditioner;
pub mod probe;
pub mod rattlers;
pub mod relax;
pub mod solve;
pub mod stiffness;
mod sweep;

pub use analyse::{Analysis, Settings, analyse};
pub use error::{MicroError, NoNetwork, ProbeError};
pub use network::{Motion, Network};
pub use probe::{Probe, ProbeResult, Sides, probe};
pub use solve::Solver;
