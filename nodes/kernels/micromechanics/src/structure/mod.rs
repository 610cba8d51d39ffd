//! Structure of a packing: contacts, their orientation, and their stress.
//!
//! - [`contact_statistics()`]: coordination, rattlers, forces, mobilised friction
//! - [`fabric()`]: fabric tensors and ε; [`principal_axis()`]: its axis and how well it is known;
//!   [`orientation_histogram`], [`orientation_fit`]: A(d); [`fourth_order_fabric`]
//! - [`stress_decomposition()`]: by kind of force and by network; [`stress_force_fabric()`]: by anisotropies
//! - [`strain_ratio`], [`total_strain_ratio`], [`overlap_anisotropy_fit`]: the ratios γ/Δ
//! - [`deviator`]: traceless tensors as five numbers

mod contact_statistics;
pub mod deviator;
mod fabric;
mod fourth_order;
mod orientation;
mod principal_axis;
mod strain_ratios;
mod stress_decomposition;
mod stress_force_fabric;

pub use contact_statistics::contact_statistics;
pub use fabric::fabric;
pub use fourth_order::fourth_order_fabric;
pub use orientation::{orientation_fit, orientation_histogram};
pub use principal_axis::{fabric_stddev, principal_axis};
pub use strain_ratios::{overlap_anisotropy_fit, strain_ratio, total_strain_ratio};
pub use stress_decomposition::stress_decomposition;
pub use stress_force_fabric::stress_force_fabric;
