//! Nodes that join, leave, and return in the middle of a run.

use grainlab_buskit::{Bench, Kind, Record, exit_of, tiny};
use grainlab_core::Packing;
use grainlab_dem_simulator::{DemSimulator, Settings};
use grainlab_msgs::boundary::BoundaryError;
use grainlab_msgs::msg::{self, RunState};
use grainlab_msgs::topics;
use grainlab_node_kit::{Actor, Bus, Exit, Faults, Next, Node, NodeError, Statistics};
use std::time::Duration;

fn state_in(message: &msg::Packing) -> Result<(Packing, Vec<u8>), BoundaryError> {
    Ok((Packing::try_from(message)?, message.run_state.clone()))
}

fn requests(record: &Record) -> usize {
    record.bodies(&topics::STRESS).len()
}

#[test]
fn a_fresh_servo_in_the_middle_of_a_run_changes_no_byte() {
    let clean = Bench::new(0).whole_run(&Settings::default(), None).without_repeats();
    let bench = Bench::new(0);
    let mut actors = vec![
        bench.node(Kind::Recorder),
        bench.node(Kind::Analyzer),
        bench.node(Kind::Inversion),
        bench.simulator(&Settings::default(), None),
        bench.node(Kind::Servo),
    ];
    assert!(bench.run(&mut actors, |_| requests(&bench.record.borrow()) > 300));
    actors.pop();
    bench.pass(&mut actors, Duration::from_secs(3));
    assert!(!bench.record.borrow().complete(), "the simulator waits");
    actors.push(bench.node(Kind::Servo));
    assert!(bench.run(&mut actors, |_| bench.record.borrow().complete()));
    assert_eq!(bench.record.borrow().without_repeats().difference(&clean), None);
}

#[test]
fn a_run_resumed_from_any_packing_continues_bit_for_bit() {
    let clean = Bench::new(0).whole_run(&Settings::default(), None).without_repeats();
    for (place, packing) in clean.messages::<msg::Packing>(&topics::PACKING).iter().enumerate() {
        let resume = state_in(packing).unwrap();
        let record = Bench::new(1).whole_run(&Settings::default(), Some(resume)).without_repeats();
        for topic in [topics::STRESS, topics::STRAIN_RATE, topics::PACKING, topics::MICROSTRUCTURE] {
            let (all, again) = (clean.bodies(&topic), record.bodies(&topic));
            assert!(all.ends_with(again), "{} after packing {place}", topic.name);
        }
        let packings = record.bodies(&topics::PACKING).len();
        assert_eq!(packings, 3 - place, "the packing resumed from is there again");
    }
}

/// A simulator that is stopped before its n-th step.
struct Stopped {
    simulator: Box<dyn Node>,
    steps_left: u32,
}

impl Node for Stopped {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        if self.steps_left == 0 {
            return Ok(Next::Finished(self.simulator.on_shutdown(bus)?));
        }
        self.steps_left -= 1;
        self.simulator.step(bus)
    }
}

#[test]
fn an_interrupted_run_saves_its_state_and_goes_on_from_there() {
    let clean = Bench::new(0).whole_run(&Settings::default(), None).without_repeats();
    let bench = Bench::new(0);
    let Actor { node: simulator, bus, .. } = bench.simulator(&Settings::default(), None);
    let stopped = Stopped { simulator, steps_left: 500 };
    let mut actors =
        [bench.node(Kind::Recorder), bench.node(Kind::Servo), Actor::new(Box::new(stopped), bus)];
    assert!(bench.run(&mut actors, |actors| actors[2].ended.is_some()));
    assert_eq!(exit_of(&actors[2]), Some(Exit::Interrupted));
    bench.pass(&mut actors[..1], Duration::ZERO);
    let (saved, end): (msg::Packing, RunState) = {
        let record = bench.record.borrow();
        (record.last(&topics::PACKING).unwrap(), record.last(&topics::RUN_STATE).unwrap())
    };
    assert!(saved.step > 0 && end.last_packing_step == saved.step && end.message.starts_with("interrupted"));
    let rest =
        Bench::new(0).whole_run(&Settings::default(), Some(state_in(&saved).unwrap())).without_repeats();
    assert!(rest.bodies(&topics::STRESS).len() > 100, "it was stopped under way");
    assert!(clean.bodies(&topics::STRESS).ends_with(rest.bodies(&topics::STRESS)));
    assert_eq!(clean.bodies(&topics::MICROSTRUCTURE).last(), rest.bodies(&topics::MICROSTRUCTURE).last());
}

