//! Parameters at their ends: no pressure, no friction, friction without limit, a strain step beyond the overlap.

use grainlab_core::contact::RollingResistance;
use grainlab_core::{Cell, Packing, Vec3};
use grainlab_dem::Engine;
use grainlab_testkit::engine::*;

fn cubic(overlap: f64) -> Engine {
    let mut s = setting(0.3, 0.0);
    s.time_step = grainlab_engine::TimeStep::FractionOfStable(0.8);
    engine(
        Cell::cube(2.0 * RADIUS - overlap).unwrap(),
        GLASS,
        &[RADIUS],
        &[Vec3::new(0.3, 0.1, -0.2) * RADIUS],
        s,
    )
}

/// Expected: Hertz's stress down to overlaps of a few units in the last place of a diameter, then none; the time step
/// never leaves the Rayleigh bound.
#[test]
fn as_pressure_goes_to_zero_stress_follows_hertz_until_the_last_bit() {
    let idle = cubic(-1e-9).time_step();
    for exponent in 7..=18 {
        let overlap = 10f64.powi(-exponent);
        let e = cubic(overlap);
        let s = e.observables().unwrap();
        let expected = GLASS.normal_force(0.5 * RADIUS, overlap) / (2.0 * RADIUS - overlap).powi(2);
        // Three roundings of lengths near a diameter, entering with the power 3/2.
        let error = 1.5 * 4.0 * f64::EPSILON * 2.0 * RADIUS / overlap;
        if error < 0.5 {
            for v in &s.stress.tensor.voigt()[..3] {
                assert!((v / expected - 1.0).abs() < error, "overlap {overlap}: {v} {expected}");
            }
        }
        assert!(
            s.stress.tensor.is_finite() && s.tangent.iter().all(|c| c.is_finite()) && !s.unbalanced.is_nan()
        );
        assert!(e.time_step() > 0.0 && e.time_step() <= idle);
    }
    for overlap in [0.0, -1e-18, -1e-12] {
        let s = cubic(overlap).observables().unwrap();
        assert!(s.stress.tensor.mean() < 1e-9 && s.stress.tensor.mean() >= 0.0, "{overlap}: {s:?}");
    }
}

/// Expected: without friction no contact carries a tangential or a rolling force and no grain a spin, also where the phase
/// before had all of them.
#[test]
fn without_friction_there_is_neither_spin_nor_tangential_force() {
    let p = Sample::Pressed.packing();
    let law = p.law.with_rolling(RollingResistance { stiffness: 1e4, damping: 1e-3, friction: 0.1 });
    let mut e = taken_up(&Packing { law, ..p }, setting(0.3, 2e-8));
    e.set_rate(&[0.0, 0.0, 0.0, 0.0, 1.0, 0.5]).unwrap();
    steps(&mut e, 100);
    let loaded = packing(&e);
    let none = Vec3::zeros();
    assert!(loaded.contacts.iter().any(|c| c.tangential_force != none && c.rolling_force != none));
    assert!(loaded.spins.iter().any(|w| w.norm() > 0.0));
    e.set_settings(setting(0.0, 2e-8)).unwrap();
    steps(&mut e, 100);
    let p = packing(&e);
    assert!(!p.contacts.is_empty());
    assert!(p.contacts.iter().all(|c| c.tangential_force == none && c.rolling_force == none));
    assert!(p.spins.iter().all(|w| *w == none));
}

/// Expected: a packing that had friction, taken up without, shows the stress of its normal forces at once.
#[test]
fn a_frictional_packing_taken_up_without_friction_drops_its_tangential_forces() {
    let p = Sample::Pressed.packing();
    let e = taken_up(&p, setting(0.0, 2e-8));
    let mut bare = p.clone();
    bare.contacts.iter_mut().for_each(|c| c.tangential_force = Vec3::zeros());
    let expected = grainlab_core::stress::stress(&bare).tensor.matrix();
    assert!((expected - grainlab_core::stress::stress(&p).tensor.matrix()).norm() > 1e-3 * expected.norm());
    let seen = e.observables().unwrap().stress.tensor.matrix();
    assert!((seen - expected).norm() < 1e-12 * expected.norm(), "{seen} {expected}");
    assert!(packing(&e).contacts.iter().all(|c| c.tangential_force == Vec3::zeros()));
}

