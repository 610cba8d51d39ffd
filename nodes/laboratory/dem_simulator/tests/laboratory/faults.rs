//! Invalid messages, and runs that cannot continue.

use grainlab_buskit::{Bench, Kind, Record, exit_of, tiny};
use grainlab_core::{ComponentControl, Mat3, Packing};
use grainlab_dem::Dem;
use grainlab_dem_simulator::{DemSimulator, Settings};
use grainlab_engine::{Compute, EngineError, EngineFactory, EngineSettings, Observables, ParticleEngine};
use grainlab_msgs::msg::{self, PackingReport, RunState, StrainRate, Stress};
use grainlab_msgs::{to_cdr, topics};
use grainlab_node_kit::{
    Actor, Bus, Demand, Exit, Next, Node, NodeError, Publisher, Statistics, Subscription,
};
use std::sync::Arc;
use std::time::Duration;

/// A servo that answers `honest` requests correctly and then invalidly.
struct BadServo {
    stress: Subscription<Stress>,
    strain_rate: Publisher<StrainRate>,
    honest: u64,
    lies: u32,
    lie: f64,
    /// Also in a component that the servo must not choose.
    anywhere: bool,
}

impl BadServo {
    fn new(bus: &mut dyn Bus, honest: u64, lies: u32, lie: f64) -> Self {
        let stress = Subscription::subscribe(bus, &topics::STRESS, Demand::best_effort(16)).unwrap();
        let strain_rate = Publisher::advertise(bus, &topics::STRAIN_RATE).unwrap();
        let anywhere = lie.is_nan() || lie.abs() >= 1.0;
        Self { stress, strain_rate, honest, lies, lie, anywhere }
    }
}

impl Node for BadServo {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        while let Some((stress, _)) = self.stress.take_valid(bus)? {
            let mut answer = grainlab_servo_controller::answer(&stress).expect("an answer");
            let chosen = grainlab_servo::ServoRequest::try_from(&stress).unwrap().input.controls[2];
            let may = self.anywhere || matches!(chosen, ComponentControl::Stress(_));
            if stress.sequence >= self.honest && self.lies > 0 && may {
                self.lies -= 1;
                answer.rate[2] = self.lie;
            }
            self.strain_rate.publish(bus, &answer)?;
        }
        Ok(Next::Wait(Duration::from_secs(3600)))
    }
}

/// The end of a run with this servo, if it ends within some seconds, and its record.
fn run_with(honest: u64, lies: u32, lie: f64) -> (Option<Exit>, Record) {
    let (exit, record, _) = run_ahead_with(honest, lies, lie, true);
    (exit, record)
}

/// A run with or without speculative steps, with the number of answers predicted and the total.
fn run_ahead_with(honest: u64, lies: u32, lie: f64, ahead: bool) -> (Option<Exit>, Record, [u64; 2]) {
    let bench = Bench::new(0);
    let mut servo_bus = bench.bus("servo_controller");
    let servo = BadServo::new(&mut servo_bus, honest, lies, lie);
    let mut actors = vec![
        bench.node(Kind::Recorder),
        bench.simulator(&Settings { ahead, ..Settings::default() }, None),
        Actor::new(Box::new(servo), servo_bus),
    ];
    bench.run(&mut actors, |actors| {
        let end = bench.record.borrow().last::<RunState>(&topics::RUN_STATE);
        actors[1].ended.is_some() || end.is_some_and(|s| s.state == RunState::FINISHED)
    });
    // The last messages of the simulator are still in transit.
    bench.pass(&mut actors[..1], Duration::ZERO);
    let exit = exit_of(&actors[1]);
    let health = actors[1].node.health();
    let count = |name| health.value(name).map_or(0, |v| v.parse().unwrap());
    (exit, bench.record.take(), ["foreseen", "exchanges"].map(count))
}

