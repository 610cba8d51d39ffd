//! States of a run: measured as they are, resumed, and refused where they contradict themselves.

use grainlab::{Error, State, measure, resume, simulate};
use std::time::Duration;

type Change = fn(&mut State);

const SMALL: [&str; 2] = ["grains.count=200", "seed=2"];

#[test]
fn a_state_resumes_its_run_to_the_same_packings() {
    let states: Vec<State> = simulate("s1", &SMALL).unwrap().collect::<Result<_, _>>().unwrap();
    assert_eq!(states.len(), 4);
    let resumed: Vec<State> = resume("s1", &SMALL, &states[1]).unwrap().collect::<Result<_, _>>().unwrap();
    assert_eq!(resumed, states[2..]);
    let mixed = State { run_state: states[1].run_state.clone(), ..states[2].clone() };
    let changed = |change: fn(&mut grainlab::Packing)| {
        let mut state = states[1].clone();
        change(&mut state.packing);
        ("s1", state)
    };
    let refused = [
        ("s1", mixed),
        ("s2", states[1].clone()),
        ("s1", states[1].packing.clone().into()),
        changed(|p| p.friction *= 2.0),
        changed(|p| p.positions[3].x += 1e-8),
        changed(|p| p.material.density *= 1.1),
        changed(|p| *p = p.repeated(2).unwrap()),
    ];
    for (n, (scene, state)) in refused.into_iter().enumerate() {
        assert!(matches!(resume(scene, &SMALL, &state), Err(Error::Simulation(_))), "state {n}");
    }
}

#[test]
fn a_packing_that_contradicts_itself_is_not_measured() {
    let state = simulate("demo", &SMALL).unwrap().last().unwrap().unwrap();
    let measured = measure(&state).unwrap();
    assert!(measured.pressure() > 4e4 && measured.notes.is_empty(), "{:?}", measured.notes);
    let faults: [Change; 6] = [
        |s| s.packing.radii.iter_mut().for_each(|r| *r *= 2.0),
        |s| s.packing.contacts.iter_mut().for_each(|c| c.overlap *= 10.0),
        |s| s.packing.contacts.iter_mut().for_each(|c| c.normal_force *= 1e6),
        |s| s.packing.ids[1] = s.packing.ids[0],
        |s| s.packing.positions[3].x = f64::NAN,
        |s| s.packing.radii[0] *= 1.1,
    ];
    for (n, fault) in faults.into_iter().enumerate() {
        let mut broken = state.clone();
        fault(&mut broken);
        assert!(matches!(measure(&broken), Err(Error::Measurement(_))), "fault {n}");
    }
}

#[test]
fn a_packing_that_no_law_made_is_measured_with_a_warning() {
    let state = simulate("demo", &SMALL).unwrap().last().unwrap().unwrap();
    let doubts: [(Change, &str); 4] = [
        (|s| s.packing.contacts[0].normal_force *= -1.0, "1 contact pulls"),
        (
            |s| s.packing.contacts.iter_mut().for_each(|c| c.normal_force *= 1.5),
            "differ from the contact law",
        ),
        (|s| s.packing.velocities[0].x = 10.0, "in motion"),
        (|s| _ = s.packing.contacts.pop(), "not listed"),
    ];
    for (change, text) in doubts {
        let mut doubtful = state.clone();
        change(&mut doubtful);
        let found = grainlab_core::notes::texts(&measure(&doubtful).unwrap().notes);
        assert!(found.iter().any(|w| w.contains(text)), "{text}: {found:?}");
    }
}

#[test]
fn a_run_goes_on_however_short_its_turns_are() {
    let mut run = simulate("demo", &SMALL).unwrap();
    assert!(run.notes().is_empty() && run.scene_notes().iter().any(|n| n.contains("friction 10")));
    for _ in 0..100 {
        run.advance(Duration::ZERO).unwrap();
    }
    assert!(run.steps() >= 100, "{}", run.steps());
    assert!(run.with_threads(100_000).is_err());
}
