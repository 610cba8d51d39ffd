//! Stress by kind of force and by network, the stress-force-fabric relation, distributions of forces.

use crate::golden::reference;
use crate::samples::{Pair, drawn, eq6, packing, pairs, random, spread};
use grainlab_core::results::{ContactStatistics, Fabric, StressDecomposition};
use grainlab_core::{Cell, Mat3, Packing, SymTensor, Vec3};
use grainlab_micromechanics::PackingView;
use grainlab_micromechanics::structure::{contact_statistics, fabric, stress_decomposition};
use grainlab_testkit::Random;

/// All measurements without a stiffness, about z.
struct Structure {
    contacts: ContactStatistics,
    fabric: Fabric,
    stress: StressDecomposition,
}

fn structure(p: &Packing) -> Structure {
    let view = PackingView::new(p).unwrap();
    let fabric = fabric(&view, &Vec3::z());
    Structure { contacts: contact_statistics(&view), stress: stress_decomposition(&view, &fabric), fabric }
}

fn largest(t: &SymTensor) -> f64 {
    t.voigt().iter().fold(0.0, |m, v| m.max(v.abs()))
}

fn difference(a: &SymTensor, b: &SymTensor) -> f64 {
    let (a, b) = (a.voigt(), b.voigt());
    (0..6).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max)
}

/// Traceless and symmetric, with entries of about `scale`, in a general direction.
fn tilted(dice: &mut Random, scale: f64) -> SymTensor {
    SymTensor::from_voigt(std::array::from_fn(|_| (dice.unit() - 0.5) * scale)).deviator()
}

fn quadratic(a: &SymTensor, n: &Vec3) -> f64 {
    n.dot(&(a.matrix() * n))
}

/// `random` with tangential forces of half the normal ones, across the normal.
fn rough(seed: u64) -> Packing {
    let (mut p, mut dice) = (random(60, 1.15, seed), Random::new(seed));
    for c in &mut p.contacts {
        let any = Vec3::from_fn(|_, _| dice.unit() - 0.5);
        c.tangential_force = c.normal.cross(&any).normalize() * 0.5 * c.normal_force;
    }
    p
}

#[test]
fn a_single_pair_has_the_stress_of_its_two_forces() {
    let pair = Pair { normal_force: 2.0, tangential_force: Vec3::x() * 0.5, ..Pair::along(Vec3::z()) };
    let s = structure(&pairs(&[pair], 1));
    let scale = 2e-4 / 1e-6;
    let (n, t) = (s.stress.normal, s.stress.tangential);
    assert!((n.zz - 2.0 * scale).abs() < 1e-9 && (largest(&n) - n.zz).abs() < 1e-9);
    // Half of the shear, because the other half is spin.
    assert!((t.xz - 0.25 * scale).abs() < 1e-9 && (largest(&t) - t.xz).abs() < 1e-9);
    let along_x = SymTensor { xx: 1.0, ..SymTensor::default() };
    assert!(difference(&s.fabric.tangential_force_fabric, &along_x) < 1e-15);
}

#[test]
fn kinds_of_force_and_networks_add_up_to_the_stress() {
    for p in [rough(31), reference()] {
        let s = structure(&p);
        let stress = grainlab_core::stress::stress(&p).tensor;
        assert!(difference(&s.stress.sum(), &stress) < 1e-12 * largest(&stress));
        let (strong, weak) = (s.stress.strong.stress.voigt(), s.stress.weak.stress.voigt());
        let both = SymTensor::from_voigt(std::array::from_fn(|k| strong[k] + weak[k]));
        assert!(difference(&both, &stress) < 1e-12 * largest(&stress));
        assert_eq!((s.stress.strong.contacts + s.stress.weak.contacts) as usize, p.contacts.len());
        let (a, b) = (f64::from(s.stress.strong.contacts), f64::from(s.stress.weak.contacts));
        let (strong, weak) = (s.stress.strong.fabric.voigt(), s.stress.weak.fabric.voigt());
        let mean = SymTensor::from_voigt(std::array::from_fn(|k| (a * strong[k] + b * weak[k]) / (a + b)));
        assert!(difference(&mean, &s.fabric.contact_fabric) < 1e-14);
        assert!(s.stress.strong.contacts > 0 && s.stress.weak.contacts > s.stress.strong.contacts);
    }
}

