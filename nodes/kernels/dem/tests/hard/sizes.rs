//! Grains of size ratio 1 to 5.

use grainlab_core::contact::TangentialLaw;
use grainlab_core::effective_radius;
use grainlab_core::{Cell, Vec3};
use grainlab_dem::Engine;
use grainlab_testkit::Random;
use grainlab_testkit::engine::*;

const SMALL: f64 = 0.2 * RADIUS;

/// Expected: σ = F l/V along the line of centres with R* = R_i R_j/(R_i + R_j), and k_n l²/V, k_t l²/(4V) as tangent.
#[test]
fn two_unequal_grains_have_the_stress_of_their_contact() {
    let overlap = 2e-8;
    let length = RADIUS + SMALL - overlap;
    let cell = Cell::cube(10.0 * RADIUS).unwrap();
    let e = engine(cell, GLASS, &[SMALL, RADIUS], &[Vec3::zeros(), Vec3::z() * length], setting(0.3, 1e-9));
    let s = e.observables().unwrap();
    let (r_eff, volume) = (effective_radius(SMALL, RADIUS), (10.0 * RADIUS).powi(3));
    let expected = GLASS.normal_force(r_eff, overlap) * length / volume;
    assert!((s.stress.tensor.zz / expected - 1.0).abs() < 1e-9, "{} {expected}", s.stress.tensor.zz);
    assert!(s.stress.tensor.xx == 0.0 && s.stress.tensor.yy == 0.0);
    let c33 = GLASS.normal_stiffness(r_eff, overlap) * length * length / volume;
    let c44 = 0.25 * GLASS.tangential_stiffness(r_eff, overlap) * length * length / volume;
    assert!((s.tangent[2] / c33 - 1.0).abs() < 1e-9 && (s.tangent[3] / c44 - 1.0).abs() < 1e-9);
}

/// A gas of large and small grains without overlap.
fn mixture(seed: u64, friction: f64, time_step: f64) -> Engine {
    let mut random = Random::new(seed);
    let edge = 8.0 * RADIUS;
    let cell = Cell::cube(edge).unwrap();
    let (mut radii, mut x) = (Vec::<f64>::new(), Vec::<Vec3>::new());
    while x.len() < 60 {
        let (r, at) = (if x.len() < 24 { RADIUS } else { SMALL }, random.vector(0.5 * edge));
        let free =
            (0..x.len()).all(|i| (x[i] - at).map(|d| d - edge * (d / edge).round()).norm() > r + radii[i]);
        if free {
            radii.push(r);
            x.push(at);
        }
    }
    let mut s = setting(friction, time_step);
    s.tangential = TangentialLaw::Rescaled;
    let mut e = engine(cell, GLASS, &radii, &x, s);
    e.set_velocities(&(0..60).map(|_| random.vector(1.0)).collect::<Vec<_>>()).unwrap();
    e
}

/// Expected: without friction and damping a mixture keeps energy and momentum, and every contact is found.
#[test]
fn a_mixture_of_sizes_keeps_energy_and_momentum_and_finds_every_contact() {
    let mut e = mixture(1, 0.0, 1e-9);
    let (before, momenta) = (energy(&packing(&e)), momentum(&packing(&e)));
    let mut kinds = [0; 3];
    for step in 0..60_000 {
        e.step().unwrap();
        if step % 10 == 0 {
            let p = packing(&e);
            assert_eq!(found(&p), brute_force(&p), "after {step} steps");
            p.contacts.iter().for_each(|c| kinds[usize::from(c.i >= 24) + usize::from(c.j >= 24)] += 1);
        }
    }
    let p = packing(&e);
    assert!(kinds[0] > 10 && kinds[1] > 10, "large and small grains met: {kinds:?}");
    assert!((energy(&p) / before - 1.0).abs() < 2e-4, "{}", energy(&p) / before - 1.0);
    let scale = 24.0 * GLASS.sphere_mass(RADIUS);
    assert!((momentum(&p) - momenta).norm() < 1e-11 * scale, "{:?}", momentum(&p) - momenta);
}

/// Expected: with friction no contact ever exceeds Coulomb's limit nor leaves the tangent plane, energy never grows, and
/// a small grain on a large one does not stick (LAMMPS, PR 4244): what slid over a contact is gone with it.
#[test]
fn a_small_grain_slides_on_a_large_one_within_coulombs_limit() {
    let mut e = mixture(2, 0.4, 1e-9);
    let mut last = energy(&packing(&e));
    let (mut seen, mut sliding) = (0, 0);
    for step in 0..60_000 {
        e.step().unwrap();
        if step % 5 == 0 {
            let p = packing(&e);
            for c in &p.contacts {
                let t = c.tangential_force;
                assert!(t.norm() <= 0.4 * c.normal_force * (1.0 + 1e-9), "{c:?}");
                assert!(t.dot(&c.normal).abs() <= 1e-3 * t.norm(), "{c:?}");
                seen += 1;
                sliding += usize::from(t.norm() > 0.399 * c.normal_force);
            }
            if p.contacts.is_empty() {
                let now = energy(&p);
                assert!(now < last * (1.0 + 1e-5), "{now} {last} after {step} steps");
                last = now;
            }
        }
    }
    assert!(seen > 100 && sliding > 10 && sliding < seen, "{sliding} of {seen}");
}
