//! What is observed of a packing.

use crate::error::EmtError;
use grains::{Anisotropy, Mat3};
use nalgebra::{Matrix5, SymmetricEigen};
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

    /// What the paper's models take of a measured packing: the total ratio where it is known, else the one of the
    /// contacts, else zero.
    pub fn preferred(measured: &Anisotropy) -> Self {
        Self::of(measured, GammaSource::Total)
    }

    /// The ratio of a measured packing that `source` names; where it is not known, the one of the contacts, else zero.
    pub fn of(measured: &Anisotropy, source: GammaSource) -> Self {
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

/// The moduli of one transversely isotropic packing and the state they belong to.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// Shear modulus in the plane of isotropy, Pa.
    pub g12: f64,
    /// Shear modulus along the axis, Pa.
    pub g13: f64,
    /// Voigt bulk modulus Θ = C_iijj/9, Pa.
    pub theta: f64,
    /// Confining pressure, Pa, positive in compression.
    pub pressure: f64,
    /// Standard deviation of the pressure, Pa; 0 takes it as exact.
    pub pressure_stddev: f64,
    /// γ/Δ of the state.
    pub gamma: Gamma,
    /// Covariance of (G12, G13, Θ), Pa²; `None` if their uncertainty is not known.
    pub covariance: Option<Mat3>,
}

impl Observation {
    /// Moduli and pressure in Pa, of unknown uncertainty.
    pub fn new(g12: f64, g13: f64, theta: f64, pressure: f64, gamma: Gamma) -> Self {
        Self { g12, g13, theta, pressure, pressure_stddev: 0.0, gamma, covariance: None }
    }

    /// The same with an independent one-sigma relative error on each of G12, G13 and Θ: 0.01 is one percent.
    pub fn with_relative_error(mut self, relative: f64) -> Self {
        let sigma = [self.g12, self.g13, self.theta].map(|modulus| relative * modulus);
        self.covariance = Some(Mat3::from_diagonal(&sigma.map(|s| s * s).into()));
        self
    }

    /// The same with this covariance of (G12, G13, Θ), Pa².
    pub fn with_covariance(mut self, covariance: Mat3) -> Self {
        self.covariance = Some(covariance);
        self
    }

    /// The first fault, if any. Every model calls this first.
    pub fn check(&self) -> Result<(), EmtError> {
        for (quantity, value) in
            [("G12", self.g12), ("G13", self.g13), ("Theta", self.theta), ("pressure", self.pressure)]
        {
            if !value.is_finite() {
                return Err(EmtError::NotFinite { quantity, value });
            }
            if value <= 0.0 {
                return Err(EmtError::NotPositive { quantity, value });
            }
        }
        for (quantity, value) in
            [("stddev of pressure", self.pressure_stddev), ("stddev of gamma/Delta", self.gamma.stddev)]
        {
            if !value.is_finite() {
                return Err(EmtError::NotFinite { quantity, value });
            }
            if value < 0.0 {
                return Err(EmtError::NegativeStddev { quantity, value });
            }
        }
        let g = self.gamma.value;
        if !g.is_finite() {
            return Err(EmtError::NotFinite { quantity: "gamma/Delta", value: g });
        }
        if !(g > -1.0 && g < 0.5) {
            return Err(EmtError::GammaOutOfRange { g });
        }
        self.covariance.as_ref().map_or(Ok(()), check_covariance)
    }

    /// Covariance of (ln G12, ln G13, ln Θ, ln p, g); `None` if that of the moduli is not known.
    pub(crate) fn log_covariance(&self) -> Option<Matrix5<f64>> {
        let covariance = self.covariance.as_ref()?;
        let moduli = [self.g12, self.g13, self.theta];
        let mut log = Matrix5::zeros();
        for i in 0..3 {
            for j in 0..3 {
                log[(i, j)] = covariance[(i, j)] / moduli[i] / moduli[j];
            }
        }
        log[(3, 3)] = (self.pressure_stddev / self.pressure).powi(2);
        log[(4, 4)] = self.gamma.stddev.powi(2);
        Some(log)
    }
}

/// A covariance is finite, symmetric and has no negative eigenvalue, to the rounding of a file or a message.
fn check_covariance(covariance: &Mat3) -> Result<(), EmtError> {
    if let Some(&value) = covariance.iter().find(|v| !v.is_finite()) {
        return Err(EmtError::NotFinite { quantity: "covariance of (G12, G13, Theta)", value });
    }
    let slack = 1e-9 * covariance.amax();
    let asymmetry = (covariance - covariance.transpose()).amax();
    if asymmetry > slack {
        return Err(EmtError::Covariance { fault: "it is not symmetric", value: asymmetry });
    }
    let lowest = SymmetricEigen::new(*covariance).eigenvalues.min();
    if lowest < -slack {
        return Err(EmtError::Covariance { fault: "it has a negative eigenvalue", value: lowest });
    }
    Ok(())
}
