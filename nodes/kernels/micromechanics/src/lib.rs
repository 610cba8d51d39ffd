//! Structure and stiffness of a packing: fabric, coordination, and the moduli of the frozen contact network.
//!
//! [`analyse()`] is the one entry that node and command line share. The parts are public for those who need one alone:
//!
//! - [`mod@analyse`]: everything that is measured on one packing
//! - [`rattlers`]: who carries force
//! - [`fabric`]: coordination, fabric tensors, ε
//! - [`mod@structure`]: the rest of the structure, put together from the following
//! - [`axis`]: how far the principal axis of the fabric can be trusted
//! - [`mod@orientation`]: contacts and overlaps by orientation, A(d) fitted
//! - [`fourth_order`]: ⟨n n n n⟩
//! - [`mod@stress_parts`]: stress by kind of force and by network
//! - [`mod@stress_force_fabric`]: anisotropies of contacts and forces, and the stress they make
//! - [`mod@forces`]: distribution of forces, mobilised friction
//! - [`deviator`]: traceless tensors as five numbers
//! - [`symmetry`]: how much of a stiffness is the accident of one packing
//! - [`anisotropy`]: the three ratios γ/Δ
//! - [`balance`]: how far the packing is from equilibrium
//! - [`bounds`]: the stiffness with a mean spin, and a lower bound of the bulk modulus
//! - [`network`]: the frozen contact network as a linear operator, for any number of right-hand sides at once
//! - [`mod@solve`]: conjugate gradients on the singular operator, preconditioned by symmetric Gauss–Seidel with the grains'
//!   own blocks ([`preconditioner`])
//! - [`direct`]: the same by a sparse Cholesky factorisation
//! - [`stiffness`]: C = A − ΞᵀK⁺Ξ/V and the checks that every result must pass
//! - [`mod@probe`]: the same stiffness by straining the packing with the whole contact law; [`mod@column`] and [`relax`]
//!   serve it; [`mod@scan`]: over which strains it is linear
//! - [`error`]: what can go wrong, typed

pub mod analyse;
pub mod anisotropy;
pub mod axis;
pub mod balance;
pub mod bounds;
pub mod column;
mod descent;
pub mod deviator;
pub mod direct;
pub mod error;
pub mod fabric;
pub mod forces;
pub mod fourth_order;
mod lanes;
pub mod network;
pub mod orientation;
pub mod preconditioner;
pub mod probe;
pub mod rattlers;
pub mod relax;
pub mod scan;
pub mod solve;
pub mod stiffness;
pub mod stress_force_fabric;
pub mod stress_parts;
pub mod structure;
mod sweep;
pub mod symmetry;

pub use analyse::{Analysis, Settings, analyse};
pub use error::{MicroError, NoNetwork, ProbeError};
pub use network::{Link, Motion, Network};
pub use probe::{Probe, ProbeResult, Sides, probe};
pub use solve::Solver;
