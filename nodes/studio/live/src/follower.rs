//! The subscriptions of the page, and the run that it follows.

use crate::laboratory::Laboratory;
use grainlab_console::Failure;
use grainlab_msgs::msg::{Microstructure, Packing, PackingReport, RunState, Stress};
use grainlab_msgs::{Message, Topic, from_cdr, topics};
use grainlab_node_kit::{
    BulkSubscription, Bus, BusError, DdsBus, Demand, Graph, Identity, Names, Network, Participant, Peer,
    PeerWatch, RunId, SampleInfo, Scope, Subscription, run_of,
};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

pub(crate) const NODE: &str = "grainlab_live";

/// Samples that may wait for this process.
const DEPTH: u32 = 256;

/// Packings that may wait for this process.
const PACKINGS: u32 = 4;

/// Further runs are counted up to this number, and forgotten when they are silent for this long.
const OTHERS: usize = 64;
const FORGOTTEN: Duration = Duration::from_secs(5);

/// Silence after which another run is followed instead.
const ABANDONED: Duration = Duration::from_secs(15);

pub(crate) struct Follower {
    bus: DdsBus,
    clock: Instant,
    pub(crate) domain: u16,
    stress: Subscription<Stress>,
    run_state: Subscription<RunState>,
    packings: BulkSubscription,
    states: Subscription<Packing>,
    packing_reports: Subscription<PackingReport>,
    microstructure: Subscription<Microstructure>,
    watch: PeerWatch,
    /// The simulator of the run, once heard.
    simulator: Option<Participant>,
    others: BTreeMap<Option<RunId>, Duration>,
}

impl Follower {
    /// Joins a network. Times of laboratories are those since `clock`, because they outlast a bus.
    pub(crate) fn join(network: Network, names: Names, clock: Instant) -> Result<Self, Failure> {
        // With a run of its own it is a stranger to every process, also to those started by hand: nobody waits for it.
        let identity = Identity { run: Some(RunId::fresh()), scope: Scope::Everyone, ..Identity::default() };
        let bus = DdsBus::join(network, names, identity).map_err(Failure::failed)?;
        Self::subscribed(bus, network.domain, clock).map_err(Failure::failed)
    }

    fn subscribed(mut bus: DdsBus, domain: u16, clock: Instant) -> Result<Self, BusError> {
        fn latched<T: Message>(bus: &mut DdsBus, topic: &Topic) -> Result<Subscription<T>, BusError> {
            Subscription::subscribe(bus, topic, Demand::reliable(16))
        }
        Ok(Self {
            clock,
            domain,
            stress: Subscription::subscribe(&mut bus, &topics::STRESS_SAMPLED, Demand::best_effort(DEPTH))?,
            // Repeated once a second.
            run_state: Subscription::subscribe(&mut bus, &topics::RUN_STATE, Demand::best_effort(16))?,
            packings: BulkSubscription::subscribe(&mut bus, &topics::PACKING, Demand::reliable(PACKINGS))?,
            states: Subscription::subscribe(&mut bus, &topics::PACKING_SAMPLED, Demand::best_effort(1))?,
            packing_reports: latched(&mut bus, &topics::PACKING_REPORT)?,
            microstructure: latched(&mut bus, &topics::MICROSTRUCTURE)?,
            watch: PeerWatch::subscribe(&mut bus)?,
            simulator: None,
            others: BTreeMap::new(),
            bus,
        })
    }

    pub(crate) fn wait(&mut self, time: Duration) {
        let patience = self.packings.patience(self.bus.now());
        self.bus.wait(time.min(patience));
    }

    /// Time since `clock`.
    pub(crate) fn now(&self) -> Duration {
        self.clock.elapsed()
    }

    /// Time of the bus, which reports have.
    pub(crate) fn bus_now(&self) -> Duration {
        self.bus.now()
    }

    /// All processes that report.
    pub(crate) fn peers(&self) -> impl Iterator<Item = &Peer> {
        self.watch.iter()
    }

    /// Number of runs on the bus that are not followed.
    pub(crate) fn others(&self) -> usize {
        self.others.len()
    }

    pub(crate) fn take(&mut self, laboratory: &mut Option<Laboratory>) -> Result<(), BusError> {
        let now = self.now();
        while let Some((message, info)) = self.run_state.take_valid(&mut self.bus)? {
            if let Some(known) = self.of_simulator(laboratory, &info, now) {
                known.run_state(&message, now);
            }
        }
        while let Some((message, info)) = self.stress.take_valid(&mut self.bus)? {
            if let Some(known) = self.of_simulator(laboratory, &info, now) {
                known.request(&message, now);
            }
        }
        while let Some(sample) = self.packings.take(&mut self.bus)? {
            if let Some(known) = self.of_simulator(laboratory, &sample.info, now) {
                match from_cdr::<Packing>(&sample.body) {
                    Ok(message) => known.packing(&message),
                    Err(_) => known.refused += 1,
                }
            }
        }
        while let Some((message, info)) = self.states.take_valid(&mut self.bus)? {
            if let Some(known) = self.of_simulator(laboratory, &info, now) {
                known.state_of_grains(&message);
            }
        }
        while let Some((message, info)) = self.packing_reports.take_valid(&mut self.bus)? {
            let run = run_of(&info.writer.participant());
            laboratory.iter_mut().filter(|l| l.run == run).for_each(|l| l.packing_report(&message));
        }
        while let Some((message, info)) = self.microstructure.take_valid(&mut self.bus)? {
            let run = run_of(&info.writer.participant());
            laboratory.iter_mut().filter(|l| l.run == run).for_each(|l| l.microstructure(&message));
        }
        let simulator = self.simulator;
        self.watch.update(&mut self.bus, |info, report| {
            let ours = simulator == Some(info.writer.participant());
            laboratory.iter_mut().filter(|_| ours).for_each(|l| l.simulator(report, now));
        })?;
        self.others.retain(|_, heard| now.saturating_sub(*heard) < FORGOTTEN);
        if let (Some(simulator), Some(known)) = (self.simulator, laboratory) {
            let present = self.bus.foreign_writers(&topics::RUN_STATE);
            // After a restart the next simulator is heard within a moment.
            if known.silence(now) > FORGOTTEN && !present.iter().any(|w| w.participant() == simulator) {
                known.left();
            }
        }
        Ok(())
    }

    /// The run that a message of a simulator is about; `None` if another run is followed.
    fn of_simulator<'a>(
        &mut self,
        laboratory: &'a mut Option<Laboratory>,
        info: &SampleInfo,
        now: Duration,
    ) -> Option<&'a mut Laboratory> {
        let sender = info.writer.participant();
        let run = run_of(&sender);
        let is_known = self.simulator == Some(sender);
        let same_run = laboratory.as_ref().is_some_and(|l| l.run == run);
        let is_over = laboratory.as_ref().is_none_or(|l| l.end.is_some() || l.silence(now) > ABANDONED);
        // Launched runs have different ids; of those by hand, another simulator after the end is another run.
        let is_next = if run.is_some() { !same_run && is_over } else { !is_known && is_over };
        if is_next {
            *laboratory = Some(Laboratory::new(run, now));
            self.others.remove(&run);
        } else if !same_run {
            if self.others.len() < OTHERS {
                self.others.insert(run, now);
            }
            return None;
        }
        self.simulator = Some(sender);
        laboratory.as_mut()
    }
}
