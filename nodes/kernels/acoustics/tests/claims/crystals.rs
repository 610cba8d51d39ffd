//! Crystals of equal springs have dispersion relations in closed form.
//!
//! c = cos(q d/2) and s = sin(q d/2), with the spacing d of planes along the wave, the lever λ, mass m and
//! moment of inertia I. Transverse waves couple to rotations: m ω² and I ω² of the 2 × 2 problem K_uu, K_φφ,
//! ± i K_uφ.

use grainlab_acoustics::dispersion::{Settings, curves};
use grainlab_acoustics::{DispersionCurve, Ray};
use grainlab_core::{Cell, Mat3, Packing, Vec3, contact_search};

const RADIUS: f64 = 1e-4;
const OVERLAP: f64 = 1e-8;

/// `positions` in units of the columns of `cell` (m), with contacts of one overlap.
fn crystal(cell: Mat3, positions: &[Vec3]) -> Packing {
    let cell = Cell::new(cell).unwrap();
    let n = positions.len();
    let mut p = Packing {
        ids: (1..=n as u32).collect(),
        friction: 0.3,
        ..Packing::at_rest(cell, vec![RADIUS; n], positions.iter().map(|x| cell.matrix() * x).collect())
    };
    p.contacts = contact_search::of_packing(&p).unwrap();
    p.validated().unwrap()
}

fn grid(n: usize) -> Vec<Vec3> {
    let at = |k: usize| k as f64 / n as f64;
    (0..n * n * n).map(|k| Vec3::new(at(k / n / n), at(k / n % n), at(k % n))).collect()
}

fn measured(packing: &Packing, direction: Vec3, polarization: Vec3) -> DispersionCurve {
    let settings = Settings {
        wavelengths: vec![2.2, 3.0, 7.0, 40.0],
        tolerance: 1e-12,
        doublings: 0,
        ..Settings::default()
    };
    let ray = Ray { direction, indices: None, polarizations: vec![polarization] };
    curves(packing, &[ray], &settings).unwrap().remove(0)
}

/// The lower frequency of the coupled u and φ, and the constants of all contacts.
struct Springs {
    normal: f64,
    tangential: f64,
    mass: f64,
    inertia: f64,
    lever: f64,
}

impl Springs {
    fn of(packing: &Packing, branch: f64) -> Self {
        let (normal, tangential) = packing.contact_stiffness(&packing.contacts[0]);
        let mass = packing.material.sphere_mass(RADIUS);
        Self { normal, tangential, mass, inertia: 0.4 * mass * RADIUS * RADIUS, lever: 0.5 * branch }
    }

    fn softer(&self, uu: f64, phi: f64, coupling: f64) -> f64 {
        let (a, b, c) = (uu / self.mass, phi / self.inertia, coupling.powi(2) / (self.mass * self.inertia));
        // The smaller root of w² − (a + b) w + ab − c is the product over the larger one, which avoids
        // cancellation.
        (a * b - c) / (0.5 * (a + b) + (0.25 * (a - b).powi(2) + c).sqrt())
    }
}

fn assert_closed_form(curve: &DispersionCurve, what: &str, square: impl Fn(f64) -> f64) {
    for point in &curve.points {
        let (found, expected) = ((point.speed * point.wavenumber).powi(2), square(point.wavenumber));
        let error = (found / expected - 1.0).abs();
        assert!(error < 1e-8, "{what}: {error:e} at {point:?}");
    }
}

#[test]
fn simple_cubic_has_its_dispersion_relation() {
    let branch = 2.0 * RADIUS - OVERLAP;
    for n in [1, 3] {
        let packing = crystal(Mat3::identity() * branch * n as f64, &grid(n));
        assert_eq!(packing.contacts.len(), 3 * n * n * n);
        let k = Springs::of(&packing, branch);
        let along = measured(&packing, Vec3::x(), Vec3::x());
        assert_closed_form(&along, "P", |q| 4.0 * k.normal / k.mass * (0.5 * q * branch).sin().powi(2));
        let across = measured(&packing, Vec3::x(), Vec3::y());
        assert_closed_form(&across, "S", |q| {
            let (s, c) = (0.5 * q * branch).sin_cos();
            let t = k.tangential;
            let phi = 4.0 * t * k.lever.powi(2) * (c * c + 1.0);
            k.softer(4.0 * t * s * s, phi, 4.0 * t * k.lever * s * c)
        });
    }
}

