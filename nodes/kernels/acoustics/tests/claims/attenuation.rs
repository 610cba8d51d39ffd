//! 1/Q of waves in the contact network: closed forms, and the network under a static strain.

use crate::sample;
use grainlab_acoustics::dispersion::{Attenuation, AttenuationSettings, attenuation};
use grainlab_acoustics::{AcousticsError, Ray};
use grainlab_core::{Cell, Contact, Mat3, Material, Packing, Vec3};
use grainlab_micromechanics::PackingView;
use grainlab_micromechanics::network::{ContactSpring, GrainDofs, SpringNetwork, Springs, solve};

const RADIUS: f64 = 1e-4;
const OVERLAP: f64 = 1e-8;
const SPACING: f64 = 2.0 * RADIUS - OVERLAP;

/// A lattice of n × n × `layers` equal grains that touch along e3, and along e1 and e2 if `solid`.
fn lattice(n: usize, layers: usize, solid: bool) -> Packing {
    let across = if solid { SPACING } else { 2.0 * SPACING };
    let edges = Vec3::new(n as f64 * across, n as f64 * across, layers as f64 * SPACING);
    let at = |i: usize, j: usize, k: usize| (i * n + j) * layers + k;
    let (mut positions, mut contacts) = (Vec::new(), Vec::new());
    for (i, j, k) in (0..n).flat_map(|i| (0..n).flat_map(move |j| (0..layers).map(move |k| (i, j, k)))) {
        positions.push(Vec3::new(i as f64 * across, j as f64 * across, (k as f64 + 0.5) * SPACING));
        let next = [
            (Vec3::x(), at((i + 1) % n, j, k), [i8::from(i + 1 == n), 0, 0]),
            (Vec3::y(), at(i, (j + 1) % n, k), [0, i8::from(j + 1 == n), 0]),
            (Vec3::z(), at(i, j, (k + 1) % layers), [0, 0, i8::from(k + 1 == layers)]),
        ];
        for (normal, other, image) in next.into_iter().skip(if solid { 0 } else { 2 }) {
            let turned = other < at(i, j, k);
            let sign = if turned { -1 } else { 1 };
            contacts.push(Contact {
                i: at(i, j, k).min(other) as u32,
                j: at(i, j, k).max(other) as u32,
                image: image.map(|c| sign * c),
                overlap: OVERLAP,
                normal: normal * f64::from(sign),
                normal_force: Material::GLASS.normal_force(0.5 * RADIUS, OVERLAP),
                tangential_force: Vec3::zeros(),
                rolling_force: Vec3::zeros(),
            });
        }
    }
    contacts.sort_by_key(|c| (c.i, c.j, c.image));
    let grains = positions.len();
    let packing = Packing {
        step: 0,
        time: 0.0,
        cell: Cell::new(Mat3::from_diagonal(&edges)).unwrap(),
        deformation: Mat3::identity(),
        ids: (0..grains as u32).collect(),
        radii: vec![RADIUS; grains],
        positions,
        velocities: vec![Vec3::zeros(); grains],
        spins: vec![Vec3::zeros(); grains],
        contacts,
        material: Material::GLASS,
        law: Default::default(),
        friction: 0.3,
        time_step: 0.0,
    };
    packing.validated().unwrap()
}

/// A ray in any direction.
pub(crate) fn along(direction: Vec3, polarizations: &[Vec3]) -> Ray {
    Ray { direction, indices: None, polarizations: polarizations.to_vec() }
}

/// The attenuation along one ray.
pub(crate) fn found(packing: &Packing, ray: Ray, wavelengths: &[f64], damping: f64) -> Vec<Attenuation> {
    let settings = AttenuationSettings { wavelengths: wavelengths.to_vec(), damping };
    attenuation(packing, &[ray], &settings).unwrap()
}

