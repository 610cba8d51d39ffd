//! Grains in motion: the deforming cell, its periodic images, and what is refused.

use grainlab_core::contact::TangentialLaw;
use grainlab_core::{Cell, Mat3, Vec3};
use grainlab_dem::{Engine, gas::GasError};
use grainlab_engine::EngineSettings;
use grainlab_testkit::engine::{
    self as testkit, GLASS, RADIUS, box_of, brute_force, engine, gas, packing, steps, taken_up,
};
use nalgebra::Rotation3;

fn setting(friction: f64, time_step: f64) -> EngineSettings {
    EngineSettings { tangential: TangentialLaw::Incremental, ..testkit::setting(friction, time_step) }
}

/// One grain that touches its own images along x, y and z: a simple cubic lattice of edge `a`.
fn cubic(overlap: f64, friction: f64) -> (Engine, f64) {
    let edge = 2.0 * RADIUS - overlap;
    let x = Vec3::new(0.3, 0.1, -0.2) * RADIUS;
    (engine(Cell::cube(edge).unwrap(), GLASS, &[RADIUS], &[x], setting(friction, 1e-9)), edge)
}

#[test]
fn the_stress_along_the_way_is_the_momentum_that_contacts_carry_dashpots_included() {
    let edge = 20.0 * RADIUS;
    // Across a face of the cell, and not.
    for x in [[0.0, 1.9998 * RADIUS], [0.02 * RADIUS, edge - 1.9798 * RADIUS]] {
        let positions = x.map(|x| Vec3::new(x, 0.3 * RADIUS, -0.2 * RADIUS));
        let damped = EngineSettings { damping: 0.5, ..setting(0.3, 1e-9) };
        let mut e = engine(Cell::cube(edge).unwrap(), GLASS, &[RADIUS; 2], &positions, damped);
        let towards = if x[1] < 0.5 * edge { 0.5 } else { -0.5 };
        e.set_velocities(&[Vec3::x() * towards, -Vec3::x() * towards]).unwrap();
        let mut stress = 0.0;
        e.run_with_stress(10, |s| stress = s.xx).unwrap();
        let elastic = e.observables().unwrap().stress.tensor.xx;
        let p = packing(&e);
        e.step().unwrap();
        // F = m dv/dt over the step that follows.
        let after = packing(&e).velocities[0];
        let force = p.material.sphere_mass(RADIUS) * (after.x - p.velocities[0].x).abs() / 1e-9;
        let expected = force * (2.0 * RADIUS - p.contacts[0].overlap) / edge.powi(3);
        assert!((stress / expected - 1.0).abs() < 1e-9, "{stress} {expected}");
        assert!(stress > 1.2 * elastic, "{stress} {elastic}");
    }
}

#[test]
fn affine_shear_loads_tangential_springs_across_periodic_images() {
    let overlap = 4e-8;
    let (mut e, edge) = cubic(overlap, f64::INFINITY);
    let rate = 1.0;
    e.set_rate(&[0.0, 0.0, 0.0, 0.0, rate, 0.0]).unwrap();
    steps(&mut e, 1000);
    let p = packing(&e);
    let strain = rate * 1e-6;
    let k_t = p.material.tangential_stiffness(RADIUS / 2.0, overlap);
    // The contact along z slips by l E_xz along x, the one along x by as much along z; y carries none.
    let slip = k_t * edge * strain;
    assert_eq!(p.contacts.len(), 3);
    for c in &p.contacts {
        let axis = c.normal.iamax();
        let expected = match axis {
            0 => Vec3::z() * slip,
            2 => Vec3::x() * slip,
            _ => Vec3::zeros(),
        } * c.normal[axis].signum();
        assert!((c.tangential_force - expected).norm() < 1e-5 * slip, "{c:?} {expected:?}");
    }
    // σ_xz = −2 C44 E_xz with C44 = k_t/(2a), and the normal forces of both contacts, turned by E_xz.
    let stress = e.observables().unwrap().stress.tensor;
    let expected = (2.0 * stress.xx - k_t / edge) * strain;
    assert!((stress.xz / expected - 1.0).abs() < 1e-5, "{} {expected}", stress.xz);
    assert!(p.spins[0].norm() < 1e-6 * rate, "symmetric shear does not turn the grain");
}

/// A gas of 40 grains being pressed together, in a turned cell.
fn pressed(turn: &Rotation3<f64>, time_step: f64) -> Engine {
    let mut gas = gas(&[RADIUS; 40], 0.3, 11);
    gas.cell = Cell::new(turn.matrix() * gas.cell.matrix()).unwrap();
    gas.positions.iter_mut().chain(&mut gas.velocities).for_each(|v| *v = turn * *v);
    let mut e = taken_up(&gas, EngineSettings { damping: 0.2, ..testkit::setting(0.3, time_step) });
    let rate = Mat3::new(-900.0, 100.0, 0.0, 100.0, -700.0, -200.0, 0.0, -200.0, -800.0);
    let rate = grainlab_core::SymTensor::symmetric_part(&(turn.matrix() * rate * turn.matrix().transpose()));
    e.set_rate(&rate.voigt()).unwrap();
    e
}

#[test]
fn the_whole_dynamics_is_objective() {
    let turn = Rotation3::from_euler_angles(0.4, -1.1, 2.3);
    let (mut plain, mut turned) = (pressed(&Rotation3::identity(), 2e-8), pressed(&turn, 2e-8));
    for e in [&mut plain, &mut turned] {
        steps(e, 3_500);
    }
    let expected =
        turn.matrix() * plain.observables().unwrap().stress.tensor.matrix() * turn.matrix().transpose();
    let found = turned.observables().unwrap();
    assert!(found.contacts >= 2, "{} contacts", found.contacts);
    let difference = (found.stress.tensor.matrix() - expected).norm() / expected.norm();
    // Round-off grows by collisions; this few of them keep it far below.
    assert!(difference < 1e-6, "{difference}");
}

#[test]
fn grains_that_do_not_fit_are_refused() {
    let error = grainlab_dem::gas::random_placement(&[RADIUS; 3000], 0.60, 1.0, 1).unwrap_err();
    assert!(matches!(error, GasError::Placement { grains: 3000, .. }), "{error}");
}

#[test]
fn grains_placed_at_random_do_not_overlap() {
    for seed in [0, 1, 2, 3, 11] {
        assert_eq!(brute_force(&gas(&[RADIUS; 40], 0.3, seed)), []);
    }
}

#[test]
fn a_grain_held_by_two_contacts_spins_for_ever_unless_spins_are_damped() {
    let spin_after = |spin_drag: f64| {
        let cell = box_of(5.0 * RADIUS, 5.0 * RADIUS, 2.0 * RADIUS - 4e-8);
        let mut s = setting(0.3, 1e-8);
        (s.spin_drag, s.damping) = (spin_drag, 0.3);
        let mut e = engine(cell, GLASS, &[RADIUS], &[Vec3::zeros()], s);
        e.set_spins(&[Vec3::z() * 1300.0]).unwrap();
        steps(&mut e, 1000);
        packing(&e).spins[0]
    };
    assert!((spin_after(0.0) - Vec3::z() * 1300.0).norm() < 1e-9, "nothing resists twist");
    let damped = spin_after(2e5);
    assert!((damped.z / (1300.0 * (1.0f64 - 2e-3).powi(1000)) - 1.0).abs() < 1e-9, "{damped:?}");
}
