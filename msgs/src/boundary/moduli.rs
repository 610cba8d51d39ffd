//! `Moduli`: stiffness, and what an inversion needs beside it.

use super::BoundaryError;
use super::check::{Check, ratios, vector_message};
use crate::builtin_interfaces::Time;
use crate::msg;
use crate::std_msgs::Header;
use grainlab_core::results::{
    ElasticStiffness, PackingReport, StiffnessBounds, StiffnessMethod, StrainRatios,
};
use grainlab_core::{Material, Stiffness, Vec3};

const CHECK: Check = Check("Moduli");

/// How moduli were obtained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModuliMethod {
    /// Relaxed frozen network, solved.
    FrozenNetwork,
    /// Every grain moves with the mean deformation.
    Affine,
    /// Small strains imposed on a simulation.
    Probe,
    /// From wave speeds.
    Acoustic,
    /// Relaxed frozen network with the prestress term, solved.
    PrestressedNetwork,
}

impl ModuliMethod {
    /// One word for it, as tables and files have it.
    pub fn word(self) -> &'static str {
        match self {
            Self::FrozenNetwork => "frozen_network",
            Self::Affine => "affine",
            Self::Probe => "probe",
            Self::Acoustic => "acoustic",
            Self::PrestressedNetwork => "prestressed_network",
        }
    }

    /// As messages have it.
    pub fn code(self) -> u8 {
        match self {
            Self::FrozenNetwork => msg::Moduli::METHOD_FROZEN_NETWORK,
            Self::Affine => msg::Moduli::METHOD_AFFINE,
            Self::Probe => msg::Moduli::METHOD_PROBE,
            Self::Acoustic => msg::Moduli::METHOD_ACOUSTIC,
            Self::PrestressedNetwork => msg::Moduli::METHOD_PRESTRESSED_NETWORK,
        }
    }
}

impl From<StiffnessMethod> for ModuliMethod {
    fn from(method: StiffnessMethod) -> Self {
        match method {
            StiffnessMethod::FrozenNetwork => Self::FrozenNetwork,
            StiffnessMethod::PrestressedNetwork => Self::PrestressedNetwork,
            StiffnessMethod::StrainProbe => Self::Probe,
        }
    }
}

/// Moduli as an inversion takes them: checked, and with `None` for what the sender did not know.
#[derive(Clone, Debug, PartialEq)]
pub struct ModuliReading {
    /// Stamp of the source.
    pub stamp: Time,
    /// Step of the packing measured.
    pub source_step: u64,
    /// How they were obtained.
    pub method: ModuliMethod,
    /// Number of grains.
    pub grains: Option<u32>,
    /// Reference axis h, unit, which g12, g13, c11, c33, c13, the covariance, γ/Δ and ε are about; e3 if the sender named
    /// none. Stiffnesses are in the frame of the cell.
    pub reference_axis: Vec3,
    /// Shear modulus in the plane of isotropy, Pa.
    pub g12: Option<f64>,
    /// Shear modulus along h, Pa.
    pub g13: Option<f64>,
    /// Voigt bulk modulus Θ, Pa.
    pub theta: Option<f64>,
    /// Reuss bulk modulus, Pa.
    pub theta_reuss: Option<f64>,
    /// Lower bound of that, Pa.
    pub theta_bound: Option<f64>,
    /// Projected C11, Pa.
    pub c11: Option<f64>,
    /// C33, Pa.
    pub c33: Option<f64>,
    /// Projected C13, Pa.
    pub c13: Option<f64>,
    /// Full stiffness.
    pub stiffness: Option<Stiffness>,
    /// Standard error of each entry of the stiffness, as a measurement of one packing.
    pub stddev: Option<Stiffness>,
    /// Affine stiffness.
    pub affine: Option<Stiffness>,
    /// Stiffness of affine motion with one spin of all grains.
    pub mean_spin: Option<Stiffness>,
    /// Covariance of (g12, g13, Θ), row-major, Pa².
    pub covariance: Option<[f64; 9]>,
    /// Confining pressure, Pa, 0 or more.
    pub pressure: f64,
    /// Solid fraction φ.
    pub solid_fraction: Option<f64>,
    /// Unit axis of symmetry found.
    pub axis: Option<Vec3>,
    /// The three ratios γ/Δ.
    pub gamma_over_delta: StrainRatios,
    /// Measured coordination number k.
    pub k: Option<f64>,
    /// Measured coordination number without rattlers.
    pub z: Option<f64>,
    /// Measured fabric anisotropy ε; known if `k` is.
    pub eps: Option<f64>,
    /// Material of the grains.
    pub material: Material,
}

