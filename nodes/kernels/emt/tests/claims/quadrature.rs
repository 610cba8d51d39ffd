//! The closed forms against numerical integration over the sphere.

use crate::sphere::{contact_density, directions, stiffness};
use grainlab_core::{Mat3, Material, Stiffness};
use grainlab_emt::{Eq16Reading, Medium, Moments};
use std::f64::consts::PI;

fn grid() -> impl Iterator<Item = (f64, f64)> {
    (0..=15).flat_map(|i| (0..=14).map(move |j| (-0.5 + 0.1 * f64::from(i), -0.45 + 0.05 * f64::from(j))))
}

fn overlap_law(g: f64, x: f64) -> f64 {
    1.0 + g - 3.0 * g * x * x
}

#[test]
fn moments_are_the_integral_over_the_sphere() {
    let sphere = directions();
    for (eps, g) in grid() {
        let mut m = Mat3::zeros();
        for (d, w) in &sphere {
            m += d * d.transpose() * (w * contact_density(eps, d.z) * overlap_law(g, d.z));
        }
        let closed = Moments::new(eps, g);
        let mut expected = Mat3::identity() * closed.m1;
        expected[(2, 2)] += closed.m2;
        assert!((m - expected).amax() < 1e-12, "eps {eps} g {g}: {m} {expected}");
        assert!((m.trace() - closed.trace()).abs() < 1e-12);
        assert!((closed.trace() - (1.0 - 0.8 * eps * g)).abs() < 1e-14);
    }
}

#[test]
fn stiffness_of_the_medium_is_the_integral_with_the_spin_that_keeps_stress_symmetric() {
    const D: f64 = 2.0e-4;
    let sphere = directions();
    for (eps, g) in grid().step_by(7) {
        let medium = Medium {
            material: Material::GLASS,
            solid_fraction: 0.636,
            volume_strain: 4.5e-4,
            k: 5.5,
            eps,
            gamma_over_delta: g,
        };
        // K_T of Eq. 9 is twice the Mindlin stiffness at the full overlap 2 δ, here of the isotropic part δ = DΔ/6.
        let k_t = 2.0 * medium.material.tangential_stiffness(D / 4.0, D * medium.volume_strain / 3.0);
        let number = 6.0 * medium.solid_fraction / (PI * D.powi(3));
        let unit = number * D / 2.0 * D / 2.0 * k_t * medium.k;
        let integrated = stiffness(&sphere, |x| [unit * contact_density(eps, x) * overlap_law(g, x); 2]);
        let psi = medium.moduli(Eq16Reading::Corrected);
        let scale = integrated.amax();
        assert!((integrated - psi.stiffness().0).amax() < 1e-12 * scale, "eps {eps} g {g}");
        assert!((Stiffness(integrated).bulk_voigt() - psi.bulk()).abs() < 1e-12 * scale);
        // Over the isotropic medium the bulk modulus is the bracket of Eq. 16, and the shear ratio is 1 + a.
        let isotropic = Medium { eps: 0.0, gamma_over_delta: 0.0, ..medium }.moduli(Eq16Reading::Corrected);
        let a = Moments::new(eps, g).spin();
        assert!((psi.bulk() / isotropic.bulk() - Eq16Reading::Corrected.bulk(eps, a, g)).abs() < 1e-12);
        let t = psi.stiffness().transverse_isotropy();
        assert!((t.g13 / t.g12 - 1.0 - a).abs() < 1e-12);
    }
}

/// The printed Eqs. 13 and 16 lack a factor a in one term each: the excess is (4ε/5)(1−a) and (2ε/5)(1−a).
#[test]
fn printed_forms_exceed_the_corrected_ones_by_the_missing_factor() {
    for (eps, g) in grid() {
        let a = Moments::new(eps, g).spin();
        let psi1 = Eq16Reading::AsPrinted.psi1_factor(eps, g) - Eq16Reading::Corrected.psi1_factor(eps, g);
        assert!((psi1 - 0.8 * eps * (1.0 - a)).abs() < 1e-14);
        let bulk = Eq16Reading::AsPrinted.bulk(eps, a, g) - Eq16Reading::Corrected.bulk(eps, a, g);
        assert!((bulk - 0.4 * eps * (1.0 - a)).abs() < 1e-14);
    }
}

/// a as printed below Eq. 15.
#[test]
fn spin_is_the_printed_a() {
    for (e, g) in grid() {
        let a = (4.0 * e / 5.0 - (16.0 / 35.0 * e + 4.0 / 5.0) * g)
            / (4.0 / 3.0 + 4.0 / 15.0 * e - (128.0 / 105.0 * e + 4.0 / 15.0) * g);
        assert!((Moments::new(e, g).spin() - a).abs() < 1e-14, "eps {e} g {g}");
    }
}
