//! Packings that a calibration is learned from.

use grainlab_core::Material;
use grainlab_core::results::{Microstructure, StrainRatios};
use grainlab_emt::{
    CalibrationError, Conditions, Measured, Moduli, Modulus, Observation, ROUNDING, StrainRatio,
    StrainRatioSource, check_structure,
};

/// Θ over E*^⅔ p^⅓ of any packing of spheres, with a wide margin: .21 to .44 in those of `tests/golden/ensembles`. A modulus or a
/// pressure in another unit is outside.
const REDUCED_BULK: [f64; 2] = [0.05, 2.0];

/// Share by which k may exceed z: rattlers have few contacts, so that k is below z.
const K_ABOVE_Z: f64 = 0.01;

/// Largest spread of the radii over their mean.
const MAX_SPREAD: f64 = 1.0;

/// One packing: its moduli, and its structure counted from the contacts.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationSample {
    /// Recipe of the preparation. Packings of one preparation are left out together when the models are tested.
    pub preparation: String,
    /// Name of the packing: states of the same packing at several pressures share it.
    pub packing: String,
    /// File that it is from: recipes of one file share how they are pressed.
    pub file: String,
    /// File and line that it is from, for messages.
    pub place: String,
    /// Number of grains.
    pub grains: u32,
    /// Material of the grains.
    pub material: Material,
    /// Confining pressure, Pa.
    pub pressure: f64,
    /// Solid fraction φ.
    pub solid_fraction: f64,
    /// (σ_33 − (σ_11 + σ_22)/2)/p.
    pub stress_ratio: f64,
    /// Standard deviation of the radii over their mean.
    pub size_spread: f64,
    /// All six moduli, Pa.
    pub moduli: Moduli,
    /// Measured ratios γ/Δ.
    pub gamma: StrainRatios,
    /// Coordination number of all grains.
    pub k: f64,
    /// Coordination number without rattlers.
    pub z: f64,
    /// Contact anisotropy ε.
    pub eps: f64,
    /// ε weighted by contact stiffness.
    pub eps_stiffness: f64,
}

impl CalibrationSample {
    /// The observation with this γ/Δ.
    pub fn observation(&self, gamma: StrainRatioSource) -> Observation {
        let conditions = Conditions {
            gamma: StrainRatio::of(&self.gamma, gamma),
            solid_fraction: Some(Measured::exact(self.solid_fraction)),
            stress_ratio: Some(Measured::exact(self.stress_ratio)),
            size_spread: Some(self.size_spread),
            material: Some(self.material),
            ..Conditions::at(self.pressure)
        };
        Observation { grains: Some(self.grains), ..Observation::new(self.moduli, conditions) }
    }

    /// Refuses what no packing is, as an inversion would, and moduli or a pressure in another unit.
    pub fn check(&self) -> Result<(), CalibrationError> {
        let fault = |fault: String| Err(self.fault(fault));
        if !self.is_finite() {
            return fault("every number must be finite, and all moduli known and positive".to_owned());
        }
        if self.grains == 0 {
            return fault("grains = 0: a packing has one grain or more".to_owned());
        }
        if !(0.0..=MAX_SPREAD).contains(&self.size_spread) {
            return fault(format!("size_spread = {} is outside [0, {MAX_SPREAD}]", self.size_spread));
        }
        let structure = Microstructure {
            k: Some(self.k),
            z: Some(self.z),
            eps: Some(self.eps),
            eps_stiffness: Some(self.eps_stiffness),
            ..Microstructure::default()
        };
        let sound = check_structure(&structure)
            .and_then(|()| self.observation(StrainRatioSource::Zero).checked().map(|_| ()));
        if let Err(error) = sound {
            return fault(error.to_string());
        }
        if self.k > self.z * (1.0 + K_ABOVE_Z) {
            let [k, z] = [self.k, self.z];
            return fault(format!(
                "k = {k} is above z = {z}: k counts all grains, z those that are no rattlers"
            ));
        }
        if self.moduli.unstable(None, 0.0) {
            return fault("no stable medium has these moduli: they are not of one state".to_owned());
        }
        if let Some(relative) = self.moduli.imbalance().filter(|relative| relative.abs() > ROUNDING) {
            return fault(format!(
                "Theta is {:.1} % off the value that follows from C11, C33, C13 and G12: one of them is wrong",
                100.0 * relative.abs()
            ));
        }
        let unit = self.material.effective_young().cbrt().powi(2) * self.pressure.cbrt();
        let reduced = self.moduli.get(Modulus::Theta).map_or(f64::NAN, |theta| theta / unit);
        let [low, high] = REDUCED_BULK;
        if !(low..=high).contains(&reduced) {
            return fault(format!(
                "Theta = {reduced:.3e} E*^(2/3) p^(1/3), and that of packings is {low} to {high}: check the units of moduli and \
                 pressure (Pa) and the material of the grains"
            ));
        }
        Ok(())
    }

    pub(crate) fn fault(&self, fault: String) -> CalibrationError {
        CalibrationError::Packing { packing: format!("{} ({})", self.packing, self.place), fault }
    }

    /// Ratio p/E*, dimensionless.
    pub(crate) fn reduced_pressure(&self) -> f64 {
        self.pressure / self.material.effective_young()
    }

    /// True if every number is finite and every modulus positive.
    pub(crate) fn is_finite(&self) -> bool {
        let numbers = [
            self.pressure,
            self.solid_fraction,
            self.stress_ratio,
            self.size_spread,
            self.k,
            self.z,
            self.eps,
            self.eps_stiffness,
            self.material.shear_modulus,
            self.material.poisson_ratio,
        ];
        numbers.iter().all(|v| v.is_finite())
            && self.moduli.values().iter().all(|m| m.is_some_and(|m| m.is_finite() && m > 0.0))
    }
}

pub(crate) fn bounds(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}
