//! Decomposition of a transversely isotropic stiffness into irreducible parts.
//!
//! An elastic tensor consists of two scalars, two deviators and one harmonic tensor of fourth order. To first order, a
//! contact distribution that differs from an isotropic one by a deviator (ε of Eq. 6) changes the two deviators alone:
//! the scalars depend on the coordination number, the harmonic part on the fourth-order fabric. A ratio such as G13/G12
//! depends on all three, so that the fourth-order fabric of a sample, which no acoustic measurement gives, is an error
//! in it.

use crate::moduli::{Moduli, Modulus};
use nalgebra::SMatrix;

pub(crate) const INVARIANTS: usize = 5;

/// The five invariants of a medium that is isotropic about e3, dimensionless but for the unit of the first two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Invariants {
    /// ln Θ, Θ = C_iikk/9.
    pub ln_theta: f64,
    /// ln G of the isotropic part, G = (3 C_ikik − C_iikk)/30.
    pub ln_shear: f64,
    /// D = 3 (C_33kk − C_11kk)/C_iikk, of the dilatational deviator.
    pub dilatation: f64,
    /// V = 3 (C_3k3k − C_1k1k)/C_ikik, of the Voigt deviator.
    pub voigt: f64,
    /// H = 3 (C11 + C33 − 2 C13 − 4 C44)/C_ikik, of the harmonic part: how P speeds at 45° differ from the mean of
    /// those along and across the axis.
    pub harmonic: f64,
}

impl Invariants {
    /// Invariants of all six moduli; `None` where one is missing, or Θ or G is not positive.
    pub fn of(moduli: &Moduli) -> Option<Self> {
        let get = |m| moduli.get(m);
        let (c11, c33, c13) = (get(Modulus::C11)?, get(Modulus::C33)?, get(Modulus::C13)?);
        let (g12, g13) = (get(Modulus::G12)?, get(Modulus::G13)?);
        let (along, across) = (c33 + 2.0 * c13, 2.0 * c11 - 2.0 * g12 + c13);
        let (shear_along, shear_across) = (c33 + 2.0 * g13, c11 + g12 + g13);
        let dilatation = along + 2.0 * across;
        let voigt = shear_along + 2.0 * shear_across;
        let shear = (3.0 * voigt - dilatation) / 30.0;
        (dilatation > 0.0 && shear > 0.0).then(|| Self {
            ln_theta: (dilatation / 9.0).ln(),
            ln_shear: shear.ln(),
            dilatation: 3.0 * (along - across) / dilatation,
            voigt: 3.0 * (shear_along - shear_across) / voigt,
            harmonic: 3.0 * (c11 + c33 - 2.0 * c13 - 4.0 * g13) / voigt,
        })
    }

    /// In the order of the fields.
    pub const fn values(&self) -> [f64; INVARIANTS] {
        [self.ln_theta, self.ln_shear, self.dilatation, self.voigt, self.harmonic]
    }

    /// The moduli, in the order of [`Modulus::ALL`].
    pub fn moduli(&self) -> [f64; 6] {
        let (theta, voigt) = self.scales();
        let parts = [theta, voigt, self.dilatation * theta, self.voigt * voigt, self.harmonic * voigt];
        let mut moduli = [0.0; 6];
        for (modulus, row) in moduli.iter_mut().zip(&PARTS) {
            *modulus = row.iter().zip(parts).map(|(weight, part)| weight * part).sum();
        }
        moduli
    }

    /// Derivatives of the moduli with respect to the invariants.
    pub(crate) fn slopes(&self) -> SMatrix<f64, 6, INVARIANTS> {
        let (theta, voigt) = self.scales();
        // voigt = (30 G + 9 Θ)/9 changes with both scalars.
        let (by_theta, by_shear) = (theta / 3.0, 10.0 / 3.0 * self.ln_shear.exp());
        let deviators = |row: &[f64; INVARIANTS]| row[1] + row[3] * self.voigt + row[4] * self.harmonic;
        SMatrix::from_fn(|i, j| {
            let row = &PARTS[i];
            match j {
                0 => (row[0] + row[2] * self.dilatation) * theta + deviators(row) * by_theta,
                1 => deviators(row) * by_shear,
                2 => row[2] * theta,
                3 => row[3] * voigt,
                _ => row[4] * voigt,
            }
        })
    }

