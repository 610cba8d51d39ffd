//! Grains in motion: the deforming cell, its periodic images, and what is refused.

use grainlab_core::contact::TangentialLaw;
use grainlab_core::{Cell, Mat3, Material, Vec3};
use grainlab_dem::{DemError, Engine, EngineSettings, TimeStep};
use grainlab_testkit::engine::{self, RADIUS};
use grainlab_testkit::packings::touching;
use nalgebra::Rotation3;

fn setting(friction: f64, time_step: f64) -> EngineSettings {
    EngineSettings { tangential: TangentialLaw::Incremental, ..engine::setting(friction, time_step) }
}

/// One grain that touches its own images along x, y and z: a simple cubic lattice of edge `a`.
fn cubic(overlap: f64, friction: f64) -> (Engine, f64) {
    let edge = 2.0 * RADIUS - overlap;
    let mut e = Engine::new(
        Cell::cube(edge).unwrap(),
        Material::GLASS,
        vec![RADIUS],
        &[Vec3::new(0.3, 0.1, -0.2) * RADIUS],
        setting(friction, 1e-9),
    )
    .unwrap();
    e.initialise().unwrap();
    (e, edge)
}

#[test]
fn a_cubic_lattice_has_the_stress_of_its_three_contacts() {
    let overlap = 4e-8;
    let (e, edge) = cubic(overlap, 0.5);
    let s = e.observables().unwrap();
    // σ = F l/V, one contact a face.
    let expected = Material::GLASS.normal_force(RADIUS / 2.0, overlap) / (edge * edge);
    for v in &s.stress.tensor.voigt()[..3] {
        assert!((v / expected - 1.0).abs() < 1e-9, "{v} {expected}");
    }
    assert_eq!(s.contacts, 3);
    let (k_n, k_t) = (
        Material::GLASS.normal_stiffness(RADIUS / 2.0, overlap),
        Material::GLASS.tangential_stiffness(RADIUS / 2.0, overlap),
    );
    assert!((s.tangent[0] * edge / k_n - 1.0).abs() < 1e-9, "C11 = k_n/a");
    assert!((s.tangent[3] * edge / (0.5 * k_t) - 1.0).abs() < 1e-9, "C44 = k_t/(2a)");
}

