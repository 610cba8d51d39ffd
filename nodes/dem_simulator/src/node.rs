//! The node.

use crate::ahead::{self, Ahead};
use crate::barrier::Barrier;
use crate::messages::{self, Packings};
use crate::outbox::Outbox;
use crate::partner::Partner;
use crate::rivals::Rivals;
use crate::settings::{Mode, Settings};
use grainlab_dem::ComputeError;
use grainlab_experiment::{ExperimentError, Simulation};
use grainlab_msgs::msg::{RunState, StrainRate, Stress};
use grainlab_msgs::rosgraph_msgs::Clock;
use grainlab_msgs::tf2_msgs::TFMessage;
use grainlab_msgs::{to_cdr, topics};
use grainlab_node_kit::admission::Participant;
use grainlab_node_kit::{
    BulkPublisher, Bus, BusError, Demand, Exit, Health, Next, Node, NodeError, Publisher, Subscription,
};
use grainlab_scene::Scene;
use std::time::Duration;

/// Period of `run_state` where nothing happens, wall time.
pub(crate) const BEAT: Duration = Duration::from_secs(1);
/// Least period of `/clock`, wall time.
const CLOCK_PERIOD: Duration = Duration::from_millis(10);
/// How often a run that waits says what it waits for.
pub(crate) const NOTICE_PERIOD: Duration = Duration::from_secs(5);
/// How long an outbox that a slow reader holds up rests.
pub(crate) const HOLD: Duration = Duration::from_millis(5);
/// How long the delivery of a state that is saved may take: less than the launcher's patience.
const SAVING: Duration = Duration::from_secs(4);
/// How long the last messages may take to be acknowledged.
const FAREWELL: Duration = Duration::from_secs(2);

