// Generated from msg/StressDecomposition.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::grainlab_msgs::StressForceFabric;
use crate::generated::grainlab_msgs::SubNetwork;
use crate::generated::grainlab_msgs::SymmetricTensor;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Which forces and which contacts carry the stress; positive in compression.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StressDecomposition {
    /// Pa, stress of the normal forces
    pub normal: SymmetricTensor,
    /// Pa, stress of the tangential forces; both add up to the stress
    pub tangential: SymmetricTensor,
    /// contacts with more than the mean normal force
    pub strong: SubNetwork,
    /// the others; the stresses of both add up to the stress
    pub weak: SubNetwork,
    /// one, or none without normal forces
    pub stress_force_fabric: Vec<StressForceFabric>,
}

impl Message for StressDecomposition {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "StressDecomposition";
    const TYPE: &'static str = "grainlab_msgs/msg/StressDecomposition";
    const HASH: &'static str = "RIHS01_a0178e161cb22c62a819ec34d92e51a1d667f6f3e94cc8f109f17b6a4ae31e3a";
    const FIELDS: &'static [FieldInfo] = fields!(
        "normal" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "tangential" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "strong" => (1, 0, "grainlab_msgs/msg/SubNetwork"),
        "weak" => (1, 0, "grainlab_msgs/msg/SubNetwork"),
        "stress_force_fabric" => (145, 0, "grainlab_msgs/msg/StressForceFabric"),
    );
    const DEFINITION: &'static str = definition!(
        "msg/StressDecomposition.msg",
        "grainlab_msgs/StressForceFabric" => "msg/StressForceFabric.msg",
        "grainlab_msgs/SymmetricTensor" => "msg/SymmetricTensor.msg",
        "grainlab_msgs/SubNetwork" => "msg/SubNetwork.msg",
    );
}
