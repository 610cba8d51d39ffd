//! Plane waves of long wavelength in an elastic medium.
//!
//! A wave u = p exp(iq(n·x − vt)) along the unit vector n solves Γ p = ρ v² p, with the Christoffel tensor
//! Γ_ik = C_ijkl n_j n_l. Its three modes have perpendicular particle motions p.

use crate::stiffness::{Stiffness, VOIGT};
use crate::tensor::{Mat3, Vec3};
use nalgebra::SymmetricEigen;

/// One speed of one mode, as measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveSpeed {
    /// Unit direction of propagation; its sign does not matter.
    pub direction: Vec3,
    /// Unit particle motion, which tells the modes apart; its sign does not matter, and it need not be exact.
    pub polarization: Vec3,
    /// Phase speed of long waves, m/s.
    pub speed: f64,
    /// Standard deviation of the speed, m/s; `None` if it is not known.
    pub stddev: Option<f64>,
}

/// Method of measurement of a speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaveMethod {
    /// Onset of the first arrival.
    FirstArrival,
    /// Delay of greatest correlation.
    CrossCorrelation,
    /// Delay of the peak.
    Peak,
    /// Frequency of a standing wave.
    StandingWave,
    /// Slope of the dispersion relation.
    Dispersion,
}

impl WaveMethod {
    /// All of them.
    pub const ALL: [WaveMethod; 5] =
        [Self::FirstArrival, Self::CrossCorrelation, Self::Peak, Self::StandingWave, Self::Dispersion];

    /// One word for it, as tables and files have it.
    pub const fn word(self) -> &'static str {
        match self {
            Self::FirstArrival => "first_arrival",
            Self::CrossCorrelation => "cross_correlation",
            Self::Peak => "peak",
            Self::StandingWave => "standing_wave",
            Self::Dispersion => "dispersion",
        }
    }
}

/// One speed of one mode, and how it was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredWave {
    /// Direction, particle motion, speed and its standard deviation.
    pub wave: WaveSpeed,
    /// Method of measurement.
    pub method: WaveMethod,
    /// Dominant frequency, Hz; `None` if the speed is extrapolated to zero frequency.
    pub frequency: Option<f64>,
    /// Peak strain, 0 or more; 0 if nothing was moved (dispersion of the frozen network).
    pub strain_amplitude: f64,
}

/// The three modes along one direction, the stiffest first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneWaves {
    /// ρ v² of each mode, Pa: the eigenvalues of the Christoffel tensor. Negative if the medium is unstable.
    pub moduli: [f64; 3],
    /// Unit particle motion of each mode. Where modes have one speed, any perpendicular pair of theirs.
    pub polarizations: [Vec3; 3],
}

impl Stiffness {
    /// Christoffel tensor Γ_ik = C_ijkl n_j n_l along the unit vector `direction`, Pa.
    pub fn christoffel(&self, direction: &Vec3) -> Mat3 {
        let n = direction;
        Mat3::from_fn(|i, k| {
            let mut sum = 0.0;
            for (j, l) in (0..3).flat_map(|j| (0..3).map(move |l| (j, l))) {
                sum += self.0[(VOIGT[i][j], VOIGT[k][l])] * n[j] * n[l];
            }
            sum
        })
    }

    /// The three modes along the unit vector `direction`.
    ///
    /// ```
    /// use grainlab_core::{TransverseIsotropy, Vec3};
    /// let t = TransverseIsotropy { c11: 360e6, c12: 80e6, c13: 70e6, c33: 400e6, g13: 150e6, g12: 140e6, residual: 0.0 };
    /// let [p, fast, slow] = t.stiffness().plane_waves(&Vec3::x()).speeds(1600.0).unwrap();
    /// assert!((p - 474.34).abs() < 0.01 && (fast - 306.19).abs() < 0.01 && (slow - 295.80).abs() < 0.01);
    /// ```
    pub fn plane_waves(&self, direction: &Vec3) -> PlaneWaves {
        let eigen = SymmetricEigen::new(self.christoffel(direction));
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        PlaneWaves {
            moduli: order.map(|k| eigen.eigenvalues[k]),
            polarizations: order.map(|k| eigen.eigenvectors.column(k).into_owned()),
        }
    }
}

impl PlaneWaves {
    /// Phase speeds √(modulus/ρ) in a medium of density ρ, kg/m³ (of the mass that moves with the wave), m/s, the fastest
    /// first; `None` if the medium is unstable.
    pub fn speeds(&self, density: f64) -> Option<[f64; 3]> {
        self.moduli.iter().all(|m| *m > 0.0).then(|| self.moduli.map(|m| (m / density).sqrt()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stiffness::TransverseIsotropy;

    const MEDIUM: TransverseIsotropy = TransverseIsotropy::of_constants(360.0, 400.0, 70.0, 150.0, 140.0);

    #[test]
    fn along_the_axes_the_moduli_are_those_of_voigt() {
        let c = MEDIUM.stiffness();
        for (n, moduli) in [
            (Vec3::z(), [400.0, 150.0, 150.0]),
            (Vec3::x(), [360.0, 150.0, 140.0]),
            (Vec3::y(), [360.0, 150.0, 140.0]),
        ] {
            let found = c.plane_waves(&n).moduli;
            assert!(found.iter().zip(moduli).all(|(a, b)| (a / b - 1.0).abs() < 1e-14), "{found:?}");
        }
    }

    #[test]
    fn a_wave_is_a_solution_and_does_not_know_the_sign_of_its_direction() {
        let c = MEDIUM.stiffness();
        let n = Vec3::new(0.36, -0.48, 0.8);
        let waves = c.plane_waves(&n);
        for (modulus, p) in waves.moduli.iter().zip(&waves.polarizations) {
            assert!((c.christoffel(&n) * p - p * *modulus).amax() < 1e-11);
        }
        assert!((waves.moduli.iter().sum::<f64>() - c.christoffel(&n).trace()).abs() < 1e-11);
        assert!((c.christoffel(&-n) - c.christoffel(&n)).amax() < 1e-13);
    }

    #[test]
    fn a_medium_that_yields_to_shear_has_no_speeds() {
        let t = TransverseIsotropy { g13: -1.0, ..MEDIUM };
        assert!(t.stiffness().plane_waves(&Vec3::z()).speeds(1600.0).is_none());
        assert!(MEDIUM.stiffness().plane_waves(&Vec3::z()).speeds(1600.0).is_some());
    }
}
