//! A grain with two contacts, whose spin the contact law does not resist.

use grainlab_core::{Packing, Vec3};
use grainlab_experiment::Simulation;
use grainlab_scene::Scene;
use grainlab_servo::ServoInput;

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
