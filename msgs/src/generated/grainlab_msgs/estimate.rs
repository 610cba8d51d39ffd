// Generated from msg/Estimate.msg by examples/generate; not edited by hand.

use crate::message::{Message, definition};
use serde::{Deserialize, Serialize};

/// What one model infers. Values hold for STATUS_OK and STATUS_EXTRAPOLATED, else they are 0.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// for example "ratio"
    pub model: String,
    /// name of the isotropic calibration
    pub calibration: String,
    /// one of STATUS_\*
    pub status: u8,
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
    const HASH: &'static str = "RIHS01_a33156b3b57b60099ee365976594326a04d037551d9c5d38f44efa2744ab5b51";
    const DEFINITION: &'static str = definition!("msg/Estimate.msg");
}
