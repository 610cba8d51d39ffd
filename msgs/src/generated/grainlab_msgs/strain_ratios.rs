// Generated from msg/StrainRatios.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Ratios gamma/Delta of deviatoric to volumetric strain about a reference axis; each one number, or none if not known.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StrainRatios {
    /// of the strain since the reference state
    pub total: Vec<f64>,
    /// of an isotropic stress increment on the frozen network
    pub elastic: Vec<f64>,
    /// fitted to the overlaps
    pub contact: Vec<f64>,
}

impl Message for StrainRatios {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "StrainRatios";
    const TYPE: &'static str = "grainlab_msgs/msg/StrainRatios";
    const HASH: &'static str = "RIHS01_3da6fb7bc1e5b890b3df7019a57626c5c958ab4a7dc6c2390799dccfa72a3ad9";
    const FIELDS: &'static [FieldInfo] = fields!(
        "total" => (155, 0, ""),
        "elastic" => (155, 0, ""),
        "contact" => (155, 0, ""),
    );
    const DEFINITION: &'static str = definition!("msg/StrainRatios.msg");
}
