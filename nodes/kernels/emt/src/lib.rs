//! Effective medium theory: forward models from microstructure to moduli, and their inversion.
//!
//! Implements Eqs. 10–18, 21 and 22 of La Ragione & Magnanimo, Phys. Rev. E 85, 031304 (2012). The inversion is closed,
//! or a root that is unique in its bracket; errors are propagated to first order. SI units at every
//! interface. The axis of anisotropy is e3; ε and g = γ/Δ are positive when there are more contacts, or more extension,
//! along it.
//!
//! - `moduli`, `conditions`, `probe`: what a microstructure is inferred from, at what state, and how it was measured
//! - `observation`, `estimate`, `note`, `error`: input and output of an inversion
//! - `model`, `point_estimate`, `domain`: the trait of the models, their result, and their range
//! - `registry`: the list of the models
//! - `models`: one file per model
//!   - `effective_medium`: the plain theory, at given pressure
//!   - `ratio`: the paper's model, corrected and as printed
//!   - `directional`: each modulus with its own coordination number
//!   - `relaxed`: the relaxed network
//!   - `free_contact`: the relaxed network with contacts that are not known
//!   - `hertz_mindlin`: a pack with contacts in all directions alike, as in rock physics
//! - `calibration`: the constants of the models; the crate `calibration` of the studio learns them from packings
//! - `moments`, `eq16`, `medium`, `invariants`: the theory that the models share
//! - `likelihood`, `estimate_likelihood`: the probability of moduli, as a model states it
//! - `posterior`: draws, evidence and predictive checks
//! - `prior`, `update`: prior knowledge, and estimates with it
//! - `series`: speeds of a sample over pressure, whose contacts are not known
//! - `propagation`: errors to first order
//! - [`christoffel`], [`WaveModuli`]: moduli from wave speeds
//!
//! ```
//! use grainlab_core::results::InferredQuantity;
//! use grainlab_emt::{Calibration, Observation, StrainRatio};
//! // The first row of the paper's Table III: k = 5.73, k_hat = 5.63, eps = 0.016.
//! let gamma = StrainRatio::given(-0.0623);
//! let s1 = Observation::from_g12_g13_theta(121.71e6, 127.37e6, 144.38e6, 50.0e3, gamma).with_relative_error(0.01);
//! let estimate = grainlab_emt::model("ratio").unwrap().infer(&s1, &Calibration::PAPER).unwrap();
//! let near = |found: Option<f64>, value: f64| (found.unwrap() - value).abs() < 1e-3;
//! assert!(near(estimate.structure.k, 5.73) && near(estimate.structure.k_hat, 5.63));
//! assert!(near(estimate.structure.eps, 0.016));
//! // Errors of the data alone: the model's own error is larger.
//! let k = InferredQuantity::K as usize;
//! assert!((estimate.data_covariance.unwrap()[(k, k)].sqrt() - 0.056).abs() < 1e-2);
//! ```

mod calibration;
mod checks;
pub mod christoffel;
mod conditions;
mod domain;
mod eq16;
mod error;
mod estimate;
mod estimate_likelihood;
mod invariants;
mod likelihood;
mod medium;
mod model;
mod models;
mod moduli;
mod moments;
mod normal;
mod observation;
mod point_estimate;
mod posterior;
mod prior;
mod prior_conflict;
mod probe;
mod propagation;
mod random;
mod registry;
mod series;
mod update;
mod wave_moduli;

pub use calibration::{
    Calibration, CalibrationError, DeviatorLaw, GROUPS, ISOSTATIC, IsotropicCalibration, ModelDiscrepancy,
    NetworkState, RESPONSE_STDDEV, RattlerLaw, Reach, RelaxationCalibration, SCATTERED, ScalingLaw, Scatter,
    ScatterLevels,
};
pub use checks::{ROUNDING, check_structure};
pub use conditions::{
    Conditions, Measured, StrainRatio, StrainRatioSource, UNKNOWN_SIZE_SPREAD, UNKNOWN_STRESS_RATIO,
};
pub use domain::{Domain, Fitted, Range};
pub use eq16::Eq16Reading;
pub use error::EmtError;
pub use estimate::{CREDIBLE_LEVEL, Inversion};
pub use invariants::Invariants;
pub use likelihood::{Likelihood, Predicted};
pub use medium::{Medium, MediumModuli};
pub use model::Model;
pub use models::free_contact::ROUGH_CONTACTS;
pub use models::relaxed::Relaxed;
pub use moduli::{MODULI, Moduli, ModuliCovariance, Modulus};
pub use moments::Moments;
pub use normal::HALF_WIDTH;
pub use observation::{INPUTS, Observation};
pub use point_estimate::{Jacobian, Misfit, PointEstimate};
pub use posterior::{Check, Draw, Draws, Evidence, ModulusCheck, Posterior, PosteriorSettings};
pub use prior::{Density, Prior, PriorError};
pub use probe::{NoProbe, Probe, ProbeErrors};
pub use registry::{free_contact, model, models, recommended};
pub use series::{
    ContactCorrections, ContactKind, ContactPrior, Doubted, Interval, LawEstimate, LeftOut, OTHER_CONTACTS,
    PreparationPrior, PressureEstimate, RowEstimate, SCATTER_TREND, SampleQuantity, Sensitivity,
    SeriesEstimate, SeriesPrior, SeriesRow, SpeedMode, SpeedSeries, infer_series, series_stddev,
    simulate_series,
};
pub use wave_moduli::WaveModuli;
