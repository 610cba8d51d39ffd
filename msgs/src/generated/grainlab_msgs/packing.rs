// Generated from msg/Packing.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The complete mechanical state: measures, displays and resumes bit for bit.
/// Structure of arrays; triples interleaved xyz. n grains, m contacts.
/// Lengths: radius and id n; position, velocity, angular_velocity 3 n; contact_overlap and contact_normal_force m;
/// contact_pair 2 m; contact_image, contact_normal, contact_tangential_force 3 m;
/// contact_rolling_force 3 m, or 0 where the contact law has no resistance to rolling.
/// Everything is finite, except friction, which may be +inf, and deformation, which is NaN where there is no reference state.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Packing {
    /// stamp: 1e9 s + simulated time, rounded to 1 ns; frame: cell
    pub header: Header,
    /// solver steps done
    pub step: u64,
    /// s, simulated time, exact
    pub time: f64,
    /// m, row-major, columns are the cell vectors
    pub cell: [f64; 9],
    /// row-major deformation gradient since the reference state, else the first step of the run, all NaN = neither
    pub deformation: [f64; 9],
    /// persistent
    pub id: Vec<u32>,
    /// m
    pub radius: Vec<f64>,
    /// m, as held: unwrapped, not folded into the cell
    pub position: Vec<f64>,
    /// m/s, relative to the affine motion
    pub velocity: Vec<f64>,
    /// rad/s
    pub angular_velocity: Vec<f64>,
    /// indices (i, j), j \>= i, sorted by i, j, image
    pub contact_pair: Vec<u32>,
    /// cell vectors added to j
    pub contact_image: Vec<i8>,
    /// m, full overlap
    pub contact_overlap: Vec<f64>,
    /// unit vector from i to the image of j
    pub contact_normal: Vec<f64>,
    /// N, elastic part, positive in compression
    pub contact_normal_force: Vec<f64>,
    /// N, on i, as integrated
    pub contact_tangential_force: Vec<f64>,
    /// N, elastic part: R\* n x this is a torque on i, its opposite one on j
    pub contact_rolling_force: Vec<f64>,
    /// Pa, of the grain
    pub shear_modulus: f64,
    /// of the grain
    pub poisson_ratio: f64,
    /// kg/m3, of the grain
    pub density: f64,
    /// name, as in scenes: hertz_mindlin, linear, rough
    pub contact_law: String,
    /// those that do not follow from the material, as in scenes; last those of rolling, if any
    pub contact_law_parameters: Vec<f64>,
    /// in force, may be +inf
    pub friction: f64,
    /// s, in force, 0 = not made by a simulation of ours
    pub time_step: f64,
    /// loading path, generator, numerics: opaque, versioned, needed only to resume
    pub run_state: Vec<u8>,
    /// name of the scene; its text is attached to the recording
    pub scene: String,
}

impl Message for Packing {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Packing";
    const TYPE: &'static str = "grainlab_msgs/msg/Packing";
    const HASH: &'static str = "RIHS01_efb90efc0a1bb9f476b26e0486fff1b14a644a4dbc73314730daf1a9d2ca4646";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "step" => (9, 0, ""),
        "time" => (11, 0, ""),
        "cell" => (59, 9, ""),
        "deformation" => (59, 9, ""),
        "id" => (151, 0, ""),
        "radius" => (155, 0, ""),
        "position" => (155, 0, ""),
        "velocity" => (155, 0, ""),
        "angular_velocity" => (155, 0, ""),
        "contact_pair" => (151, 0, ""),
        "contact_image" => (146, 0, ""),
        "contact_overlap" => (155, 0, ""),
        "contact_normal" => (155, 0, ""),
        "contact_normal_force" => (155, 0, ""),
        "contact_tangential_force" => (155, 0, ""),
        "contact_rolling_force" => (155, 0, ""),
        "shear_modulus" => (11, 0, ""),
        "poisson_ratio" => (11, 0, ""),
        "density" => (11, 0, ""),
        "contact_law" => (17, 0, ""),
        "contact_law_parameters" => (155, 0, ""),
        "friction" => (11, 0, ""),
        "time_step" => (11, 0, ""),
        "run_state" => (147, 0, ""),
        "scene" => (17, 0, ""),
    );
    const DEFINITION: &'static str = definition!(
        "msg/Packing.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
