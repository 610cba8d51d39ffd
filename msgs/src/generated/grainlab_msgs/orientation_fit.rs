// Generated from msg/OrientationFit.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Maximum likelihood of the distribution (1 - eps) + 3 eps x^2 of contacts (Eq. 6).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OrientationFit {
    /// Dimensionless.
    pub eps: f64,
    /// standard error for independent contacts
    pub eps_stddev: f64,
    /// chi^2 of the histogram over its 8 degrees of freedom
    pub chi2_per_dof: f64,
}

impl Message for OrientationFit {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "OrientationFit";
    const TYPE: &'static str = "grainlab_msgs/msg/OrientationFit";
    const HASH: &'static str = "RIHS01_10fd1701211e6e29b604c892576f5e5065ddbfa8d2633d72143bc1ce2d4a02a3";
    const FIELDS: &'static [FieldInfo] = fields!(
        "eps" => (11, 0, ""),
        "eps_stddev" => (11, 0, ""),
        "chi2_per_dof" => (11, 0, ""),
    );
    const DEFINITION: &'static str = definition!("msg/OrientationFit.msg");
}