#[test]
fn the_stress_along_the_way_is_the_momentum_that_contacts_carry_dashpots_included() {
    let edge = 20.0 * RADIUS;
    // Across a face of the cell, and not.
    for x in [[0.0, 1.9998 * RADIUS], [0.02 * RADIUS, edge - 1.9798 * RADIUS]] {
        let positions = x.map(|x| Vec3::new(x, 0.3 * RADIUS, -0.2 * RADIUS));
        let damped = EngineSettings { damping: 0.5, ..setting(0.3, 1e-9) };
        let cell = Cell::cube(edge).unwrap();
        let mut e = Engine::new(cell, Material::GLASS, vec![RADIUS; 2], &positions, damped).unwrap();
        let towards = if x[1] < 0.5 * edge { 0.5 } else { -0.5 };
        e.set_velocities(&[Vec3::x() * towards, -Vec3::x() * towards]).unwrap();
        let mut stress = 0.0;
        e.run_with_stress(10, |s| stress = s.xx).unwrap();
        let elastic = e.observables().unwrap().stress.tensor.xx;
        let p = e.packing(Mat3::identity());
        e.step().unwrap();
        // F = m dv/dt over the step that follows.
        let after = e.packing(Mat3::identity()).velocities[0];
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
    let (rate, steps) = (1.0, 1000u32);
    e.set_rate(&[0.0, 0.0, 0.0, 0.0, rate, 0.0]).unwrap();
    for _ in 0..steps {
        e.step().unwrap();
    }
    let p = e.packing(Mat3::identity());
    let strain = rate * 1e-9 * f64::from(steps);
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

#[test]
fn two_grains_that_touch_only_through_an_image_feel_the_affine_velocity() {
    // Heavy grains stay where they are: only the affine motion shears the contact.
    let heavy = Material { density: 1e20, ..Material::GLASS };
    let overlap = 4e-8;
    let height = 8.0 * RADIUS;
    let top = Vec3::new(0.0, 0.0, height - 2.0 * RADIUS + overlap);
    let positions = [Vec3::zeros(), top];
    let mut e =
        Engine::new(Cell::cube(height).unwrap(), heavy, vec![RADIUS; 2], &positions, setting(0.5, 1e-9))
            .unwrap();
    e.initialise().unwrap();
    e.set_rate(&[0.0, 0.0, 0.0, 0.0, 1.0, 0.0]).unwrap();
    for _ in 0..1000 {
        e.step().unwrap();
    }
    let p = e.packing(Mat3::identity());
    assert_eq!((p.contacts.len(), p.contacts[0].image), (1, [0, 0, -1]));
    let slip = (2.0 * RADIUS - overlap) * 1e-6;
    let expected = -Vec3::x() * p.material.tangential_stiffness(RADIUS / 2.0, overlap) * slip;
    assert!((p.contacts[0].tangential_force - expected).norm() < 1e-4 * expected.norm());
}

/// A gas of 40 grains being pressed together, in a turned cell.
fn pressed(turn: &Rotation3<f64>, time_step: f64) -> Engine {
    let gas = grainlab_dem::gas::random_sequential_addition(40, 2.0 * RADIUS, 0.35, 0.3, 11).unwrap();
    let cell = Cell::new(turn.matrix() * gas.cell.matrix());
    let rotate = |v: &[Vec3]| v.iter().map(|x| turn * x).collect::<Vec<_>>();
    let mut s = setting(0.3, time_step);
    s.damping = 0.2;
    s.tangential = TangentialLaw::Rescaled;
    let mut e =
        Engine::new(cell.unwrap(), Material::GLASS, vec![RADIUS; 40], &rotate(&gas.positions), s).unwrap();
    e.set_velocities(&rotate(&gas.velocities)).unwrap();
    e.initialise().unwrap();
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
        (0..3_500).for_each(|_| e.step().map(|_| ()).unwrap());
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
    let error = grainlab_dem::gas::random_sequential_addition(3000, 2.0 * RADIUS, 0.60, 1.0, 1).unwrap_err();
    assert!(matches!(error, DemError::Placement { grains: 3000, .. }), "{error}");
}

#[test]
fn grains_placed_at_random_do_not_overlap() {
    for seed in [0, 1, 2, 3, 11] {
        let gas = grainlab_dem::gas::random_sequential_addition(40, 2.0 * RADIUS, 0.35, 0.3, seed).unwrap();
        assert_eq!(touching(&gas.cell, &gas.positions, &[RADIUS; 40]), []);
    }
}

#[test]
fn a_grain_held_by_two_contacts_spins_for_ever_unless_spins_are_damped() {
    let spin_after = |spin_drag: f64| {
        let height = 2.0 * RADIUS - 4e-8;
        let cell = Cell::new(Mat3::from_diagonal(&Vec3::new(5.0 * RADIUS, 5.0 * RADIUS, height))).unwrap();
        let mut s = setting(0.3, 1e-8);
        (s.spin_drag, s.damping) = (spin_drag, 0.3);
        let mut e = Engine::new(cell, Material::GLASS, vec![RADIUS], &[Vec3::zeros()], s).unwrap();
        e.set_spins(&[Vec3::z() * 1300.0]).unwrap();
        e.initialise().unwrap();
        (0..1000).for_each(|_| e.step().map(|_| ()).unwrap());
        e.packing(Mat3::identity()).spins[0]
    };
    assert!((spin_after(0.0) - Vec3::z() * 1300.0).norm() < 1e-9, "nothing resists twist");
    let damped = spin_after(2e5);
    assert!((damped.z / (1300.0 * (1.0f64 - 2e-3).powi(1000)) - 1.0).abs() < 1e-9, "{damped:?}");
}

/// Two grains in a row that touch each other directly and across the boundary: ω² = 4 k_n/m.
fn chain(time_step: TimeStep, damping: f64) -> (Engine, f64) {
    // Deep enough for the contacts, and not the Rayleigh time, to set the step.
    let overlap = 1e-5;
    let height = 2.0 * (2.0 * RADIUS - overlap);
    let cell = Cell::new(Mat3::from_diagonal(&Vec3::new(5.0 * RADIUS, 5.0 * RADIUS, height))).unwrap();
    let mut s = setting(0.0, 0.0);
    (s.time_step, s.damping) = (time_step, damping);
    let positions = [Vec3::zeros(), Vec3::z() * (0.5 * height)];
    let mut e = Engine::new(cell, Material::GLASS, vec![RADIUS; 2], &positions, s).unwrap();
    // An amplitude far below the overlap: linear to 1e-5.
    e.set_velocities(&[Vec3::z() * 1e-7, -Vec3::z() * 1e-7]).unwrap();
    e.initialise().unwrap();
    let k_n = Material::GLASS.normal_stiffness(RADIUS / 2.0, overlap);
    let critical = (Material::GLASS.sphere_mass(RADIUS) / k_n).sqrt();
    (e, critical)
}

#[test]
fn the_stability_bound_is_the_critical_time_step_of_a_chain() {
    let (e, critical) = chain(TimeStep::FractionOfStable(1.0), 0.0);
    // Rounded down to the grid of 2^(1/16).
    let chosen = e.time_step();
    assert!(chosen <= critical && chosen > critical / 2f64.powf(1.0 / 16.0) * 0.999, "{chosen} {critical}");
    // With damping the bound is shorter, and what it promises holds.
    for damping in [0.3, 0.6, 1.0] {
        let (mut e, _) = chain(TimeStep::FractionOfStable(1.0), damping);
        assert!(e.time_step() < chosen);
        (0..2000).for_each(|_| e.step().map(|_| ()).unwrap());
        assert!(e.speed() < 1e-9, "damping {damping}: {}", e.speed());
    }
}
