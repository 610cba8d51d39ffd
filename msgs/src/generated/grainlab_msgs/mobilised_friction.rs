// Generated from msg/MobilisedFriction.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Mobilised friction |Ft|/(mu Fn), at most 1.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MobilisedFriction {
    /// Dimensionless.
    pub mean: f64,
    /// contacts by tenths, the last with those at the limit
    pub histogram: [u32; 10],
}

impl Message for MobilisedFriction {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "MobilisedFriction";
    const TYPE: &'static str = "grainlab_msgs/msg/MobilisedFriction";
    const HASH: &'static str = "RIHS01_1fc98aa74493c6d139c27ba8b583a08f0470234e331577734235af3c52114581";
    const FIELDS: &'static [FieldInfo] = fields!(
        "mean" => (11, 0, ""),
        "histogram" => (55, 10, ""),
    );
    const DEFINITION: &'static str = definition!("msg/MobilisedFriction.msg");
}
