// Generated from msg/Moduli.msg by examples/generate; not edited by hand.

use crate::generated::geometry_msgs::Vector3;
use crate::generated::std_msgs::Header;
use crate::message::{Message, definition};
use serde::{Deserialize, Serialize};

/// Effective stiffness, with what an inversion needs beside it.
/// Voigt order xx yy zz yz xz xy, engineering shear, stiffnesses in the frame of the cell. h is the reference axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moduli {
    /// copied from the source
    pub header: Header,
    /// step of the Packing measured, 0 = not from a simulation
    pub source_step: u64,
    /// one of METHOD_\*
    pub method: u8,
    /// 0 = unknown
    pub grains: u32,
    /// Pa, row-major, all 0 = only the moduli below are known
    #[serde(with = "crate::fixed_array")]
    pub stiffness: [f64; 36],
    /// Pa, row-major, as a measurement of this packing, 0 = unknown
    #[serde(with = "crate::fixed_array")]
    pub stiffness_stddev: [f64; 36],
    /// Pa, row-major, all 0 = not computed
    #[serde(with = "crate::fixed_array")]
    pub stiffness_affine: [f64; 36],
    /// Pa, row-major, affine motion with one spin of all grains, all 0 = not computed
    #[serde(with = "crate::fixed_array")]
    pub stiffness_mean_spin: [f64; 36],
    /// h, unit, what the fields from g12 on are about, all 0 = e3 = z
    pub reference_axis: Vector3,
    /// Pa, shear modulus across h: with h as e3 (C11 + C22)/8 - C12/4 + C66/2, 0 = unknown
    pub g12: f64,
    /// Pa, shear modulus along h: with h as e3 (C44 + C55)/2, 0 = unknown
    pub g13: f64,
    /// Pa, Voigt bulk modulus C_iijj/9, 0 = unknown
    pub theta: f64,
    /// Pa, Reuss bulk modulus, 0 = undefined
    pub theta_reuss: f64,
    /// Pa, lower bound of theta_reuss by the forces present, 0 = unknown
    pub theta_bound: f64,
    /// Pa2, of (g12, g13, theta), row-major, all 0 = unknown
    pub covariance: [f64; 9],
    /// Pa, confining, compression positive
    pub pressure: f64,
    /// 0 = unknown
    pub solid_fraction: f64,
    /// unit axis of symmetry found, all 0 = unknown
    pub axis: Vector3,
    /// whether the next field is valid
    pub gamma_over_delta_total_known: bool,
    /// of the strain since the reference state, else 0
    pub gamma_over_delta_total: f64,
    /// whether the next field is valid
    pub gamma_over_delta_elastic_known: bool,
    /// of an isotropic stress increment on the frozen network, else 0
    pub gamma_over_delta_elastic: f64,
    /// whether the next field is valid
    pub gamma_over_delta_contact_known: bool,
    /// fitted to the overlaps, else 0
    pub gamma_over_delta_contact: f64,
    /// measured 2 contacts / grains, 0 = unknown (an instrument does not know it)
    pub k: f64,
    /// measured k without rattlers, 0 = unknown
    pub z: f64,
    /// measured fabric anisotropy about h, valid only if k is known
    pub eps: f64,
    /// Pa
    pub grain_shear_modulus: f64,
    /// Dimensionless.
    pub grain_poisson_ratio: f64,
    /// kg/m3
    pub grain_density: f64,
    /// relative residual of the solve, worst of the six columns
    pub residual: f64,
    /// of the solve, 0 = direct
    pub iterations: u32,
}

impl Moduli {
    /// relaxed frozen network, solved
    pub const METHOD_FROZEN_NETWORK: u8 = 0;

    /// every grain moves with the mean deformation
    pub const METHOD_AFFINE: u8 = 1;

    /// small strains imposed on a simulation
    pub const METHOD_PROBE: u8 = 2;

    /// from wave speeds
    pub const METHOD_ACOUSTIC: u8 = 3;

    /// relaxed frozen network with the prestress term
    pub const METHOD_PRESTRESSED_NETWORK: u8 = 4;
}

impl Default for Moduli {
    fn default() -> Self {
        Self {
            header: Default::default(),
            source_step: Default::default(),
            method: Default::default(),
            grains: Default::default(),
            stiffness: [f64::default(); 36],
            stiffness_stddev: [f64::default(); 36],
            stiffness_affine: [f64::default(); 36],
            stiffness_mean_spin: [f64::default(); 36],
            reference_axis: Default::default(),
            g12: Default::default(),
            g13: Default::default(),
            theta: Default::default(),
            theta_reuss: Default::default(),
            theta_bound: Default::default(),
            covariance: Default::default(),
            pressure: Default::default(),
            solid_fraction: Default::default(),
            axis: Default::default(),
            gamma_over_delta_total_known: Default::default(),
            gamma_over_delta_total: Default::default(),
            gamma_over_delta_elastic_known: Default::default(),
            gamma_over_delta_elastic: Default::default(),
            gamma_over_delta_contact_known: Default::default(),
            gamma_over_delta_contact: Default::default(),
            k: Default::default(),
            z: Default::default(),
            eps: Default::default(),
            grain_shear_modulus: Default::default(),
            grain_poisson_ratio: Default::default(),
            grain_density: Default::default(),
            residual: Default::default(),
            iterations: Default::default(),
        }
    }
}

impl Message for Moduli {
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Moduli";
    const TYPE: &'static str = "grainlab_msgs/msg/Moduli";
    const HASH: &'static str = "RIHS01_318c2b545bbf49b10543bcb934dc26d3dd5fa095965753bc4c4c3277acc1c604";
    const DEFINITION: &'static str = definition!(
        "msg/Moduli.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
