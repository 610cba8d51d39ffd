//! The simulator as a node.

use crate::duplicate_simulators::DuplicateSimulators;
use crate::inversions::Inversions;
use crate::lockstep::Lockstep;
use crate::messages::{self, Packings};
use crate::partner::Partner;
use crate::samples::Samples;
use crate::send_queue::SendQueue;
use crate::settings::Settings;
use crate::speculative_step::{self, SpeculativeStep};
use grainlab_engine::EngineError;
use grainlab_experiment::{ExperimentError, Simulation};
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::msg::{self, RunState, StrainRate, Stress};
use grainlab_msgs::tf2_msgs::TFMessage;
use grainlab_msgs::{PhaseReport, to_cdr, topics};
use grainlab_node_kit::{
    BulkPublisher, Bus, BusError, Demand, Exit, Health, Next, Node, NodeError, Publisher, Subscription,
};
use grainlab_scene::Scene;
use std::time::Duration;

/// Period of `run_state` where nothing happens, wall time.
pub(crate) const BEAT: Duration = Duration::from_secs(1);
/// Period of the log message of a run that waits.
pub(crate) const NOTICE_PERIOD: Duration = Duration::from_secs(5);
/// Pause before the next attempt while a slow reader holds up the send queue.
pub(crate) const HOLD: Duration = Duration::from_millis(5);
/// Time limit for the delivery of a packing that is in transit when a state is saved.
const EARLIER: Duration = Duration::from_secs(2);
/// Time limit for the delivery of a saved state: less than the launcher waits before it kills a simulator.
pub const SAVED_WITHIN: Duration = Duration::from_secs(20);
/// Time limit for the acknowledgement of the last messages.
const FLUSH_LIMIT: Duration = Duration::from_secs(2);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    /// Looks for other simulators, readers and a servo.
    Starting,
    /// Sends requests and applies the answers.
    Running,
    /// The loading path is complete.
    Finished,
}

