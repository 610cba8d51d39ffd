// Generated from msg/Fabric.msg by examples/generate; not edited by hand.

use crate::generated::geometry_msgs::Vector3;
use crate::generated::grainlab_msgs::SymmetricTensor;
use crate::generated::std_msgs::Header;
use crate::message::{Message, definition};
use serde::{Deserialize, Serialize};

/// Structure of one packing. e3 = z is the axis of the scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fabric {
    /// copied from the Packing measured
    pub header: Header,
    /// step of the Packing measured
    pub source_step: u64,
    /// Dimensionless.
    pub grains: u32,
    /// Dimensionless.
    pub contacts: u32,
    /// recursively fewer than 2 contacts with friction, 4 without
    pub rattlers: u32,
    /// 2 contacts / grains, all grains
    pub k: f64,
    /// the same without rattlers and their contacts
    pub z: f64,
    /// mean of n n, trace 1 (Eq. 2)
    pub contact_fabric: SymmetricTensor,
    /// weighted by normal force, trace 1
    pub force_fabric: SymmetricTensor,
    /// weighted by normal stiffness, trace 1
    pub stiffness_fabric: SymmetricTensor,
    /// 5/2 (L33 - (L11 + L22)/2), about e3 (Eq. 20)
    pub eps: f64,
    /// unit eigenvector of the contact fabric furthest from isotropy, z \>= 0
    pub axis: Vector3,
    /// coefficient of P4(cos) in the contact distribution about e3
    pub fourth_order: f64,
    /// whether the next field is valid
    pub gamma_over_delta_total_known: bool,
    /// of the strain since the reference state, else 0
    pub gamma_over_delta_total: f64,
    /// whether the next field is valid
    pub gamma_over_delta_elastic_known: bool,
    /// of an isotropic stress increment on the frozen network, else 0
    pub gamma_over_delta_elastic: f64,
    /// whether the next field is valid
    pub gamma_over_delta_contact_known: bool,
    /// fitted to the overlaps, else 0
    pub gamma_over_delta_contact: f64,
    /// share of contacts at the Coulomb limit
    pub mobilised: f64,
}

impl Message for Fabric {
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Fabric";
    const TYPE: &'static str = "grainlab_msgs/msg/Fabric";
    const HASH: &'static str = "RIHS01_6d501294e24535f5e1b64785b326f307aa16ebee83cd80ac2960fd12c9fc6a4e";
    const DEFINITION: &'static str = definition!(
        "msg/Fabric.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
        "grainlab_msgs/SymmetricTensor" => "msg/SymmetricTensor.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