/// The message of the stiffness of a packing, moduli about the reference axis of its fabric; `header` is that of the packing.
/// The covariance of G12, G13 and Θ is left unknown: it is to say how packings of one kind differ, and one packing does not.
pub fn moduli_message(
    header: Header,
    report: &PackingReport,
    stiffness: &ElasticStiffness,
) -> Result<msg::Moduli, BoundaryError> {
    let axis = report.fabric.reference_axis;
    let (tensor, bounds) = (&stiffness.tensor, &stiffness.bounds);
    let projected = tensor.transverse_isotropy_about(&axis);
    let [total, elastic, contact] = ratios(&report.strain_ratios);
    let message = msg::Moduli {
        header,
        source_step: report.step,
        method: ModuliMethod::from(stiffness.method).code(),
        grains: report.contacts.grains,
        stiffness: tensor.row_major(),
        stiffness_stddev: stiffness.stddev.row_major(),
        stiffness_affine: bounds.affine.row_major(),
        stiffness_mean_spin: bounds.uniform_rotation.row_major(),
        reference_axis: vector_message(&axis),
        g12: projected.g12,
        g13: projected.g13,
        theta: tensor.bulk_voigt(),
        theta_reuss: tensor.bulk_reuss().unwrap_or(0.0),
        theta_bound: bounds.bulk_reuss.unwrap_or(0.0),
        covariance: [0.0; 9],
        pressure: report.pressure(),
        solid_fraction: report.solid_fraction,
        axis: vector_message(&report.fabric.principal_axis.direction),
        gamma_over_delta_total_known: total.0,
        gamma_over_delta_total: total.1,
        gamma_over_delta_elastic_known: elastic.0,
        gamma_over_delta_elastic: elastic.1,
        gamma_over_delta_contact_known: contact.0,
        gamma_over_delta_contact: contact.1,
        k: report.contacts.coordination,
        z: report.contacts.mechanical_coordination,
        eps: report.fabric.contact_anisotropy,
        grain_shear_modulus: report.material.shear_modulus,
        grain_poisson_ratio: report.material.poisson_ratio,
        grain_density: report.material.density,
        residual: stiffness.residual,
        iterations: stiffness.iterations,
    };
    ModuliReading::try_from(&message)?;
    Ok(message)
}

impl TryFrom<&msg::Moduli> for ModuliReading {
    type Error = BoundaryError;

    fn try_from(m: &msg::Moduli) -> Result<Self, BoundaryError> {
        CHECK.header(&m.header)?;
        let stiffness = known_stiffness("stiffness", &m.stiffness)?;
        let reference_axis = CHECK.direction("reference_axis", &m.reference_axis)?.unwrap_or_else(Vec3::z);
        let projected = stiffness.map(|c| c.transverse_isotropy_about(&reference_axis));
        for (i, stddev) in m.stiffness_stddev.iter().enumerate() {
            CHECK.not_negative(&format!("stiffness_stddev[{i}]"), *stddev)?;
        }
        CHECK.not_negative("residual", m.residual)?;
        let k = CHECK.known("k", m.k)?;
        Ok(Self {
            stamp: m.header.stamp,
            source_step: m.source_step,
            method: method(m.method)?,
            grains: Some(m.grains).filter(|n| *n > 0),
            reference_axis,
            g12: not_zero("g12", m.g12)?,
            g13: not_zero("g13", m.g13)?,
            theta: not_zero("theta", m.theta)?,
            theta_reuss: not_zero("theta_reuss", m.theta_reuss)?,
            c11: projected.map(|t| t.c11),
            c33: projected.map(|t| t.c33),
            c13: projected.map(|t| t.c13),
            theta_bound: CHECK.known("theta_bound", m.theta_bound)?,
            stiffness,
            stddev: known_stiffness("stiffness_stddev", &m.stiffness_stddev)?,
            mean_spin: known_stiffness("stiffness_mean_spin", &m.stiffness_mean_spin)?,
            affine: known_stiffness("stiffness_affine", &m.stiffness_affine)?,
            covariance: CHECK.covariance("covariance", &m.covariance)?,
            pressure: CHECK.not_negative("pressure", m.pressure)?,
            solid_fraction: CHECK.known("solid_fraction", m.solid_fraction)?,
            axis: CHECK.direction("axis", &m.axis)?,
            gamma_over_delta: anisotropy(m)?,
            k,
            z: CHECK.known("z", m.z)?,
            eps: match k {
                Some(_) => Some(CHECK.finite("eps", m.eps)?),
                None => None,
            },
            material: material(m)?,
        })
    }
}