#[test]
fn computing_ahead_of_the_answers_changes_no_message_whether_they_are_foreseen_or_not() {
    let (_, plain, [none, exchanges]) = run_ahead_with(0, 0, 0.0, false);
    let (_, ahead, foreseen) = run_ahead_with(0, 0, 0.0, true);
    assert!(exchanges > 400 && none == 0, "{exchanges} exchanges, {none} foreseen");
    assert_eq!(foreseen, [exchanges; 2], "every answer is foreseen");
    assert!(plain == ahead, "run_state and repetitions included");

    // Another law is applied, and one answer suffices to detect it.
    let (_, plain, _) = run_ahead_with(300, 5, -0.7, false);
    let (_, ahead, foreseen) = run_ahead_with(300, 5, -0.7, true);
    let first = plain.messages::<Stress>(&topics::STRESS).into_iter().find(|stress| {
        let chosen = grainlab_servo::ServoRequest::try_from(stress).unwrap().input.controls[2];
        stress.sequence >= 300 && matches!(chosen, ComponentControl::Stress(_))
    });
    let exchanges = plain.without_repeats().bodies(&topics::STRAIN_RATE).len() as u64;
    assert_eq!(foreseen, [first.unwrap().sequence, exchanges]);
    assert!(plain == ahead);
    let (_, honest) = run_with(0, 0, 0.0);
    assert!(honest.bodies(&topics::STRESS) != plain.bodies(&topics::STRESS), "it mattered");
}

#[test]
fn ten_answers_that_are_not_numbers_end_the_run_with_its_state_saved() {
    let (exit, record) = run_with(200, 10, f64::NAN);
    assert_eq!(exit, Some(Exit::PhysicsInvalid));
    let end: RunState = record.last(&topics::RUN_STATE).unwrap();
    assert_eq!(end.state, RunState::FAILED);
    assert!(end.message.contains("rate[2] (zz) = NaN"), "{}", end.message);
    let saved: msg::Packing = record.last(&topics::PACKING).unwrap();
    assert_eq!((saved.step, end.last_packing_step), (end.step, end.step));
    // The state is that of request 200: resumed, it gives the result of an undisturbed run.
    let clean = Bench::new(0).whole_run(&Settings::default(), None).without_repeats();
    let resume = (Packing::try_from(&saved).unwrap(), saved.run_state);
    let resumed = Bench::new(0).whole_run(&Settings::default(), Some(resume)).without_repeats();
    let rest = resumed.bodies(&topics::STRESS);
    assert!(rest.len() > 100 && clean.bodies(&topics::STRESS)[200..] == *rest);
    assert_eq!(clean.bodies(&topics::MICROSTRUCTURE).last(), resumed.bodies(&topics::MICROSTRUCTURE).last());
}

#[test]
fn nine_answers_that_are_not_numbers_change_no_byte() {
    let clean = Bench::new(0).whole_run(&Settings::default(), None).without_repeats();
    let (exit, record) = run_with(200, 9, f64::NAN);
    assert_eq!(exit, None);
    for topic in [topics::STRESS, topics::PACKING] {
        assert!(record.without_repeats().bodies(&topic) == clean.bodies(&topic), "{}", topic.name);
    }
    assert_eq!(
        record.bodies(&topics::STRESS).len() - clean.bodies(&topics::STRESS).len(),
        2 * 9,
        "asked again nine times, each time with the request before"
    );
}

#[test]
fn ten_answers_beyond_the_rate_limit_end_the_run_with_its_state_saved() {
    // Applied, 10⁸ per second would move a grain by more than its size within one step of some 10⁻⁸ s.
    let (exit, record) = run_with(400, u32::MAX, -1e8);
    assert_eq!(exit, Some(Exit::PhysicsInvalid));
    let end: RunState = record.last(&topics::RUN_STATE).unwrap();
    assert!(end.state == RunState::FAILED && end.message.contains("rate limit"), "{}", end.message);
    let saved: msg::Packing = record.last(&topics::PACKING).unwrap();
    assert_eq!(saved.step, end.last_packing_step);
    assert!(Packing::try_from(&saved).is_ok());
}