/// The simulator: owns the run and advances it only with an answer of the servo.
pub struct DemSimulator {
    pub(crate) run: Simulation,
    pub(crate) settings: Settings,
    pub(crate) stress: Publisher<Stress>,
    pub(crate) samples: Samples,
    pub(crate) run_state: Publisher<RunState>,
    /// With `energy_balance` of the scene.
    pub(crate) energy: Option<Publisher<grainlab_msgs::msg::EnergyBalance>>,
    pub(crate) strain_rate: Subscription<StrainRate>,
    pub(crate) run_states: Subscription<RunState>,
    pub(crate) inversions: Inversions,
    /// Time of the end of the loading path.
    pub(crate) done: Option<Duration>,
    pub(crate) stage: Stage,
    pub(crate) duplicates: DuplicateSimulators,
    pub(crate) lockstep: Lockstep,
    pub(crate) partner: Partner,
    /// The run after the next steps if the answer is the one that the law gives.
    pub(crate) speculative: Option<SpeculativeStep>,
    /// True while speculative steps are computed: switched off once the answer of a servo differs.
    pub(crate) speculates: bool,
    /// Answers that equal the one a speculative step was computed with.
    pub(crate) foreseen: u64,
    pub(crate) send_queue: SendQueue,
    pub(crate) packings: Packings,
    /// The packing that the run resumes from, while it is still to be published.
    pub(crate) resumed: Option<msg::Packing>,
    pub(crate) created_at: Duration,
    pub(crate) began: Duration,
    pub(crate) first_step: u64,
    pub(crate) computing: Duration,
    /// Duration and end of the last advance of the run.
    pub(crate) advance: (Duration, Duration),
    /// Wall time from the first request to the latest applied answer.
    pub(crate) wall: Duration,
    pub(crate) next_beat: Duration,
    /// Condition that the start waits for, in words.
    pub(crate) awaited: String,
    pub(crate) next_notice: Duration,
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
        let samples = Samples::advertise(bus)?;
        let packing = BulkPublisher::advertise(bus, &topics::PACKING)?;
        let run_state = Publisher::advertise(bus, &topics::RUN_STATE)?;
        let energy = run.scene().numerics.energy_balance;
        let energy = energy.then(|| Publisher::advertise(bus, &topics::ENERGY)).transpose()?;
        let frames: Publisher<TFMessage> = Publisher::advertise(bus, &topics::TF_STATIC)?;
        let strain_rate = Subscription::subscribe(bus, &topics::STRAIN_RATE, Demand::best_effort(64))?;
        // Another simulator repeats its state every second; a reliable reader of our own topic might fill our own
        // window.
        let run_states = Subscription::subscribe(bus, &topics::RUN_STATE, Demand::best_effort(16))?;
        let awaited = if settings.exit_when_finished { settings.until_inverted.as_slice() } else { &[] };
        let inversions = Inversions::new(bus, awaited)?;
        frames.publish(bus, &messages::frames())?;
        let own_stress = bus.published().first().map(|p| p.writer).unwrap_or_default();
        let now = bus.now();
        Ok(Self {
            stress,
            samples,
            run_state,
            energy,
            strain_rate,
            run_states,
            inversions,
            done: None,
            stage: Stage::Starting,
            duplicates: DuplicateSimulators::new(own_stress.participant()),
            lockstep: Lockstep::new(&settings),
            partner: Partner::new(own_stress),
            speculative: None,
            speculates: settings.ahead && run.scene().grains <= speculative_step::GRAINS,
            foreseen: 0,
            send_queue: SendQueue::new(packing),
            packings,
            resumed,
            created_at: now,
            began: now,
            first_step: run.engine().steps(),
            computing: Duration::ZERO,
            advance: (Duration::ZERO, now),
            wall: Duration::ZERO,
            next_beat: now,
            awaited: String::new(),
            next_notice: now + NOTICE_PERIOD,
            run,
            settings,
        })
    }

    pub(crate) fn publish_run_state(&mut self, state: u8, text: &str) {
        let message = messages::run_state(&self.run, state, self.packings, text);
        self.send_queue.push_state(self.run_state.id(), to_cdr(&message));
    }

    pub(crate) fn publish_packing(&mut self) -> Result<(), ExperimentError> {
        let message = messages::packing(&self.run)?;
        self.packings = Packings { last_step: message.step, count: self.packings.count.saturating_add(1) };
        self.send_queue.push_packing(to_cdr(&message));
        Ok(())
    }

    /// Publishes the progress once a second.
    fn publish_progress(&mut self, now: Duration) {
        if now >= self.next_beat {
            self.next_beat = now + BEAT;
            let state = if self.stage == Stage::Finished { RunState::FINISHED } else { RunState::RUNNING };
            let left_out = self.run.left_out();
            self.publish_run_state(state, &left_out);
        }
    }

    /// True if the log message of a waiting run is due.
    pub(crate) fn notice_due(&mut self, now: Duration) -> bool {
        let due = now >= self.next_notice;
        if due {
            self.next_notice = now + NOTICE_PERIOD;
        }
        due
    }

    /// Saves the last finite state and ends. A failed run has returned to that state already.
    pub(crate) fn fail(&mut self, bus: &mut dyn Bus, reason: &str) -> Result<Next, NodeError> {
        let step = self.run.engine().steps();
        let saved = match self.save(bus, reason) {
            Ok(()) => format!("The state of step {step} is saved as the last packing"),
            Err(error) => format!("The state of step {step} could not be saved: {error}"),
        };
        Err(NodeError::new(Exit::PhysicsInvalid, format!("{reason}. {saved}")))
    }

    /// Publishes the state as the last packing, and waits until its readers have it. The error is why they may not.
    fn save(&mut self, bus: &mut dyn Bus, reason: &str) -> Result<(), String> {
        let published = self.publish_packing().map_err(|e| e.to_string());
        self.samples.end(bus, self.lockstep.sequence(), self.lockstep.body()).map_err(|e| e.to_string())?;
        self.publish_run_state(RunState::FAILED, reason);
        let delivered = self.deliver_all(bus);
        self.flush_last_messages(bus);
        published?;
        if delivered.map_err(|e| e.to_string())? {
            return Ok(());
        }
        let (lacking, time) = (self.send_queue.packings.waited_for(), SAVED_WITHIN.as_secs());
        Err(format!("{lacking} readers do not have the whole packing after {time} s"))
    }

    /// Delivers all queued messages; true if every reader that is waited for has them.
    fn deliver_all(&mut self, bus: &mut dyn Bus) -> Result<bool, BusError> {
        let begin = bus.now();
        for limit in [EARLIER, SAVED_WITHIN] {
            self.send_queue.deliver(bus)?;
            while !self.send_queue.is_empty() && bus.now() < begin + limit {
                bus.wait(HOLD);
                self.send_queue.deliver(bus)?;
            }
            if self.send_queue.is_empty() {
                return Ok(true);
            }
            if limit == EARLIER {
                self.send_queue.flush(bus)?;
            }
        }
        Ok(false)
    }

    pub(crate) fn flush_last_messages(&self, bus: &mut dyn Bus) {
        if !bus.flush(FLUSH_LIMIT) {
            log::warn!("a reader has not acknowledged the last messages");
        }
    }
}

