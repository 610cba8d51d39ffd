// Generated from msg/SymmetricTensor.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Symmetric second-order tensor; unit and sign are set by the field that uses it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SymmetricTensor {
    /// component along x, x
    pub xx: f64,
    /// component along y, y
    pub yy: f64,
    /// component along z, z
    pub zz: f64,
    /// component along y, z (tensor component, not engineering shear)
    pub yz: f64,
    /// component along x, z
    pub xz: f64,
    /// component along x, y
    pub xy: f64,
}

impl Message for SymmetricTensor {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "SymmetricTensor";
    const TYPE: &'static str = "grainlab_msgs/msg/SymmetricTensor";
    const HASH: &'static str = "RIHS01_7885ee4bfa6f13326245eb435e5e8135b0f726678621c30856e81b13fa0f2301";
    const FIELDS: &'static [FieldInfo] = fields!(
        "xx" => (11, 0, ""),
        "yy" => (11, 0, ""),
        "zz" => (11, 0, ""),
        "yz" => (11, 0, ""),
        "xz" => (11, 0, ""),
        "xy" => (11, 0, ""),
    );
    const DEFINITION: &'static str = definition!("msg/SymmetricTensor.msg");
}
