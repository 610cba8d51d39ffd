//! One grain, two grains, and a box barely above two diameters.

use grainlab_core::contact::TangentialLaw;
use grainlab_core::{Cell, Vec3};
use grainlab_engine::TimeStep;
use grainlab_testkit::engine::*;

/// Expected: alone, it keeps its velocity relative to a resting cell; in a straining one v = exp(−L t) v0.
#[test]
fn one_grain_that_touches_nothing_flies_freely() {
    let cell = Cell::cube(10.0 * RADIUS).unwrap();
    let start = Vec3::new(0.3, -0.2, 0.1);
    let mut e = engine(cell, GLASS, &[RADIUS], &[Vec3::zeros()], setting(0.3, 1e-6));
    e.set_velocities(&[start]).unwrap();
    e.set_rate(&[10.0, -20.0, 30.0, 0.0, 0.0, 0.0]).unwrap();
    steps(&mut e, 1000);
    let p = packing(&e);
    let expected = start.component_mul(&Vec3::new(-0.01, 0.02, -0.03).map(f64::exp));
    // A first-order step: r² t dt/2 of each component, 4e-7 at most.
    assert!((p.velocities[0] - expected).norm() < 1e-6 * start.norm(), "{:?}", p.velocities[0]);
    let s = e.observables().unwrap();
    assert_eq!((s.contacts, s.stress.tensor.voigt(), s.tangent), (0, [0.0; 6], [0.0; 6]));
    assert_eq!(s.unbalanced, 1.0, "nothing in contact is not a balance");
}

/// Expected: a grain stuck to its own image turns to and fro at ω² = 4 a² k_t/I: both ends of the contact are its own.
#[test]
fn one_grain_swings_on_the_contact_with_its_own_image() {
    let overlap = 4e-8;
    let cell = box_of(5.0 * RADIUS, 5.0 * RADIUS, 2.0 * RADIUS - overlap);
    let mut e = engine(cell, GLASS, &[RADIUS], &[Vec3::zeros()], setting(f64::INFINITY, 1e-9));
    e.set_spins(&[Vec3::x()]).unwrap();
    let lever = RADIUS - 0.5 * overlap;
    let inertia = 0.4 * GLASS.sphere_mass(RADIUS) * RADIUS * RADIUS;
    let k_t = GLASS.tangential_stiffness(0.5 * RADIUS, overlap);
    let period = std::f64::consts::TAU / (4.0 * lever * lever * k_t / inertia).sqrt();
    let (mut rising, mut last) = (Vec::new(), 1.0);
    while rising.len() < 11 {
        e.step().unwrap();
        let now = packing(&e).spins[0].x;
        if last < 0.0 && now >= 0.0 {
            rising.push(e.time() - 1e-9 * now / (now - last));
        }
        last = now;
    }
    let measured = (rising[10] - rising[0]) / 10.0;
    assert!((measured / period - 1.0).abs() < 1e-5, "{measured} {period}");
    assert!(e.speed() == 0.0, "it does not move");
}

