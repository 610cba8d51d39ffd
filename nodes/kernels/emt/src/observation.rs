//! What is observed of a packing.

use crate::conditions::{Conditions, Gamma};
use crate::error::EmtError;
use crate::moduli::{MODULI, Moduli, ModuliCovariance, Modulus};
use grainlab_core::{Mat3, Stiffness};
use nalgebra::{SMatrix, SymmetricEigen};

/// Number of things an inversion may depend on: the moduli, the pressure, γ/Δ and the solid fraction.
pub const INPUTS: usize = MODULI + 3;

/// Names of the inputs, in the order of every row of slopes.
pub const INPUT_NAMES: [&str; INPUTS] =
    ["G12", "G13", "Theta", "C11", "C33", "C13", "pressure", "gamma/Delta", "solid fraction"];

/// Covariance of the inputs: of the relative errors of moduli, pressure and solid fraction and the error of γ/Δ.
pub(crate) type InputCovariance = SMatrix<f64, INPUTS, INPUTS>;

/// Moduli of one transversely isotropic packing, as far as known, and the state they belong to.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// The moduli, Pa.
    pub moduli: Moduli,
    /// Their covariance, Pa²; `None` if their uncertainty is not known.
    pub covariance: Option<ModuliCovariance>,
    /// The state.
    pub conditions: Conditions,
    /// Part of the stiffness that no medium isotropic about the axis has, relative (Mandel norm); `None` if only the
    /// moduli are known.
    pub asymmetry: Option<f64>,
    /// Grains in the sample, which decide how much of that is its own scatter; `None` if not known, or as good as infinite.
    pub grains: Option<u32>,
    /// The one of the moduli that was not measured but follows from the others ([`Observation::checked`]).
    pub derived: Option<Modulus>,
}

impl Observation {
    /// Of unknown uncertainty.
    pub const fn new(moduli: Moduli, conditions: Conditions) -> Self {
        Self { moduli, covariance: None, conditions, asymmetry: None, grains: None, derived: None }
    }

    /// The paper's three moduli and the pressure, Pa.
    pub const fn paper(g12: f64, g13: f64, theta: f64, pressure: f64, gamma: Gamma) -> Self {
        let mut conditions = Conditions::at(pressure);
        conditions.gamma = gamma;
        Self::new(Moduli::paper(g12, g13, theta), conditions)
    }

    /// The moduli of a stiffness about e3.
    pub fn of_stiffness(stiffness: &Stiffness, conditions: Conditions) -> Self {
        let t = stiffness.transverse_isotropy();
        Self { asymmetry: Some(t.residual), ..Self::new(Moduli::of_medium(&t), conditions) }
    }

    /// The same with an independent one-sigma relative error on each of the moduli: 0.01 is one percent.
    #[must_use]
    pub fn with_relative_error(mut self, relative: f64) -> Self {
        let variance = self.moduli.values().map(|m| m.map_or(0.0, |m| (relative * m).powi(2)));
        self.covariance = Some(ModuliCovariance::from_diagonal(&variance.into()));
        self
    }

    /// The same with this covariance of the moduli, Pa².
    #[must_use]
    pub fn with_covariance(mut self, covariance: ModuliCovariance) -> Self {
        self.covariance = Some(covariance);
        self
    }

    /// The same with this covariance of (G12, G13, Θ), Pa²; the others are taken as exact.
    #[must_use]
    pub fn with_paper_covariance(self, covariance: &Mat3) -> Self {
        let mut all = ModuliCovariance::zeros();
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(covariance);
        self.with_covariance(all)
    }

    /// Pressure, Pa.
    pub const fn pressure(&self) -> f64 {
        self.conditions.pressure.value
    }

    /// The same with the modulus that follows from the others, after a look at every number.
    pub fn checked(&self) -> Result<Self, EmtError> {
        self.check_values()?;
        if let Some(covariance) = &self.covariance {
            check_covariance(covariance)?;
        }
        let (moduli, covariance) = self.moduli.completed(self.covariance);
        for (modulus, value) in moduli.known() {
            if !value.is_finite() {
                return Err(EmtError::NotFinite { quantity: modulus.name(), value });
            }
            if value <= 0.0 && modulus != Modulus::C13 {
                return Err(EmtError::Unstable { modulus: modulus.name(), value });
            }
        }
        let is_new = |m: &Modulus| self.moduli.get(*m).is_none() && moduli.get(*m).is_some();
        let derived = Modulus::ALL.into_iter().find(is_new).or(self.derived);
        Ok(Self { moduli, covariance, derived, ..self.clone() })
    }

    /// The first number that is none, the covariance apart.
    pub(crate) fn check_values(&self) -> Result<(), EmtError> {
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

    /// Covariance of the relative errors of the inputs; `None` if that of the moduli is not known.
    pub(crate) fn input_covariance(&self) -> Option<InputCovariance> {
        let covariance = self.covariance.as_ref()?;
        let values = self.moduli.values().map(|m| m.filter(|m| *m != 0.0));
        let mut relative = InputCovariance::zeros();
        for (i, a) in values.iter().enumerate() {
            for (j, b) in values.iter().enumerate() {
                if let (Some(a), Some(b)) = (a, b) {
                    relative[(i, j)] = covariance[(i, j)] / a / b;
                }
            }
        }
        let c = &self.conditions;
        relative[(MODULI, MODULI)] = (c.pressure.stddev / c.pressure.value).powi(2);
        relative[(MODULI + 1, MODULI + 1)] = c.gamma.stddev.powi(2);
        relative[(MODULI + 2, MODULI + 2)] =
            c.solid_fraction.map_or(0.0, |phi| (phi.stddev / phi.value).powi(2));
        Some(relative)
    }

    /// The same with one input changed: `by` is the relative change, of γ/Δ the change itself. `None` if the input is not
    /// known.
    pub(crate) fn moved(&self, input: usize, by: f64) -> Option<Self> {
        let mut moved = self.clone();
        match input {
            0..MODULI => {
                let modulus = Modulus::ALL[input];
                let value = self.moduli.get(modulus)?;
                moved.moduli = self.moduli.with(modulus, value * (1.0 + by));
            }
            6 => moved.conditions.pressure.value *= 1.0 + by,
            7 => moved.conditions.gamma.value += by,
            _ => moved.conditions.solid_fraction.as_mut()?.value *= 1.0 + by,
        }
        Some(moved)
    }
}

/// A covariance is finite, symmetric and has no negative eigenvalue, to the rounding of a file or a message.
fn check_covariance(covariance: &ModuliCovariance) -> Result<(), EmtError> {
    if let Some(&value) = covariance.iter().find(|v| !v.is_finite()) {
        return Err(EmtError::NotFinite { quantity: "covariance of the moduli", value });
    }
    let slack = 1e-9 * covariance.amax();
    let asymmetry = (covariance - covariance.transpose()).amax();
    if asymmetry > slack {
        return Err(EmtError::Covariance { fault: "it is not symmetric", value: asymmetry });
    }
    // The common case needs no eigenvalues: no correlation, no negative variance.
    let diagonal = ModuliCovariance::from_diagonal(&covariance.diagonal());
    let lowest = if *covariance == diagonal {
        covariance.diagonal().min()
    } else {
        SymmetricEigen::new(*covariance).eigenvalues.min()
    };
    if lowest < -slack {
        return Err(EmtError::Covariance { fault: "it has a negative eigenvalue", value: lowest });
    }
    Ok(())
}
