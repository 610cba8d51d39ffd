//! Random structures and states, the same in every run.

use grainlab_core::Material;
use grainlab_core::results::Microstructure;
use grainlab_emt::{Calibration, Conditions, Domain, IsotropicCalibration, Measured, StrainRatio};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// The paper's calibration, one with other constants, and the built-in one.
pub(crate) fn calibrations() -> Vec<Calibration> {
    let own = IsotropicCalibration::new([150.0, -3.5, 80.0, -0.2], [4.2, 6.5]).unwrap();
    let grains = Material { shear_modulus: 25.0e9, poisson_ratio: 0.25, density: 2600.0 };
    let relaxed = Calibration::builtin("grainlab").unwrap().clone();
    vec![Calibration::PAPER, Calibration::of_isotropic("own", own, grains), relaxed]
}

/// A generator of cases.
pub(crate) struct Random(Pcg64Mcg);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    /// Uniform between two numbers.
    pub(crate) fn within(&mut self, [low, high]: [f64; 2]) -> f64 {
        let unit = (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        (low + (high - low) * unit).min(high)
    }

    /// Number of mean 0 and variance 1: a sum of twelve uniform numbers, approximately normal.
    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.within([0.0, 1.0])).sum::<f64>() - 6.0
    }

    /// Uniform in a range; with a probability of one in eight, one of its ends.
    fn with_ends(&mut self, range: [f64; 2]) -> f64 {
        match self.0.next_u64() >> 60 {
            0 => range[0],
            1 => range[1],
            _ => self.within(range),
        }
    }

    /// A pressure from 100 Pa to 100 MPa that the domain has for these grains.
    pub(crate) fn pressure(&mut self, domain: &Domain, material: &Material) -> f64 {
        let [low, high] = domain.reduced_pressure.map(|p| p * material.effective_young());
        // So far from the ends that numerical derivatives stay inside.
        let [low, high] = [low.max(1e2) * 1.01, high.min(1e8) / 1.01];
        self.with_ends([low.ln(), high.ln()]).exp().clamp(low, high)
    }

    /// A structure and a state of a domain: pressures from 100 Pa to 100 MPa, solid fractions from 0.5 to
    /// 0.7, the grains of the calibration or others.
    pub(crate) fn case(&mut self, domain: &Domain) -> (Microstructure, Conditions) {
        let structure = domain.structure.map(|range| range.map(|r| self.with_ends(r)));
        let other = Material {
            shear_modulus: 10f64.powf(self.within([9.0, 11.5])),
            poisson_ratio: self.with_ends([0.0, 0.5]),
            density: 2500.0,
        };
        let material = (self.0.next_u64() >> 63 == 0).then_some(other);
        let conditions = Conditions {
            pressure: Measured::exact(self.pressure(domain, &material.unwrap_or(Material::GLASS))),
            gamma: StrainRatio::given(self.with_ends(domain.gamma)),
            solid_fraction: Some(Measured::exact(self.within([0.5, 0.7]))),
            stress_ratio: Some(Measured::exact(self.with_ends(domain.stress_ratio))),
            size_spread: Some(self.with_ends(domain.size_spread.map(|s| s.min(1.0)))),
            material,
            ..Conditions::at(1e5)
        };
        (Microstructure::of_values(structure), conditions)
    }
}
