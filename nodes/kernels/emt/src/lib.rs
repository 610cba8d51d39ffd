//! Effective medium theory: forward models from microstructure to moduli, and their inversion.
//!
//! Implements Eqs. 10–18, 21 and 22 of La Ragione & Magnanimo, Phys. Rev. E 85, 031304 (2012), and inverts them in
//! closed form with first-order error propagation. SI at every interface. The axis of anisotropy is e3; ε and
//! g = γ/Δ are positive when there is more (of contacts, of extension) along it.
//!
//! - [`moments`]: the tensor that every modulus is made of
//! - [`form`]: the printed equations against the corrected ones
//! - [`medium`]: absolute moduli of the effective medium
//! - [`calibration`]: moduli of isotropic packings
//! - [`observation`], [`estimate`], [`error`]: what goes into an inversion and what comes out
//! - [`mod@model`]: what a model is, and the list of them
//! - [`ratio`]: the paper's model, corrected and as printed
//!
//! ```
//! use emt::{Calibration, Gamma, Observation};
//! // The first row of the paper's Table III: k = 5.73, k_hat = 5.63, eps = 0.016.
//! let s1 = Observation::new(121.71e6, 127.37e6, 144.38e6, 50.0e3, Gamma::given(-0.0623)).with_relative_error(0.01);
//! let estimate = emt::model("ratio").unwrap().infer(&s1, &Calibration::PAPER).unwrap();
//! assert!((estimate.structure.k - 5.73).abs() < 1e-3 && (estimate.structure.k_hat - 5.63).abs() < 1e-3);
//! assert!((estimate.structure.eps - 0.016).abs() < 1e-3);
//! assert!((estimate.stddev().unwrap()[0] - 0.056).abs() < 1e-2);
//! ```

pub mod calibration;
pub mod error;
pub mod estimate;
pub mod form;
pub mod medium;
pub mod model;
pub mod moments;
pub mod observation;
pub mod ratio;

pub use calibration::{Calibration, CalibrationError};
pub use error::EmtError;
pub use estimate::{CREDIBLE_LEVEL, Estimate, Status, Structure, Warning};
pub use form::Form;
pub use medium::{Medium, Psi};
pub use model::{Model, infer_all, model, models};
pub use moments::Moments;
pub use observation::{Gamma, GammaSource, Observation};