#[test]
fn an_analyzer_that_comes_late_gets_the_last_packing_and_makes_the_same_bytes() {
    let clean = Bench::new(0).whole_run(&Settings::default(), None);
    let bench = Bench::new(0);
    let mut actors = vec![
        bench.node(Kind::Recorder),
        bench.node(Kind::Servo),
        bench.simulator(&Settings::default(), None),
    ];
    let finished = |record: &Record| {
        record.last::<RunState>(&topics::RUN_STATE).is_some_and(|s| s.state == RunState::FINISHED)
    };
    assert!(bench.run(&mut actors, |_| finished(&bench.record.borrow())));
    actors.extend([Kind::Analyzer, Kind::Inversion].map(|kind| bench.node(kind)));
    assert!(bench.run(&mut actors, |_| bench.record.borrow().complete()));
    for topic in [topics::PACKING_REPORT, topics::MICROSTRUCTURE] {
        assert!(
            bench.record.borrow().bodies(&topic) == &clean.bodies(&topic)[clean.bodies(&topic).len() - 1..]
        );
    }
}

#[test]
fn a_run_waits_for_the_readers_it_was_told_to_wait_for() {
    let bench = Bench::new(0);
    let settings =
        Settings { wait_for: vec![topics::STRESS, topics::PACKING], min_readers: 2, ..Settings::default() };
    let mut actors =
        vec![bench.simulator(&settings, None), bench.node(Kind::Servo), bench.node(Kind::Analyzer)];
    bench.pass(&mut actors, Duration::from_secs(60));
    assert_eq!(actors[0].bus.published()[0].count, 0, "there is one reader of each only");
    actors.push(bench.node(Kind::Recorder));
    assert!(bench.run(&mut actors, |_| requests(&bench.record.borrow()) > 10));
    let first: Vec<msg::Stress> = bench.record.borrow().messages(&topics::STRESS);
    assert_eq!(first[0].sequence, 0, "the recorder missed nothing");
}

#[test]
fn a_second_simulator_ends_and_the_first_one_does_not_notice() {
    let clean = Bench::new(0).whole_run(&Settings::default(), None).without_repeats();
    let bench = Bench::new(0);
    // The intruder joins first, so that its GUID is the smaller one; nevertheless the running simulator
    // continues.
    let mut intruder_bus = bench.bus("dem_simulator");
    let mut actors = vec![
        bench.node(Kind::Recorder),
        bench.node(Kind::Analyzer),
        bench.node(Kind::Inversion),
        bench.node(Kind::Servo),
        bench.simulator(&Settings::default(), None),
    ];
    // Delays give the intruder time for its check while the run lasts.
    bench.hub.set_faults("/stress", Faults { delay: Duration::from_millis(20), ..Default::default() });
    assert!(bench.run(&mut actors, |_| requests(&bench.record.borrow()) > 100));
    let intruder = DemSimulator::new(&mut intruder_bus, tiny(), None, Settings::default()).unwrap();
    actors.push(Actor::new(Box::new(intruder), intruder_bus));
    assert!(bench.run(&mut actors, |actors| actors[5].ended.is_some()));
    assert!(!bench.record.borrow().complete(), "the run was still under way");
    assert_eq!(exit_of(&actors[5]), Some(Exit::Failure));
    let message = actors[5].ended.as_ref().map(|e| format!("{}", e.as_ref().unwrap_err())).unwrap();
    let ours = actors[4].bus.published()[0].writer.to_string();
    assert!(message.contains(&ours) && message.contains("ROS_DOMAIN_ID"), "{message}");
    actors.pop();
    // The last request may still be in transit when its result is there.
    let all = clean.bodies(&topics::STRESS).len();
    let whole =
        |record: &Record| record.complete() && record.without_repeats().bodies(&topics::STRESS).len() >= all;
    assert!(bench.run(&mut actors, |_| whole(&bench.record.borrow())));
    assert_eq!(bench.record.borrow().without_repeats().difference(&clean), None);
}

#[test]
fn of_two_simulators_that_start_at_once_one_runs() {
    let bench = Bench::new(0);
    let mut actors = vec![
        bench.node(Kind::Recorder),
        bench.node(Kind::Servo),
        bench.simulator(&Settings::default(), None),
        bench.simulator(&Settings::default(), None),
    ];
    assert!(bench.run(&mut actors, |actors| actors.iter().any(|a| a.ended.is_some())));
    assert_eq!(exit_of(&actors[3]), Some(Exit::Failure), "the larger GUID gives way");
    // The process ends, and its endpoints leave the graph.
    actors.pop();
    assert!(bench.run(&mut actors, |_| requests(&bench.record.borrow()) > 10));
}
