//! The node.

use crate::barrier::{Barrier, REFUSALS_ALLOWED};
use crate::messages::{self, Packings};
use crate::outbox::Outbox;
use crate::rivals::{Rivals, Verdict};
use crate::settings::{Mode, Settings};
use dem::{Advanced, DemError, Simulation};
use grainlab_msgs::boundary::StrainRateAnswer;
use grainlab_msgs::msg::{Packing, RunState, StrainRate, Stress};
use grainlab_msgs::rosgraph_msgs::Clock;
use grainlab_msgs::tf2_msgs::TFMessage;
use grainlab_msgs::{Message, to_cdr, topics};
use node_kit::{Bus, BusError, Demand, Exit, Health, Next, Node, NodeError, Publisher, Subscription};
use scene::Scene;
use std::time::Duration;

/// Period of `run_state` where nothing happens, wall time.
const BEAT: Duration = Duration::from_secs(1);
/// Least period of `/clock`, wall time.
const CLOCK_PERIOD: Duration = Duration::from_millis(10);
/// How often a start that waits looks again and how often it says what it waits for.
const LOOK_AGAIN: Duration = Duration::from_millis(50);
const NOTICE_PERIOD: Duration = Duration::from_secs(5);
/// How long an outbox that a slow reader holds up rests.
const HOLD: Duration = Duration::from_millis(5);
/// How long the last messages may take to be acknowledged.
const FAREWELL: Duration = Duration::from_secs(2);

