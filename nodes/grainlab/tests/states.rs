//! States of a run: measured as they are, resumed, and refused where they contradict themselves.

use grainlab::{Error, State, measure, resume, simulate};
use std::time::Duration;

const SMALL: [&str; 2] = ["grains.count=200", "seed=2"];

#[test]
fn a_state_resumes_its_run_to_the_same_packings() {
    let states: Vec<State> = simulate("s1", &SMALL).unwrap().collect::<Result<_, _>>().unwrap();
    assert_eq!(states.len(), 4);
    let resumed: Vec<State> = resume("s1", &SMALL, &states[1]).unwrap().collect::<Result<_, _>>().unwrap();
    assert_eq!(resumed, states[2..]);
    let mixed = State { run_state: states[1].run_state.clone(), ..states[2].clone() };
    for (scene, state) in [("s1", mixed), ("s2", states[1].clone()), ("s1", states[1].packing.clone().into())]
    {
        assert!(matches!(resume(scene, &SMALL, &state), Err(Error::Simulation(_))), "{scene}");
    }
}

#[test]
fn a_packing_that_contradicts_itself_is_not_measured() {
    let state = simulate("demo", &SMALL).unwrap().last().unwrap().unwrap();
    assert!(measure(&state).unwrap().pressure() > 4e4);
    let faults: [fn(&mut State); 6] = [
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
fn a_run_goes_on_however_short_its_turns_are() {
    let mut run = simulate("demo", &SMALL).unwrap();
    for _ in 0..100 {
        run.advance(Duration::ZERO).unwrap();
    }
    assert!(run.steps() >= 100, "{}", run.steps());
    assert!(run.with_threads(100_000).is_err());
}
