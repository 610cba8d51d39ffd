// Generated from msg/Estimate.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// What one model infers. Numbers hold unless the status is STATUS_UNKNOWN. What may be missing is an array of one entry, or of none.
/// Arrays have the quantities in the order k, k_hat, z, eps, eps_stiffness.
/// The columns of information are G12, G13, Theta, C11, C33, C13, pressure, gamma/Delta, solid fraction, q/p, size spread, grain shear
/// modulus, grain Poisson ratio.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// for example "ratio"
    pub model: String,
    /// name of the calibration
    pub calibration: String,
    /// one of STATUS_\*
    pub status: u8,
    /// strain ratio that the model was fed with, whatever the status; none if it takes none
    pub gamma_over_delta: Vec<f64>,
    /// total, elastic, contact: as measured; given; zero: not known, taken as 0; none: the model takes none
    pub gamma_over_delta_source: String,
    /// coordination number, 2 contacts / grains
    pub k: Vec<f64>,
    /// that of the equivalent isotropic packing, in the calibration's sense
    pub k_hat: Vec<f64>,
    /// coordination number without rattlers
    pub z: Vec<f64>,
    /// anisotropy of the number of contacts about the axis
    pub eps: Vec<f64>,
    /// the same with every contact weighted by its normal stiffness
    pub eps_stiffness: Vec<f64>,
    /// of the five, from data and model, row-major, 25 or none; 0 where a quantity is not known
    pub covariance: Vec<f64>,
    /// the part of it that the model leaves out, learned from packings, 25 or none
    pub covariance_model: Vec<f64>,
    /// credible bounds, low and high of each of the five, 10 or none; 0 where a quantity is not known
    pub interval: Vec<f64>,
    /// probability inside each interval, 0 = no interval
    pub credible_level: f64,
    /// misfit by the errors of data and model, 0 if as many data as unknowns
    pub chi_square: f64,
    /// data less unknowns, 0 = as many data as unknowns
    pub degrees_of_freedom: u32,
    /// how much more one combination suffers from errors of the data than another
    pub condition_number: Vec<f64>,
    /// share of each datum in the variance that the data cause, a row per quantity, all 0 = unknown
    #[serde(with = "crate::fixed_array")]
    pub information: [f64; 65],
    /// for a reader, empty if there is nothing to say
    pub warnings: Vec<String>,
}

impl Estimate {
    /// all unknowns of the model, inside the range it was made for
    pub const STATUS_OK: u8 = 0;

    /// outside that range, or some unknowns of the model alone: the reason is in warnings
    pub const STATUS_EXTRAPOLATED: u8 = 1;

    /// the data contradict each other or the model: the reason is in warnings
    pub const STATUS_CONTRADICTORY: u8 = 2;

    /// no answer: the reason is in warnings
    pub const STATUS_UNKNOWN: u8 = 3;
}

impl Default for Estimate {
    fn default() -> Self {
        Self {
            model: Default::default(),
            calibration: Default::default(),
            status: Default::default(),
            gamma_over_delta: Default::default(),
            gamma_over_delta_source: Default::default(),
            k: Default::default(),
            k_hat: Default::default(),
            z: Default::default(),
            eps: Default::default(),
            eps_stiffness: Default::default(),
            covariance: Default::default(),
            covariance_model: Default::default(),
            interval: Default::default(),
            credible_level: Default::default(),
            chi_square: Default::default(),
            degrees_of_freedom: Default::default(),
            condition_number: Default::default(),
            information: [f64::default(); 65],
            warnings: Default::default(),
        }
    }
}

impl Message for Estimate {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Estimate";
    const TYPE: &'static str = "grainlab_msgs/msg/Estimate";
    const HASH: &'static str = "RIHS01_b3b26c89cbb3e60cfc7c8a7ef437a95e65be68914e892a772bb74ef82bcccd65";
    const FIELDS: &'static [FieldInfo] = fields!(
        "model" => (17, 0, ""),
        "calibration" => (17, 0, ""),
        "status" => (3, 0, ""),
        "gamma_over_delta" => (155, 0, ""),
        "gamma_over_delta_source" => (17, 0, ""),
        "k" => (155, 0, ""),
        "k_hat" => (155, 0, ""),
        "z" => (155, 0, ""),
        "eps" => (155, 0, ""),
        "eps_stiffness" => (155, 0, ""),
        "covariance" => (155, 0, ""),
        "covariance_model" => (155, 0, ""),
        "interval" => (155, 0, ""),
        "credible_level" => (11, 0, ""),
        "chi_square" => (11, 0, ""),
        "degrees_of_freedom" => (7, 0, ""),
        "condition_number" => (155, 0, ""),
        "information" => (59, 65, ""),
        "warnings" => (161, 0, ""),
    );
    const DEFINITION: &'static str = definition!("msg/Estimate.msg");
}
