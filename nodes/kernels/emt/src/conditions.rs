//! The state that the moduli belong to.

use crate::error::EmtError;
use grainlab_core::Material;
use grainlab_core::results::StrainRatios;
use std::fmt;

/// Where a γ/Δ comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GammaSource {
    /// The total strain since the reference state: mostly plastic history. What the paper's Table II holds.
    Total,
    /// The elastic strain of an isotropic stress increment.
    Elastic,
    /// A fit to the overlaps of the contacts.
    Contact,
    /// Given by whoever asks.
    Given,
    /// Not known, and set to zero.
    Zero,
}

impl GammaSource {
    /// As messages, parameters and results name it.
    pub const fn name(self) -> &'static str {
        match self {
            GammaSource::Total => "total",
            GammaSource::Elastic => "elastic",
            GammaSource::Contact => "contact",
            GammaSource::Given => "given",
            GammaSource::Zero => "zero",
        }
    }
}

/// The strain ratio g = γ/Δ that a model is fed with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gamma {
    /// g, dimensionless.
    pub value: f64,
    /// Standard deviation, dimensionless; 0 takes the value as exact.
    pub stddev: f64,
    /// Where it comes from.
    pub source: GammaSource,
}

impl Gamma {
    /// Not known: zero.
    pub const ZERO: Gamma = Gamma { value: 0.0, stddev: 0.0, source: GammaSource::Zero };

    /// A value given, taken as exact.
    pub const fn given(value: f64) -> Self {
        Self { value, stddev: 0.0, source: GammaSource::Given }
    }

    /// Whether the ratio that `source` names was measured.
    pub fn is_known(measured: &StrainRatios, source: GammaSource) -> bool {
        match source {
            GammaSource::Total => measured.total.is_some(),
            GammaSource::Elastic => measured.elastic.is_some(),
            GammaSource::Contact => measured.contact.is_some(),
            GammaSource::Given | GammaSource::Zero => false,
        }
    }

    /// What the paper's models take of a measured packing: the total ratio where it is known, else the one of the
    /// contacts, else zero.
    pub fn preferred(measured: &StrainRatios) -> Self {
        Self::of(measured, GammaSource::Total)
    }

    /// The ratio of a measured packing that `source` names; where it is not known, the one of the contacts, else zero.
    pub fn of(measured: &StrainRatios, source: GammaSource) -> Self {
        let with = |value: Option<f64>, source| value.map(|value| Gamma { value, stddev: 0.0, source });
        let wanted = match source {
            GammaSource::Total => with(measured.total, source),
            GammaSource::Elastic => with(measured.elastic, source),
            GammaSource::Contact => with(measured.contact, source),
            GammaSource::Given | GammaSource::Zero => Some(Self::ZERO),
        };
        wanted.or(with(measured.contact, GammaSource::Contact)).unwrap_or(Self::ZERO)
    }
}

impl fmt::Display for Gamma {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let source = match self.source {
            GammaSource::Total => "total strain since the reference state",
            GammaSource::Elastic => "elastic increment",
            GammaSource::Contact => "contact overlaps",
            GammaSource::Given => "given",
            GammaSource::Zero => "not known, taken as 0",
        };
        write!(f, "gamma/Delta = {:.4} ({source})", self.value)
    }
}

/// A number with the standard deviation of its error; 0 takes it as exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// One sigma, in the unit of the number.
    pub stddev: f64,
}

impl Measured {
    /// A number taken as exact.
    pub const fn exact(value: f64) -> Self {
        Self { value, stddev: 0.0 }
    }
}

/// Everything but moduli that a model may ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Confining pressure, Pa, positive in compression.
    pub pressure: Measured,
    /// γ/Δ of the state.
    pub gamma: Gamma,
    /// Solid fraction φ; `None` if not known.
    pub solid_fraction: Option<Measured>,
    /// What the grains are made of; `None` takes those of the calibration.
    pub material: Option<Material>,
}

impl Conditions {
    /// At this pressure, Pa, and nothing else known.
    pub const fn at(pressure: f64) -> Self {
        Self { pressure: Measured::exact(pressure), gamma: Gamma::ZERO, solid_fraction: None, material: None }
    }

    /// The first fault, if any.
    pub(crate) fn check(&self) -> Result<(), EmtError> {
        let finite = |quantity: &'static str, value: f64| {
            if value.is_finite() { Ok(()) } else { Err(EmtError::NotFinite { quantity, value }) }
        };
        finite("pressure", self.pressure.value)?;
        if self.pressure.value <= 0.0 {
            return Err(EmtError::NotPositive { quantity: "pressure", value: self.pressure.value });
        }
        let phi = self.solid_fraction;
        for (quantity, value) in [
            ("stddev of pressure", Some(self.pressure.stddev)),
            ("stddev of gamma/Delta", Some(self.gamma.stddev)),
            ("stddev of the solid fraction", phi.map(|p| p.stddev)),
        ] {
            let Some(value) = value else { continue };
            finite(quantity, value)?;
            if value < 0.0 {
                return Err(EmtError::NegativeStddev { quantity, value });
            }
        }
        finite("gamma/Delta", self.gamma.value)?;
        if let Some(phi) = phi
            && !(phi.value > 0.0 && phi.value < 1.0)
        {
            return Err(EmtError::SolidFraction { phi: phi.value });
        }
        if let Some(m) = &self.material {
            finite("shear modulus of the grains", m.shear_modulus)?;
            if m.shear_modulus <= 0.0 {
                let quantity = "shear modulus of the grains";
                return Err(EmtError::NotPositive { quantity, value: m.shear_modulus });
            }
            if !(0.0..=0.5).contains(&m.poisson_ratio) {
                return Err(EmtError::PoissonRatio { nu: m.poisson_ratio });
            }
        }
        Ok(())
    }
}
