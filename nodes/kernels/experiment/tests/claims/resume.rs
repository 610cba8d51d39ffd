//! A packing and its run state are a checkpoint: a run resumed from them continues bit for bit.

use crate::{begin, path};
use grainlab_dem::gas::GasError;
use grainlab_engine::Compute;
use grainlab_experiment::{ExperimentError, Simulation};
use grainlab_scene::{Condition, Measure, Scene};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, LazyLock};

/// The path with a gas of soft grains and a phase of stress control.
static SCENE: LazyLock<String> = LazyLock::new(|| {
    path(
        "method = \"soft\"\nrate = -60.0\ncontrol_period = 100",
        r#"publish = true
[[phase]]
kind = "servo"
friction = 0.1
drag = 5e3
response_time = 3e-6
control = { xx = { stress = 5e4 }, yy = { stress = 5e4 }, zz = { stress = 5e4 }, xy = { stress = 0.0 } }
control_period = 7
until = { on_target = 0.1, unbalanced = 3e-2, hold = 1e-5 }
"#,
    )
});

fn advance(run: &mut Simulation) -> bool {
    run.exchange().unwrap().is_some()
}

fn speed(run: &Simulation) -> f64 {
    run.engine().observables().unwrap().speed
}

fn start() -> Simulation {
    begin(&SCENE)
}

/// Scene with the same path from an event-driven gas.
fn event_driven() -> String {
    SCENE.replace("method = \"soft\"\nrate = -60.0\ncontrol_period = 100", "rate = -60.0\ncontrol_period = 3")
}

/// In the middle of each phase, and where each begins.
#[test]
fn a_run_resumed_at_any_request_equals_the_run_that_went_on() {
    // The phase of every request.
    let (mut run, mut phases) = (start(), Vec::new());
    while run.request().is_some() {
        phases.push(run.path().phase);
        advance(&mut run);
    }
    let end = run.packing().unwrap();
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
            let saved = (first.packing().unwrap(), first.run_state().unwrap());
            let mut second = Simulation::resume(Scene::parse(&SCENE).unwrap(), &saved.0, &saved.1).unwrap();
            while advance(&mut second) {}
            // Every number of both states, contact history and run state included.
            assert_eq!(second.packing().unwrap(), end, "resumed at request {at}, in phase {phase}");
            assert_eq!(second.run_state().unwrap(), run.run_state().unwrap());
        }
        advance(&mut first);
    }
}

#[test]
fn an_event_driven_gas_resumed_at_every_request_equals_the_run_that_went_on() {
    let scene = event_driven();
    let (mut run, mut saves) = (begin(&scene), Vec::new());
    while run.path().phase < 2 {
        if run.path().phase == 0 {
            saves.push((run.packing().unwrap(), run.run_state().unwrap(), run.request()));
        }
        advance(&mut run);
    }
    let end = run.packing().unwrap();
    assert!(saves.len() > 20, "{} exchanges", saves.len());
    for (packing, state, request) in saves {
        let mut second = Simulation::resume(Scene::parse(&scene).unwrap(), &packing, &state).unwrap();
        assert_eq!(second.request(), request);
        while second.path().phase < 2 {
            advance(&mut second);
        }
        assert_eq!(second.packing().unwrap(), end, "resumed at step {}", packing.step);
        assert_eq!(second.run_state().unwrap(), run.run_state().unwrap());
    }
}

#[test]
fn a_run_that_is_stopped_saves_a_state_that_goes_on_to_the_same_bytes() {
    for scene in [SCENE.clone(), event_driven()] {
        let mut run = begin(&scene);
        while advance(&mut run) {}
        let (end, state) = (run.packing().unwrap(), run.run_state().unwrap());
        let (mut run, mut advances, mut stop_at, mut stops) = (begin(&scene), 0u64, 3, [0; 5]);
        while let Some(request) = run.request() {
            let rate = grainlab_servo::control(&request.input).unwrap().rate;
            let flag = Arc::new(AtomicBool::new(advances == stop_at));
            run.set_compute(Compute::default().stopping_on(flag));
            advances += 1;
            let Err(error) = run.advance(&rate) else { continue };
            assert!(error.is_stopped(), "{error}");
            // The state returned to may be some requests back: more of them each time, so that the run comes to its end.
            stop_at = advances * 9 / 8 + 20;
            stops[request.phase as usize - 1] += 1;
            let back = run.request().unwrap();
            let at_once = request.phase == 1 && scene != *SCENE;
            assert!(if at_once { back == request } else { back.step <= request.step }, "{back:?}");
            let saved = (run.packing().unwrap(), run.run_state().unwrap());
            run = Simulation::resume(Scene::parse(&scene).unwrap(), &saved.0, &saved.1).unwrap();
        }
        assert!(
            stops.iter().filter(|n| **n > 0).count() > 2,
            "stopped {stops:?} times in {advances} advances"
        );
        assert_eq!(run.packing().unwrap(), end, "stopped {stops:?} times");
        assert_eq!(run.run_state().unwrap(), state);
    }
}

