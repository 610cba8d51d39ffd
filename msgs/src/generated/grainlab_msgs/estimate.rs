// Generated from msg/Estimate.msg by examples/generate; not edited by hand.

use crate::message::{Message, definition};
use serde::{Deserialize, Serialize};

/// What one model infers. What is known holds for STATUS_OK and STATUS_EXTRAPOLATED; else nothing is, and all of it is 0.
/// Arrays have the quantities in the order k, k_hat, z, eps, eps_stiffness; entries of those that are not known are 0.
/// The columns of information are G12, G13, Theta, C11, C33, C13, pressure, gamma/Delta, solid fraction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// for example "ratio"
    pub model: String,
    /// name of the calibration
    pub calibration: String,
    /// one of STATUS_\*
    pub status: u8,
    /// strain ratio that the model was fed with, whatever the status; 0 if it takes none
    pub gamma_over_delta: f64,
    /// total, elastic, contact: as measured; given; zero: not known, taken as 0; none: the model takes none
    pub gamma_over_delta_source: String,
    /// whether the next field is valid
    pub k_known: bool,
    /// coordination number, 2 contacts / grains
    pub k: f64,
    /// whether the next field is valid
    pub k_hat_known: bool,
    /// that of the equivalent isotropic packing, in the calibration's sense
    pub k_hat: f64,
    /// whether the next field is valid
    pub z_known: bool,
    /// coordination number without rattlers
    pub z: f64,
    /// whether the next field is valid
    pub eps_known: bool,
    /// anisotropy of the number of contacts about the axis
    pub eps: f64,
    /// whether the next field is valid
    pub eps_stiffness_known: bool,
    /// the same with every contact weighted by its normal stiffness
    pub eps_stiffness: f64,
    /// of the five, from data and model, row-major, all 0 = unknown
    pub covariance: [f64; 25],
    /// the part of it that the model leaves out, learned from packings, all 0 = unknown
    pub covariance_model: [f64; 25],
    /// credible bounds, low and high of each of the five
    pub interval: [f64; 10],
    /// probability inside each interval, 0 = no interval
    pub credible_level: f64,
    /// misfit by the errors of data and model, 0 if as many data as unknowns
    pub chi_square: f64,
    /// data less unknowns, 0 = as many data as unknowns
    pub degrees_of_freedom: u32,
    /// how much more one combination suffers from errors of the data than another, 0 = unknown
    pub condition_number: f64,
    /// share of each datum in the variance that the data cause, a row per quantity, all 0 = unknown
    #[serde(with = "crate::fixed_array")]
    pub information: [f64; 45],
    /// for a reader, empty if there is nothing to say
    pub warnings: Vec<String>,
}

impl Estimate {
    /// inside the range the model was made for
    pub const STATUS_OK: u8 = 0;

    /// a solution outside that range
    pub const STATUS_EXTRAPOLATED: u8 = 1;

    /// the data do not determine the answer
    pub const STATUS_UNDETERMINED: u8 = 2;

    /// no solution
    pub const STATUS_FAILED: u8 = 3;
}

impl Default for Estimate {
    fn default() -> Self {
        Self {
            model: Default::default(),
            calibration: Default::default(),
            status: Default::default(),
            gamma_over_delta: Default::default(),
            gamma_over_delta_source: Default::default(),
            k_known: Default::default(),
            k: Default::default(),
            k_hat_known: Default::default(),
            k_hat: Default::default(),
            z_known: Default::default(),
            z: Default::default(),
            eps_known: Default::default(),
            eps: Default::default(),
            eps_stiffness_known: Default::default(),
            eps_stiffness: Default::default(),
            covariance: Default::default(),
            covariance_model: Default::default(),
            interval: Default::default(),
            credible_level: Default::default(),
            chi_square: Default::default(),
            degrees_of_freedom: Default::default(),
            condition_number: Default::default(),
            information: [f64::default(); 45],
            warnings: Default::default(),
        }
    }
}

impl Message for Estimate {
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Estimate";
    const TYPE: &'static str = "grainlab_msgs/msg/Estimate";
    const HASH: &'static str = "RIHS01_6559e3dd339323d88c0b186339ffcf1f7819923c3ec691e7749b58e4d3b46f82";
    const DEFINITION: &'static str = definition!("msg/Estimate.msg");
}
