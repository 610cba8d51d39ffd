//! Observations of a packing.

use crate::conditions::{Conditions, Measured, STATE_INPUTS, StrainRatio};
use crate::error::EmtError;
use crate::moduli::{MODULI, Moduli, ModuliCovariance, Modulus};
use crate::probe::Probe;
use grainlab_core::notes::Note;
use grainlab_core::results::PackingReport;
use grainlab_core::{Mat3, Material, Stiffness};
use nalgebra::{SMatrix, SymmetricEigen};

/// Number of inputs of an inversion: the moduli, the pressure, γ/Δ, the solid fraction, the axial stress ratio, the spread of
/// the sizes, and the shear modulus and Poisson ratio of the grains.
pub const INPUTS: usize = MODULI + STATE_INPUTS;

/// Standard deviation over the largest modulus beyond which a modulus counts as unknown: it determines nothing, and numbers of
/// such different size lose their digits.
pub(crate) const UNKNOWN_ERROR: f64 = 1e3;

/// Covariance of the relative errors of moduli, pressure, solid fraction and shear modulus of the grains, and of the errors of
/// γ/Δ, q/p, the spread of the sizes and the Poisson ratio.
pub(crate) type InputCovariance = SMatrix<f64, INPUTS, INPUTS>;

/// The known moduli of one transversely isotropic packing, and the state in which they were measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// The moduli, Pa.
    pub moduli: Moduli,
    /// Covariance of the moduli, Pa²; `None` if their uncertainty is not known.
    pub covariance: Option<ModuliCovariance>,
    /// State of the packing.
    pub conditions: Conditions,
    /// Relative part of the stiffness that is not isotropic about the axis (Mandel norm); `None` if only the moduli are
    /// known.
    pub asymmetry: Option<f64>,
    /// Number of grains of the sample, on which the scatter depends; `None` if it is unknown.
    pub grains: Option<u32>,
    /// Whether contacts slid while the moduli were measured.
    pub probe: Probe,
    /// The modulus that was not measured but follows from the others ([`Observation::checked`]).
    pub derived: Option<Modulus>,
    /// For each modulus, true if its error is so large that it was taken as unknown ([`Observation::checked`]).
    pub taken_as_unknown: [bool; MODULI],
}

impl Observation {
    /// Creates an observation of moduli of unknown uncertainty. Set [`Observation::probe`] if contacts may have slid.
    pub const fn new(moduli: Moduli, conditions: Conditions) -> Self {
        Self {
            moduli,
            covariance: None,
            conditions,
            asymmetry: None,
            grains: None,
            probe: Probe::Sticking,
            derived: None,
            taken_as_unknown: [false; MODULI],
        }
    }

    /// The three moduli that the paper uses and the pressure, all Pa.
    pub fn from_g12_g13_theta(g12: f64, g13: f64, theta: f64, pressure: f64, gamma: StrainRatio) -> Self {
        let mut conditions = Conditions::at(pressure);
        conditions.gamma = gamma;
        Self::new(Moduli::paper(g12, g13, theta), conditions)
    }

    /// The moduli of a stiffness about e3.
    pub fn of_stiffness(stiffness: &Stiffness, conditions: Conditions) -> Self {
        let t = stiffness.transverse_isotropy();
        Self { asymmetry: Some(t.residual), ..Self::new(Moduli::of_medium(&t), conditions) }
    }

    /// The moduli of a packing about the reference axis of its report, and its state, as exact numbers; `None` without a
    /// stiffness.
    pub fn of(report: &PackingReport) -> Option<Self> {
        let (stiffness, medium) = (report.stiffness()?, report.projected()?);
        let conditions = Conditions {
            gamma: StrainRatio::preferred(&report.strain_ratios),
            solid_fraction: Some(Measured::exact(report.solid_fraction)),
            stress_ratio: report.axial_stress_ratio().map(Measured::exact),
            size_spread: Some(report.size_spread),
            material: Some(report.material),
            contact_law: Some(report.law),
            smooth: stiffness.smooth,
            ..Conditions::at(report.pressure())
        };
        Some(Self {
            asymmetry: Some(medium.residual),
            grains: Some(report.contacts.grains),
            ..Self::new(Moduli::of_medium(&medium), conditions)
        })
    }

    /// Observation with independent errors of this relative standard deviation for all moduli: 0.01 is one percent. A
    /// negative or infinite one is refused by [`Observation::checked`].
    #[must_use]
    pub fn with_relative_error(mut self, relative: f64) -> Self {
        // The sign is kept for the check.
        let variance = self.moduli.values().map(|m| m.map_or(0.0, |m| relative * relative.abs() * m * m));
        self.covariance = Some(ModuliCovariance::from_diagonal(&variance.into()));
        self
    }

    /// Observation with this covariance of the moduli, Pa².
    #[must_use]
    pub fn with_covariance(mut self, covariance: ModuliCovariance) -> Self {
        self.covariance = Some(covariance);
        self
    }

    /// Observation with this covariance of (G12, G13, Θ), Pa²; the others are taken as exact.
    #[must_use]
    pub fn with_g12_g13_theta_covariance(self, covariance: &Mat3) -> Self {
        let mut all = ModuliCovariance::zeros();
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(covariance);
        self.with_covariance(all)
    }

