//! The simulator as a node.

mod end;
mod exchange;
mod start;

use crate::duplicate_simulators::DuplicateSimulators;
use crate::messages::{self, Packings, Remark};
use crate::publication::{FLUSH_LIMIT, HOLD, Publication, flush_last_messages};
use crate::results::Results;
use crate::run::Run;
use crate::run_end::{RunEnd, Verdict};
use crate::servo::Servo;
use crate::settings::{Finish, Settings};
use grainlab_engine::{EngineError, EngineFactory};
use grainlab_experiment::{ExperimentError, Simulation};
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::msg::{self, RunState};
use grainlab_msgs::{PhaseReport, topics};
use grainlab_node_kit::{
    BulkPublisher, Bus, BusError, Demand, Exit, Health, Next, Node, NodeError, Publisher, Subscription,
};
use grainlab_scene::Scene;
use std::sync::Arc;
use std::time::Duration;

/// Period of the log message of a run that waits.
const NOTICE_PERIOD: Duration = Duration::from_secs(5);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Looks for other simulators, readers and a servo.
    Starting,
    /// Sends requests and applies the answers.
    Running,
    /// The loading path is complete.
    Finished,
}

/// The simulator: owns the run and advances it only with an answer of the servo.
pub struct DemSimulator {
    run: Run,
    settings: Settings,
    servo: Servo,
    publication: Publication,
    run_states: Subscription<RunState>,
    /// `None` if the process ends with the loading path.
    results: Option<Results>,
    /// What readers of `run_state` are told after the loading path.
    remark: Remark,
    verdict: Option<Verdict>,
    stage: Stage,
    duplicates: DuplicateSimulators,
    /// The packing that the run resumes from, while it is still to be published.
    resumed: Option<msg::Packing>,
    created_at: Duration,
    began: Duration,
    /// Wall time from the first request to the latest applied answer.
    wall: Duration,
    /// Condition that the start waits for, in words.
    awaited: String,
    next_notice: Duration,
}

impl DemSimulator {
    /// A simulator at the beginning of `scene`, or at the state of `resume`: a packing and its run state. A scene that
    /// starts from a packing begins with `resume`, whose run state is then empty.
    pub fn new(
        bus: &mut dyn Bus,
        scene: Scene,
        resume: Option<(grainlab_core::Packing, Vec<u8>)>,
        settings: Settings,
    ) -> Result<Self, NodeError> {
        let from = resume.as_ref().map(|(packing, state)| (packing, state.as_slice()));
        let factory = settings.engine_for(&scene, from)?;
        Self::with_engine(bus, scene, factory, resume, settings)
    }

    /// A simulator whose engines are of `factory`, whatever engine the settings name.
    pub fn with_engine(
        bus: &mut dyn Bus,
        scene: Scene,
        factory: Arc<dyn EngineFactory>,
        resume: Option<(grainlab_core::Packing, Vec<u8>)>,
        settings: Settings,
    ) -> Result<Self, NodeError> {
        let from = resume.as_ref().map(|(packing, state)| (packing, state.as_slice()));
        let mut run = Simulation::with_engine(scene, factory, from).map_err(|e| match e {
            ExperimentError::Engine(EngineError::Failed { .. }) => NodeError::usage(e),
            e => NodeError::failed(e),
        })?;
        run.number_requests_from(settings.next_request);
        let resumed = match &resume {
            None => None,
            // With the clock and the strain of the run.
            Some((_, state)) if state.is_empty() => Some(messages::packing(&run).map_err(NodeError::failed)?),
            Some((packing, state)) => Some(packing_message(packing, &run.scene().name, state.clone())),
        };
        let count = u32::try_from(run.packings()).unwrap_or(u32::MAX);
        let packings =
            from.map_or_else(Packings::default, |_| Packings { last_step: run.engine().steps(), count });
        let compute = settings.compute(run.scene().grains as usize).map_err(NodeError::failed)?;
        run.set_compute(match bus.stop_flag() {
            Some(flag) => compute.stopping_on(flag),
            None => compute,
        });
        let stress = Publisher::advertise(bus, &topics::STRESS)?;
        let publication = Publication::advertise(bus, run.scene().numerics.energy_balance, packings)?;
        let strain_rate = Subscription::subscribe(bus, &topics::STRAIN_RATE, Demand::best_effort(64))?;
        // Another simulator repeats its state every second; a reliable reader of our own topic might fill our own
        // window.
        let run_states = Subscription::subscribe(bus, &topics::RUN_STATE, Demand::best_effort(16))?;
        let results = match settings.finish {
            Finish::AtOnce => None,
            Finish::Never | Finish::Inverted => Some(results_of(bus, run.scene(), &settings)?),
        };
        publication.frames(bus)?;
        let own_stress = bus.published().first().map(|p| p.writer).unwrap_or_default();
        let now = bus.now();
        Ok(Self {
            run: Run::new(run, settings.ahead, now),
            servo: Servo::new(stress, strain_rate, own_stress, &settings),
            publication,
            run_states,
            results,
            remark: Remark::default(),
            verdict: None,
            stage: Stage::Starting,
            duplicates: DuplicateSimulators::new(own_stress.participant()),
            resumed,
            created_at: now,
            began: now,
            wall: Duration::ZERO,
            awaited: String::new(),
            next_notice: now + NOTICE_PERIOD,
            settings,
        })
    }