#[test]
fn a_chain_has_the_damped_modes_of_a_chain_for_any_dashpot() {
    let packing = lattice(1, 5, false);
    let (stiffness, _) = packing.contact_stiffness(&packing.contacts[0]);
    let mass = packing.material.sphere_mass(RADIUS);
    for damping in [0.01, 0.3, 1.0] {
        let dashpot = 2.0 * damping * (0.5 * mass * stiffness).sqrt();
        let curves = found(&packing, along(Vec3::z(), &[Vec3::z()]), &[30.0, 60.0], damping);
        for point in &curves[0].points {
            // m u'' + 4 sin²(qd/2) (c u' + k u) = 0.
            let bend = 4.0 * (0.5 * point.wavenumber * SPACING).sin().powi(2);
            let rate = 0.5 * dashpot * bend / mass;
            let omega = (stiffness * bend / mass - rate * rate).sqrt();
            let contact = point.contact.unwrap();
            assert!((contact.omega / omega - 1.0).abs() < 1e-8, "{contact:?} {omega:e}");
            assert!((contact.loss * omega / (2.0 * rate) - 1.0).abs() < 1e-8, "{contact:?}");
            let first = dashpot * bend / mass / (stiffness * bend / mass).sqrt();
            assert!((contact.first_order / first - 1.0).abs() < 1e-8);
        }
    }
}

#[test]
fn shear_waves_of_a_crystal_lose_energy_to_both_dashpots() {
    // Transverse waves turn the grains. Of the 2 × 2 problem, with stiffness and dashpots of equal ratio in every entry,
    // λ² = −ω₀² (1 + λτ) with τ = c_t/k_t.
    let packing = lattice(2, 2, true);
    let (_, tangential) = packing.contact_stiffness(&packing.contacts[0]);
    let mass = packing.material.sphere_mass(RADIUS);
    let relaxation = 2.0 * 0.2 * (0.5 * mass / tangential).sqrt();
    let of = |damping: f64| {
        let ray = along(Vec3::x(), &[Vec3::x(), Vec3::y(), Vec3::z()]);
        let curves = found(&packing, ray, &[40.0], damping);
        [1, 2].map(|k| curves[k].points[0].contact.unwrap())
    };
    for (contact, free) in of(0.2).iter().zip(of(0.0)) {
        let undamped = free.omega;
        assert!((contact.first_order / (undamped * relaxation) - 1.0).abs() < 1e-5, "{contact:?} {free:?}");
        let rate = 0.5 * undamped * undamped * relaxation;
        let omega = (undamped * undamped - rate * rate).sqrt();
        assert!((contact.omega / omega - 1.0).abs() < 1e-6, "{contact:?} {omega:e}");
        assert!((contact.loss * omega / (2.0 * rate) - 1.0).abs() < 1e-5, "{contact:?}");
    }
}

#[test]
fn plane_waves_of_a_crystal_are_not_scattered() {
    let packing = lattice(6, 6, true);
    let ray = along(Vec3::z(), &[Vec3::x(), Vec3::y(), Vec3::z()]);
    let curves = found(&packing, ray, &[8.0, 14.0], 0.0);
    let p = curves.iter().find(|c| c.polarization == Vec3::z()).unwrap();
    for scattering in p.points.iter().filter_map(|p| p.scattering) {
        assert!(scattering.loss.abs() < 1e-6 && !scattering.is_resolved(), "{scattering:?}");
    }
    assert!(p.points.iter().any(|p| p.scattering.is_some()));
}

/// Dashpot coefficients of a contact in place of its springs, for unit damping.
fn dashpots(packing: &Packing, c: &ContactSpring) -> [f64; 2] {
    let [m, n] = [c.i, c.j].map(|g| packing.material.sphere_mass(packing.radii[g as usize]));
    [c.kn_minus_kt + c.tangential, c.tangential].map(|k| 2.0 * (m * n / (m + n) * k).sqrt())
}