    /// C_iikk/3 = 3 Θ and C_ikik/3 = (10 G + 3 Θ)/3.
    fn scales(&self) -> (f64, f64) {
        let theta = 3.0 * self.ln_theta.exp();
        (theta, (10.0 * self.ln_shear.exp() + theta) / 3.0)
    }
}

/// The moduli from t = C_iikk/3, v = C_ikik/3, D t, V v and H v: the inverse of the definitions above.
const PARTS: [[f64; INVARIANTS]; 6] = parts();

const fn parts() -> [[f64; INVARIANTS]; 6] {
    let mut rows = [[0.0; INVARIANTS]; 6];
    let mut part = 0;
    while part < INVARIANTS {
        // One part is 1, the others 0.
        let mut unit = [0.0; INVARIANTS];
        unit[part] = 1.0;
        let (along, across) = (unit[0] + 2.0 / 3.0 * unit[2], unit[0] - unit[2] / 3.0);
        let (shear_along, shear_across) = (unit[1] + 2.0 / 3.0 * unit[3], unit[1] - unit[3] / 3.0);
        let h = unit[4];
        let c33 = (4.0 * h + 4.5 * along + 9.0 * shear_along - across - 2.0 * shear_across) / 17.5;
        let c13 = (along - c33) / 2.0;
        let g13 = (shear_along - c33) / 2.0;
        let c11 = h + along + 2.0 * shear_along - 4.0 * c33;
        let g12 = shear_across - c11 - g13;
        let column = [g12, g13, unit[0] / 3.0, c11, c33, c13];
        let mut modulus = 0;
        while modulus < 6 {
            rows[modulus][part] = column[modulus];
            modulus += 1;
        }
        part += 1;
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::TransverseIsotropy;

    const MEDIUM: TransverseIsotropy = TransverseIsotropy::of_constants(271.0, 293.0, 61.0, 112.0, 103.0);

    #[test]
    fn moduli_come_back_from_their_invariants() {
        let moduli = Moduli::of_medium(&MEDIUM);
        let back = Invariants::of(&moduli).unwrap().moduli();
        for ((modulus, given), back) in moduli.known().zip(back) {
            assert!((given / back - 1.0).abs() < 1e-14, "{modulus}: {given} {back}");
        }
    }

    #[test]
    fn slopes_are_those_of_the_moduli() {
        let at = Invariants::of(&Moduli::of_medium(&MEDIUM)).unwrap();
        let slopes = at.slopes();
        for j in 0..INVARIANTS {
            let moved = |by: f64| {
                let mut v = at.values();
                v[j] += by;
                let [ln_theta, ln_shear, dilatation, voigt, harmonic] = v;
                Invariants { ln_theta, ln_shear, dilatation, voigt, harmonic }.moduli()
            };
            let (up, down) = (moved(1e-5), moved(-1e-5));
            for i in 0..6 {
                assert!(((up[i] - down[i]) / 2e-5 - slopes[(i, j)]).abs() < 1e-6, "{i} {j}");
            }
        }
    }

    /// The fourth-order part of a tensor has no trace of either kind.
    #[test]
    fn the_harmonic_part_moves_neither_scalars_nor_deviators() {
        let mut with = Invariants::of(&Moduli::of_medium(&MEDIUM)).unwrap();
        let before = with;
        with.harmonic += 0.3;
        let m = with.moduli();
        let after = Invariants::of(&Moduli::of_values(m.map(Some))).unwrap();
        for (a, b) in before.values().iter().zip(after.values()).take(4) {
            assert!((a - b).abs() < 1e-14);
        }
    }

    #[test]
    fn an_isotropic_medium_has_neither_deviator_nor_harmonic_part() {
        let (g, theta) = (100.0, 140.0);
        let (c11, c12) = (theta + 4.0 / 3.0 * g, theta - 2.0 / 3.0 * g);
        let t = TransverseIsotropy { c11, c12, c13: c12, c33: c11, g13: g, g12: g, residual: 0.0 };
        let i = Invariants::of(&Moduli::of_medium(&t)).unwrap();
        assert!((i.ln_theta.exp() / theta - 1.0).abs() < 1e-14 && (i.ln_shear.exp() / g - 1.0).abs() < 1e-14);
        assert!(i.dilatation.abs() < 1e-14 && i.voigt.abs() < 1e-14 && i.harmonic.abs() < 1e-14);
    }
}