/// The kernels' stiffness, of a message that knows it and its bounds.
impl TryFrom<&msg::Moduli> for ElasticStiffness {
    type Error = BoundaryError;

    fn try_from(m: &msg::Moduli) -> Result<Self, BoundaryError> {
        let reading = ModuliReading::try_from(m)?;
        let missing = |field: &str| BoundaryError::Value {
            message: "Moduli",
            field: field.to_owned(),
            value: 0.0,
            requirement: "known: the message holds only zeros there",
        };
        Ok(Self {
            tensor: reading.stiffness.ok_or_else(|| missing("stiffness"))?,
            stddev: reading.stddev.ok_or_else(|| missing("stiffness_stddev"))?,
            bounds: StiffnessBounds {
                affine: reading.affine.ok_or_else(|| missing("stiffness_affine"))?,
                uniform_rotation: reading.mean_spin.ok_or_else(|| missing("stiffness_mean_spin"))?,
                bulk_reuss: reading.theta_bound,
            },
            method: match reading.method {
                ModuliMethod::FrozenNetwork => StiffnessMethod::FrozenNetwork,
                ModuliMethod::PrestressedNetwork => StiffnessMethod::PrestressedNetwork,
                ModuliMethod::Probe => StiffnessMethod::StrainProbe,
                ModuliMethod::Affine | ModuliMethod::Acoustic => {
                    let measured = "0 (frozen network), 2 (probe), 4 (prestressed network)";
                    return Err(CHECK.code("method", m.method, measured));
                }
            },
            residual: m.residual,
            iterations: m.iterations,
        })
    }
}

/// A finite number of either sign; `None` if it is 0.
fn not_zero(field: &str, value: f64) -> Result<Option<f64>, BoundaryError> {
    Ok(Some(CHECK.finite(field, value)?).filter(|v| *v != 0.0))
}

fn known_stiffness(field: &str, values: &[f64; 36]) -> Result<Option<Stiffness>, BoundaryError> {
    CHECK.all_finite(field, values)?;
    let known = values.iter().any(|v| *v != 0.0);
    Ok(known.then(|| Stiffness::from_row_major(values)))
}

fn method(code: u8) -> Result<ModuliMethod, BoundaryError> {
    match code {
        msg::Moduli::METHOD_FROZEN_NETWORK => Ok(ModuliMethod::FrozenNetwork),
        msg::Moduli::METHOD_AFFINE => Ok(ModuliMethod::Affine),
        msg::Moduli::METHOD_PROBE => Ok(ModuliMethod::Probe),
        msg::Moduli::METHOD_ACOUSTIC => Ok(ModuliMethod::Acoustic),
        msg::Moduli::METHOD_PRESTRESSED_NETWORK => Ok(ModuliMethod::PrestressedNetwork),
        other => {
            let known = "0 (frozen network), 1 (affine), 2 (probe), 3 (acoustic), 4 (prestressed network)";
            Err(CHECK.code("method", other, known))
        }
    }
}

fn anisotropy(m: &msg::Moduli) -> Result<StrainRatios, BoundaryError> {
    let total = (m.gamma_over_delta_total_known, m.gamma_over_delta_total);
    let elastic = (m.gamma_over_delta_elastic_known, m.gamma_over_delta_elastic);
    let contact = (m.gamma_over_delta_contact_known, m.gamma_over_delta_contact);
    Ok(StrainRatios {
        total: CHECK.ratio("gamma_over_delta_total", total)?,
        elastic: CHECK.ratio("gamma_over_delta_elastic", elastic)?,
        contact: CHECK.ratio("gamma_over_delta_contact", contact)?,
    })
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
