//! Scenes as their authors write them, right and wrong.

use grainlab_core::{ComponentControl, ServoLaw, SymTensor};
use grainlab_scene::{
    Condition, GasMethod, Measure, Observation, PathError, PathEvent, PathState, PhaseKind, Scene,
};

const GOOD: &str = r#"
name = "tiny"
seed = 7
[grains]
count = 100
diameter = 2e-4
[[phase]]
kind = "gas"
rate = -12.0
until = { solid_fraction = 0.6 }
[[phase]]
kind = "relax"
name = "rest"
friction = 0.0
reference = true
until = { speed = 1e-3, hold = 1e-4 }
[[phase]]
kind = "cycle"
times = 2
[[phase.phase]]
kind = "strain"
name = "unload"
friction = 0.1
rate = [0, 0, 4.0, 0, 0, 0]
until = { strain = { zz = 0.002 } }
[[phase.phase]]
kind = "servo"
name = "reload"
friction = 0.1
response_time = 2e-5
control = { xx = { stress = 50e3 }, yy = { stress = 50e3 }, zz = { stress = 50e3 }, xy = { rate = 0.5 } }
publish = true
until = { on_target = 1e-3, unbalanced = 1e-6, timeout = 0.5 }
"#;

fn seen(time: f64) -> Observation {
    Observation {
        time,
        stress: SymTensor::isotropic(50e3),
        strain: SymTensor::default(),
        solid_fraction: 0.5,
        unbalanced: 1.0,
        speed: 1.0,
    }
}

#[test]
fn cycles_unroll_into_numbered_phases() {
    let scene = Scene::parse(GOOD).unwrap();
    let names: Vec<&str> = scene.phases.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["gas", "rest", "unload#1", "reload#1", "unload#2", "reload#2"]);
    assert_eq!(scene.phases[2].until.all, [Condition::AtLeast(Measure::Strain(2), 0.002)]);
    let PhaseKind::Servo { controls, .. } = &scene.phases[3].kind else { panic!("a servo phase") };
    assert_eq!(controls[0], ComponentControl::Stress(50e3));
    assert_eq!(controls[3], ComponentControl::Held);
    assert_eq!(controls[5], ComponentControl::StrainRate(0.5));
}

#[test]
fn a_servo_phase_is_normalised_unless_it_says_otherwise() {
    let law = |keys: &str| {
        let text = GOOD.replace("response_time = 2e-5", keys);
        match Scene::parse(&text)?.phases.swap_remove(3).kind {
            PhaseKind::Servo { law, .. } => Ok(law),
            other => panic!("a servo phase: {other:?}"),
        }
    };
    assert_eq!(law(""), Ok(ServoLaw::Normalised { share: 0.3, leak: 0.0 }));
    let chosen = ServoLaw::Normalised { share: 0.1, leak: 0.05 };
    assert_eq!(law("law = 'normalised'\ngain_share = 0.1\nleak = 0.05"), Ok(chosen));
    assert_eq!(law("response_time = 2e-5"), Ok(ServoLaw::Scaled { response_time: 2e-5 }));
    assert_eq!(law("law = 'integral'\ngain = 1e-3"), Ok(ServoLaw::Integral { gain: 1e-3, leak: 0.0 }));
    for (wrong, place) in [
        ("gain_share = 1.0", "gain_share"),
        ("gain = 1e-3", "gain"),
        ("law = 'integral'\ngain = 1e-3\nresponse_time = 1e-5", "response_time"),
        ("law = 'scaled'", "response_time"),
    ] {
        let error: grainlab_scene::SceneError = law(wrong).unwrap_err();
        assert!(error.faults.iter().any(|f| f.place.ends_with(place)), "{wrong}: {error}");
    }
}

#[test]
fn spins_are_damped_where_grains_are_to_come_to_rest_unless_the_scene_says_otherwise() {
    let drags = |text: &str| -> Vec<f64> {
        Scene::parse(text).unwrap().phases[..4].iter().map(|p| p.spin_drag).collect()
    };
    // √(G/ρ)/(1000 d) of glass: gas, relax, strain, servo.
    let expected = (29e9f64 / 2500.0).sqrt() / 0.2;
    for (found, expected) in drags(GOOD).iter().zip([0.0, expected, 0.0, expected]) {
        assert!((found - expected).abs() <= 1e-9 * expected, "{found} {expected}");
    }
    let larger = GOOD.replace("diameter = 2e-4", "diameter = 2e-3\n[material]\ndensity = 1e4");
    assert!((drags(&larger)[3] / expected - 0.05).abs() < 1e-12);
    let own = GOOD.replace("response_time", "spin_drag = 0\nresponse_time");
    assert_eq!(drags(&own)[3], 0.0);
}

