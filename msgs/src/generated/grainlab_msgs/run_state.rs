// Generated from msg/RunState.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Where the run stands.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunState {
    /// stamp: 1e9 s + simulated time; frame: cell
    pub header: Header,
    /// RUNNING, FINISHED or FAILED
    pub state: u8,
    /// number of the phase in the loading path, from 1
    pub phase: u32,
    /// as the scene names it
    pub phase_name: String,
    /// of the loading path, 0 to 1
    pub progress: f64,
    /// solver steps done
    pub step: u64,
    /// step of the last Packing, 0 if packings is 0
    pub last_packing_step: u64,
    /// published so far
    pub packings: u32,
    /// for a reader, may be empty
    pub message: String,
}

impl RunState {
    /// under way
    pub const RUNNING: u8 = 0;

    /// the loading path is done
    pub const FINISHED: u8 = 1;

    /// it ended early, message says why
    pub const FAILED: u8 = 2;
}

impl Message for RunState {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "RunState";
    const TYPE: &'static str = "grainlab_msgs/msg/RunState";
    const HASH: &'static str = "RIHS01_b375ca50ba6b32a74683442b09b2e3153e0e61a9c74755927dbdbcb27a23d002";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "state" => (3, 0, ""),
        "phase" => (7, 0, ""),
        "phase_name" => (17, 0, ""),
        "progress" => (11, 0, ""),
        "step" => (9, 0, ""),
        "last_packing_step" => (9, 0, ""),
        "packings" => (7, 0, ""),
        "message" => (17, 0, ""),
    );
    const DEFINITION: &'static str = definition!(
        "msg/RunState.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
