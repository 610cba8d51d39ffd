//! `Moduli`: elastic moduli that an instrument measured, and the other inputs of an inversion.

use super::check::Check;
use super::error::BoundaryError;
use crate::msg;
use grainlab_core::contact::ContactLaw;
use grainlab_core::results::StrainRatios;
use grainlab_core::{Material, Vec3};

const CHECK: Check = Check("Moduli");

/// Checked moduli for an inversion, with `None` for values unknown to the sender.
#[derive(Clone, Debug, PartialEq)]
pub struct ModuliReading {
    /// Number of grains.
    pub grains: Option<u32>,
    /// Reference axis h, unit, of g12, g13, the covariance and γ/Δ; e3 if the sender gave none.
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
    /// Standard deviation of that, Pa; 0: exact, or not stated.
    pub pressure_stddev: f64,
    /// Solid fraction φ.
    pub solid_fraction: Option<f64>,
    /// Axial stress less the lateral one over pressure, (σ_hh − (tr σ − σ_hh)/2)/p, about the reference axis.
    pub stress_ratio: Option<f64>,
    /// Standard deviation of that; 0: exact, or not stated.
    pub stress_ratio_stddev: f64,
    /// Standard deviation of the radii over their mean.
    pub size_spread: Option<f64>,
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
    /// True for moduli without tangential springs.
    pub smooth: bool,
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
            strain_ratios: CHECK.strain_ratios(&m.strain_ratios)?,
            material: CHECK.material(m.grain_shear_modulus, m.grain_poisson_ratio, m.grain_density)?,
            shear_modulus_stddev: CHECK
                .not_negative("grain_shear_modulus_stddev", m.grain_shear_modulus_stddev)?,
            poisson_ratio_stddev: CHECK
                .not_negative("grain_poisson_ratio_stddev", m.grain_poisson_ratio_stddev)?,
            contact_law: CHECK.optional_contact_law(&m.contact_law, &m.contact_law_parameters)?,
            smooth: m.smooth,
        })
    }
}