impl Node for DemSimulator {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        let now = bus.now();
        self.receive_run_states(bus, now)?;
        self.inversions.receive(bus)?;
        if let Some(reason) = self.receive_answers(bus, now)? {
            return self.fail(bus, &reason);
        }
        self.publish_progress(now);
        self.samples.offer_state(bus, &self.run)?;
        if !self.send_queue.deliver(bus)? {
            return Ok(Next::Wait(HOLD));
        }
        let next = match self.stage {
            Stage::Starting => self.start(bus, now),
            Stage::Running if self.send_queue.goes_first(now, self.advance) => Ok(Next::Wait(HOLD)),
            Stage::Running => self.exchange(bus, now),
            Stage::Finished => self.wait_after_end(bus),
        }?;
        Ok(match next {
            // A message of a reader ends a wait by itself; its absence is found at the end of this time.
            Next::Wait(time) if self.send_queue.is_under_way() => {
                Next::Wait(time.min(BulkPublisher::patience()))
            }
            next => next,
        })
    }

    fn health(&self) -> Health {
        let phase = self.run.path().phase(self.run.scene()).map_or("none", |p| p.name.as_str());
        let (counts, steps) =
            (self.lockstep.counts, self.run.engine().steps().saturating_sub(self.first_step));
        let is_running = self.stage == Stage::Running;
        let share = self.run.phase_share().filter(|_| is_running);
        let unmet = if is_running { self.run.unmet() } else { String::new() };
        let computing = self.computing.as_secs_f64();
        let particle_steps = steps as f64 * f64::from(self.run.scene().grains);
        let message = match self.stage {
            Stage::Starting if self.awaited.is_empty() => "starting".into(),
            Stage::Starting => format!("waiting for {}", self.awaited),
            Stage::Running => format!("phase {phase}"),
            Stage::Finished => "finished".into(),
        };
        Health::ok(message)
            .with_phase(&PhaseReport { name: phase.to_owned(), share, unmet })
            .with("step", self.run.engine().steps())
            .with("steps", steps)
            .with("scene", &self.run.scene().name)
            .with("grains", self.run.scene().grains)
            .with("exchanges", counts.exchanges)
            .with("foreseen", self.foreseen)
            .with("resends", counts.resends)
            .with("refused", counts.refused)
            .with("stale", counts.stale)
            .with("contradictions", counts.contradictions)
            .with("other_servos", self.partner.ignored)
            .with("held_up", self.send_queue.held_up)
            .with("packings", self.packings.count)
            .with("readers_left_behind", self.send_queue.packings.left_behind())
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
                let step = self.run.engine().steps();
                match self.save(bus, "interrupted") {
                    Ok(()) => log::info!("the state of step {step} is saved as a packing"),
                    Err(error) => log::error!("the state of step {step} could not be saved: {error}"),
                }
                Ok(Exit::Interrupted)
            }
            Stage::Finished => {
                self.flush_last_messages(bus);
                Ok(Exit::Done)
            }
        }
    }
}
