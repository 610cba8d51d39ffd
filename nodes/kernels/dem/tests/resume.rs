//! A packing and its run state are a checkpoint: a run taken up from them goes on bit for bit.

use dem::Simulation;
use scene::Scene;

const SCENE: &str = r#"
name = "tiny"
seed = 5
[grains]
count = 32
diameter = 2e-4
[[phase]]
kind = "gas"
rate = -60.0
control_period = 100
until = { solid_fraction = 0.55 }
[[phase]]
kind = "relax"
friction = 0.0
drag = 1e4
reference = true
control_period = 50
until = { elapsed = 2e-4 }
[[phase]]
kind = "strain"
friction = 0.1
rate = [-30.0, -30.0, -40.0, 0.0, 3.0, 0.0]
until = { pressure_above = 2e4 }
publish = true
[[phase]]
kind = "servo"
friction = 0.1
drag = 5e3
response_time = 3e-6
control = { xx = { stress = 5e4 }, yy = { stress = 5e4 }, zz = { stress = 5e4 }, xy = { stress = 0.0 } }
control_period = 7
until = { on_target = 0.1, unbalanced = 3e-2, hold = 1e-5 }
[[phase]]
kind = "relax"
friction = inf
drag = 5e4
spin_drag = 5e4
until = { elapsed = 5e-5 }
publish = true
"#;

fn advance(run: &mut Simulation) -> bool {
    let Some(r) = run.request() else { return false };
    let request = servo::Request {
        stress: r.snapshot.stress.tensor,
        controls: r.controls,
        rate: r.rate,
        rate_limit: r.rate_limit,
        law: r.law,
        tangent: r.snapshot.tangent,
        control_interval: r.control_interval,
    };
    run.answer(&servo::answer(&request).unwrap().rate).unwrap();
    true
}

fn start() -> Simulation {
    Simulation::new(Scene::parse(SCENE).unwrap()).unwrap()
}

#[test]
fn a_run_resumed_at_any_request_equals_the_run_that_went_on() {
    // The phase of every request, to save in the middle of each phase and where each begins.
    let (mut run, mut phases) = (start(), Vec::new());
    while run.request().is_some() {
        phases.push(run.path().phase);
        advance(&mut run);
    }
    let end = run.packing();
    assert!(end.contacts.len() > 50, "{} contacts", end.contacts.len());
    let mut saves = Vec::new();
    for phase in 0..5 {
        let first = phases.iter().position(|p| *p == phase).unwrap();
        let length = phases.iter().filter(|p| **p == phase).count();
        saves.extend([first, first + length / 2]);
    }
    let mut first = start();
    for (at, phase) in phases.iter().enumerate() {
        if saves.contains(&at) {
            let saved = (first.packing(), first.run_state());
            let mut second = Simulation::resume(Scene::parse(SCENE).unwrap(), &saved.0, &saved.1).unwrap();
            while advance(&mut second) {}
            // Every number of both states, contact history and run state included.
            assert_eq!(second.packing(), end, "resumed at request {at}, in phase {phase}");
            assert_eq!(second.run_state(), run.run_state());
        }
        advance(&mut first);
    }
}

#[test]
fn observing_changes_nothing() {
    let (mut plain, mut watched) = (start(), start());
    while advance(&mut plain) {
        let _ = (watched.packing(), watched.run_state(), watched.engine().snapshot());
        assert!(advance(&mut watched));
    }
    assert_eq!(plain.packing(), watched.packing());
}

#[test]
fn a_foreign_or_broken_run_state_is_refused() {
    let run = start();
    let (packing, state) = (run.packing(), run.run_state());
    let resume =
        |scene: &str, state: &[u8]| Simulation::resume(Scene::parse(scene).unwrap(), &packing, state);
    assert!(resume(SCENE, &state).is_ok());
    assert!(
        resume(&SCENE.replace("seed = 5", "seed = 6"), &state)
            .unwrap_err()
            .to_string()
            .contains("another scene")
    );
    assert!(resume(SCENE, &[]).unwrap_err().to_string().contains("no run state"));
    assert!(resume(SCENE, &state[..40]).unwrap_err().to_string().contains("bytes"));
    let mut old = state.clone();
    old[0] = 99;
    assert!(resume(SCENE, &old).unwrap_err().to_string().contains("version 99"));
}