    /// True if the log message of a waiting run is due.
    fn notice_due(&mut self, now: Duration) -> bool {
        let due = now >= self.next_notice;
        if due {
            self.next_notice = now + NOTICE_PERIOD;
        }
        due
    }

    /// Saves the last finite state and ends. A failed run has returned to that state already.
    fn fail(&mut self, bus: &mut dyn Bus, reason: &str) -> Result<Next, NodeError> {
        let step = self.run.simulation().engine().steps();
        let saved = match self.save(bus, reason) {
            Ok(()) => format!("The state of step {step} is saved as the last packing"),
            Err(error) => format!("The state of step {step} could not be saved: {error}"),
        };
        Err(NodeError::new(Exit::PhysicsInvalid, format!("{reason}. {saved}")))
    }

    fn save(&mut self, bus: &mut dyn Bus, reason: &str) -> Result<(), String> {
        self.publication.save(bus, self.run.simulation(), self.servo.request(), reason)
    }
}

/// Subscribes to the results of a run of this scene.
fn results_of(bus: &mut dyn Bus, scene: &Scene, settings: &Settings) -> Result<Results, BusError> {
    let last = scene.phases.iter().rfind(|phase| phase.publish || phase.record.is_some());
    let is_within_phase = last.is_some_and(|phase| !phase.publish);
    let end = RunEnd::new(&settings.awaited, settings.recorded.clone(), is_within_phase);
    Results::subscribe(bus, end, scene.start.is_some())
}

impl Node for DemSimulator {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        let now = bus.now();
        self.receive_run_states(bus, now)?;
        if let Some(results) = &mut self.results {
            results.receive(bus)?;
        }
        if let Some(reason) = self.servo.receive(bus, now)? {
            return self.fail(bus, &reason);
        }
        let (run, is_finished) = (self.run.simulation(), self.stage == Stage::Finished);
        let state = if is_finished { RunState::FINISHED } else { RunState::RUNNING };
        let remark = || if is_finished { self.remark.clone() } else { run.left_out().into() };
        self.publication.progress(run, state, remark, now);
        self.publication.sample(bus, self.run.simulation())?;
        if !self.publication.deliver(bus)? {
            return Ok(Next::Wait(HOLD));
        }
        let next = match self.stage {
            Stage::Starting => self.start(bus, now),
            Stage::Running if self.publication.queue().goes_first(now, self.run.last_advance()) => {
                Ok(Next::Wait(HOLD))
            }
            Stage::Running => self.exchange(bus, now),
            Stage::Finished => self.wait_after_end(bus),
        }?;
        Ok(match next {
            // A message of a reader ends a wait by itself; its absence is found at the end of this time.
            Next::Wait(time) if self.publication.queue().is_under_way() => {
                Next::Wait(time.min(BulkPublisher::patience()))
            }
            next => next,
        })
    }

    fn health(&self) -> Health {
        let run = self.run.simulation();
        let phase = run.path().phase(run.scene()).map_or("none", |p| p.name.as_str());
        let (counts, steps, queue) = (self.servo.counts(), self.run.steps(), self.publication.queue());
        let is_running = self.stage == Stage::Running;
        let share = run.phase_share().filter(|_| is_running);
        let unmet = if is_running { run.unmet() } else { String::new() };
        let computing = self.run.computing().as_secs_f64();
        let particle_steps = steps as f64 * f64::from(run.scene().grains);
        let message = match self.stage {
            Stage::Starting if self.awaited.is_empty() => "starting".into(),
            Stage::Starting => format!("waiting for {}", self.awaited),
            Stage::Running => format!("phase {phase}"),
            Stage::Finished if self.remark.text.is_empty() => "finished".into(),
            Stage::Finished => self.remark.text.clone(),
        };
        Health::ok(message)
            .with_phase(&PhaseReport { name: phase.to_owned(), share, unmet })
            .with("step", run.engine().steps())
            .with("steps", steps)
            .with("scene", &run.scene().name)
            .with("grains", run.scene().grains)
            .with("exchanges", counts.exchanges)
            .with("foreseen", self.run.foreseen())
            .with("resends", counts.resends)
            .with("refused", counts.refused)
            .with("stale", counts.stale)
            .with("contradictions", counts.contradictions)
            .with("other_servos", self.servo.ignored())
            .with("held_up", queue.held_up)
            .with("packings", self.publication.packings().count)
            .with("readers_left_behind", queue.packings.left_behind())
            .with("waiting_s", counts.waiting.as_secs_f64())
            .with("computing_s", computing)
            .with("wall_s", self.wall.as_secs_f64())
            .with("particle_steps_per_s", if computing > 0.0 { particle_steps / computing } else { 0.0 })
    }

    /// Saves the state of a run that is under way, so that it can be resumed.
    fn on_shutdown(&mut self, bus: &mut dyn Bus) -> Result<Exit, NodeError> {
        match self.stage {
            Stage::Starting => Ok(Exit::Interrupted),
            Stage::Running => {
                let step = self.run.simulation().engine().steps();
                match self.save(bus, "interrupted") {
                    Ok(()) => log::info!("the state of step {step} is saved as a packing"),
                    Err(error) => log::error!("the state of step {step} could not be saved: {error}"),
                }
                Ok(Exit::Interrupted)
            }
            Stage::Finished => {
                flush_last_messages(bus, FLUSH_LIMIT);
                Ok(self.exit_after_end())
            }
        }
    }
}
