//! `Moduli`: elastic moduli, and the other inputs of an inversion.

use super::check::{Check, strain_ratios_message, vector_message};
use super::elastic_stiffness::{elastic_stiffness, elastic_stiffness_message};
use super::error::BoundaryError;
use crate::msg;
use crate::std_msgs::Header;
use grainlab_core::contact::ContactLaw;
use grainlab_core::results::{ElasticStiffness, PackingReport, StrainRatios};
use grainlab_core::{Material, Vec3};

const CHECK: Check = Check("Moduli");

/// Checked moduli for an inversion, with `None` for values unknown to the sender.
#[derive(Clone, Debug, PartialEq)]
pub struct ModuliReading {
    /// Number of grains.
    pub grains: Option<u32>,
    /// Reference axis h, unit, of g12, g13, the covariance and γ/Δ; e3 if the sender gave none. The stiffness
    /// is in the frame of the cell.
    pub reference_axis: Vec3,
    /// Shear modulus in the plane of isotropy, Pa.
    pub g12: Option<f64>,
    /// Shear modulus along h, Pa.
    pub g13: Option<f64>,
    /// Voigt bulk modulus Θ, Pa.
    pub theta: Option<f64>,
    /// Covariance of (g12, g13, Θ), row-major, Pa².
    pub covariance: Option<[f64; 9]>,
    /// Confining pressure, Pa, 0 or more.
    pub pressure: f64,
    /// Its standard deviation, Pa; 0: exact, or not stated.
    pub pressure_stddev: f64,
    /// Solid fraction φ.
    pub solid_fraction: Option<f64>,
    /// Axial stress less the lateral one over pressure, (σ_hh − (tr σ − σ_hh)/2)/p, about the reference axis.
    pub stress_ratio: Option<f64>,
    /// Its standard deviation; 0: exact, or not stated.
    pub stress_ratio_stddev: f64,
    /// Standard deviation of the radii over their mean.
    pub size_spread: Option<f64>,
    /// Unit axis of symmetry that was found.
    pub axis: Option<Vec3>,
    /// The three ratios γ/Δ.
    pub strain_ratios: StrainRatios,
    /// Material of the grains.
    pub material: Material,
    /// Standard deviation of its shear modulus, Pa; 0: exact, or not stated.
    pub shear_modulus_stddev: f64,
    /// Standard deviation of its Poisson ratio; 0: exact, or not stated.
    pub poisson_ratio_stddev: f64,
    /// Contact law of the grains.
    pub contact_law: Option<ContactLaw>,
    /// Whether the moduli are those without tangential springs.
    pub smooth: bool,
    /// The full stiffness, of a packing.
    pub stiffness: Option<ElasticStiffness>,
}

/// The message with the stiffness of a packing, with moduli about the reference axis of its fabric; `header`
/// is that of the packing. The covariance of G12, G13 and Θ is left unknown: it describes the scatter between
/// packings of one kind, which one packing does not show.
pub fn moduli_message(
    header: Header,
    report: &PackingReport,
    stiffness: &ElasticStiffness,
) -> Result<msg::Moduli, BoundaryError> {
    let axis = report.fabric.reference_axis;
    let projected = stiffness.tensor.transverse_isotropy_about(&axis);
    let message = msg::Moduli {
        header,
        name: String::new(),
        source_step: report.step,
        grains: report.contacts.grains,
        reference_axis: vector_message(&axis),
        g12: vec![projected.g12],
        g13: vec![projected.g13],
        theta: vec![stiffness.tensor.bulk_voigt()],
        covariance: Vec::new(),
        pressure: report.pressure(),
        pressure_stddev: 0.0,
        solid_fraction: vec![report.solid_fraction],
        stress_ratio: report.axial_stress_ratio().into_iter().collect(),
        stress_ratio_stddev: 0.0,
        size_spread: vec![report.size_spread],
        axis: vector_message(&report.fabric.principal_axis.direction),
        strain_ratios: strain_ratios_message(&report.strain_ratios),
        grain_shear_modulus: report.material.shear_modulus,
        grain_shear_modulus_stddev: 0.0,
        grain_poisson_ratio: report.material.poisson_ratio,
        grain_poisson_ratio_stddev: 0.0,
        grain_density: report.material.density,
        contact_law: report.law.name().to_owned(),
        contact_law_parameters: report.law.parameters(),
        smooth: false,
        stiffness: vec![elastic_stiffness_message(stiffness)],
    };
    ModuliReading::try_from(&message)?;
    Ok(message)
}

impl TryFrom<&msg::Moduli> for ModuliReading {
    type Error = BoundaryError;

    fn try_from(m: &msg::Moduli) -> Result<Self, BoundaryError> {
        CHECK.header(&m.header)?;
        Ok(Self {
            grains: Some(m.grains).filter(|n| *n > 0),
            reference_axis: CHECK.direction("reference_axis", &m.reference_axis)?.unwrap_or_else(Vec3::z),
            g12: CHECK.optional_finite("g12", &m.g12)?,
            g13: CHECK.optional_finite("g13", &m.g13)?,
            theta: CHECK.optional_finite("theta", &m.theta)?,
            covariance: CHECK.covariance("covariance", &m.covariance)?,
            pressure: CHECK.not_negative("pressure", m.pressure)?,
            pressure_stddev: CHECK.not_negative("pressure_stddev", m.pressure_stddev)?,
            solid_fraction: CHECK.optional_positive("solid_fraction", &m.solid_fraction)?,
            stress_ratio: CHECK.optional_finite("stress_ratio", &m.stress_ratio)?,
            stress_ratio_stddev: CHECK.stddev(
                "stress_ratio_stddev",
                m.stress_ratio_stddev,
                !m.stress_ratio.is_empty(),
            )?,
            size_spread: CHECK.optional_not_negative("size_spread", &m.size_spread)?,
            axis: CHECK.direction("axis", &m.axis)?,
            strain_ratios: CHECK.strain_ratios(&m.strain_ratios)?,
            material: material(m)?,
            shear_modulus_stddev: CHECK
                .not_negative("grain_shear_modulus_stddev", m.grain_shear_modulus_stddev)?,
            poisson_ratio_stddev: CHECK
                .not_negative("grain_poisson_ratio_stddev", m.grain_poisson_ratio_stddev)?,
            contact_law: CHECK.optional_contact_law(&m.contact_law, &m.contact_law_parameters)?,
            smooth: m.smooth,
            stiffness: CHECK.optional("stiffness", &m.stiffness, |_, s| elastic_stiffness(CHECK, s))?,
        })
    }
}

fn material(m: &msg::Moduli) -> Result<Material, BoundaryError> {
    let (name, poisson_ratio) = ("grain_poisson_ratio", m.grain_poisson_ratio);
    Ok(Material {
        shear_modulus: CHECK.positive("grain_shear_modulus", m.grain_shear_modulus)?,
        poisson_ratio: CHECK.that(
            (0.0..=0.5).contains(&poisson_ratio),
            name,
            poisson_ratio,
            "between 0 and 0.5",
        )?,
        density: CHECK.positive("grain_density", m.grain_density)?,
    })
}