/// Expected: μ = ∞ is the limit of large μ, and small μ goes over into μ = 0.
#[test]
fn infinite_friction_is_the_limit_of_large_friction_and_none_of_small() {
    let p = Sample::Pressed.packing();
    let after = |friction: f64| {
        let mut q = p.clone();
        // Small friction would cut off the history of this packing at once.
        q.contacts.iter_mut().for_each(|c| c.tangential_force = Vec3::zeros());
        let mut e = taken_up(&q, setting(friction, 2e-8));
        e.set_rate(&[-1.0, 0.5, 0.2, 0.0, 1.0, 0.5]).unwrap();
        steps(&mut e, 300);
        e.observables().unwrap().stress.tensor.matrix()
    };
    let difference = |a: f64, b: f64| (after(a) - after(b)).norm() / after(b).norm();
    assert!(difference(1e9, f64::INFINITY) < 1e-12, "{}", difference(1e9, f64::INFINITY));
    assert!(difference(1e-9, 0.0) < 1e-6, "{}", difference(1e-9, 0.0));
    assert!(difference(0.3, f64::INFINITY) > 1e-4, "friction matters on this path");
}

/// Expected: a step that strains a contact by many times its overlap opens it and drops its history; a step that
/// closes a gap by many times the overlap finds the contact, with Hertz's force of where it stands.
#[test]
fn a_strain_step_larger_than_the_overlap_opens_and_closes_contacts_exactly() {
    let overlap = 4e-8;
    // Touch along z through the boundary; heavy, so that only the strain moves them.
    let height = 8.0 * RADIUS;
    let x = [Vec3::zeros(), Vec3::z() * (height - 2.0 * RADIUS + overlap)];
    let mut e = engine(Cell::cube(height).unwrap(), HEAVY, &[RADIUS; 2], &x, setting(0.5, 1e-9));
    e.set_rate(&[0.0, 0.0, 0.0, 0.0, 1.0, 0.0]).unwrap();
    steps(&mut e, 1000);
    assert!(packing(&e).contacts[0].tangential_force.norm() > 0.0);
    let jump = |e: &mut Engine, overlaps: f64| {
        e.set_rate(&[0.0, 0.0, overlaps * overlap / (2.0 * RADIUS) / 1e-9, 0.0, 0.0, 0.0]).unwrap();
        e.step().unwrap();
    };
    jump(&mut e, 50.0);
    assert!(packing(&e).contacts.is_empty() && e.observables().unwrap().stress.tensor.mean() == 0.0);
    jump(&mut e, -75.0);
    let p = packing(&e);
    assert_eq!(found(&p), [(0, 1, [0, 0, -1])]);
    assert_eq!(found(&p), brute_force(&p));
    let c = p.contacts[0];
    let depth = 2.0 * RADIUS - p.branch(&c).norm();
    assert!(depth > 20.0 * overlap, "{depth}");
    assert!((c.normal_force / GLASS.normal_force(0.5 * RADIUS, depth) - 1.0).abs() < 1e-9);
    // The contact is new: what it was loaded with before is forgotten.
    let slip = p.material.tangential_stiffness(0.5 * RADIUS, depth) * 2.0 * RADIUS * 1e-6;
    assert!(c.tangential_force.norm() < 0.2 * slip, "{} {slip}", c.tangential_force.norm());
    // A jump beyond the skin, too.
    jump(&mut e, 2000.0);
    jump(&mut e, -1900.0);
    let p = packing(&e);
    assert_eq!((found(&p), p.contacts.len()), (brute_force(&p), 1));
}
