// Generated from msg/PrincipalAxis.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::geometry_msgs::Vector3;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The principal axis of the contact fabric that stands out most, and its noise among packings prepared alike.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PrincipalAxis {
    /// unit eigenvector furthest from isotropy, z \>= 0
    pub direction: Vector3,
    /// eps about it
    pub contact_anisotropy: f64,
    /// standard deviation of eps about any axis, none with fewer than 30 contacts
    pub contact_anisotropy_stddev: Vec<f64>,
    /// rad, of the direction, none where it would exceed 1 rad
    pub angle_stddev: Vec<f64>,
    /// whether the anisotropy exceeds its noise and one axis stands out; else any axis is as good
    pub determined: bool,
}

impl Message for PrincipalAxis {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "PrincipalAxis";
    const TYPE: &'static str = "grainlab_msgs/msg/PrincipalAxis";
    const HASH: &'static str = "RIHS01_b9bd81493b313eca1ff19f20ab62485aa1b52927dcd95ecacdbb8bc5db5654c9";
    const FIELDS: &'static [FieldInfo] = fields!(
        "direction" => (1, 0, "geometry_msgs/msg/Vector3"),
        "contact_anisotropy" => (11, 0, ""),
        "contact_anisotropy_stddev" => (155, 0, ""),
        "angle_stddev" => (155, 0, ""),
        "determined" => (15, 0, ""),
    );
    const DEFINITION: &'static str = definition!(
        "msg/PrincipalAxis.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
    );
}
