//! Packings that LAMMPS and our engine step alike.

use super::lammps;
use grainlab_core::stress::stress;
use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_dem::Dem;
use grainlab_engine::{Compute, EngineFactory, EngineSettings, TimeStep};
use grainlab_experiment::Simulation;
use grainlab_scene::Scene;
use std::sync::LazyLock;

/// 100 grains without friction, at 50 kPa.
pub(super) static PRESSED: LazyLock<Packing> = LazyLock::new(|| {
    let text = r#"
name = "pressed"
seed = 5
[grains]
count = 100
diameter = 2e-4
[[phase]]
kind = "gas"
method = "event_driven"
rate = -30.0
until = { solid_fraction = 0.6 }
[[phase]]
kind = "servo"
friction = 0.0
damping = 0.3
drag = 1.5e3
control = { xx = { stress = 50e3 }, yy = { stress = 50e3 }, zz = { stress = 50e3 }, yz = { stress = 0 }, xz = { stress = 0 }, xy = { stress = 0 } }
rate_limit = 30.0
leak = 0.0
control_period = 20
until = { on_target = 1e-3, unbalanced = 1e-5, hold = 1e-4 }
"#;
    let mut run = Simulation::new(Scene::parse(text).unwrap()).unwrap();
    while run.exchange().unwrap().is_some() {}
    run.packing().unwrap()
});

/// The packing, with velocities of about 0.3 mm/s.
fn shaken(time_step: f64) -> Packing {
    let mut packing = Packing { time_step, ..PRESSED.clone() };
    for (n, v) in packing.velocities.iter_mut().enumerate() {
        *v = 1e-4 * Vec3::new((n % 3) as f64 - 1.0, (n % 5) as f64 - 2.0, (n % 7) as f64 - 3.0);
    }
    packing
}

fn settings(friction: f64, damping: f64, time_step: f64) -> EngineSettings {
    let time_step = TimeStep::Fixed(time_step);
    EngineSettings { friction, damping, skin: 1e-5, time_step, ..EngineSettings::default() }
}

/// The packing after several exchanges at a strain rate (1/s), with the stress that the engine observed.
fn stepped(
    factory: &dyn EngineFactory,
    packing: &Packing,
    settings: &EngineSettings,
    rate: [f64; 6],
    exchanges: &[u32],
) -> (Packing, Mat3) {
    let mut engine = factory.start(packing, settings, &[0.0; 6], &Compute::default()).unwrap();
    engine.begin_phase(settings).unwrap();
    engine.set_rate(&rate).unwrap();
    for steps in exchanges {
        engine.run(*steps).unwrap();
    }
    let stress = engine.observables().unwrap().stress.tensor.matrix();
    (engine.packing(Mat3::identity()).unwrap(), stress)
}

fn difference(a: &Mat3, b: &Mat3) -> f64 {
    (a - b).norm() / a.norm()
}

#[test]
fn in_a_fixed_cell_both_engines_have_the_same_stress_after_1000_steps() {
    let Some(lammps) = lammps(1) else { return };
    // With friction and without dashpots grains do not come to rest, and the levers of spins differ by the overlap: 1e-6.
    for (friction, damping, bound) in [(0.0, 0.0, 1e-9), (0.3, 0.3, 1e-9), (0.3, 0.0, 2e-6)] {
        let step = |factory: &dyn EngineFactory| {
            stepped(factory, &shaken(4e-8), &settings(friction, damping, 4e-8), [0.0; 6], &[1000])
        };
        let ((_, ours), (packing, theirs)) = (step(&Dem::default()), step(&lammps));
        let off = difference(&ours, &theirs);
        eprintln!("friction {friction}, damping {damping}: {off:.1e}");
        assert!(off < bound, "{off:e}");
        assert!(packing.check().is_ok() && packing.check_consistency().is_ok());
        assert_eq!(friction > 0.0, packing.contacts.iter().any(|c| c.tangential_force != Vec3::zeros()));
    }
}

#[test]
fn in_a_deforming_cell_the_difference_falls_in_proportion_to_the_time_step() {
    let Some(lammps) = lammps(1) else { return };
    let off = [500, 1000, 2000].map(|count: u32| {
        let dt = 2e-5 / f64::from(count);
        let step = |factory: &dyn EngineFactory| {
            let rate = [-4.0, 2.0, -3.0, 1.0, -0.5, 2.0];
            stepped(factory, &shaken(dt), &settings(0.3, 0.0, dt), rate, &[count / 10; 10])
        };
        let ((_, ours), (packing, theirs)) = (step(&Dem::default()), step(&lammps));
        // The stress that LAMMPS sums is that of the packing read from it.
        assert!(difference(&stress(&packing).tensor.matrix(), &theirs) < 1e-10);
        difference(&ours, &theirs)
    });
    eprintln!("{off:?}");
    for pair in off.windows(2) {
        assert!((1.8..2.2).contains(&(pair[0] / pair[1])), "{off:?}");
    }
    assert!(off[2] < 1e-5, "{off:?}");
}