#[test]
fn an_event_driven_phase_keeps_its_clock_and_meets_its_conditions() {
    let mut run = begin(&event_driven());
    while run.path().phase == 0 {
        let asked = run.request().unwrap();
        advance(&mut run);
        let (time, steps) = (run.engine().time(), run.engine().steps());
        assert_eq!(steps, asked.step + 3);
        let expected = asked.time + asked.input.control_interval;
        assert!((time / expected - 1.0).abs() < 1e-14 && time > asked.time, "{time} {expected}");
        assert!(speed(&run) <= 1.0 + 1e-12);
        let packing = run.packing().unwrap().validated().unwrap();
        let deepest = packing.contacts.iter().map(|c| c.overlap).fold(0.0, f64::max);
        assert!(deepest < 1e-12 * 2e-4, "{deepest:e}");
    }
    let reached = run.packing().unwrap().solid_fraction();
    assert!((0.55..0.55 * (1.0 + 1e-8)).contains(&reached), "{reached}");
    assert!(speed(&run) > 0.9, "still a gas: {}", speed(&run));
    // The contact law continues with its own time step.
    assert!(run.engine().time_step() < 1e-6, "{}", run.engine().time_step());
}

#[test]
fn an_event_driven_gas_accepts_isotropic_rates_only_and_reports_jamming() {
    let mut run = begin(&event_driven());
    advance(&mut run);
    let before = (run.packing().unwrap(), run.run_state().unwrap());
    let error = run.advance(&[-60.0, -60.0, -50.0, 0.0, 0.0, 0.0]).unwrap_err().to_string();
    assert!(error.contains("not isotropic"), "{error}");
    let error = run.advance(&[f64::NAN; 6]).unwrap_err().to_string();
    assert!(error.contains("finite"), "{error}");
    // After a refused rate, the run is in a state from which it can continue.
    assert!(run.engine().steps() <= before.0.step);
    assert!(advance(&mut run));

    let mut dense = Scene::parse(&event_driven()).unwrap();
    dense.phases[0].until.all = vec![Condition::AtLeast(Measure::SolidFraction, 0.76)];
    let mut run = Simulation::new(dense).unwrap();
    let error = loop {
        let rate = run.request().unwrap().input.controls.map(|c| match c {
            grainlab_core::ComponentControl::StrainRate(rate) => rate,
            _ => 0.0,
        });
        if let Err(error) = run.advance(&rate) {
            break error;
        }
    };
    assert!(matches!(error, ExperimentError::Gas(GasError::Jammed { .. })), "{error}");
    assert!(run.packing().unwrap().validated().is_ok());
}

#[test]
fn a_foreign_or_broken_run_state_is_refused() {
    let run = start();
    let (packing, state) = (run.packing().unwrap(), run.run_state().unwrap());
    let resume =
        |scene: &str, state: &[u8]| Simulation::resume(Scene::parse(scene).unwrap(), &packing, state);
    assert!(resume(&SCENE, &state).is_ok());
    assert!(
        resume(&SCENE.replace("seed = 5", "seed = 6"), &state)
            .unwrap_err()
            .to_string()
            .contains("another scene")
    );
    assert!(resume(&SCENE, &[]).unwrap_err().to_string().contains("no run state"));
    let refused = |state: &str| resume(&SCENE, state.as_bytes()).unwrap_err().to_string();
    let text = String::from_utf8(state.clone()).unwrap();
    assert!(refused(&text[..40]).contains("damaged"));
    assert!(refused(&text.replace("\"version\":4", "\"version\":99")).contains("version 99"));
    assert!(refused(&text.replace("\"phase\":0,", "")).contains("missing field `phase`"));
    assert!(refused(&text.replace("\"phase\":0,", "\"phase\":0,\"more\":1,")).contains("more"));
    // Names, not places, say what a number is.
    let mut fields: serde_json::Map<String, serde_json::Value> = serde_json::from_str(&text).unwrap();
    let first = fields.remove("version");
    fields.extend(first.map(|version| ("version".to_owned(), version)));
    assert!(resume(&SCENE, &serde_json::to_vec(&fields).unwrap()).is_ok());
}

#[test]
fn a_run_state_of_version_3_is_not_resumed() {
    let mut words = [0u64; 26];
    words[0] = 3;
    let state: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
    let error =
        Simulation::resume(Scene::parse(&SCENE).unwrap(), &start().packing().unwrap(), &state).unwrap_err();
    assert!(error.to_string().contains("version 3"), "{error}");
}
