//! The predictions of every model against a sum over contacts in every direction of the sphere.

use crate::cases::calibrations;
use crate::model;
use crate::sphere::{contact_density, directions, stiffness};
use grainlab_core::results::Microstructure;
use grainlab_core::{Material, Stiffness, Vec3};
use grainlab_emt::{Conditions, Eq16Reading, Measured, Moduli, Modulus, Moments, StrainRatio};
use std::f64::consts::PI;

/// Values of ε and g: both ends and their neighbours, and values where the overlap is almost linear.
const EPS: [f64; 6] = [-0.5, -0.2, 0.0, 0.08, 0.45, 1.0];
const G: [f64; 13] = [-0.5, -0.4999, -0.45, -0.3, -0.1, -0.075, -1e-3, 0.0, 1e-9, 0.08, 0.12, 0.2499, 0.25];
const NU: [f64; 4] = [0.0, 0.2, 0.35, 0.5];

/// Diameter of the grains, m: cancels in every result.
const D: f64 = 2.0e-4;

/// Root of the overlap over that of the isotropic part, Eq. 10.
fn linear(g: f64, x: f64) -> f64 {
    1.0 + g - 3.0 * g * x * x
}

const RATIOS: [&str; 2] = ["ratio", "ratio-as-printed"];

/// G12, G13 and Θ of one contact per grain, by Hertz and Mindlin, for an overlap of the isotropic part of 30
/// nm.
fn paper_moduli(sphere: &[(Vec3, f64)], grains: &Material, eps: f64, g: f64) -> [f64; 3] {
    let c = stiffness(sphere, |x| {
        let overlap = 3.0e-8 * linear(g, x).powi(2);
        let k_t = grains.tangential_stiffness(D / 4.0, overlap);
        // Eq. 11 takes the normal spring as the tangential one.
        [k_t, k_t].map(|k| k * contact_density(eps, x))
    });
    let t = Stiffness(c).transverse_isotropy();
    assert!(t.residual < 1e-12);
    [t.g12, t.g13, Stiffness(c).bulk_voigt()]
}

fn near(found: Moduli, modulus: Modulus, expected: f64, scale: f64, what: &dyn Fn() -> String) {
    let found = found.get(modulus).unwrap();
    assert!((found - expected).abs() < 1e-12 * scale, "{}: {modulus} = {found}, {expected}", what());
}

/// Moduli over the isotropic ones, times Eqs. 21 and 22.
#[test]
fn ratios_are_those_of_the_integral_with_the_spin_that_keeps_stress_symmetric() {
    let sphere = directions();
    let (k, k_hat, pressure) = (5.2, 5.5f64, 2.0e5);
    for name in RATIOS {
        for nu in NU {
            let grains = Material { poisson_ratio: nu, ..Material::GLASS };
            let isotropic = paper_moduli(&sphere, &grains, 0.0, 0.0);
            for (eps, g) in EPS.into_iter().flat_map(|eps| G.map(|g| (eps, g))) {
                let anisotropic = paper_moduli(&sphere, &grains, eps, g);
                for calibration in calibrations() {
                    let mut over: [f64; 3] = std::array::from_fn(|i| anisotropic[i] / isotropic[i]);
                    if name == "ratio-as-printed" {
                        // The missing factor of Eq. 16: (2ε/5)(1 − a).
                        over[2] += 0.4 * eps * (2.0 - over[1] / over[0]);
                    }
                    let fitted = calibration.isotropic_for(Some(grains));
                    let structure = Microstructure::paper(k, k_hat, eps);
                    let conditions = Conditions {
                        gamma: StrainRatio::given(g),
                        material: Some(grains),
                        ..Conditions::at(pressure)
                    };
                    let found = model(name).predict(&structure, &conditions, &calibration).unwrap();
                    let denser = k / k_hat;
                    let shear = denser * fitted.shear_modulus(k_hat, pressure);
                    let bulk = denser * fitted.bulk_modulus(k_hat, pressure);
                    let what = || format!("{name} eps {eps} g {g} nu {nu}");
                    near(found, Modulus::G12, over[0] * shear, shear, &what);
                    near(found, Modulus::G13, over[1] * shear, shear, &what);
                    near(found, Modulus::Theta, over[2] * bulk, bulk, &what);
                }
            }
        }
    }
}

/// All six moduli at the pressure from the Hertz forces of the same contacts: Eq. 4 before any algebra, with
/// the force for the overlap whose root is Eq. 10.
#[test]
fn the_effective_medium_has_the_moduli_and_the_pressure_of_its_contacts() {
    let sphere = directions();
    let (k, phi, volume_strain) = (5.4, 0.636, 4.5e-4);
    let number = 6.0 * phi / (PI * D.powi(3));
    for nu in NU {
        let grains = Material { poisson_ratio: nu, ..Material::GLASS };
        for (eps, g) in EPS.into_iter().flat_map(|eps| G.map(|g| (eps, g))) {
            let overlap = |x: f64| D * volume_strain / 3.0 * linear(g, x).powi(2);
            let per_contact = number * k * D / 2.0;
            let force = |(d, weight): &(Vec3, f64)| {
                weight * contact_density(eps, d.z) * grains.normal_force(D / 4.0, overlap(d.z))
            };
            let pressure = per_contact / 3.0 * sphere.iter().map(force).sum::<f64>();
            let c = stiffness(&sphere, |x| {
                let spring = grains.tangential_stiffness(D / 4.0, overlap(x));
                [per_contact * D * spring * contact_density(eps, x); 2]
            });
            let expected = Moduli::of_medium(&Stiffness(c).transverse_isotropy());

            let structure = Microstructure { k: Some(k), eps: Some(eps), ..Microstructure::default() };
            let conditions = Conditions {
                gamma: StrainRatio::given(g),
                solid_fraction: Some(Measured::exact(phi)),
                material: Some(grains),
                ..Conditions::at(pressure)
            };
            for calibration in calibrations() {
                let found = model("emt").predict(&structure, &conditions, &calibration).unwrap();
                let what = || format!("eps {eps} g {g} nu {nu}");
                for (modulus, value) in expected.known() {
                    near(
                        found,
                        modulus,
                        value,
                        value.abs().max(expected.get(Modulus::Theta).unwrap()),
                        &what,
                    );
                }
                assert_eq!(found.known().count(), expected.known().count());
            }
        }
    }
}

/// The printed Eqs. 13 and 16 lack a factor a in one term each: the excess is (4ε/5)(1−a) and (2ε/5)(1−a).
#[test]
fn printed_forms_exceed_the_corrected_ones_by_the_missing_factor() {
    for (eps, g) in EPS.into_iter().flat_map(|eps| G.map(|g| (eps, g))) {
        let a = Moments::new(eps, g).spin();
        let psi1 = Eq16Reading::AsPrinted.psi1_factor(eps, g) - Eq16Reading::Corrected.psi1_factor(eps, g);
        assert!((psi1 - 0.8 * eps * (1.0 - a)).abs() < 1e-14);
        let bulk = Eq16Reading::AsPrinted.bulk(eps, a, g) - Eq16Reading::Corrected.bulk(eps, a, g);
        assert!((bulk - 0.4 * eps * (1.0 - a)).abs() < 1e-14);
    }
}
