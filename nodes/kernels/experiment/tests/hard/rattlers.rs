//! A grain with two contacts, whose spin the contact law does not resist.

use grainlab_core::{Mat3, Packing, Vec3};
use grainlab_dem::{Engine, EngineSettings};
use grainlab_experiment::Simulation;
use grainlab_scene::Scene;
use grainlab_servo::ServoInput;
use grainlab_testkit::engine::*;

/// A zigzag column of two grains and their images, each with two contacts inclined by `lean` (rad) to either
/// side: at rest under friction, its force along the line through the contact points.
fn column(radii: [f64; 2], lean: f64, calm: EngineSettings) -> Engine {
    let length = radii[0] + radii[1] - 4e-4 * radii[1];
    let top = Vec3::new(lean.sin(), 0.0, lean.cos()) * length;
    let cell = box_of(6.0 * RADIUS, 6.0 * RADIUS, 2.0 * top.z);
    let mut e = engine(cell, GLASS, &radii, &[Vec3::zeros(), top], calm);
    steps(&mut e, 40_000);
    assert!(e.observables().unwrap().unbalanced < 1e-9, "{:?}", e.observables());
    e
}

fn calm() -> EngineSettings {
    let mut s = setting(0.5, 5e-9);
    (s.damping, s.drag, s.spin_drag) = (0.3, 5e5, 5e5);
    s
}

/// Turns the column about its axis through the centre of mass, spins included, at `rate` (rad/s).
fn turn(e: &mut Engine, rate: f64) {
    let p = packing(e);
    let m = p.radii.iter().map(|r| GLASS.sphere_mass(*r)).collect::<Vec<_>>();
    let axis = (p.positions[0] * m[0] + p.positions[1] * m[1]) / (m[0] + m[1]);
    let spin = Vec3::z() * rate;
    e.set_velocities(&p.positions.iter().map(|x| spin.cross(&(x - axis))).collect::<Vec<_>>()).unwrap();
    e.set_spins(&[spin; 2]).unwrap();
}

/// Expected: a column that rotates as a whole does not slip, so that contact damping alone leaves it rotating
/// with an unbalanced force of m Ω² e/F. A drag on spins brings it to rest and to balance.
#[test]
fn two_contact_grains_hold_the_unbalanced_force_up_unless_spins_are_damped() {
    let turned = |spin_drag: f64| {
        let mut e = column([RADIUS; 2], 0.1, calm());
        turn(&mut e, 1300.0);
        let mut s = calm();
        (s.drag, s.spin_drag) = (0.0, spin_drag);
        e.set_settings(s).unwrap();
        steps(&mut e, 1_000_000);
        e
    };
    let free = turned(0.0);
    let p = packing(&free);
    assert!(p.spins.iter().all(|w| (w.z / 1300.0 - 1.0).abs() < 0.01), "{:?}", p.spins);
    let force = p.contacts[0].normal_force.hypot(p.contacts[0].tangential_force.norm());
    let arm = RADIUS * 0.1f64.sin();
    let expected = GLASS.sphere_mass(RADIUS) * 1300.0 * 1300.0 * arm / force;
    let held = free.observables().unwrap().unbalanced;
    assert!((held / expected - 1.0).abs() < 0.1, "{held} {expected}");
    let damped = turned(2e4);
    let p = packing(&damped);
    assert!(p.spins.iter().all(|w| w.norm() < 1e-3), "{:?}", p.spins);
    assert!(
        damped.observables().unwrap().unbalanced < 1e-3 * expected,
        "{}",
        damped.observables().unwrap().unbalanced
    );
}

