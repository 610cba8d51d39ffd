// Generated from msg/ForceStatistics.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Distribution of normal forces, f = Fn over its mean.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ForceStatistics {
    /// N, mean normal force
    pub mean_normal: f64,
    /// N, mean |Ft|
    pub mean_tangential: f64,
    /// means of f^2, f^3, f^4
    pub moments: [f64; 3],
    /// largest f
    pub largest: f64,
    /// contacts by f, bins of 0.25 from 0, the last without upper end
    pub histogram: [u32; 20],
}

impl Message for ForceStatistics {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "ForceStatistics";
    const TYPE: &'static str = "grainlab_msgs/msg/ForceStatistics";
    const HASH: &'static str = "RIHS01_f5bab78414577f3507df661b97f7f1a5804957c6b0dc68d29dbc69eb8ce95128";
    const FIELDS: &'static [FieldInfo] = fields!(
        "mean_normal" => (11, 0, ""),
        "mean_tangential" => (11, 0, ""),
        "moments" => (59, 3, ""),
        "largest" => (11, 0, ""),
        "histogram" => (55, 20, ""),
    );
    const DEFINITION: &'static str = definition!("msg/ForceStatistics.msg");
}