/// Forces generated from given tensors return these tensors for any distribution of the contacts. The stress
/// equals the predicted one up to products of two anisotropies.
#[test]
fn anisotropies_are_found_and_predict_the_deviatoric_stress_to_first_order() {
    let mut errors = Vec::new();
    for scale in [0.08, 0.04] {
        let mut dice = Random::new(41);
        let [a_n, a_l, a_t] = [0; 3].map(|_| tilted(&mut dice, scale));
        let eps = scale / 3.0;
        let contacts: Vec<Pair> = spread(40_000, eq6(eps))
            .into_iter()
            .map(|n| Pair {
                branch: 2e-4 * (1.0 + quadratic(&a_l, &n)),
                normal_force: 3.0 * (1.0 + quadratic(&a_n, &n)),
                tangential_force: (a_t.matrix() * n - n * quadratic(&a_t, &n)) * 3.0,
                ..Pair::along(n)
            })
            .collect();
        let p = pairs(&contacts, 1);
        let s = structure(&p);
        let found = s.stress.stress_force_fabric.unwrap();
        assert!(difference(&found.normal_forces, &a_n) < 1e-12);
        assert!(difference(&found.branches, &a_l) < 1e-10);
        assert!(difference(&found.tangential_forces, &a_t) < 1e-12);
        // a^c = 3 ε (zz − 1/3); the directions are uniform to 1e-4.
        assert!((found.contacts.zz - 2.0 * eps).abs() < 2e-4 && (found.contacts.xx + eps).abs() < 2e-4);
        let stress = s.stress.sum();
        let measured = SymTensor::from_voigt(stress.deviator().voigt().map(|v| v / stress.mean()));
        errors.push(difference(&measured, &found.stress_ratio()));
        assert!(measured.deviatoric_invariant() > 0.2 * scale);
    }
    assert!(errors[0] < 0.3 * 0.08f64.powi(2) && errors[0] / errors[1] > 3.0, "{errors:?}");
}

/// Radii from 1 to 5, forces proportional to the square of the radius: the anisotropies are those of the mean
/// over each direction.
#[test]
fn sizes_from_one_to_five_leave_the_relation_alone() {
    let mut dice = Random::new(43);
    let (a_n, eps) = (tilted(&mut dice, 0.3), 0.08);
    let contacts: Vec<Pair> = drawn(&mut dice, 60_000, eq6(eps))
        .into_iter()
        .map(|n| {
            let size = 1.0 + 4.0 * dice.unit();
            Pair {
                branch: 1e-4 * size,
                normal_force: size * size * (1.0 + quadratic(&a_n, &n)),
                ..Pair::along(n)
            }
        })
        .collect();
    let s = structure(&pairs(&contacts, 1));
    let found = s.stress.stress_force_fabric.unwrap();
    // The size does not depend on direction: relative scatter of the force (.7) times about 4 over √60000.
    assert!(largest(&found.branches) < 0.03 && difference(&found.normal_forces, &a_n) < 0.04);
    let stress = s.stress.sum();
    let measured = SymTensor::from_voigt(stress.deviator().voigt().map(|v| v / stress.mean()));
    assert!(difference(&measured, &found.stress_ratio()) < 0.015);
    assert!(measured.deviatoric_invariant() > 0.08);
}

/// A chain and a simple cubic lattice do not determine how forces depend on direction: the anisotropy is 0.
#[test]
fn missing_directions_get_no_anisotropy() {
    let chain = structure(&pairs(&[Pair::along(Vec3::z()), Pair::along(Vec3::z())], 1));
    let a = chain.stress.stress_force_fabric.unwrap();
    assert_eq!((largest(&a.normal_forces), largest(&a.tangential_forces)), (0.0, 0.0));
    let cell = Cell::new(Mat3::identity() * 2e-4).unwrap();
    let cubic = structure(&packing(cell, vec![Vec3::zeros()], 1e-4 * (1.0 + 1e-4), 0.3, None));
    let a = cubic.stress.stress_force_fabric.unwrap();
    assert!([a.contacts, a.normal_forces, a.tangential_forces].iter().all(|t| largest(t) < 1e-12), "{a:?}");
    assert_eq!((cubic.stress.strong.contacts, cubic.stress.weak.contacts), (0, 3));
}

#[test]
fn four_contacts_have_the_moments_and_networks_of_their_forces() {
    let of = |f: f64, n: Vec3| Pair { normal_force: f, ..Pair::along(n) };
    let p = pairs(&[of(1.0, Vec3::x()), of(1.0, Vec3::x()), of(1.0, Vec3::x()), of(5.0, Vec3::z())], 1);
    let s = structure(&p);
    let f = s.contacts.forces.unwrap();
    assert_eq!((f.mean_normal, f.mean_tangential, f.largest), (2.0, 0.0, 2.5));
    assert_eq!(f.moments, [1.75, (0.375 + 15.625) / 4.0, (0.1875 + 39.0625) / 4.0]);
    assert!((f.participation_ratio() - 64.0 / 112.0).abs() < 1e-15);
    assert_eq!((f.histogram[2], f.histogram[10], f.histogram.iter().sum::<u32>()), (3, 1, 4));
    assert_eq!((s.stress.strong.contacts, s.stress.weak.contacts), (1, 3));
    assert!(
        (s.stress.strong.contact_anisotropy - 2.5).abs() < 1e-15
            && (s.stress.weak.contact_anisotropy + 1.25).abs() < 1e-15
    );
    let share = s.stress.strong.stress.trace() / s.stress.sum().trace();
    assert!((share - 5.0 / 8.0).abs() < 1e-12);
}

