//! Quantities measured on a packing, and inferred from it: one type for each, which kernels, messages and printers share.
//!
//! - [`ContactStatistics`]: coordination, rattlers, forces, mobilised friction
//! - [`Fabric`]: how contacts are oriented
//! - [`StressDecomposition`]: which forces and which contacts carry the stress
//! - [`StrainRatios`]: deviatoric over volumetric strain
//! - [`ElasticStiffness`]: the stiffness, its bounds, and how it was found
//! - [`PackingReport`]: all of it for one packing
//! - [`warnings()`]: doubts about a packing and its report
//! - [`Microstructure`]: what an inversion infers; [`Estimate`]: the result of one model
//!
//! Tensors are in the frame of the cell. h is the reference axis ([`Fabric::reference_axis`]), n a contact normal and
//! x = |n·h|. What is undefined (no contacts, no forces, no Coulomb limit) is `None`; tensors whose weights sum to nothing
//! are zero.

mod contact_statistics;
mod elastic_stiffness;
mod estimate;
mod fabric;
mod microstructure;
mod packing_report;
mod quantities;
mod spring_notes;
mod strain_ratios;
mod stress_decomposition;
mod warnings;

pub use contact_statistics::{
    ContactStatistics, FORCE_BIN_WIDTH, FORCE_BINS, ForceStatistics, MOBILISATION_BINS, MobilisedFriction,
};
pub use elastic_stiffness::{ElasticStiffness, Elasticity, NoStiffness, StiffnessBounds, StiffnessMethod};
pub use estimate::{Estimate, GammaUsed, Interval, Quantities};
pub use fabric::{
    Fabric, FourthOrderFabric, ORIENTATION_BINS, OrientationFit, OrientationHistogram, OverlapAnisotropyFit,
    PrincipalAxis, contact_anisotropy,
};
pub use microstructure::{INFERENCE_INPUTS, InferredQuantity, Microstructure, MicrostructureCovariance};
pub use packing_report::PackingReport;
pub use quantities::QUANTITIES;
pub use spring_notes::spring_notes;
pub use strain_ratios::StrainRatios;
pub use stress_decomposition::{StressDecomposition, StressForceFabric, SubNetwork};
pub use warnings::{geometry_warnings, report_warnings, warnings, yields};
