// Generated from msg/StressForceFabric.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::grainlab_msgs::SymmetricTensor;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Second-order anisotropies of contacts and forces; traceless tensors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StressForceFabric {
    /// contacts are distributed as 1 + a.nn
    pub contacts: SymmetricTensor,
    /// normal forces as 1 + a.nn
    pub normal_forces: SymmetricTensor,
    /// branch lengths as 1 + a.nn
    pub branches: SymmetricTensor,
    /// tangential forces as a.n - (n.a.n) n, in mean normal forces
    pub tangential_forces: SymmetricTensor,
}

impl Message for StressForceFabric {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "StressForceFabric";
    const TYPE: &'static str = "grainlab_msgs/msg/StressForceFabric";
    const HASH: &'static str = "RIHS01_cba70b5c787dd210ceb331f0389db2e388a8b57b1fb59b26e3fcd1e0c474fd92";
    const FIELDS: &'static [FieldInfo] = fields!(
        "contacts" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "normal_forces" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "branches" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "tangential_forces" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
    );
    const DEFINITION: &'static str = definition!(
        "msg/StressForceFabric.msg",
        "grainlab_msgs/SymmetricTensor" => "msg/SymmetricTensor.msg",
    );
}
