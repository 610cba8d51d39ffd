// Generated from msg/StrainRate.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The answer to one Stress. Voigt order xx yy zz yz xz xy, tensor components.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StrainRate {
    /// copied from the Stress answered
    pub header: Header,
    /// of the Stress answered
    pub sequence: u64,
    /// 1/s, extension positive
    pub rate: [f64; 6],
    /// the component met rate_limit
    pub saturated: [bool; 6],
}

impl Message for StrainRate {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "StrainRate";
    const TYPE: &'static str = "grainlab_msgs/msg/StrainRate";
    const HASH: &'static str = "RIHS01_a7c8a9b3d41976170056a34e9b4187b9a68686f0ee059bc1ae29f97c7a76b43a";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "sequence" => (9, 0, ""),
        "rate" => (59, 6, ""),
        "saturated" => (63, 6, ""),
    );
    const DEFINITION: &'static str = definition!(
        "msg/StrainRate.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