#[test]
fn exponential_forces_have_the_moments_of_an_exponential() {
    let mut dice = Random::new(44);
    let contacts: Vec<Pair> = drawn(&mut dice, 100_000, eq6(0.0))
        .into_iter()
        .map(|n| Pair { normal_force: -(1.0 - dice.unit()).ln(), ..Pair::along(n) })
        .collect();
    let s = structure(&pairs(&contacts, 1));
    let f = s.contacts.forces.unwrap();
    // Standard errors of the moments: .015, .09, .9.
    for (found, (expected, error)) in f.moments.iter().zip([(2.0, 0.06), (6.0, 0.4), (24.0, 4.0)]) {
        assert!((found - expected).abs() < error, "{:?}", f.moments);
    }
    // A fraction e^-1 of the contacts is strong, and carries 2/e of the pressure.
    let e = std::f64::consts::E;
    assert!((f64::from(s.stress.strong.contacts) / 1e5 - 1.0 / e).abs() < 0.006);
    assert!((s.stress.strong.stress.trace() / s.stress.sum().trace() - 2.0 / e).abs() < 0.01);
    let tail = f64::from(f.histogram[19]) / 1e5;
    assert!((tail - (-4.75f64).exp()).abs() < 0.002, "{tail}");
}

#[test]
fn mobilised_friction_is_shared_out_in_tenths_and_has_no_meaning_without_a_limit() {
    let of = |normal_force: f64, t: f64| Pair {
        normal_force,
        tangential_force: Vec3::x() * t,
        ..Pair::along(Vec3::z())
    };
    // μ = 0.5: 0, 0.44, 1, more than 1, and contacts with a zero or a tensile normal force.
    let forces = [(2.0, 0.0), (2.0, 0.44), (2.0, 1.0), (2.0, 1.5), (0.0, 0.1), (-4.0, 0.1)];
    let mut p = pairs(&forces.map(|(n, t)| of(n, t)), 1);
    let m = structure(&p).contacts.friction.unwrap();
    assert_eq!(m.histogram, [1, 0, 0, 0, 1, 0, 0, 0, 0, 4]);
    assert!((m.mean - 4.44 / 6.0).abs() < 1e-15);
    for friction in [0.0, f64::INFINITY] {
        p.friction = friction;
        let found = structure(&p).contacts;
        assert_eq!((found.friction, found.sliding_fraction), (None, 0.0));
    }
}

#[test]
fn contacts_without_force_have_a_fabric_and_no_force_statistics() {
    let p = pairs(&[Pair { normal_force: 0.0, ..Pair::along(Vec3::z()) }], 1);
    let s = structure(&p);
    assert_eq!((s.contacts.forces, s.stress.stress_force_fabric), (None, None));
    assert_eq!((s.fabric.orientation.contacts[9], largest(&s.fabric.tangential_force_fabric)), (1, 0.0));
}

/// The packing of LAMMPS was compressed to a shape, not to a stress: q/p is .05, as predicted by the
/// anisotropies.
#[test]
fn the_deviatoric_stress_of_a_real_packing_is_the_one_its_anisotropies_predict() {
    let s = structure(&reference());
    let a = s.stress.stress_force_fabric.unwrap();
    let stress = s.stress.sum();
    let measured = SymTensor::from_voigt(stress.deviator().voigt().map(|v| v / stress.mean()));
    assert!((0.045..0.06).contains(&measured.deviatoric_invariant()));
    assert!(difference(&measured, &a.stress_ratio()) < 0.0015, "{measured:?} {:?}", a.stress_ratio());
    // Without any one of the three kinds the error would be larger.
    for kind in [a.contacts, a.normal_forces] {
        assert!(0.4 * largest(&kind) > 0.02);
    }
    assert!(0.6 * largest(&a.tangential_forces) > 0.0025);
    assert!(largest(&a.branches) < 1e-4);
    let f = s.contacts.forces.unwrap();
    assert!((1.2..2.0).contains(&f.moments[0]) && (0.5..0.85).contains(&f.participation_ratio()));
    let m = s.contacts.friction.unwrap();
    assert!((0.4..0.9).contains(&m.mean) && f64::from(m.histogram[9]) / 1277.0 > 0.35);
    let share = s.stress.strong.stress.trace() / s.stress.sum().trace();
    assert!(
        (0.6..0.8).contains(&share) && s.stress.strong.contacts < 600,
        "{share} {}",
        s.stress.strong.contacts
    );
}
