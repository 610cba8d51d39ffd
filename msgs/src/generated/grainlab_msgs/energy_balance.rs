// Generated from msg/EnergyBalance.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Where the energy of a phase went, J: start + strain_work + integration = the energies present at its end + the energies
/// dissipated. Sums over all grains and contacts, from the beginning of the phase.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyBalance {
    /// stamp: 1e9 s + simulated time; frame: cell
    pub header: Header,
    /// solver steps done
    pub step: u64,
    /// number of the phase in the loading path, from 1
    pub phase: u32,
    /// as the scene names it
    pub phase_name: String,
    /// J, kinetic and elastic energy at the beginning
    pub start: f64,
    /// J, work of the strain of the cell
    pub strain_work: f64,
    /// J, created by the finite time step, negative where it removes energy
    pub integration: f64,
    /// J, present, relative to the affine motion, with spins
    pub kinetic: f64,
    /// J, present
    pub normal_springs: f64,
    /// J, present
    pub tangential_springs: f64,
    /// J, present
    pub rolling_springs: f64,
    /// J, dissipated by normal dashpots
    pub normal_damping: f64,
    /// J, dissipated by tangential dashpots
    pub tangential_damping: f64,
    /// J, dissipated by rolling dashpots
    pub rolling_damping: f64,
    /// J, dissipated by friction
    pub sliding: f64,
    /// J, dissipated by rolling friction
    pub rolling: f64,
    /// J, lost by springs whose stiffness changes or whose contact opens
    pub history: f64,
    /// J, dissipated by the drags on velocities and spins
    pub drag: f64,
    /// J, removed by the thermostat
    pub thermostat: f64,
}

impl Message for EnergyBalance {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "EnergyBalance";
    const TYPE: &'static str = "grainlab_msgs/msg/EnergyBalance";
    const HASH: &'static str = "RIHS01_66aa2144d04aef2d858fd18ca699da88747171000f580cb060bdce736dc41d48";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "step" => (9, 0, ""),
        "phase" => (7, 0, ""),
        "phase_name" => (17, 0, ""),
        "start" => (11, 0, ""),
        "strain_work" => (11, 0, ""),
        "integration" => (11, 0, ""),
        "kinetic" => (11, 0, ""),
        "normal_springs" => (11, 0, ""),
        "tangential_springs" => (11, 0, ""),
        "rolling_springs" => (11, 0, ""),
        "normal_damping" => (11, 0, ""),
        "tangential_damping" => (11, 0, ""),
        "rolling_damping" => (11, 0, ""),
        "sliding" => (11, 0, ""),
        "rolling" => (11, 0, ""),
        "history" => (11, 0, ""),
        "drag" => (11, 0, ""),
        "thermostat" => (11, 0, ""),
    );
    const DEFINITION: &'static str = definition!(
        "msg/EnergyBalance.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