/// Expected: an oblique collision with friction keeps momentum and angular momentum, and loses energy; only
/// the incremental law without sliding gains some.
#[test]
fn two_grains_collide_obliquely_with_friction_and_keep_angular_momentum() {
    for tangential in [TangentialLaw::Rescaled, TangentialLaw::Incremental] {
        for (friction, damping) in [(0.3, 0.0), (f64::INFINITY, 0.0), (0.5, 0.2)] {
            let mut s = setting(friction, 1e-9);
            (s.tangential, s.damping) = (tangential, damping);
            let x = [Vec3::zeros(), Vec3::new(2.001, 0.9, -0.4).normalize() * (2.001 * RADIUS)];
            let mut e = engine(Cell::cube(30.0 * RADIUS).unwrap(), GLASS, &[RADIUS; 2], &x, s);
            e.set_velocities(&[Vec3::x(), Vec3::zeros()]).unwrap();
            e.set_spins(&[Vec3::new(900.0, -2000.0, 500.0), Vec3::new(0.0, 3000.0, 800.0)]).unwrap();
            let angular = |e: &grainlab_dem::Engine| {
                let p = packing(e);
                let (m, r) = (GLASS.sphere_mass(RADIUS), RADIUS);
                let each =
                    |i: usize| p.positions[i].cross(&p.velocities[i]) * m + p.spins[i] * (0.4 * m * r * r);
                each(0) + each(1)
            };
            let (before, momenta) = ((energy(&packing(&e)), angular(&e)), momentum(&packing(&e)));
            let mut touched = false;
            for _ in 0..6000 {
                e.step().unwrap();
                touched |= e.observables().unwrap().contacts > 0;
            }
            let p = packing(&e);
            assert!(touched && p.contacts.is_empty(), "they met and parted");
            assert!((momentum(&p) - momenta).norm() < 1e-12 * momenta.norm());
            assert!(
                (angular(&e) - before.1).norm() < 1e-9 * before.1.norm(),
                "{:?} {:?}",
                angular(&e),
                before.1
            );
            let gain = energy(&p) / before.0 - 1.0;
            if tangential == TangentialLaw::Rescaled || friction.is_finite() {
                assert!(gain < -1e-3, "{tangential:?}, friction {friction}: {gain}");
            } else {
                // "rescaled" prevents this: the law gives back on parting energy that it was not given on approach.
                assert!(gain > 1e-4 && gain < 1e-2, "{gain}");
            }
        }
    }
}

/// Expected: as in any other box: every contact found, momentum and energy kept, though a grain meets another through
/// several images at once.
#[test]
fn a_box_barely_above_two_diameters_is_a_box_like_any_other() {
    let gas = grainlab_dem::gas::random_placement(&[RADIUS; 5], 0.33, 5.0, 2).unwrap();
    let edge = 4.02 * RADIUS;
    let scale = edge / gas.cell.matrix()[(0, 0)];
    assert!(scale > 1.0, "placed a little closer than they are used");
    let x: Vec<Vec3> = gas.positions.iter().map(|x| x * scale).collect();
    let mut s = setting(0.0, 2e-9);
    // The list reaches further than half the box.
    s.skin = 0.5 * RADIUS;
    let mut e = engine(Cell::cube(edge).unwrap(), GLASS, &[RADIUS; 5], &x, s);
    e.set_velocities(&gas.velocities).unwrap();
    let before = energy(&packing(&e));
    let (mut collisions, mut last) = (0, 0);
    for step in 0..200_000 {
        e.step().unwrap();
        if step % 20 == 0 {
            let p = packing(&e);
            assert_eq!(found(&p), brute_force(&p), "after {step} steps");
            collisions += usize::from(p.contacts.len() > last);
            last = p.contacts.len();
        }
    }
    // In a contact, velocities half a step behind make energy seem to swing: look where nothing touches.
    while !packing(&e).contacts.is_empty() {
        e.step().unwrap();
    }
    let p = packing(&e);
    assert!(collisions > 50, "{collisions} collisions");
    assert!(momentum(&p).norm() < 1e-12 * 5.0 * GLASS.sphere_mass(RADIUS) * 5.0);
    assert!((energy(&p) / before - 1.0).abs() < 1e-4, "{}", energy(&p) / before - 1.0);
}

/// Expected: a packing without a contact takes its time step from the Rayleigh wave, whatever friction is.
#[test]
fn grains_without_a_contact_have_a_time_step() {
    let x = [Vec3::zeros(), Vec3::x() * (3.0 * RADIUS)];
    let of = |friction: f64| {
        let mut s = setting(friction, 0.0);
        s.time_step = TimeStep::FractionOfStable(0.8);
        engine(Cell::cube(8.0 * RADIUS).unwrap(), GLASS, &[RADIUS, 0.5 * RADIUS], &x, s).time_step()
    };
    let wave = std::f64::consts::PI * 0.5 * RADIUS * (GLASS.density / GLASS.shear_modulus).sqrt() / 0.90922;
    for friction in [0.0, 0.3, f64::INFINITY] {
        let share = of(friction) / wave;
        assert!(share <= 0.8001 && share > 0.8 / 2f64.powf(0.25) * 0.999, "friction {friction}: {share}");
    }
}