#[test]
fn long_waves_lose_what_the_dashpots_dissipate_under_a_static_strain() {
    // 1/Q = ω p·η·p/(p·Γ·p), with the viscosity of the motions that balance the springs under unit strains.
    let packing = sample::anisotropic();
    let network =
        SpringNetwork::new(&PackingView::new(&packing).unwrap(), Springs::NormalAndTangential).unwrap();
    let (loads, scale) = network.affine_loads();
    let motion: Vec<GrainDofs<6>> = solve(&network, &loads, &scale, 1e-9, 20_000).unwrap().motion;
    let ray = along(Vec3::z(), &[Vec3::z(), Vec3::x(), Vec3::y()]);
    let curves = found(&packing, ray, &[320.0], 0.05);
    for curve in curves {
        // The strain n p, in Voigt notation with engineering shear.
        let p = curve.polarization;
        let strain = [0.0, 0.0, p.z, p.y, p.x, 0.0];
        let (mut viscous, mut elastic) = (0.0, 0.0);
        for c in network.contact_springs() {
            let (n, l) = (Vec3::from(c.normal), Vec3::from(c.branch));
            let of = |g: u32, row: usize| (0..6).map(|k| motion[g as usize][row][k] * strain[k]).sum::<f64>();
            let moved = |g: u32| Vec3::new(of(g, 0), of(g, 1), of(g, 2));
            let turned = |g: u32| Vec3::new(of(g, 3), of(g, 4), of(g, 5));
            let sheared = 0.5 * (Vec3::z() * p.dot(&l) + p * l.z);
            let w = sheared + moved(c.j)
                - moved(c.i)
                - (turned(c.i) * c.levers[0] + turned(c.j) * c.levers[1]).cross(&n);
            let (apart, slip) = (w.dot(&n).powi(2), (w - n * w.dot(&n)).norm_squared());
            let [normal, tangential] = dashpots(&packing, &c);
            viscous += 0.05 * (normal * apart + tangential * slip);
            elastic += (c.kn_minus_kt + c.tangential) * apart + c.tangential * slip;
        }
        let contact = curve.points[0].contact.unwrap();
        let expected = contact.omega * viscous / elastic;
        assert!((contact.loss / expected - 1.0).abs() < 5e-3, "{contact:?} {expected:e}");
    }
}

#[test]
fn loss_by_dashpots_is_proportional_to_them_and_to_frequency() {
    let packing = sample::anisotropic();
    let of = |damping: f64| {
        let curves = found(&packing, along(Vec3::z(), &[Vec3::z()]), &[80.0, 160.0], damping);
        [0, 1].map(|k| curves[0].points[k].contact.unwrap())
    };
    let [long, short] = of(0.05);
    let [strong, _] = of(0.2);
    assert!((long.loss / long.omega / (short.loss / short.omega) - 1.0).abs() < 1e-2, "{long:?} {short:?}");
    assert!((strong.loss / long.loss / 4.0 - 1.0).abs() < 1e-4, "{strong:?} {long:?}");
    for mode in [long, short, strong] {
        assert!(
            (mode.loss / mode.first_order - 1.0).abs() < 1e-3 && mode.stddev < 1e-3 * mode.loss,
            "{mode:?}"
        );
    }
    assert!(of(0.0).iter().all(|mode| mode.loss == 0.0 && mode.stddev == 0.0));
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let packing = lattice(1, 5, false);
    for (wavelengths, damping, name) in [
        (vec![], 0.1, "number of wavelengths of attenuation"),
        (vec![100.0, 2.0], 0.1, "wavelength of attenuation"),
        (vec![100.0], 1.1, "contact damping"),
        (vec![100.0], f64::NAN, "contact damping"),
    ] {
        let settings = AttenuationSettings { wavelengths, damping };
        let error = attenuation(&packing, &[along(Vec3::z(), &[Vec3::z()])], &settings).unwrap_err();
        assert!(matches!(&error, AcousticsError::Setting { name: n, .. } if *n == name), "{error}");
    }
}