#[test]
fn all_of_a_crystal_moves_however_few_grains_its_cell_has() {
    let branch = 2.0 * RADIUS - OVERLAP;
    for n in [1, 2, 3] {
        let packing = crystal(Mat3::identity() * branch * n as f64, &grid(n));
        let measured =
            grainlab_acoustics::measure(&packing, &grainlab_acoustics::Settings::default()).unwrap();
        let mass: f64 = packing.radii.iter().map(|r| packing.material.sphere_mass(*r)).sum();
        assert!((measured.density * packing.cell.volume() / mass - 1.0).abs() < 1e-12, "{measured:?}");
    }
}

#[test]
fn face_centred_cubic_has_its_dispersion_relation() {
    let branch = 2.0 * RADIUS - OVERLAP;
    let edge = branch * 2f64.sqrt();
    let corners =
        [Vec3::zeros(), Vec3::new(0.0, 0.5, 0.5), Vec3::new(0.5, 0.0, 0.5), Vec3::new(0.5, 0.5, 0.0)];
    let primitive = Mat3::new(0.0, 0.5, 0.5, 0.5, 0.0, 0.5, 0.5, 0.5, 0.0) * edge;
    for packing in [crystal(Mat3::identity() * edge, &corners), crystal(primitive, &[Vec3::zeros()])] {
        assert_eq!(packing.contacts.len(), 6 * packing.grains());
        let k = Springs::of(&packing, branch);
        let half = |q: f64| (0.25 * q * edge).sin_cos();
        let along = measured(&packing, Vec3::x(), Vec3::x());
        let sum = k.normal + k.tangential;
        assert_closed_form(&along, "P", |q| 8.0 * sum / k.mass * half(q).0.powi(2));
        let across = measured(&packing, Vec3::x(), Vec3::y());
        assert_closed_form(&across, "S", |q| {
            let (s, c) = half(q);
            let t = k.tangential;
            let phi = 4.0 * t * k.lever.powi(2) * (3.0 * c * c + 1.0);
            k.softer(4.0 * (k.normal + 3.0 * t) * s * s, phi, 8.0 * 2f64.sqrt() * t * k.lever * s * c)
        });
    }
}

#[test]
fn a_chain_has_its_dispersion_relation_and_resists_nothing_across() {
    let branch = 2.0 * RADIUS - OVERLAP;
    let n = 5;
    let cell = Mat3::from_diagonal(&Vec3::new(4.0 * RADIUS, 4.0 * RADIUS, n as f64 * branch));
    let positions: Vec<Vec3> = (0..n).map(|k| Vec3::new(0.5, 0.5, k as f64 / n as f64)).collect();
    let packing = crystal(cell, &positions);
    let k = Springs::of(&packing, branch);
    let along = measured(&packing, Vec3::z(), Vec3::z());
    assert_closed_form(&along, "P", |q| 4.0 * k.normal / k.mass * (0.5 * q * branch).sin().powi(2));
    let ray = Ray { direction: Vec3::z(), indices: None, polarizations: vec![Vec3::x()] };
    let error = curves(&packing, &[ray], &Settings::default()).unwrap_err();
    assert!(matches!(error, grainlab_acoustics::AcousticsError::NoStiffness(_)), "{error}");
}

/// A chain whose grains overlap by a tenth of a diameter and more has no contact law, and no waves.
#[test]
fn grains_that_overlap_beyond_every_contact_law_have_no_waves() {
    let branch = 1.78 * RADIUS;
    let cell = Mat3::from_diagonal(&Vec3::new(4.0 * RADIUS, 4.0 * RADIUS, 5.0 * branch));
    let positions: Vec<Vec3> = (0..5).map(|k| Vec3::new(0.5, 0.5, k as f64 / 5.0)).collect();
    let mut packing = crystal(cell, &positions);
    packing.contacts.iter_mut().for_each(|c| c.overlap = 0.22 * RADIUS);
    let error = grainlab_acoustics::measure(&packing, &grainlab_acoustics::Settings::default()).unwrap_err();
    let none = grainlab_core::results::NoStiffness::TooDeep;
    assert_eq!(error, grainlab_acoustics::AcousticsError::NoStiffness(none));
}
