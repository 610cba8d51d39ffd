// Generated from msg/Fabric.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::geometry_msgs::Vector3;
use crate::generated::grainlab_msgs::OrientationHistogram;
use crate::generated::grainlab_msgs::PrincipalAxis;
use crate::generated::grainlab_msgs::SymmetricTensor;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Orientation of the contacts of a packing. h is the reference axis, e3 = z unless the analyzer was told another; n is a contact normal.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fabric {
    /// h, unit
    pub reference_axis: Vector3,
    /// mean of n n, trace 1 (Eq. 2)
    pub contact_fabric: SymmetricTensor,
    /// weighted by normal force, trace 1
    pub normal_force_fabric: SymmetricTensor,
    /// mean of t t weighted by |Ft|, t along Ft, trace 1, all 0 = no tangential forces
    pub tangential_force_fabric: SymmetricTensor,
    /// weighted by normal stiffness, trace 1
    pub stiffness_fabric: SymmetricTensor,
    /// eps: 5/2 (L33 - (L11 + L22)/2), about h (Eq. 20)
    pub contact_anisotropy: f64,
    /// coefficient of P4(cos) in the contact distribution about h
    pub p4_coefficient: f64,
    /// mean of n n n n: xxxx xxxy xxxz xxyy xxyz xxzz xyyy xyyz xyzz xzzz yyyy yyyz yyzz yzzz zzzz
    pub fourth_order_fabric: [f64; 15],
    /// of its harmonic part: |a4| where that is a4 P4 about some axis
    pub fourth_order_magnitude: f64,
    /// `PrincipalAxis principal_axis`.
    pub principal_axis: PrincipalAxis,
    /// `OrientationHistogram orientation`.
    pub orientation: OrientationHistogram,
}

impl Message for Fabric {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Fabric";
    const TYPE: &'static str = "grainlab_msgs/msg/Fabric";
    const HASH: &'static str = "RIHS01_a9a04f7cc8610c9cbf2a3e1f8daca0f2c3fcc26d1a4c8ed380ce6ca4e4d0f3e7";
    const FIELDS: &'static [FieldInfo] = fields!(
        "reference_axis" => (1, 0, "geometry_msgs/msg/Vector3"),
        "contact_fabric" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "normal_force_fabric" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "tangential_force_fabric" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "stiffness_fabric" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "contact_anisotropy" => (11, 0, ""),
        "p4_coefficient" => (11, 0, ""),
        "fourth_order_fabric" => (59, 15, ""),
        "fourth_order_magnitude" => (11, 0, ""),
        "principal_axis" => (1, 0, "grainlab_msgs/msg/PrincipalAxis"),
        "orientation" => (1, 0, "grainlab_msgs/msg/OrientationHistogram"),
    );
    const DEFINITION: &'static str = definition!(
        "msg/Fabric.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
        "grainlab_msgs/OrientationHistogram" => "msg/OrientationHistogram.msg",
        "grainlab_msgs/OrientationFit" => "msg/OrientationFit.msg",
        "grainlab_msgs/OverlapAnisotropyFit" => "msg/OverlapAnisotropyFit.msg",
        "grainlab_msgs/PrincipalAxis" => "msg/PrincipalAxis.msg",
        "grainlab_msgs/SymmetricTensor" => "msg/SymmetricTensor.msg",
    );
}