/// Why there is no simulator.
#[derive(Debug, thiserror::Error)]
pub enum SimulatorError {
    /// The scene cannot be set up, or the packing is no state of it.
    #[error(transparent)]
    Run(#[from] ExperimentError),
    /// The processor cannot do what it was told to.
    #[error(transparent)]
    Compute(#[from] ComputeError),
    /// The topics cannot be had.
    #[error(transparent)]
    Bus(#[from] BusError),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    /// Looks for rivals, readers and a servo.
    Starting,
    /// Asks and obeys.
    Running,
    /// The loading path is done.
    Finished,
}

/// The simulator: owns the run and moves only when it is answered.
pub struct DemSimulator {
    pub(crate) run: Simulation,
    pub(crate) settings: Settings,
    pub(crate) stress: Publisher<Stress>,
    pub(crate) run_state: Publisher<RunState>,
    pub(crate) clock: Publisher<Clock>,
    pub(crate) strain_rate: Subscription<StrainRate>,
    pub(crate) run_states: Subscription<RunState>,
    pub(crate) stage: Stage,
    pub(crate) rivals: Rivals,
    pub(crate) participant: Participant,
    pub(crate) barrier: Barrier,
    pub(crate) partner: Partner,
    /// The run as it will be if the answer is the one that the law gives.
    pub(crate) ahead: Option<Ahead>,
    /// Whether that is computed: not any more once a servo has answered otherwise.
    pub(crate) looks_ahead: bool,
    /// Answers that came as they were computed with.
    pub(crate) foreseen: u64,
    pub(crate) outbox: Outbox,
    pub(crate) packings: Packings,
    /// The packing that the run goes on from, until it is published again for those who missed it.
    pub(crate) resumed: bool,
    pub(crate) born: Duration,
    pub(crate) began: Duration,
    pub(crate) first_step: u64,
    pub(crate) computing: Duration,
    /// From the first request to the latest answer obeyed.
    pub(crate) wall: Duration,
    pub(crate) next_beat: Duration,
    pub(crate) next_clock: Duration,
    pub(crate) next_notice: Duration,
}

impl DemSimulator {
    /// A simulator at the beginning of `scene`, or where `resume` was published: a packing and the run state in it. A scene
    /// that starts from a packing begins with `resume`, whose run state is then empty.
    pub fn new(
        bus: &mut dyn Bus,
        scene: Scene,
        resume: Option<(grainlab_core::Packing, Vec<u8>)>,
        settings: Settings,
    ) -> Result<Self, SimulatorError> {
        let (mut run, packings) = match &resume {
            Some((packing, state)) if state.is_empty() && scene.start.is_some() => {
                (Simulation::from_packing(scene, packing)?, Packings { last_step: 0, count: 1 })
            }
            Some((packing, state)) => {
                let run = Simulation::resume(scene, packing, state)?;
                let count = u32::try_from(run.packings()).unwrap_or(u32::MAX);
                (run, Packings { last_step: packing.step, count })
            }
            None => (Simulation::new(scene)?, Packings::default()),
        };
        run.set_compute(settings.compute(run.scene().grains as usize)?);
        let stress = Publisher::advertise(bus, &topics::STRESS)?;
        let packing = BulkPublisher::advertise(bus, &topics::PACKING)?;
        let run_state = Publisher::advertise(bus, &topics::RUN_STATE)?;
        let clock = Publisher::advertise(bus, &topics::CLOCK)?;
        let frames: Publisher<TFMessage> = Publisher::advertise(bus, &topics::TF_STATIC)?;
        let strain_rate = Subscription::subscribe(bus, &topics::STRAIN_RATE, Demand::best_effort(64))?;
        // A rival says it again every second; a reliable reader of our own topic might fill our own window.
        let run_states = Subscription::subscribe(bus, &topics::RUN_STATE, Demand::best_effort(16))?;
        frames.publish(bus, &messages::frames())?;
        let own_stress = bus.published().first().map(|p| p.writer).unwrap_or_default();
        let now = bus.now();
        Ok(Self {
            stress,
            run_state,
            clock,
            strain_rate,
            run_states,
            stage: Stage::Starting,
            rivals: Rivals::new(own_stress.participant()),
            participant: own_stress.participant(),
            barrier: Barrier::new(&settings),
            partner: Partner::new(own_stress),
            ahead: None,
            looks_ahead: settings.ahead
                && settings.mode == Mode::Lockstep
                && run.scene().grains <= ahead::GRAINS,
            foreseen: 0,
            outbox: Outbox::new(packing),
            packings,
            resumed: resume.is_some(),
            born: now,
            began: now,
            first_step: run.engine().steps(),
            computing: Duration::ZERO,
            wall: Duration::ZERO,
            next_beat: now,
            next_clock: now,
            next_notice: now + NOTICE_PERIOD,
            run,
            settings,
        })
    }

    pub(crate) fn post_run_state(&mut self, state: u8, text: &str) {
        let message = messages::run_state(&self.run, state, self.packings, text);
        self.outbox.post_state(self.run_state.id(), to_cdr(&message));
    }

    /// The packing as it is now, once.
    pub(crate) fn post_packing(&mut self) -> Result<(), grainlab_core::PackingError> {
        let message = messages::packing(&self.run)?;
        self.packings = Packings { last_step: message.step, count: self.packings.count.saturating_add(1) };
        self.outbox.post_packing(to_cdr(&message));
        Ok(())
    }

    /// Progress once a second, simulated time at most every hundredth.
    fn beat(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<(), BusError> {
        // Not before the run begins: who waits for readers would say it to nobody.
        if now >= self.next_clock && self.stage != Stage::Starting {
            self.next_clock = now + CLOCK_PERIOD;
            self.clock.publish(bus, &messages::clock(&self.run))?;
        }
        if now >= self.next_beat {
            self.next_beat = now + BEAT;
            let state = if self.stage == Stage::Finished { RunState::FINISHED } else { RunState::RUNNING };
            let left_out = self.run.left_out();
            self.post_run_state(state, &left_out);
        }
        Ok(())
    }

    /// Whether it is time to say again what is waited for.
    pub(crate) fn notice_due(&mut self, now: Duration) -> bool {
        let due = now >= self.next_notice;
        if due {
            self.next_notice = now + NOTICE_PERIOD;
        }
        due
    }

    /// Saves the last finite state and ends. A failing run is back there by itself.
    pub(crate) fn fail(&mut self, bus: &mut dyn Bus, reason: &str) -> Result<Next, NodeError> {
        let step = self.run.engine().steps();
        let saved = match self.save(bus, reason) {
            Ok(()) => format!("The state of step {step} is saved as the last packing"),
            Err(error) => format!("The state of step {step} could not be saved: {error}"),
        };
        Err(NodeError::new(Exit::PhysicsInvalid, format!("{reason}. {saved}")))
    }

    fn save(&mut self, bus: &mut dyn Bus, reason: &str) -> Result<(), BusError> {
        if let Err(error) = self.post_packing() {
            log::error!("the state cannot be saved: {error}");
        }
        self.post_run_state(RunState::FAILED, reason);
        // Whoever lives has a packing before this one after half the time.
        for hurry in [false, true] {
            if hurry && !self.outbox.is_empty() {
                self.outbox.hurry(bus)?;
            }
            let until = bus.now() + SAVING / 2;
            self.outbox.deliver(bus)?;
            while !self.outbox.is_empty() && bus.now() < until {
                bus.wait(HOLD);
                self.outbox.deliver(bus)?;
            }
        }
        if !self.outbox.is_empty() {
            let lacking = self.outbox.packings().waited_for();
            log::warn!("{lacking} readers do not have the whole last packing after {} s", SAVING.as_secs());
        }
        self.farewell(bus);
        Ok(())
    }

    pub(crate) fn farewell(&self, bus: &mut dyn Bus) {
        if !bus.flush(FAREWELL) {
            log::warn!("a reader has not acknowledged the last messages");
        }
    }
}

impl Node for DemSimulator {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        let now = bus.now();
        self.hear_rivals(bus, now)?;
        if let Some(reason) = self.hear_answers(bus, now)? {
            return self.fail(bus, &reason);
        }
        self.beat(bus, now)?;
        if !self.outbox.deliver(bus)? {
            return Ok(Next::Wait(HOLD));
        }
        let next = match self.stage {
            Stage::Starting => self.start(bus, now),
            Stage::Running => self.exchange(bus, now),
            Stage::Finished => self.rest(bus),
        }?;
        Ok(match next {
            // What a reader says ends a wait by itself; what it does not say has to be noticed.
            Next::Wait(time) if self.outbox.is_under_way() => Next::Wait(time.min(BulkPublisher::patience())),
            next => next,
        })
    }

    fn health(&self) -> Health {
        let phase = self.run.path().phase(self.run.scene()).map_or("none", |p| p.name.as_str());
        let (counts, steps) =
            (self.barrier.counts, self.run.engine().steps().saturating_sub(self.first_step));
        let computing = self.computing.as_secs_f64();
        let particle_steps = steps as f64 * f64::from(self.run.scene().grains);
        let message = match self.stage {
            Stage::Starting => "starting".into(),
            Stage::Running => format!("phase {phase}"),
            Stage::Finished => "finished".into(),
        };
        Health::ok(message)
            .with("phase", phase)
            .with("step", self.run.engine().steps())
            .with("steps", steps)
            .with("exchanges", counts.exchanges)
            .with("foreseen", self.foreseen)
            .with("resends", counts.resends)
            .with("refused", counts.refused)
            .with("stale", counts.stale)
            .with("contradictions", counts.contradictions)
            .with("other_servos", self.partner.ignored())
            .with("held_up", self.outbox.held_up())
            .with("packings", self.packings.count)
            .with("readers_left_behind", self.outbox.packings().left_behind())
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
                self.save(bus, "interrupted; the last packing is where the run stands")?;
                Ok(Exit::Interrupted)
            }
            Stage::Finished => {
                self.farewell(bus);
                Ok(Exit::Done)
            }
        }
    }
}
