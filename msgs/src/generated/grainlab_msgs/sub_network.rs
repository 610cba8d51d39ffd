// Generated from msg/SubNetwork.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::grainlab_msgs::SymmetricTensor;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The strong or the weak contacts of a packing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SubNetwork {
    /// Dimensionless.
    pub contacts: u32,
    /// mean of n n, trace 1, all 0 = no contacts
    pub fabric: SymmetricTensor,
    /// eps about the reference axis
    pub contact_anisotropy: f64,
    /// Pa, stress that they carry
    pub stress: SymmetricTensor,
}

impl Message for SubNetwork {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "SubNetwork";
    const TYPE: &'static str = "grainlab_msgs/msg/SubNetwork";
    const HASH: &'static str = "RIHS01_3369b9d0e0a05fe59ce0309c2e81d80c8f7672a25205746b5ac076038e88aeff";
    const FIELDS: &'static [FieldInfo] = fields!(
        "contacts" => (7, 0, ""),
        "fabric" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "contact_anisotropy" => (11, 0, ""),
        "stress" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
    );
    const DEFINITION: &'static str = definition!(
        "msg/SubNetwork.msg",
        "grainlab_msgs/SymmetricTensor" => "msg/SymmetricTensor.msg",
    );
}