#[test]
fn a_packing_with_an_index_out_of_range_is_refused_and_the_analyzer_continues() {
    let record = Bench::new(0).whole_run(&Settings::default(), None);
    let good: msg::Packing = record.last(&topics::PACKING).unwrap();
    let mut broken = good.clone();
    broken.contact_pair[1] = 40;

    let bench = Bench::new(0);
    let mut source = bench.bus("source");
    let packings: Publisher<msg::Packing> = Publisher::advertise(&mut source, &topics::PACKING).unwrap();
    let mut actors = [bench.node(Kind::Recorder), bench.node(Kind::Analyzer)];
    packings.publish(&mut source, &broken).unwrap();
    source.publish(packings.id(), &to_cdr(&good)[..1000]).unwrap();
    bench.pass(&mut actors, Duration::from_secs(1));
    assert!(bench.record.borrow().bodies(&topics::PACKING_REPORT).is_empty());
    assert_eq!(actors[1].bus.received().iter().map(|r| r.refused).sum::<u64>(), 2);
    packings.publish(&mut source, &good).unwrap();
    bench.pass(&mut actors, Duration::from_secs(1));
    let report: PackingReport = bench.record.borrow().last(&topics::PACKING_REPORT).unwrap();
    assert_eq!(report.source_step, good.step);
    let last = |record: &Record| record.bodies(&topics::PACKING_REPORT).last().cloned();
    assert_eq!(last(&bench.record.borrow()), last(&record));
}

/// Our engine, whose stress is not a number from a solver step on.
#[derive(Debug)]
struct Diverging(Box<dyn ParticleEngine>, u64);

/// Starts engines that diverge after this number of solver steps.
#[derive(Debug)]
struct DivergesAfter(u64);

impl EngineFactory for DivergesAfter {
    fn start(
        &self,
        packing: &Packing,
        settings: &EngineSettings,
        rate: &[f64; 6],
        compute: &Compute,
    ) -> Result<Box<dyn ParticleEngine>, EngineError> {
        let engine = Dem::default().start(packing, settings, rate, compute)?;
        let step = engine.steps() + self.0;
        Ok(Box::new(Diverging(engine, step)))
    }
}

impl ParticleEngine for Diverging {
    fn settings(&self) -> &EngineSettings {
        self.0.settings()
    }

    fn begin_phase(&mut self, settings: &EngineSettings) -> Result<(), EngineError> {
        self.0.begin_phase(settings)
    }

    fn set_rate(&mut self, rate: &[f64; 6]) -> Result<(), EngineError> {
        self.0.set_rate(rate)
    }

    fn rate(&self) -> [f64; 6] {
        self.0.rate()
    }

    fn run(&mut self, steps: u32) -> Result<(Mat3, Observables), EngineError> {
        let (deformation, _) = self.0.run(steps)?;
        Ok((deformation, self.observables()?))
    }

    fn steps(&self) -> u64 {
        self.0.steps()
    }

    fn time(&self) -> f64 {
        self.0.time()
    }

    fn time_step(&self) -> f64 {
        self.0.time_step()
    }

    fn observables(&self) -> Result<Observables, EngineError> {
        let mut seen = self.0.observables()?;
        if self.steps() >= self.1 {
            seen.stress.tensor.zz = f64::NAN;
        }
        Ok(seen)
    }

    fn packing(&self, deformation: Mat3) -> Result<Packing, EngineError> {
        self.0.packing(deformation)
    }
}

#[test]
fn a_stress_that_is_not_a_number_ends_the_run_with_its_state_saved_and_is_not_published() {
    let bench = Bench::new(0);
    let mut bus = bench.bus("dem_simulator");
    let engine = Arc::new(DivergesAfter(1000));
    let simulator = DemSimulator::with_engine(&mut bus, tiny(), engine, None, Settings::default()).unwrap();
    let mut actors =
        vec![bench.node(Kind::Recorder), Actor::new(Box::new(simulator), bus), bench.node(Kind::Servo)];
    bench.run(&mut actors, |actors| actors[1].ended.is_some());
    bench.pass(&mut actors[..1], Duration::ZERO);
    assert_eq!(exit_of(&actors[1]), Some(Exit::PhysicsInvalid));
    let record = bench.record.take();
    let end: RunState = record.last(&topics::RUN_STATE).unwrap();
    assert_eq!(end.state, RunState::FAILED);
    assert_eq!(end.message, "Stress.stress.zz = NaN is refused: it must be finite");
    let saved: msg::Packing = record.last(&topics::PACKING).unwrap();
    assert_eq!((saved.step, end.last_packing_step), (end.step, end.step));
    let sent = record.messages::<Stress>(&topics::STRESS);
    // One request each 100 steps.
    assert_eq!(sent.len(), 10);
    assert!(sent.iter().all(|s| s.step < saved.step && s.stress.zz.is_finite()));
}
