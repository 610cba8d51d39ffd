// Generated from msg/Stress.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::grainlab_msgs::SymmetricTensor;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// One request of the lockstep: everything a servo needs to answer, and nothing it must remember.
/// Voigt order xx yy zz yz xz xy, tensor components.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stress {
    /// stamp: 1e9 s + simulated time; frame: cell
    pub header: Header,
    /// counts requests from 0; answered by StrainRate.sequence
    pub sequence: u64,
    /// solver steps done
    pub step: u64,
    /// number of the phase in the loading path, from 1
    pub phase: u32,
    /// Pa, compression positive, Love-Weber over contacts
    pub stress: SymmetricTensor,
    /// Pa, largest |s_ij - s_ji| before symmetrising
    pub asymmetry: f64,
    /// one of MODE_\* for each component
    pub mode: [u8; 6],
    /// Pa or 1/s by mode, 0 where held
    pub setpoint: [f64; 6],
    /// 1/s, strain rate in force, extension positive
    pub rate: [f64; 6],
    /// 1/s, largest magnitude of a component of the answer
    pub rate_limit: f64,
    /// one of LAW_\*
    pub law: u8,
    /// 1/(Pa s), of Eq. 1 per control period; 1 for LAW_NORMALISED; 0 for LAW_SCALED
    pub gain: f64,
    /// share of the rate forgotten each control period; 0 for LAW_SCALED
    pub leak: f64,
    /// s, of the scaled law; 0 for the others
    pub response_time: f64,
    /// Pa, affine tangent stiffness C_iiii (xx yy zz) and C_ijij (yz xz xy) of the present contacts; one, or none
    pub tangent: Vec<SymmetricTensor>,
    /// s, simulated time until the next request
    pub control_interval: f64,
    /// logarithmic, extension positive, since the reference state, else the first step of the run
    pub strain: SymmetricTensor,
    /// Dimensionless.
    pub solid_fraction: f64,
    /// k: 2 contacts / grains
    pub coordination: f64,
    /// mean net force of non-rattlers / mean contact force; 1 without contacts
    pub unbalanced_force_ratio: f64,
}

impl Stress {
    /// no strain of this component
    pub const MODE_HELD: u8 = 0;

    /// setpoint in Pa, compression positive
    pub const MODE_STRESS: u8 = 1;

    /// setpoint in 1/s, extension positive
    pub const MODE_STRAIN_RATE: u8 = 2;

    /// rate = (stress - setpoint) / (tangent response_time); of a shear component 2 tangent
    pub const LAW_SCALED: u8 = 0;

    /// Eq. 1: rate = (1 - leak) rate + gain (stress - setpoint)
    pub const LAW_INTEGRAL: u8 = 1;

    /// as LAW_INTEGRAL, gain as a share of (4 - 2 leak) / (K control_interval); K: tangent, plus for a normal component
    pub const LAW_NORMALISED: u8 = 2;
}

impl Message for Stress {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Stress";
    const TYPE: &'static str = "grainlab_msgs/msg/Stress";
    const HASH: &'static str = "RIHS01_0b4e698df2e648397c76d1096623b0abbe4d84dd1854499c7a9ea9603f7f8df2";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "sequence" => (9, 0, ""),
        "step" => (9, 0, ""),
        "phase" => (7, 0, ""),
        "stress" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "asymmetry" => (11, 0, ""),
        "mode" => (51, 6, ""),
        "setpoint" => (59, 6, ""),
        "rate" => (59, 6, ""),
        "rate_limit" => (11, 0, ""),
        "law" => (3, 0, ""),
        "gain" => (11, 0, ""),
        "leak" => (11, 0, ""),
        "response_time" => (11, 0, ""),
        "tangent" => (145, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "control_interval" => (11, 0, ""),
        "strain" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "solid_fraction" => (11, 0, ""),
        "coordination" => (11, 0, ""),
        "unbalanced_force_ratio" => (11, 0, ""),
    );
    const DEFINITION: &'static str = definition!(
        "msg/Stress.msg",
        "grainlab_msgs/SymmetricTensor" => "msg/SymmetricTensor.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
