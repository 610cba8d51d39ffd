//! Effective medium theory: forward models from microstructure to moduli, and their inversion.
//!
//! Implements Eqs. 10–18, 21 and 22 of La Ragione & Magnanimo, Phys. Rev. E 85, 031304 (2012), and inverts them in
//! closed form, or by a root that its bracket makes unique, with errors propagated to first order or by sampling. SI at
//! every interface. The axis of anisotropy is e3; ε and g = γ/Δ are positive when there is more (of contacts, of
//! extension) along it.
//!
//! - [`structure`], [`moduli`], [`conditions`]: what is inferred, what it is inferred from, and at what state
//! - [`observation`], [`estimate`], [`warning`], [`error`]: what goes into an inversion and what comes out
//! - [`mod@model`], [`domain`]: what a model is, where it lives, and the list of them
//! - [`mod@calibration`]: what packings have taught the models
//! - [`moments`], [`form`]: the tensor that every modulus is made of; the printed equations against the corrected ones
//! - [`medium`]: absolute moduli of the effective medium
//! - [`effective`]: the plain theory, with the pressure closing the strain
//! - [`mod@christoffel`], [`WaveModuli`]: moduli from the speeds of waves
//! - [`ratio`]: the paper's model, corrected, as printed, and at the same volume
//! - [`full`], [`sqrt`](mod@sqrt): the same with K_N ≠ K_T, and with the overlap law not linear in g
//! - [`directional`]: each modulus by a coordination number of its own
//! - [`invariants`], [`relaxed`]: our own model, and the parts of a stiffness that it rests on
//! - [`sampling`]: the distribution of what is inferred, where errors are too large for slopes
//!
//! ```
//! use grainlab_emt::{Calibration, Gamma, Observation, Quantity};
//! // The first row of the paper's Table III: k = 5.73, k_hat = 5.63, eps = 0.016.
//! let s1 = Observation::paper(121.71e6, 127.37e6, 144.38e6, 50.0e3, Gamma::given(-0.0623)).with_relative_error(0.01);
//! let estimate = grainlab_emt::model("ratio").unwrap().infer(&s1, &Calibration::PAPER).unwrap();
//! let near = |found: Option<f64>, value: f64| (found.unwrap() - value).abs() < 1e-3;
//! assert!(near(estimate.structure.k, 5.73) && near(estimate.structure.k_hat, 5.63));
//! assert!(near(estimate.structure.eps, 0.016));
//! assert!((estimate.stddev(Quantity::K).unwrap() - 0.056).abs() < 1e-2);
//! ```

pub mod calibration;
pub mod christoffel;
pub mod conditions;
pub mod directional;
pub mod domain;
pub mod effective;
mod equivalent;
pub mod error;
pub mod estimate;
pub mod form;
pub mod full;
pub mod invariants;
pub mod medium;
pub mod model;
pub mod moduli;
pub mod moments;
pub mod observation;
mod propagation;
pub mod ratio;
pub mod relaxed;
mod root;
pub mod sampling;
pub mod sqrt;
pub mod structure;
pub mod warning;
mod wave_moduli;

pub use calibration::{Calibration, CalibrationError, Isotropic, Sample, learn};
pub use christoffel::ChristoffelError;
pub use conditions::{Conditions, Gamma, GammaSource, Measured};
pub use domain::Domain;
pub use error::EmtError;
pub use estimate::{CREDIBLE_LEVEL, Estimate, Status};
pub use form::Form;
pub use invariants::Invariants;
pub use medium::{Medium, Psi};
pub use model::{Misfit, Model, Slopes, Solution, model, models};
pub use moduli::{MODULI, Moduli, ModuliCovariance, Modulus};
pub use moments::Moments;
pub use observation::{INPUT_NAMES, INPUTS, Observation};
pub use sampling::{Samples, sample};
pub use structure::{QUANTITIES, Quantity, Structure, StructureCovariance};
pub use warning::Warning;
pub use wave_moduli::WaveModuli;
