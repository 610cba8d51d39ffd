// Generated from msg/Estimate.msg by examples/generate; not edited by hand.

use crate::message::{Message, definition};
use serde::{Deserialize, Serialize};

/// What one model infers. k to credible_level hold for STATUS_OK and STATUS_EXTRAPOLATED, else they are 0.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// for example "ratio"
    pub model: String,
    /// name of the isotropic calibration
    pub calibration: String,
    /// one of STATUS_\*
    pub status: u8,
    /// strain ratio that the model was fed with, whatever the status
    pub gamma_over_delta: f64,
    /// which of the three it is: total, elastic, contact; given; zero = not known, taken as 0
    pub gamma_over_delta_source: String,
    /// coordination number in the calibration's sense
    pub k: f64,
    /// of the equivalent isotropic packing
    pub k_hat: f64,
    /// fabric anisotropy
    pub eps: f64,
    /// of (k, k_hat, eps), row-major, all 0 = unknown
    pub covariance: [f64; 9],
    /// credible bounds: k low, high; k_hat low, high; eps low, high
    pub interval: [f64; 6],
    /// probability inside each interval, 0 = no interval
    pub credible_level: f64,
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

impl Message for Estimate {
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Estimate";
    const TYPE: &'static str = "grainlab_msgs/msg/Estimate";
    const HASH: &'static str = "RIHS01_ca943e34744656daac12ce9530a7a4d5004e1976f547945bd5faa77cf931f494";
    const DEFINITION: &'static str = definition!("msg/Estimate.msg");
}
