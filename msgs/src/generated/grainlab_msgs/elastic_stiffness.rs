// Generated from msg/ElasticStiffness.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Stiffness of a packing, in the frame of the cell. Voigt order xx yy zz yz xz xy, engineering shear, row-major.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ElasticStiffness {
    /// one of METHOD_\*
    pub method: u8,
    /// without tangential springs
    pub smooth: bool,
    /// Pa
    #[serde(with = "crate::fixed_array")]
    pub stiffness: [f64; 36],
    /// Pa, error that the solver or the probe left in each entry
    #[serde(with = "crate::fixed_array")]
    pub stddev: [f64; 36],
    /// relative residual of the solve, worst of the six columns
    pub residual: f64,
    /// of the solve, 0 = direct
    pub iterations: u32,
    /// Pa, every grain moves with the mean deformation
    #[serde(with = "crate::fixed_array")]
    pub affine: [f64; 36],
    /// Pa, the same with one rotation of all grains
    #[serde(with = "crate::fixed_array")]
    pub uniform_rotation: [f64; 36],
    /// Pa, lower bound of the bulk modulus under isotropic stress, none without forces
    pub bulk_reuss_bound: Vec<f64>,
}

impl ElasticStiffness {
    /// relaxed frozen network, solved
    pub const METHOD_FROZEN_NETWORK: u8 = 0;

    /// small strains imposed on a simulation
    pub const METHOD_PROBE: u8 = 2;

    /// relaxed frozen network with the prestress term
    pub const METHOD_PRESTRESSED_NETWORK: u8 = 4;
}

impl Default for ElasticStiffness {
    fn default() -> Self {
        Self {
            method: Default::default(),
            smooth: Default::default(),
            stiffness: [f64::default(); 36],
            stddev: [f64::default(); 36],
            residual: Default::default(),
            iterations: Default::default(),
            affine: [f64::default(); 36],
            uniform_rotation: [f64::default(); 36],
            bulk_reuss_bound: Default::default(),
        }
    }
}

impl Message for ElasticStiffness {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "ElasticStiffness";
    const TYPE: &'static str = "grainlab_msgs/msg/ElasticStiffness";
    const HASH: &'static str = "RIHS01_cdbf7dca69735629ef96ab13693d444ad9cb1036df42dfd2abb671383cb77874";
    const FIELDS: &'static [FieldInfo] = fields!(
        "method" => (3, 0, ""),
        "smooth" => (15, 0, ""),
        "stiffness" => (59, 36, ""),
        "stddev" => (59, 36, ""),
        "residual" => (11, 0, ""),
        "iterations" => (7, 0, ""),
        "affine" => (59, 36, ""),
        "uniform_rotation" => (59, 36, ""),
        "bulk_reuss_bound" => (155, 0, ""),
    );
    const DEFINITION: &'static str = definition!("msg/ElasticStiffness.msg");
}
