//! The frozen contact network as a linear operator, its solution, and the stiffness that follows.
//!
//! - [`SpringNetwork`]: grains and springs as an operator for any number of right-hand sides at once
//! - [`solve()`]: conjugate gradients on the singular operator, preconditioned by symmetric Gauss–Seidel with the grains'
//!   own blocks ([`generalised_inverse`]); the softest motions of a few neighbours are solved for directly
//! - [`relaxed_stiffness()`]: C = A − ΞᵀK⁺Ξ/V and its checks
//! - [`uniform_rotation_stiffness`], [`bulk_reuss_bound`]: closed forms above and below it

mod bounds;
mod conjugate_gradient;
mod gauss_seidel;
mod lanes;
mod preconditioner;
mod relaxed_stiffness;
mod soft_motions;
mod solve;
mod spring_network;

pub use bounds::{bulk_reuss_bound, uniform_rotation_stiffness};
pub use preconditioner::{Block, generalised_inverse};
pub use relaxed_stiffness::{NetworkStiffness, relaxed_stiffness};
pub use solve::{Solution, solve};
pub use spring_network::{ContactSpring, GrainDofs, SpringNetwork, Springs};
