//! Random structures and states, the same in every run.

use grainlab_core::Material;
use grainlab_core::results::Microstructure;
use grainlab_emt::{Calibration, Conditions, Domain, IsotropicCalibration, Measured, StrainRatio};
use grainlab_testkit::Random;

/// The paper's calibration, one with other constants, and the built-in one.
pub(crate) fn calibrations() -> Vec<Calibration> {
    let own = IsotropicCalibration::new([150.0, -3.5, 80.0, -0.2], [4.2, 6.5]).unwrap();
    let grains = Material { shear_modulus: 25.0e9, poisson_ratio: 0.25, density: 2600.0 };
    vec![Calibration::PAPER, Calibration::of_isotropic("own", own, grains), crate::ours().clone()]
}

/// Uniform in a range; with a probability of one in eight, one of its ends.
fn with_ends(random: &mut Random, [low, high]: [f64; 2]) -> f64 {
    match (16.0 * random.unit()) as u32 {
        0 => low,
        1 => high,
        _ => random.between(low, high).min(high),
    }
}

/// A pressure from 100 Pa to 100 MPa that the domain has for these grains.
pub(crate) fn pressure(random: &mut Random, domain: &Domain, material: &Material) -> f64 {
    let [low, high] = domain.reduced_pressure.map(|p| p * material.effective_young());
    // So far from the ends that numerical derivatives stay inside.
    let [low, high] = [low.max(1e2) * 1.01, high.min(1e8) / 1.01];
    with_ends(random, [low.ln(), high.ln()]).exp().clamp(low, high)
}

/// A structure and a state of a domain: pressures from 100 Pa to 100 MPa, solid fractions from 0.5 to 0.7, the grains of the
/// calibration or others.
pub(crate) fn case(random: &mut Random, domain: &Domain) -> (Microstructure, Conditions) {
    let structure = domain.structure.map(|range| range.map(|r| with_ends(random, r)));
    let other = Material {
        shear_modulus: 10f64.powf(random.between(9.0, 11.5)),
        poisson_ratio: with_ends(random, [0.0, 0.5]),
        density: 2500.0,
    };
    let material = (random.unit() < 0.5).then_some(other);
    let conditions = Conditions {
        pressure: Measured::exact(pressure(random, domain, &material.unwrap_or(Material::GLASS))),
        gamma: StrainRatio::given(with_ends(random, domain.gamma)),
        solid_fraction: Some(Measured::exact(random.between(0.5, 0.7))),
        stress_ratio: Some(Measured::exact(with_ends(random, domain.stress_ratio))),
        size_spread: Some(with_ends(random, domain.size_spread.map(|s| s.min(1.0)))),
        material,
        ..Conditions::at(1e5)
    };
    (Microstructure::of_values(structure), conditions)
}
