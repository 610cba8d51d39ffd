// Generated from msg/WaveSpeeds.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::geometry_msgs::Vector3;
use crate::generated::grainlab_msgs::WaveSpeed;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// What an acoustic instrument, real or virtual, hands to the inversion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WaveSpeeds {
    /// copied from the Packing probed, or the instrument's time
    pub header: Header,
    /// of the sample or the measurement, copied into the answer, empty = none
    pub name: String,
    /// step of the Packing probed, 0 = not from a simulation
    pub source_step: u64,
    /// 0 = unknown
    pub grains: u32,
    /// kg/m3, of the mass that moves with the wave
    pub density: f64,
    /// kg/m3, 0 = unknown
    pub density_stddev: f64,
    /// Pa, confining, compression positive
    pub pressure: f64,
    /// Pa, 0 = exact, or not stated
    pub pressure_stddev: f64,
    /// 0 = unknown
    pub solid_fraction: f64,
    /// axial stress less the lateral one over pressure, about the axis (e3 if unknown), one or none
    pub stress_ratio: Vec<f64>,
    /// 0 = exact, or not stated
    pub stress_ratio_stddev: f64,
    /// standard deviation of the radii over their mean, one or none
    pub size_spread: Vec<f64>,
    /// symmetry axis, zero = unknown
    pub axis: Vector3,
    /// Pa
    pub grain_shear_modulus: f64,
    /// Pa, 0 = exact, or not stated
    pub grain_shear_modulus_stddev: f64,
    /// Dimensionless.
    pub grain_poisson_ratio: f64,
    /// 0 = exact, or not stated
    pub grain_poisson_ratio_stddev: f64,
    /// name, as in Packing, empty = unknown
    pub contact_law: String,
    /// as in Packing
    pub contact_law_parameters: Vec<f64>,
    /// measured without tangential springs
    pub smooth: bool,
    /// one per mode and direction
    pub speeds: Vec<WaveSpeed>,
    /// what a reader should know, empty if there is nothing to say
    pub warnings: Vec<String>,
}

impl Message for WaveSpeeds {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "WaveSpeeds";
    const TYPE: &'static str = "grainlab_msgs/msg/WaveSpeeds";
    const HASH: &'static str = "RIHS01_0ccdc60aa7a8d973209d0bdae05b3533630b5193f091d91b65d686681272e0f7";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "name" => (17, 0, ""),
        "source_step" => (9, 0, ""),
        "grains" => (7, 0, ""),
        "density" => (11, 0, ""),
        "density_stddev" => (11, 0, ""),
        "pressure" => (11, 0, ""),
        "pressure_stddev" => (11, 0, ""),
        "solid_fraction" => (11, 0, ""),
        "stress_ratio" => (155, 0, ""),
        "stress_ratio_stddev" => (11, 0, ""),
        "size_spread" => (155, 0, ""),
        "axis" => (1, 0, "geometry_msgs/msg/Vector3"),
        "grain_shear_modulus" => (11, 0, ""),
        "grain_shear_modulus_stddev" => (11, 0, ""),
        "grain_poisson_ratio" => (11, 0, ""),
        "grain_poisson_ratio_stddev" => (11, 0, ""),
        "contact_law" => (17, 0, ""),
        "contact_law_parameters" => (155, 0, ""),
        "smooth" => (15, 0, ""),
        "speeds" => (145, 0, "grainlab_msgs/msg/WaveSpeed"),
        "warnings" => (161, 0, ""),
    );
    const DEFINITION: &'static str = definition!(
        "msg/WaveSpeeds.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
        "grainlab_msgs/WaveSpeed" => "msg/WaveSpeed.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
