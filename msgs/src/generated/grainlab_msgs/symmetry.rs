// Generated from msg/Symmetry.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::geometry_msgs::Vector3;
use crate::generated::grainlab_msgs::TransverseIsotropy;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Symmetry of a stiffness, and the axes about which it has it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Symmetry {
    /// one of CLASS_\*, the highest one whose residual is at most the tolerance
    pub symmetry_class: u8,
    /// largest relative residual that counted as none
    pub tolerance: f64,
    /// relative residual of the nearest isotropic stiffness
    pub isotropic: f64,
    /// of the nearest cubic one
    pub cubic: f64,
    /// of the nearest transversely isotropic one
    pub transversely_isotropic: f64,
    /// of the nearest orthotropic one
    pub orthotropic: f64,
    /// unit, of the nearest transversely isotropic stiffness, without meaning where the class is isotropic
    pub axis: Vector3,
    /// of the nearest transversely isotropic stiffness, about that axis
    pub moduli: TransverseIsotropy,
    /// row-major, columns are the axes of the nearest cubic stiffness
    pub cubic_axes: [f64; 9],
    /// row-major, columns are the axes of the nearest orthotropic stiffness
    pub orthotropic_axes: [f64; 9],
}

impl Symmetry {
    /// `CLASS_ISOTROPIC`.
    pub const CLASS_ISOTROPIC: u8 = 0;

    /// `CLASS_CUBIC`.
    pub const CLASS_CUBIC: u8 = 1;

    /// `CLASS_TRANSVERSELY_ISOTROPIC`.
    pub const CLASS_TRANSVERSELY_ISOTROPIC: u8 = 2;

    /// `CLASS_ORTHOTROPIC`.
    pub const CLASS_ORTHOTROPIC: u8 = 3;

    /// more than nine constants
    pub const CLASS_LOWER: u8 = 4;
}

impl Message for Symmetry {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Symmetry";
    const TYPE: &'static str = "grainlab_msgs/msg/Symmetry";
    const HASH: &'static str = "RIHS01_1d25556be9525d4179251e138d864ca982d0601c4bcde7075bad20c033f84a00";
    const FIELDS: &'static [FieldInfo] = fields!(
        "symmetry_class" => (3, 0, ""),
        "tolerance" => (11, 0, ""),
        "isotropic" => (11, 0, ""),
        "cubic" => (11, 0, ""),
        "transversely_isotropic" => (11, 0, ""),
        "orthotropic" => (11, 0, ""),
        "axis" => (1, 0, "geometry_msgs/msg/Vector3"),
        "moduli" => (1, 0, "grainlab_msgs/msg/TransverseIsotropy"),
        "cubic_axes" => (59, 9, ""),
        "orthotropic_axes" => (59, 9, ""),
    );
    const DEFINITION: &'static str = definition!(
        "msg/Symmetry.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
        "grainlab_msgs/TransverseIsotropy" => "msg/TransverseIsotropy.msg",
    );
}
