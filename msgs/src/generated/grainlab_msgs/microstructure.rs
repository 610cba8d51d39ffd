// Generated from msg/Microstructure.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::grainlab_msgs::Estimate;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// What the stiffness of a packing, moduli or wave speeds say about the packing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Microstructure {
    /// copied from the data, also where these are refused
    pub header: Header,
    /// copied from the Moduli or WaveSpeeds, empty for a PackingReport
    pub name: String,
    /// copied from the data
    pub source_step: u64,
    /// topic the data came from
    pub source: String,
    /// one per model, fixed order within a run
    pub estimates: Vec<Estimate>,
}

impl Message for Microstructure {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Microstructure";
    const TYPE: &'static str = "grainlab_msgs/msg/Microstructure";
    const HASH: &'static str = "RIHS01_5697420c04fcdcc5f63a104194596ea06fadf28b0d14bc8d37b715d50522492f";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "name" => (17, 0, ""),
        "source_step" => (9, 0, ""),
        "source" => (17, 0, ""),
        "estimates" => (145, 0, "grainlab_msgs/msg/Estimate"),
    );
    const DEFINITION: &'static str = definition!(
        "msg/Microstructure.msg",
        "grainlab_msgs/Estimate" => "msg/Estimate.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
