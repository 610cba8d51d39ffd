// Generated from msg/OverlapAnisotropyFit.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Least squares of the square root of the overlaps to A (1 + g - 3 g x^2) (Eq. 10).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OverlapAnisotropyFit {
    /// gamma/Delta
    pub g: f64,
    /// standard error for independent contacts, one or none
    pub g_stddev: Vec<f64>,
}

impl Message for OverlapAnisotropyFit {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "OverlapAnisotropyFit";
    const TYPE: &'static str = "grainlab_msgs/msg/OverlapAnisotropyFit";
    const HASH: &'static str = "RIHS01_d9fefc5692b1c725b3ae4b97d32a5d9991412849eb4bb41cc654df468f38c873";
    const FIELDS: &'static [FieldInfo] = fields!(
        "g" => (11, 0, ""),
        "g_stddev" => (155, 0, ""),
    );
    const DEFINITION: &'static str = definition!("msg/OverlapAnisotropyFit.msg");
}
