//! Engines behind the trait: ours and a toy pass the suite of engines, and a scene runs with either.

mod toy;

use grainlab_dem::Dem;
use grainlab_engine::EngineFactory;
use grainlab_experiment::Simulation;
use grainlab_scene::Scene;
use grainlab_verify::conformance::CLAIMS;
use std::sync::Arc;
use toy::{Fault, Toys};

/// Claims that do not hold.
fn broken(factory: &dyn EngineFactory) -> Vec<String> {
    CLAIMS.iter().filter_map(|claim| claim.check(factory).err()).collect()
}

#[test]
fn our_engine_and_a_toy_pass_the_suite_of_engines() {
    assert_eq!(broken(&Dem::default()), Vec::<String>::new());
    assert_eq!(broken(&Toys::default()), Vec::<String>::new());
}

#[test]
fn an_engine_with_a_fault_breaks_the_claim_about_it() {
    for (fault, claim) in [
        (Fault::Slow, "steps_and_time_count_from_those_of_the_packing"),
        (Fault::Attraction, "grains_that_are_pressed_together_have_positive_pressure"),
        (Fault::Forgetful, "an_engine_that_starts_from_a_packing_continues_the_run"),
        (Fault::Careless, "invalid_input_is_refused_and_changes_nothing"),
        (Fault::NoDrag, "drag_slows_grains_down"),
        (Fault::Heavy, "a_grain_is_accelerated_along_the_net_force_on_it"),
        (Fault::Rigid, "grains_follow_the_strain_of_the_cell"),
        (Fault::Hasty, "grains_follow_the_strain_of_the_cell"),
        (Fault::Wishful, "friction_and_damping_act_or_are_refused"),
        (Fault::Skewed, "the_observables_are_those_of_the_packing"),
    ] {
        let broken = broken(&Toys(fault));
        assert!(broken.iter().any(|b| b.starts_with(claim)), "{fault:?}: {broken:?}");
    }
}

const SCENE: &str = r#"
name = "columns"
seed = 3
[grains]
count = 40
diameter = 2e-4
[[phase]]
kind = "gas"
rate = -60.0
until = { solid_fraction = 0.55 }
[[phase]]
kind = "strain"
friction = 0.0
damping = 0.0
drag = 2e5
rate = [-100.0, -100.0, -100.0, 0.0, 0.0, 0.0]
until = { solid_fraction = 0.68 }
publish = true
"#;

/// Expected: the gas is ours, to the bit; the engines differ in their time steps, and little in the stress of one strain.
#[test]
fn a_scene_runs_with_another_engine_from_the_end_of_the_gas() {
    let run = |factory: Arc<dyn EngineFactory>| {
        let mut run = Simulation::with_engine(Scene::parse(SCENE).unwrap(), factory, None).unwrap();
        let mut gas = None;
        while let Some(request) = run.request() {
            if request.phase == 2 && gas.is_none() {
                gas = Some(run.packing().unwrap().positions);
            }
            run.exchange().unwrap();
        }
        let pressure = run.engine().observables().unwrap().stress.tensor.mean();
        (gas.unwrap(), pressure, run.packing().unwrap())
    };
    let (ours, theirs) = (run(Arc::new(Dem::default())), run(Arc::new(Toys::default())));
    let sorted = |mut positions: Vec<grainlab_core::Vec3>| {
        positions.sort_by(|a, b| a.x.total_cmp(&b.x));
        positions
    };
    assert_eq!(sorted(ours.0), sorted(theirs.0));
    assert!(ours.1 > 1e4 && (theirs.1 / ours.1 - 1.0).abs() < 0.05, "{} {}", ours.1, theirs.1);
    assert!(theirs.2.validated().is_ok());
}

/// Expected: a setting that an engine does not have ends the run with its name.
#[test]
fn a_setting_that_an_engine_does_not_have_is_refused_by_name() {
    let scene = Scene::parse(&SCENE.replace("friction = 0.0", "friction = 0.3")).unwrap();
    let mut run = Simulation::with_engine(scene, Arc::new(Toys::default()), None).unwrap();
    let error = loop {
        if let Err(error) = run.exchange() {
            break error;
        }
    };
    assert_eq!(error.to_string(), "toy: friction, damping and thermostats are not supported");
}