/// Why there is no simulator.
#[derive(Debug, thiserror::Error)]
pub enum SimulatorError {
    /// The scene cannot be set up, or the packing is no state of it.
    #[error(transparent)]
    Dem(#[from] DemError),
    /// The topics cannot be had.
    #[error(transparent)]
    Bus(#[from] BusError),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Looks for rivals, readers and a servo.
    Starting,
    /// Asks and obeys.
    Running,
    /// The loading path is done.
    Finished,
}

/// The simulator: owns the run and moves only when it is answered.
pub struct DemSimulator {
    run: Simulation,
    settings: Settings,
    stress: Publisher<Stress>,
    packing: Publisher<Packing>,
    run_state: Publisher<RunState>,
    clock: Publisher<Clock>,
    strain_rate: Subscription<StrainRate>,
    run_states: Subscription<RunState>,
    stage: Stage,
    rivals: Rivals,
    barrier: Barrier,
    outbox: Outbox,
    packings: Packings,
    /// The packing that the run goes on from, until it is published again for those who missed it.
    resumed: bool,
    born: Duration,
    began: Duration,
    first_step: u64,
    computing: Duration,
    /// From the first request to the latest answer obeyed.
    wall: Duration,
    next_beat: Duration,
    next_clock: Duration,
    next_notice: Duration,
}

impl DemSimulator {
    /// A simulator at the beginning of `scene`, or where `resume` was published: a packing and the run state in it.
    pub fn new(
        bus: &mut dyn Bus,
        scene: Scene,
        resume: Option<(grains::Packing, Vec<u8>)>,
        settings: Settings,
    ) -> Result<Self, SimulatorError> {
        let (run, packings) = match &resume {
            Some((packing, state)) => {
                let run = Simulation::resume(scene, packing, state)?;
                let count = u32::try_from(run.packings()).unwrap_or(u32::MAX);
                (run, Packings { last_step: packing.step, count })
            }
            None => (Simulation::new(scene)?, Packings::default()),
        };
        let stress = Publisher::advertise(bus, &topics::STRESS)?;
        let packing = Publisher::advertise(bus, &topics::PACKING)?;
        let run_state = Publisher::advertise(bus, &topics::RUN_STATE)?;
        let clock = Publisher::advertise(bus, &topics::CLOCK)?;
        let frames: Publisher<TFMessage> = Publisher::advertise(bus, &topics::TF_STATIC)?;
        let strain_rate = Subscription::subscribe(bus, &topics::STRAIN_RATE, Demand::best_effort(64))?;
        let run_states = Subscription::subscribe(bus, &topics::RUN_STATE, Demand::reliable(16))?;
        frames.publish(bus, &messages::frames())?;
        let own = bus.published().first().map_or([0; 12], |p| p.writer.participant());
        let now = bus.now();
        Ok(Self {
            stress,
            packing,
            run_state,
            clock,
            strain_rate,
            run_states,
            stage: Stage::Starting,
            rivals: Rivals::new(own),
            barrier: Barrier::new(&settings),
            outbox: Outbox::default(),
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

    fn post<T: Message>(&mut self, publisher: node_kit::PublisherId, message: &T) {
        self.outbox.post(publisher, to_cdr(message));
    }

    fn post_run_state(&mut self, state: u8, text: &str) {
        let message = messages::run_state(&self.run, state, self.packings, text);
        self.post(self.run_state.id(), &message);
    }

    /// The packing as it is now, once.
    fn post_packing(&mut self) -> Result<(), grains::PackingError> {
        let message = messages::packing(&self.run)?;
        self.packings = Packings { last_step: message.step, count: self.packings.count.saturating_add(1) };
        self.post(self.packing.id(), &message);
        Ok(())
    }

    /// Progress once a second, simulated time at most every hundredth.
    fn beat(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<(), BusError> {
        if now >= self.next_clock {
            self.next_clock = now + CLOCK_PERIOD;
            self.clock.publish(bus, &messages::clock(&self.run))?;
        }
        if now >= self.next_beat {
            self.next_beat = now + BEAT;
            let state = if self.stage == Stage::Finished { RunState::FINISHED } else { RunState::RUNNING };
            self.post_run_state(state, if self.stage == Stage::Starting { "starting" } else { "" });
        }
        Ok(())
    }

    fn hear_rivals(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<(), BusError> {
        while let Some((_, info)) = self.run_states.take_valid(bus)? {
            if self.rivals.hear(info.writer, now) && self.stage != Stage::Starting {
                log::error!(
                    "a second simulator ({}) speaks on our topics; it should end by itself",
                    info.writer
                );
            }
        }
        Ok(())
    }

    /// Whether it is time to say again what is waited for.
    fn notice_due(&mut self, now: Duration) -> bool {
        let due = now >= self.next_notice;
        if due {
            self.next_notice = now + NOTICE_PERIOD;
        }
        due
    }

    fn start(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<Next, NodeError> {
        let looked = now.saturating_sub(self.born);
        if looked < self.settings.look_around {
            return Ok(Next::Wait(self.settings.look_around - looked));
        }
        match self.rivals.verdict(&bus.foreign_writers(&topics::STRESS), now) {
            Verdict::Clear => {}
            Verdict::Wait(writer) => {
                if self.notice_due(now) {
                    log::warn!(
                        "another writer of stress ({writer}) is there and silent; waiting for it to speak or go"
                    );
                }
                return Ok(Next::Wait(LOOK_AGAIN));
            }
            Verdict::Refuse(writer) => {
                let message = format!(
                    "another simulator (writer {writer}) is on topic stress; two would mix their runs. Stop it, or start \
                     this one in another ROS_DOMAIN_ID or namespace (--ros-args -r __ns:=/other)"
                );
                return Err(NodeError::new(Exit::Failure, message));
            }
        }
        if let Some(missing) = self.missing(bus) {
            if self.notice_due(now) {
                log::info!("waiting for {missing}");
            }
            return Ok(Next::Wait(LOOK_AGAIN));
        }
        self.began = now;
        if std::mem::take(&mut self.resumed) {
            let message = messages::packing(&self.run)
                .map_err(|e| NodeError::new(Exit::PhysicsInvalid, e.to_string()))?;
            self.post(self.packing.id(), &message);
        }
        self.go_on(bus, now)
    }

    /// What the start still lacks.
    fn missing(&self, bus: &dyn Bus) -> Option<String> {
        for topic in &self.settings.wait_for {
            let publisher = match topic.name {
                name if name == topics::STRESS.name => self.stress.id(),
                name if name == topics::PACKING.name => self.packing.id(),
                _ => self.run_state.id(),
            };
            let (found, needed) = (bus.readers(publisher), self.settings.min_readers);
            if found < needed {
                return Some(format!("{needed} readers of {}; there are {found}", topic.name));
            }
        }
        let servo = bus.readers(self.stress.id()) > 0 && bus.writers(self.strain_rate.id()) > 0;
        (!servo).then(|| {
            "a servo: a reader of stress that writes strain_rate (same domain and namespace?)".into()
        })
    }

    /// The next request, or the end.
    fn go_on(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<Next, NodeError> {
        let Some(request) = self.run.request() else {
            self.stage = Stage::Finished;
            self.next_beat = now + BEAT;
            self.post_run_state(RunState::FINISHED, "");
            log::info!("the loading path is done at step {}", self.run.engine().steps());
            return self.rest(bus);
        };
        let message = match messages::stress(&request) {
            Ok(message) => message,
            Err(error) => return self.fail(bus, &error.to_string()),
        };
        self.stage = Stage::Running;
        let body = to_cdr(&message);
        self.outbox.post(self.stress.id(), body.clone());
        self.barrier.ask(request.sequence, message.header.stamp, body, now);
        let delivered = self.outbox.deliver(bus)?;
        // Free run needs no answer to go on.
        let free = self.settings.mode != Mode::Lockstep;
        Ok(match delivered {
            false => Next::Wait(HOLD),
            true if free => Next::Again,
            true => Next::Wait(self.barrier.patience(now)),
        })
    }

    /// One exchange at most.
    fn exchange(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<Next, NodeError> {
        while let Some((message, info)) = self.strain_rate.take_valid(bus)? {
            match StrainRateAnswer::try_from(&message) {
                Ok(answer) => self.barrier.hear(&answer),
                Err(error) => {
                    bus.count_refused(self.strain_rate.id());
                    let over = self.barrier.refuse(now);
                    if over || self.barrier.counts.refused.is_power_of_two() {
                        log::warn!("answer {} of writer {}: {error}", message.sequence, info.writer);
                    }
                    if over {
                        let text = format!(
                            "{REFUSALS_ALLOWED} answers in a row were refused, the last one: {error}"
                        );
                        return self.fail(bus, &text);
                    }
                }
            }
        }
        if let Some(rate) = self.barrier.pass(now) {
            let result = self.run.answer(&rate);
            self.computing += bus.now().saturating_sub(now);
            return match result {
                Ok(advanced) => self.advanced(bus, &advanced),
                Err(error) => self.fail(bus, &error.to_string()),
            };
        }
        if let Some(body) = self.barrier.resend(now) {
            match bus.publish(self.stress.id(), body) {
                // It is due again anyway.
                Ok(_) | Err(BusError::Full { .. }) => {}
                Err(error) => return Err(error.into()),
            }
        }
        if self.barrier.waited(now) > NOTICE_PERIOD && self.notice_due(now) {
            let waited = self.barrier.waited(now).as_secs();
            log::warn!(
                "no answer to request {} for {waited} s: is servo_controller running?",
                self.barrier.sequence()
            );
        }
        Ok(Next::Wait(self.barrier.patience(now)))
    }

    fn advanced(&mut self, bus: &mut dyn Bus, advanced: &Advanced) -> Result<Next, NodeError> {
        let now = bus.now();
        self.wall = now.saturating_sub(self.began);
        if advanced.packing_due
            && let Err(error) = self.post_packing()
        {
            return self.fail(bus, &error.to_string());
        }
        if let Some(phase) = &advanced.ended {
            log::info!("phase {phase} ended at step {}", self.run.engine().steps());
            if !advanced.finished {
                self.next_beat = now + BEAT;
                self.post_run_state(RunState::RUNNING, "");
            }
        }
        self.go_on(bus, now)
    }

    fn rest(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        if !self.outbox.deliver(bus)? {
            return Ok(Next::Wait(HOLD));
        }
        if self.settings.exit_when_finished {
            self.farewell(bus);
            return Ok(Next::Finished(Exit::Done));
        }
        Ok(Next::Wait(self.next_beat.saturating_sub(bus.now())))
    }

    /// Saves the last finite state and ends. A failing run is back there by itself.
    fn fail(&mut self, bus: &mut dyn Bus, reason: &str) -> Result<Next, NodeError> {
        self.save(bus, reason)?;
        let step = self.run.engine().steps();
        let message = format!("{reason}. The state of step {step} is saved as the last packing");
        Err(NodeError::new(Exit::PhysicsInvalid, message))
    }

    fn save(&mut self, bus: &mut dyn Bus, reason: &str) -> Result<(), BusError> {
        if let Err(error) = self.post_packing() {
            log::error!("the state cannot be saved: {error}");
        }
        self.post_run_state(RunState::FAILED, reason);
        let until = bus.now() + FAREWELL;
        while !self.outbox.deliver(bus)? && bus.now() < until {
            bus.wait(HOLD);
        }
        self.farewell(bus);
        Ok(())
    }

    fn farewell(&self, bus: &mut dyn Bus) {
        if !bus.flush(FAREWELL) {
            log::warn!("a reader has not acknowledged the last messages");
        }
    }
}

impl Node for DemSimulator {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        let now = bus.now();
        self.hear_rivals(bus, now)?;
        self.beat(bus, now)?;
        if !self.outbox.deliver(bus)? {
            return Ok(Next::Wait(HOLD));
        }
        match self.stage {
            Stage::Starting => self.start(bus, now),
            Stage::Running => self.exchange(bus, now),
            Stage::Finished => self.rest(bus),
        }
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
            .with("resends", counts.resends)
            .with("refused", counts.refused)
            .with("stale", counts.stale)
            .with("held_up", self.outbox.held_up())
            .with("packings", self.packings.count)
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
