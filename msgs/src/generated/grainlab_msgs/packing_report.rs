// Generated from msg/PackingReport.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::grainlab_msgs::ContactStatistics;
use crate::generated::grainlab_msgs::ElasticStiffness;
use crate::generated::grainlab_msgs::Fabric;
use crate::generated::grainlab_msgs::StrainRatios;
use crate::generated::grainlab_msgs::StressDecomposition;
use crate::generated::grainlab_msgs::SymmetricTensor;
use crate::generated::grainlab_msgs::Symmetry;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// Everything that is measured on one packing, and all that an inversion reads of it.
/// What may be missing is an array of one entry, or of none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PackingReport {
    /// copied from the Packing measured
    pub header: Header,
    /// step of the Packing measured
    pub source_step: u64,
    /// Pa
    pub grain_shear_modulus: f64,
    /// Dimensionless.
    pub grain_poisson_ratio: f64,
    /// kg/m3
    pub grain_density: f64,
    /// name, as in Packing
    pub contact_law: String,
    /// as in Packing
    pub contact_law_parameters: Vec<f64>,
    /// in force, may be +inf
    pub friction: f64,
    /// Dimensionless.
    pub solid_fraction: f64,
    /// standard deviation of the radii over their mean
    pub size_spread: f64,
    /// logarithmic, positive in extension, since the reference state, else the first step of the run
    pub strain: Vec<SymmetricTensor>,
    /// Pa, of the elastic contact forces, positive in compression
    pub stress: SymmetricTensor,
    /// Pa, largest difference across the diagonal before the symmetric part was taken
    pub stress_asymmetry: f64,
    /// mean net force of non-rattlers over mean contact force, none without forces
    pub unbalanced_force_ratio: Vec<f64>,
    /// `ContactStatistics contacts`.
    pub contacts: ContactStatistics,
    /// `Fabric fabric`.
    pub fabric: Fabric,
    /// `StressDecomposition stress_decomposition`.
    pub stress_decomposition: StressDecomposition,
    /// `StrainRatios strain_ratios`.
    pub strain_ratios: StrainRatios,
    /// JAMMED, or why there is no stiffness
    pub jamming: u8,
    /// contacts that resist no strain, 0 unless FLOPPY
    pub floppy_contacts: u32,
    /// one if JAMMED
    pub stiffness: Vec<ElasticStiffness>,
    /// of the stiffness, one or none
    pub symmetry: Vec<Symmetry>,
}

impl PackingReport {
    /// it has a stiffness
    pub const JAMMED: u8 = 0;

    /// it has none, as no two grains touch
    pub const NO_CONTACTS: u8 = 1;

    /// it has none, as every grain is a rattler
    pub const ONLY_RATTLERS: u8 = 2;

    /// it has none, as its contacts resist no strain
    pub const FLOPPY: u8 = 3;
}

impl Message for PackingReport {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "PackingReport";
    const TYPE: &'static str = "grainlab_msgs/msg/PackingReport";
    const HASH: &'static str = "RIHS01_7d660bbf93986277c014bd37dff185b7796bb688309acff5f6cfde8b1686172e";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "source_step" => (9, 0, ""),
        "grain_shear_modulus" => (11, 0, ""),
        "grain_poisson_ratio" => (11, 0, ""),
        "grain_density" => (11, 0, ""),
        "contact_law" => (17, 0, ""),
        "contact_law_parameters" => (155, 0, ""),
        "friction" => (11, 0, ""),
        "solid_fraction" => (11, 0, ""),
        "size_spread" => (11, 0, ""),
        "strain" => (145, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "stress" => (1, 0, "grainlab_msgs/msg/SymmetricTensor"),
        "stress_asymmetry" => (11, 0, ""),
        "unbalanced_force_ratio" => (155, 0, ""),
        "contacts" => (1, 0, "grainlab_msgs/msg/ContactStatistics"),
        "fabric" => (1, 0, "grainlab_msgs/msg/Fabric"),
        "stress_decomposition" => (1, 0, "grainlab_msgs/msg/StressDecomposition"),
        "strain_ratios" => (1, 0, "grainlab_msgs/msg/StrainRatios"),
        "jamming" => (3, 0, ""),
        "floppy_contacts" => (7, 0, ""),
        "stiffness" => (145, 0, "grainlab_msgs/msg/ElasticStiffness"),
        "symmetry" => (145, 0, "grainlab_msgs/msg/Symmetry"),
    );
    const DEFINITION: &'static str = definition!(
        "msg/PackingReport.msg",
        "grainlab_msgs/ContactStatistics" => "msg/ContactStatistics.msg",
        "grainlab_msgs/ForceStatistics" => "msg/ForceStatistics.msg",
        "grainlab_msgs/MobilisedFriction" => "msg/MobilisedFriction.msg",
        "grainlab_msgs/ElasticStiffness" => "msg/ElasticStiffness.msg",
        "grainlab_msgs/Fabric" => "msg/Fabric.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
        "grainlab_msgs/OrientationHistogram" => "msg/OrientationHistogram.msg",
        "grainlab_msgs/OrientationFit" => "msg/OrientationFit.msg",
        "grainlab_msgs/OverlapAnisotropyFit" => "msg/OverlapAnisotropyFit.msg",
        "grainlab_msgs/PrincipalAxis" => "msg/PrincipalAxis.msg",
        "grainlab_msgs/SymmetricTensor" => "msg/SymmetricTensor.msg",
        "grainlab_msgs/StrainRatios" => "msg/StrainRatios.msg",
        "grainlab_msgs/StressDecomposition" => "msg/StressDecomposition.msg",
        "grainlab_msgs/StressForceFabric" => "msg/StressForceFabric.msg",
        "grainlab_msgs/SubNetwork" => "msg/SubNetwork.msg",
        "grainlab_msgs/Symmetry" => "msg/Symmetry.msg",
        "grainlab_msgs/TransverseIsotropy" => "msg/TransverseIsotropy.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
