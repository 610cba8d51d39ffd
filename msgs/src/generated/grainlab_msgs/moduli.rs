// Generated from msg/Moduli.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::geometry_msgs::Vector3;
use crate::generated::grainlab_msgs::StrainRatios;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Elastic moduli that an instrument or another program measured on a sample, and what an inversion needs beside them. What may be
/// missing is an array of one entry, or of none; a direction that is not known is zero.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Moduli {
    /// copied from the source
    pub header: Header,
    /// of the sample or the measurement, copied into the answer, empty = none
    pub name: String,
    /// step of the Packing measured, 0 = not from a simulation
    pub source_step: u64,
    /// 0 = unknown
    pub grains: u32,
    /// h, unit, what the moduli and strain ratios are about, all 0 = e3 = z
    pub reference_axis: Vector3,
    /// Pa, shear modulus across h: with h as e3 (C11 + C22)/8 - C12/4 + C66/2
    pub g12: Vec<f64>,
    /// Pa, shear modulus along h: with h as e3 (C44 + C55)/2
    pub g13: Vec<f64>,
    /// Pa, Voigt bulk modulus C_iijj/9
    pub theta: Vec<f64>,
    /// Pa2, of (g12, g13, theta), row-major, nine or none
    pub covariance: Vec<f64>,
    /// Pa, confining, compression positive
    pub pressure: f64,
    /// Pa, 0 = exact, or not stated
    pub pressure_stddev: f64,
    /// Dimensionless.
    pub solid_fraction: Vec<f64>,
    /// axial stress less the lateral one over pressure, about h, one or none
    pub stress_ratio: Vec<f64>,
    /// 0 = exact, or not stated
    pub stress_ratio_stddev: f64,
    /// standard deviation of the radii over their mean, one or none
    pub size_spread: Vec<f64>,
    /// as measured on the sample
    pub strain_ratios: StrainRatios,
    /// Pa
    pub grain_shear_modulus: f64,
    /// Pa, 0 = exact, or not stated
    pub grain_shear_modulus_stddev: f64,
    /// Dimensionless.
    pub grain_poisson_ratio: f64,
    /// 0 = exact, or not stated
    pub grain_poisson_ratio_stddev: f64,
    /// kg/m3
    pub grain_density: f64,
    /// name, as in Packing, empty = unknown
    pub contact_law: String,
    /// as in Packing
    pub contact_law_parameters: Vec<f64>,
    /// measured without tangential springs
    pub smooth: bool,
}

impl Message for Moduli {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Moduli";
    const TYPE: &'static str = "grainlab_msgs/msg/Moduli";
    const HASH: &'static str = "RIHS01_8e4c4f01cd57e89dae67442a1490678a24757eac850a35dfb788b436c40fc2b9";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "name" => (17, 0, ""),
        "source_step" => (9, 0, ""),
        "grains" => (7, 0, ""),
        "reference_axis" => (1, 0, "geometry_msgs/msg/Vector3"),
        "g12" => (155, 0, ""),
        "g13" => (155, 0, ""),
        "theta" => (155, 0, ""),
        "covariance" => (155, 0, ""),
        "pressure" => (11, 0, ""),
        "pressure_stddev" => (11, 0, ""),
        "solid_fraction" => (155, 0, ""),
        "stress_ratio" => (155, 0, ""),
        "stress_ratio_stddev" => (11, 0, ""),
        "size_spread" => (155, 0, ""),
        "strain_ratios" => (1, 0, "grainlab_msgs/msg/StrainRatios"),
        "grain_shear_modulus" => (11, 0, ""),
        "grain_shear_modulus_stddev" => (11, 0, ""),
        "grain_poisson_ratio" => (11, 0, ""),
        "grain_poisson_ratio_stddev" => (11, 0, ""),
        "grain_density" => (11, 0, ""),
        "contact_law" => (17, 0, ""),
        "contact_law_parameters" => (155, 0, ""),
        "smooth" => (15, 0, ""),
    );
    const DEFINITION: &'static str = definition!(
        "msg/Moduli.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
        "grainlab_msgs/StrainRatios" => "msg/StrainRatios.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
