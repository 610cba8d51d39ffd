// Generated from msg/OrientationHistogram.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::grainlab_msgs::OrientationFit;
use crate::generated::grainlab_msgs::OverlapAnisotropyFit;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Contacts and overlaps by x = |n.h|, n a contact normal and h the reference axis, in bins of 0.1 from 0.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OrientationHistogram {
    /// contacts of each bin
    pub contacts: [u32; 10],
    /// m, mean overlap of each bin, 0 where there is no contact
    pub overlap: [f64; 10],
    /// m^0.5, mean square root of the overlap of each bin, 0 where there is no contact
    pub sqrt_overlap: [f64; 10],
    /// one, or none
    pub contact_fit: Vec<OrientationFit>,
    /// one, or none
    pub overlap_fit: Vec<OverlapAnisotropyFit>,
}

impl Message for OrientationHistogram {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "OrientationHistogram";
    const TYPE: &'static str = "grainlab_msgs/msg/OrientationHistogram";
    const HASH: &'static str = "RIHS01_1c48ee5f9a986c358869a903b2d4e8bfcb4894f7ff54750aeeb497c658cf121f";
    const FIELDS: &'static [FieldInfo] = fields!(
        "contacts" => (55, 10, ""),
        "overlap" => (59, 10, ""),
        "sqrt_overlap" => (59, 10, ""),
        "contact_fit" => (145, 0, "grainlab_msgs/msg/OrientationFit"),
        "overlap_fit" => (145, 0, "grainlab_msgs/msg/OverlapAnisotropyFit"),
    );
    const DEFINITION: &'static str = definition!(
        "msg/OrientationHistogram.msg",
        "grainlab_msgs/OrientationFit" => "msg/OrientationFit.msg",
        "grainlab_msgs/OverlapAnisotropyFit" => "msg/OverlapAnisotropyFit.msg",
    );
}