    /// Confining pressure, Pa.
    pub const fn pressure(&self) -> f64 {
        self.conditions.pressure.value
    }

    /// Checks every number, leaves out the moduli whose errors are too large, and adds the modulus that follows from the others.
    pub fn checked(&self) -> Result<Self, EmtError> {
        self.check_values()?;
        if let Some(covariance) = &self.covariance {
            check_covariance(covariance)?;
        }
        let known = self.without_unknown();
        let (moduli, covariance) = known.moduli.completed(known.covariance);
        for (modulus, value) in moduli.known() {
            if !value.is_finite() {
                return Err(EmtError::NotFinite { quantity: modulus.name(), value });
            }
            if value <= 0.0 && modulus != Modulus::C13 {
                return Err(Note::unstable(modulus.name(), value).into());
            }
        }
        let is_new = |m: &Modulus| known.moduli.get(*m).is_none() && moduli.get(*m).is_some();
        let derived = Modulus::ALL.into_iter().find(is_new).or(known.derived);
        Ok(Self { moduli, covariance, derived, ..known })
    }

    /// Observation without the moduli whose errors are more than [`UNKNOWN_ERROR`] times the largest modulus.
    fn without_unknown(&self) -> Self {
        let mut known = self.clone();
        let Some(covariance) = &mut known.covariance else { return known };
        let largest = self.moduli.known().map(|(_, value)| value.abs()).fold(0.0, f64::max);
        for modulus in Modulus::ALL {
            let at = modulus as usize;
            if covariance[(at, at)].sqrt() > UNKNOWN_ERROR * largest && self.moduli.get(modulus).is_some() {
                known.moduli = known.moduli.without(modulus);
                known.taken_as_unknown[at] = true;
                covariance.fill_row(at, 0.0);
                covariance.fill_column(at, 0.0);
            }
        }
        known
    }

    /// Refuses the first value that is not finite or out of range, the covariance excepted.
    fn check_values(&self) -> Result<(), EmtError> {
        for (modulus, value) in self.moduli.known() {
            if !value.is_finite() {
                return Err(EmtError::NotFinite { quantity: modulus.name(), value });
            }
            // C13 alone may be negative in a stable medium.
            if value <= 0.0 && modulus != Modulus::C13 {
                return Err(EmtError::NotPositive { quantity: modulus.name(), value });
            }
        }
        self.conditions.check()
    }

    /// Covariance of the relative errors of the inputs; `None` if neither that of the moduli nor an error of the state is known.
    /// `material` is that of the calibration.
    pub(crate) fn input_covariance(&self, material: &Material) -> Option<InputCovariance> {
        let of_state = self.conditions.stddevs(material);
        if self.covariance.is_none() && of_state.iter().all(|stddev| *stddev == 0.0) {
            return None;
        }
        let covariance = self.covariance.unwrap_or_default();
        let values = self.moduli.values().map(|m| m.filter(|m| *m != 0.0));
        let mut relative = InputCovariance::zeros();
        for (i, a) in values.iter().enumerate() {
            for (j, b) in values.iter().enumerate() {
                if let (Some(a), Some(b)) = (a, b) {
                    relative[(i, j)] = covariance[(i, j)] / a / b;
                }
            }
        }
        for (i, stddev) in of_state.iter().enumerate() {
            relative[(MODULI + i, MODULI + i)] = stddev * stddev;
        }
        Some(relative)
    }

    /// Observation with one input changed, as [`Conditions::moved`]; moduli by a relative amount. `None` if the input is not known.
    pub(crate) fn moved(&self, input: usize, by: f64, material: &Material) -> Option<Self> {
        let mut moved = self.clone();
        if let Some(modulus) = Modulus::ALL.get(input) {
            moved.moduli = self.moduli.with(*modulus, self.moduli.get(*modulus)? * (1.0 + by));
        } else {
            moved.conditions = self.conditions.moved(input - MODULI, by, material)?;
        }
        Some(moved)
    }
}

/// Checks that a covariance is finite, symmetric and positive semidefinite, to the rounding of a file or a message.
fn check_covariance(covariance: &ModuliCovariance) -> Result<(), EmtError> {
    if let Some(&value) = covariance.iter().find(|v| !v.is_finite()) {
        return Err(EmtError::NotFinite { quantity: "covariance of the moduli", value });
    }
    let slack = 1e-9 * covariance.amax();
    let asymmetry = (covariance - covariance.transpose()).amax();
    if asymmetry > slack {
        return Err(EmtError::Covariance { fault: "it is not symmetric", value: asymmetry });
    }
    let least = covariance.diagonal().min();
    if least < -slack {
        return Err(EmtError::Covariance {
            fault: "a variance, or the relative error, is negative",
            value: least,
        });
    }
    // A diagonal matrix, the common case, needs no eigenvalues.
    let diagonal = ModuliCovariance::from_diagonal(&covariance.diagonal());
    let lowest =
        if *covariance == diagonal { least } else { SymmetricEigen::new(*covariance).eigenvalues.min() };
    if lowest < -slack {
        return Err(EmtError::Covariance { fault: "it has a negative eigenvalue", value: lowest });
    }
    Ok(())
}