/// Expected: as many contacts at the limit of their elastic normal force, although LAMMPS limits forces with their dashpots.
#[test]
fn contacts_at_the_coulomb_limit_are_as_many_as_of_our_engine() {
    let Some(lammps) = lammps(1) else { return };
    let dt = 4e-8;
    let start = Packing { time_step: dt, ..PRESSED.clone() };
    for rate in [[-40.0, 20.0, 20.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 40.0, 0.0]] {
        let sliding = [&Dem::default() as &dyn EngineFactory, &lammps].map(|factory| {
            let (packing, _) = stepped(factory, &start, &settings(0.3, 0.3, dt), rate, &[50; 60]);
            packing.sliding_fraction()
        });
        eprintln!("{rate:?}: {sliding:?}");
        assert!(sliding[0] > 0.2 && (sliding[0] - sliding[1]).abs() < 0.03, "{rate:?}: {sliding:?}");
    }
}

/// Expected: a packing and a state that are saved between exchanges change nothing, also where contacts slide, and
/// the packing has the elastic forces.
#[test]
fn a_run_is_the_same_with_and_without_saved_states() {
    let Some(lammps) = lammps(1) else { return };
    let settings = settings(0.3, 0.3, 4e-8);
    let (start, rate) = (shaken(4e-8), [-30.0, 15.0, 15.0, 0.0, 40.0, 0.0]);
    let run = |saves: bool| {
        let mut engine = lammps.start(&start, &settings, &[0.0; 6], &Compute::default()).unwrap();
        engine.begin_phase(&settings).unwrap();
        engine.set_rate(&rate).unwrap();
        for _ in 0..30 {
            engine.run(20).unwrap();
            if saves {
                engine.packing(Mat3::identity()).unwrap();
                engine.own_state().unwrap();
            }
        }
        (engine.observables().unwrap().stress.tensor.matrix(), engine.packing(Mat3::identity()).unwrap())
    };
    let ((saved, packing), (plain, _)) = (run(true), run(false));
    assert!(difference(&plain, &saved) < 1e-9, "{:e}", difference(&plain, &saved));
    let slides = |c: &&grainlab_core::Contact| c.tangential_force.norm() > 0.28 * c.normal_force;
    let sliding = packing.contacts.iter().filter(slides).count();
    assert!(sliding >= 10, "{sliding}");
    assert!(packing.contacts.iter().all(|c| {
        let elastic = packing.material.normal_force(packing.effective_radius(c), c.overlap);
        (c.normal_force / elastic - 1.0).abs() < 1e-9
    }));
}

/// Expected: one dashpot at any fraction of critical damping, while the grains approach and while they separate.
#[test]
fn two_spheres_rebound_with_the_same_speed() {
    let Some(lammps) = lammps(1) else { return };
    let (radius, dt) = (1e-4, 2e-9);
    for damping in [0.05, 0.3, 0.8] {
        let pair = Packing {
            time_step: dt,
            ids: vec![3, 8],
            velocities: vec![Vec3::new(0.05, 0.0, 0.0), Vec3::new(-0.05, 0.0, 0.0)],
            ..Packing::at_rest(
                Cell::cube(1e-3).unwrap(),
                vec![radius, 0.7 * radius],
                vec![Vec3::new(4e-4, 5e-4, 5e-4), Vec3::new(4e-4 + 1.7001 * radius, 5e-4, 5e-4)],
            )
        };
        let rebound = |factory: &dyn EngineFactory| {
            let (packing, _) =
                stepped(factory, &pair, &settings(0.0, damping, dt), [0.0; 6], &[200, 300, 500, 1000]);
            let of = |id: u32| packing.velocities[packing.ids.iter().position(|i| *i == id).unwrap()].x;
            of(8) - of(3)
        };
        let (ours, theirs) = (rebound(&Dem::default()), rebound(&lammps));
        eprintln!("damping {damping}: restitution {:.6}, off {:.1e}", ours / 0.1, theirs / ours - 1.0);
        assert!(ours > 1e-3 && (theirs / ours - 1.0).abs() < 1e-5, "{damping}: {ours} {theirs}");
    }
}
