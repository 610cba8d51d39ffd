// Generated from msg/ContactStatistics.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::grainlab_msgs::ForceStatistics;
use crate::generated::grainlab_msgs::MobilisedFriction;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Contacts of a packing, and the forces they carry.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactStatistics {
    /// Dimensionless.
    pub grains: u32,
    /// Dimensionless.
    pub contacts: u32,
    /// recursively fewer than 2 contacts with friction, 4 without
    pub rattlers: u32,
    /// k: 2 contacts / grains, all grains
    pub coordination: f64,
    /// z: the same without rattlers and their contacts
    pub mechanical_coordination: f64,
    /// share of contacts at the Coulomb limit, 0 = none or no limit
    pub sliding_fraction: f64,
    /// one, or none without normal forces
    pub forces: Vec<ForceStatistics>,
    /// one, or none without friction and with an infinite one
    pub friction: Vec<MobilisedFriction>,
}

impl Message for ContactStatistics {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "ContactStatistics";
    const TYPE: &'static str = "grainlab_msgs/msg/ContactStatistics";
    const HASH: &'static str = "RIHS01_2d71efd7f8ec94b939711a2dd33ebb2bba24e964c7d565e117242052ecb3a70f";
    const FIELDS: &'static [FieldInfo] = fields!(
        "grains" => (7, 0, ""),
        "contacts" => (7, 0, ""),
        "rattlers" => (7, 0, ""),
        "coordination" => (11, 0, ""),
        "mechanical_coordination" => (11, 0, ""),
        "sliding_fraction" => (11, 0, ""),
        "forces" => (145, 0, "grainlab_msgs/msg/ForceStatistics"),
        "friction" => (145, 0, "grainlab_msgs/msg/MobilisedFriction"),
    );
    const DEFINITION: &'static str = definition!(
        "msg/ContactStatistics.msg",
        "grainlab_msgs/ForceStatistics" => "msg/ForceStatistics.msg",
        "grainlab_msgs/MobilisedFriction" => "msg/MobilisedFriction.msg",
    );
}