/// Expected: during a rotation of a column with inclined contacts, sizes 1 to 5, the tangential forces rotate
/// with it and keep their magnitude, and the stress in the rotating frame is constant.
#[test]
fn a_turning_column_of_unequal_grains_carries_its_tangential_forces_along() {
    let mut s = calm();
    s.friction = f64::INFINITY;
    let mut e = column([RADIUS, 0.2 * RADIUS], 0.3, s);
    let before = packing(&e);
    let rate = 200.0;
    turn(&mut e, rate);
    (s.drag, s.spin_drag, s.damping) = (0.0, 0.0, 0.0);
    e.set_settings(s).unwrap();
    let quarter = (0.25 * std::f64::consts::TAU / rate / 5e-9).round() as usize;
    for quarters in 1..=4 {
        steps(&mut e, quarter);
        let p = packing(&e);
        let angle = rate * e.time_step() * (quarters * quarter) as f64;
        let turned = nalgebra::Rotation3::from_axis_angle(&Vec3::z_axis(), angle);
        assert_eq!(p.contacts.len(), 2);
        for (c, was) in p.contacts.iter().zip(&before.contacts) {
            let (t, expected) = (c.tangential_force, turned * was.tangential_force);
            assert!((t - expected).norm() < 1e-2 * expected.norm(), "after {quarters}: {t:?} {expected:?}");
            assert!(t.dot(&c.normal).abs() < 1e-6 * t.norm());
        }
        let stress = e.observables().unwrap().stress.tensor.matrix();
        let was = grainlab_core::stress::stress(&before).tensor.matrix();
        let expected: Mat3 = turned.matrix() * was * turned.matrix().transpose();
        assert!((stress - expected).norm() < 1e-2 * was.norm(), "{stress} {expected}");
    }
}

/// A frictional packing at rest whose scene then relaxes it, and one of its grains with two contacts.
fn rested(spin_drag: &str) -> (Simulation, usize) {
    let text = |seed: u64| {
        format!(
            r#"
name = "rested"
seed = {seed}
[grains]
count = 48
diameter = 2e-4
[[phase]]
kind = "gas"
rate = -40.0
until = {{ solid_fraction = 0.58 }}
[[phase]]
kind = "servo"
friction = 0.5
drag = 2e4
spin_drag = 2e4
control = {{ xx = {{ stress = 50e3 }}, yy = {{ stress = 50e3 }}, zz = {{ stress = 50e3 }} }}
until = {{ on_target = 1e-3, unbalanced = 1e-8, hold = 1e-5 }}
[[phase]]
kind = "relax"
friction = 0.5
{spin_drag}
until = {{ elapsed = 4e-3 }}
"#
        )
    };
    let run = |seed: u64| {
        let mut run = Simulation::new(Scene::parse(&text(seed)).unwrap()).unwrap();
        while let Some(r) = run.request().filter(|r| r.phase < 3) {
            let rate_limit = if r.phase == 1 { 40.0 } else { 4.0 };
            let input = ServoInput { rate_limit, ..r.input };
            run.advance(&grainlab_servo::control(&input).unwrap().rate).unwrap();
        }
        let p = run.packing().unwrap();
        let contacts =
            |g: usize| p.contacts.iter().filter(|c| c.i as usize == g || c.j as usize == g).count();
        let held = (0..p.grains()).find(|g| contacts(*g) == 2);
        held.map(|g| (run, g))
    };
    (1..20).find_map(run).unwrap()
}

/// The packing with grain `g` rotating at `rate` (rad/s) about the line through its two contact points, where
/// it does not slip.
fn turning(mut p: Packing, g: usize, rate: f64) -> Packing {
    let points: Vec<Vec3> = (0..p.contacts.len())
        .filter_map(|k| {
            let c = &p.contacts[k];
            let lever = p.radii[g] - 0.5 * c.overlap;
            match (c.i as usize == g, c.j as usize == g) {
                (true, _) => Some(c.normal * lever),
                (_, true) => Some(-c.normal * lever),
                _ => None,
            }
        })
        .collect();
    let spin = (points[1] - points[0]).normalize() * rate;
    p.spins[g] = spin;
    p.velocities[g] = -spin.cross(&points[0]);
    p
}

/// Expected: a grain that rolls on two contacts comes to rest while the packing relaxes, with the default
/// settings. Without a drag on spins the grain keeps its spin.
#[test]
fn a_two_contact_grain_settles_in_a_relaxing_packing_without_any_setting() {
    let left = |spin_drag: &str| {
        let (run, g) = rested(spin_drag);
        // Too slow to reach a third contact.
        let p = turning(run.packing().unwrap(), g, 0.1);
        let mut run = Simulation::resume(run.scene().clone(), &p, &run.run_state().unwrap()).unwrap();
        while run.request().is_some() {
            run.advance(&[0.0; 6]).unwrap();
        }
        assert!(run.engine().observables().unwrap().unbalanced < 1e-8);
        run.packing().unwrap().spins[g].norm() / 0.1
    };
    let (settled, free) = (left(""), left("spin_drag = 0.0"));
    assert!(settled < 1e-6 && free > 0.99, "{settled} {free} of the spin are left");
}
