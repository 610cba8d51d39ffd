//! The closed forms against brute integration over the sphere.

use emt::{Form, Medium, Moments};
use grains::{Mat3, Material, Stiffness, Vec3};
use nalgebra::Matrix6;
use std::f64::consts::{PI, TAU};

/// Directions and solid angles: Gauss–Legendre in cos θ times equal steps in azimuth, exact to degree 23 and 23.
fn sphere() -> Vec<(Vec3, f64)> {
    const LEVELS: usize = 12;
    const STEPS: usize = 24;
    let mut out = Vec::new();
    for level in 0..LEVELS {
        let mut x = (PI * (level as f64 + 0.75) / (LEVELS as f64 + 0.5)).cos();
        let mut slope = 0.0;
        for _ in 0..50 {
            let (mut low, mut high) = (1.0, x);
            for n in 2..=LEVELS {
                let n = n as f64;
                (low, high) = (high, ((2.0 * n - 1.0) * x * high - (n - 1.0) * low) / n);
            }
            slope = LEVELS as f64 * (low - x * high) / (1.0 - x * x);
            x -= high / slope;
        }
        let weight = 2.0 / ((1.0 - x * x) * slope * slope);
        for step in 0..STEPS {
            let (sin, cos) = (TAU * step as f64 / STEPS as f64).sin_cos();
            let radial = (1.0 - x * x).sqrt();
            out.push((Vec3::new(radial * cos, radial * sin, x), weight * TAU / STEPS as f64));
        }
    }
    out
}

fn grid() -> impl Iterator<Item = (f64, f64)> {
    (0..=15).flat_map(|i| (0..=14).map(move |j| (-0.5 + 0.1 * f64::from(i), -0.45 + 0.05 * f64::from(j))))
}

fn contact_density(eps: f64, x: f64) -> f64 {
    (1.0 - eps + 3.0 * eps * x * x) / (4.0 * PI)
}

fn overlap_law(g: f64, x: f64) -> f64 {
    1.0 + g - 3.0 * g * x * x
}

#[test]
fn moments_are_the_integral_over_the_sphere() {
    let sphere = sphere();
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

/// Stress increment per unit strain increment `e`, Eq. 11 before any algebra, with the mean spin found from the
/// symmetry of the stress.
fn stress_increment(medium: &Medium, sphere: &[(Vec3, f64)], e: &Mat3) -> Mat3 {
    const D: f64 = 2.0e-4;
    let density = 6.0 * medium.solid_fraction / (PI * D.powi(3));
    // K_T of Eq. 9 is twice the Mindlin stiffness at the full overlap 2 δ, here of the isotropic part δ = DΔ/6.
    let k_t = 2.0 * medium.material.tangential_stiffness(D / 4.0, D * medium.volume_strain / 3.0);
    let stress = |gradient: &Mat3| {
        let mut sum = Mat3::zeros();
        for (d, w) in sphere {
            let stiffness = k_t * overlap_law(medium.gamma_over_delta, d.z);
            let contacts = medium.k * contact_density(medium.eps, d.z);
            sum +=
                (gradient * d * (D / 2.0)) * d.transpose() * (w * contacts * stiffness * density * D / 2.0);
        }
        sum
    };
    let torque = |s: &Mat3| Vec3::new(s[(2, 1)] - s[(1, 2)], s[(0, 2)] - s[(2, 0)], s[(1, 0)] - s[(0, 1)]);
    let spin = |v: Vec3| v.cross_matrix();
    let response = Mat3::from_columns(&[Vec3::x(), Vec3::y(), Vec3::z()].map(|v| torque(&stress(&spin(v)))));
    let relative_spin = response.lu().solve(&-torque(&stress(e))).unwrap();
    stress(&(e + spin(relative_spin)))
}

#[test]
fn stiffness_of_the_medium_is_the_integral_with_the_spin_that_keeps_stress_symmetric() {
    const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];
    let sphere = sphere();
    for (eps, g) in grid().step_by(7) {
        let medium = Medium {
            material: Material::GLASS,
            solid_fraction: 0.636,
            volume_strain: 4.5e-4,
            k: 5.5,
            eps,
            gamma_over_delta: g,
        };
        let mut integrated = Matrix6::zeros();
        for (column, (i, j)) in PAIRS.into_iter().enumerate() {
            let mut e = Mat3::zeros();
            e[(i, j)] += 0.5;
            e[(j, i)] += 0.5;
            let s = stress_increment(&medium, &sphere, &e);
            for (row, (k, l)) in PAIRS.into_iter().enumerate() {
                integrated[(row, column)] = s[(k, l)];
            }
        }
        let psi = medium.psi(Form::Corrected);
        let scale = integrated.amax();
        assert!((integrated - psi.stiffness().0).amax() < 1e-12 * scale, "eps {eps} g {g}");
        assert!((Stiffness(integrated).bulk_voigt() - psi.bulk()).abs() < 1e-12 * scale);
        // Over the isotropic medium the bulk modulus is the bracket of Eq. 16, and the shear ratio is 1 + a.
        let isotropic = Medium { eps: 0.0, gamma_over_delta: 0.0, ..medium }.psi(Form::Corrected);
        assert!((psi.bulk() / isotropic.bulk() - Form::Corrected.bulk_factor(eps, g)).abs() < 1e-12);
        let t = psi.stiffness().transverse_isotropy();
        assert!((t.g13 / t.g12 - 1.0 - Moments::new(eps, g).spin()).abs() < 1e-12);
    }
}

/// The printed Eqs. 13 and 16 miss a factor a on one term each: the excess is (4ε/5)(1−a) and (2ε/5)(1−a).
#[test]
fn printed_forms_exceed_the_corrected_ones_by_the_missing_factor() {
    for (eps, g) in grid() {
        let a = Moments::new(eps, g).spin();
        let psi1 = Form::AsPrinted.psi1_factor(eps, g) - Form::Corrected.psi1_factor(eps, g);
        assert!((psi1 - 0.8 * eps * (1.0 - a)).abs() < 1e-14);
        let bulk = Form::AsPrinted.bulk_factor(eps, g) - Form::Corrected.bulk_factor(eps, g);
        assert!((bulk - 0.4 * eps * (1.0 - a)).abs() < 1e-14);
    }
}

/// a as the paper prints it beneath Eq. 15.
#[test]
fn spin_is_the_printed_a() {
    for (e, g) in grid() {
        let a = (4.0 * e / 5.0 - (16.0 / 35.0 * e + 4.0 / 5.0) * g)
            / (4.0 / 3.0 + 4.0 / 15.0 * e - (128.0 / 105.0 * e + 4.0 / 15.0) * g);
        assert!((Moments::new(e, g).spin() - a).abs() < 1e-14, "eps {e} g {g}");
    }
}
