// Generated from msg/TransverseIsotropy.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Moduli of a stiffness isotropic about an axis, which is c3 here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TransverseIsotropy {
    /// Pa
    pub c11: f64,
    /// Pa, c11 - 2 g12
    pub c12: f64,
    /// Pa
    pub c13: f64,
    /// Pa, along the axis
    pub c33: f64,
    /// Pa, shear along the axis, C44 = C55
    pub g13: f64,
    /// Pa, shear across the axis, C66
    pub g12: f64,
    /// distance of the stiffness from this one over its norm
    pub residual: f64,
}

impl Message for TransverseIsotropy {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "TransverseIsotropy";
    const TYPE: &'static str = "grainlab_msgs/msg/TransverseIsotropy";
    const HASH: &'static str = "RIHS01_b3b5ba2fb65c0d86f8668ddfe29cf1ca4b73dd751fa819c27b489a21562c8a02";
    const FIELDS: &'static [FieldInfo] = fields!(
        "c11" => (11, 0, ""),
        "c12" => (11, 0, ""),
        "c13" => (11, 0, ""),
        "c33" => (11, 0, ""),
        "g13" => (11, 0, ""),
        "g12" => (11, 0, ""),
        "residual" => (11, 0, ""),
    );
    const DEFINITION: &'static str = definition!("msg/TransverseIsotropy.msg");
}
