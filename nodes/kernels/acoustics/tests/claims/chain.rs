//! A straight chain of grains, whose waves are known in closed form.

use grainlab_acoustics::standing_wave::{Settings, curves};
use grainlab_acoustics::{AcousticsError, Instrument, Ray, Warning};
use grainlab_core::{Cell, Contact, Mat3, Material, Packing, Vec3};

const DIAMETER: f64 = 2e-4;
const OVERLAP: f64 = 4e-4 * DIAMETER;

/// `grains` along e3 that touch each other and those of the next cell, and no other grains.
fn chain(grains: u32) -> Packing {
    let spacing = DIAMETER - OVERLAP;
    let material = Material::GLASS;
    let radius = 0.5 * DIAMETER;
    let edges = Vec3::new(3.0 * DIAMETER, 3.0 * DIAMETER, f64::from(grains) * spacing);
    let contact = |i: u32| {
        let last = i + 1 == grains;
        let (i, j, image, normal) =
            if last { (0, i, [0, 0, -1], -Vec3::z()) } else { (i, i + 1, [0; 3], Vec3::z()) };
        let normal_force = material.normal_force(0.5 * radius, OVERLAP);
        Contact {
            i,
            j,
            image,
            overlap: OVERLAP,
            normal,
            normal_force,
            tangential_force: Vec3::zeros(),
            rolling_force: Vec3::zeros(),
        }
    };
    let mut contacts: Vec<Contact> = (0..grains).map(contact).collect();
    contacts.sort_by_key(|c| (c.i, c.j, c.image));
    let n = grains as usize;
    let packing = Packing {
        step: 0,
        time: 0.0,
        cell: Cell::new(Mat3::from_diagonal(&edges)).unwrap(),
        deformation: Mat3::identity(),
        ids: (0..grains).collect(),
        radii: vec![radius; n],
        positions: (0..n).map(|k| Vec3::new(0.0, 0.0, (k as f64 + 0.5) * spacing)).collect(),
        velocities: vec![Vec3::zeros(); n],
        spins: vec![Vec3::zeros(); n],
        contacts,
        material,
        law: Default::default(),
        friction: 0.3,
        time_step: 0.0,
    };
    packing.validated().unwrap()
}

fn ray(polarizations: &[Vec3]) -> Ray {
    Ray { direction: Vec3::z(), indices: Some([0, 0, 1]), polarizations: polarizations.to_vec() }
}

#[test]
fn a_chain_rings_at_the_frequencies_of_a_chain() {
    let packing = chain(12);
    let (stiffness, _) = packing.contact_stiffness(&packing.contacts[0]);
    let mass = packing.material.sphere_mass(packing.radii[0]);
    let spacing = DIAMETER - OVERLAP;
    let (curves, ..) =
        curves(&packing, &[ray(&[Vec3::z()])], &Settings::default(), &Instrument::default()).unwrap();
    let curve = &curves[0];
    assert_eq!(curve.points.len(), 3);
    for point in &curve.points {
        let omega = 2.0 * (stiffness / mass).sqrt() * (0.5 * point.wavenumber * spacing).sin();
        let found = point.speed * point.wavenumber;
        // The time step of the engine adds up to 1e-4 at the shortest wave.
        assert!((found / omega - 1.0).abs() < 5e-4, "{found:e} {omega:e}");
    }
    let longest = &curve.points[0];
    let omega = 2.0 * (stiffness / mass).sqrt() * (0.5 * longest.wavenumber * spacing).sin();
    assert!((longest.speed * longest.wavenumber / omega - 1.0).abs() < 1e-4);
    let long = spacing * (stiffness / mass).sqrt();
    assert!((curve.speed - long).abs() < 2.0 * curve.stddev, "{} {long} {}", curve.speed, curve.stddev);
    assert!((curve.speed / long - 1.0).abs() < 2e-4);
    // v² = v₀² (1 − q² a²/12).
    assert!((12.0 * curve.dispersion_coefficient / (spacing * spacing) - 1.0).abs() < 0.2, "{curve:?}");
}

#[test]
fn a_polarization_without_stiffness_is_left_out() {
    let packing = chain(12);
    let settings = Settings::default();
    let both = ray(&[Vec3::z(), Vec3::x()]);
    let (found, traces, warnings) = curves(&packing, &[both], &settings, &Instrument::default()).unwrap();
    assert_eq!((found.len(), traces.len(), warnings.len()), (1, 1, 1));
    assert!(matches!(&warnings[0], Warning::LeftOut(AcousticsError::NoSignal { .. })), "{warnings:?}");
    let none = curves(&packing, &[ray(&[Vec3::x()])], &settings, &Instrument::default());
    assert!(matches!(none, Err(AcousticsError::NoSignal { .. })), "{none:?}");
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let packing = chain(12);
    let rays = [ray(&[Vec3::z()]), ray(&[Vec3::z()])];
    let noisy = Instrument { signal_to_noise: 30.0, ..Instrument::default() };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| curves(&packing, &rays, &Settings::default(), &noisy).unwrap())
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(one, three);
    assert_ne!(one.1[0], one.1[1], "each ray has its own noise");
}