#[test]
fn every_fault_is_reported_at_once_with_its_place() {
    let bad = GOOD
        .replace("diameter = 2e-4", "diameter = -1\ncolour = 'red'")
        .replace("name = \"unload\"\nfriction = 0.1", "name = \"unload\"\nfriction = -0.1")
        .replace("rate = -12.0", "rate = 12.0")
        .replace("times = 2", "times = 0")
        .replace("hold = 1e-4", "hold = 'long'");
    let error = Scene::parse(&bad).unwrap_err();
    let places: Vec<&str> = error.faults.iter().map(|f| f.place.as_str()).collect();
    for place in [
        "grains.diameter",
        "grains.colour",
        "phase[0].rate",
        "phase[1] (rest).until.hold",
        "phase[2].times",
        "phase[2].phase[0] (unload).friction",
    ] {
        assert!(places.contains(&place), "{place} is missing from\n{error}");
    }
    assert_eq!(error.faults.len(), 6, "{error}");
}

#[test]
fn a_gas_is_event_driven_unless_it_says_soft() {
    let method = |text: &str| match Scene::parse(text).unwrap().phases[0].kind {
        PhaseKind::Gas { method, .. } => method,
        _ => panic!("a gas phase"),
    };
    assert_eq!(method(GOOD), GasMethod::EventDriven);
    let soft = GOOD.replace("rate = -12.0", "rate = -12.0\nmethod = 'soft'\ndamping = 0.01");
    assert_eq!(method(&soft), GasMethod::Soft);
    let other = Scene::parse(&soft.replace("'soft'", "'lattice'")).unwrap_err().to_string();
    assert!(
        other.contains("phase[0].method: is \"lattice\"; it must be \"event_driven\" or \"soft\""),
        "{other}"
    );
}

#[test]
fn an_event_driven_gas_refuses_what_only_the_contact_law_knows() {
    let text = GOOD.replace("rate = -12.0", "rate = -12.0\ndamping = 0.002\nfriction = 0.1").replace(
        "until = { solid_fraction = 0.6 }",
        "until = { solid_fraction = 0.6, pressure_above = 1e3 }",
    );
    let error = Scene::parse(&text).unwrap_err();
    let places: Vec<&str> = error.faults.iter().map(|f| f.place.as_str()).collect();
    assert_eq!(places, ["phase[0].friction", "phase[0].damping", "phase[0].until"], "{error}");
    assert!(error.to_string().contains("elastic and frictionless"), "{error}");
    assert!(Scene::parse(&text.replace("rate = -12.0", "rate = -12.0\nmethod = 'soft'")).is_ok());
}

#[test]
fn text_that_is_no_toml_is_refused_with_its_line() {
    let error = Scene::parse("name = \n").unwrap_err();
    assert!(error.to_string().contains("line 1"), "{error}");
}

#[test]
fn a_phase_ends_only_after_its_conditions_held_for_the_hold_time() {
    let scene = Scene::parse(GOOD).unwrap();
    let mut state = PathState { phase: 1, began: 1.0, holding_since: None };
    let at = |time: f64, speed: f64| Observation { speed, ..seen(time) };
    assert_eq!(state.observe(&scene, &at(1.0, 1e-4)), Ok(PathEvent::Stay));
    // The condition fails once: the hold starts again.
    assert_eq!(state.observe(&scene, &at(1.00005, 1.0)), Ok(PathEvent::Stay));
    assert_eq!(state.observe(&scene, &at(1.00009, 1e-4)), Ok(PathEvent::Stay));
    assert_eq!(state.observe(&scene, &at(1.00015, 1e-4)), Ok(PathEvent::Stay));
    let ended = PathEvent::PhaseEnded { reference: true, publish: false, finished: false };
    assert_eq!(state.observe(&scene, &at(1.00020, 1e-4)), Ok(ended));
    assert_eq!(state, PathState { phase: 2, began: 1.00020, holding_since: None });
}

#[test]
fn the_last_phase_finishes_the_path_and_a_timeout_names_what_was_not_met() {
    let scene = Scene::parse(GOOD).unwrap();
    let mut state = PathState { phase: 5, began: 2.0, holding_since: None };
    let off = Observation { unbalanced: 1e-3, ..seen(2.6) };
    let Err(PathError::Timeout { index: 5, unmet, .. }) = state.observe(&scene, &off) else {
        panic!("a timeout")
    };
    assert!(unmet.contains("Unbalanced") && !unmet.contains("target"), "{unmet}");
    let on = Observation { unbalanced: 1e-7, ..seen(2.4) };
    let ended = PathEvent::PhaseEnded { reference: false, publish: true, finished: true };
    assert_eq!(state.observe(&scene, &on), Ok(ended));
    assert!(state.phase(&scene).is_none());
}
