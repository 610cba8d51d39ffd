// Generated from msg/Fabric.msg by examples/generate; not edited by hand.

use crate::generated::geometry_msgs::Vector3;
use crate::generated::grainlab_msgs::ContactStatistics;
use crate::generated::grainlab_msgs::OrientationHistogram;
use crate::generated::grainlab_msgs::PrincipalAxis;
use crate::generated::grainlab_msgs::StrainRatios;
use crate::generated::grainlab_msgs::StressDecomposition;
use crate::generated::grainlab_msgs::SymmetricTensor;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Structure of one packing. h is the reference axis, e3 = z unless the analyzer was told another; n is a contact normal.
/// What may be missing is an array of one entry, or of none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fabric {
    /// copied from the Packing measured
    pub header: Header,
    /// step of the Packing measured
    pub source_step: u64,
    /// `ContactStatistics contacts`.
    pub contacts: ContactStatistics,
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
    /// `StressDecomposition stress`.
    pub stress: StressDecomposition,
    /// `StrainRatios strain_ratios`.
    pub strain_ratios: StrainRatios,
}

impl Message for Fabric {
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Fabric";
    const TYPE: &'static str = "grainlab_msgs/msg/Fabric";
    const HASH: &'static str = "RIHS01_eef676cb4a232ae39780d508c5c32e1c995750d1e4b1c97fcc2408539f88d700";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "source_step" => (9, 0, ""),
        "contacts" => (1, 0, "grainlab_msgs/msg/ContactStatistics"),
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
        "stress" => (1, 0, "grainlab_msgs/msg/StressDecomposition"),
        "strain_ratios" => (1, 0, "grainlab_msgs/msg/StrainRatios"),
    );
    const DEFINITION: &'static str = definition!(
        "msg/Fabric.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
        "grainlab_msgs/ContactStatistics" => "msg/ContactStatistics.msg",
        "grainlab_msgs/ForceStatistics" => "msg/ForceStatistics.msg",
        "grainlab_msgs/MobilisedFriction" => "msg/MobilisedFriction.msg",
        "grainlab_msgs/OrientationHistogram" => "msg/OrientationHistogram.msg",
        "grainlab_msgs/OrientationFit" => "msg/OrientationFit.msg",
        "grainlab_msgs/OverlapAnisotropyFit" => "msg/OverlapAnisotropyFit.msg",
        "grainlab_msgs/PrincipalAxis" => "msg/PrincipalAxis.msg",
        "grainlab_msgs/StrainRatios" => "msg/StrainRatios.msg",
        "grainlab_msgs/StressDecomposition" => "msg/StressDecomposition.msg",
        "grainlab_msgs/StressForceFabric" => "msg/StressForceFabric.msg",
        "grainlab_msgs/SymmetricTensor" => "msg/SymmetricTensor.msg",
        "grainlab_msgs/SubNetwork" => "msg/SubNetwork.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
