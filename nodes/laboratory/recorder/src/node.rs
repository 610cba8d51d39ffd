//! Node that records.

mod account;

use crate::Settings;
use crate::binding::{Binding, Outside};
use crate::discovery::{Finder, FoundTopic};
use crate::disputes::Disputes;
use crate::known_processes::KnownProcesses;
use crate::repeats::{Novelty, Repeats};
use crate::strangers::LeftOut;
use crate::tallies::losses;
use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::{Guid, Qos, Topic, from_cdr, topics};
use grainlab_node_kit::{
    Bus, Demand, Exit, Health, Next, Node, NodeError, Published, Report, Sample, Source, Stranger,
};
use grainlab_recordings::strangers::{self, Authors, StrangerView};
use grainlab_recordings::{Finished, Incoming, Outcome, Recording, RunWriter, TopicSpec, host_name};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::rc::Rc;
use std::time::{Duration, Instant};

/// Maximum number of samples queued while the disk is slow: some seconds of the fastest lockstep. RustDDS
/// keeps as many of each topic, also after they were taken, so that a topic with few or long messages gets
/// fewer.
fn backlog(topic: &Topic) -> u32 {
    match topic.name {
        name if [topics::STRESS.name, topics::STRAIN_RATE.name].contains(&name) => 20_000,
        name if name == topics::PACKING.name => 16,
        name if name == topics::WAVEFORM.name => 512,
        _ => 1_000,
    }
}

/// Maximum number of small samples of a topic, whatever the depth, that RustDDS holds until they are taken: a burst is written
/// by its publisher faster than to a file.
const BURST: u32 = 8192;

/// The same for a topic outside the contract, whose publisher may be a player that waits for nothing but acknowledgements.
const FOREIGN_BURST: u32 = 32_768;

/// Period of the writer's `tick`.
const TICK: Duration = Duration::from_millis(100);

/// Longer than the time before any message is written.
const OLD_ENOUGH: Duration = Duration::from_secs(1);

/// A recorder without a step for this long was stopped by a signal, or its disk was slow.
const STALLED: Duration = Duration::from_secs(2);

/// Time limits for an ending recorder to receive reported messages that it lacks, and for a pause of
/// messages, unless every process has sent its last report.
const LAST_CALL: Duration = Duration::from_secs(2);
const SILENCE: Duration = Duration::from_millis(200);

/// The recording that a recorder finished, for the code that started it.
pub type ResultSlot = Rc<RefCell<Option<Finished>>>;

struct Channel {
    topic: Topic,
    source: Source,
    name: String,
    reports: bool,
    /// A result: written at once.
    write_through: bool,
    of_contract: bool,
}

/// Recorder of one run, or of topics.
pub struct Recorder {
    /// `None` after the end.
    writer: Option<RunWriter>,
    channels: Vec<Channel>,
    /// Resolved names of the channels.
    names: BTreeSet<String>,
    result: ResultSlot,
    whole_run: bool,
    recorded: u64,
    known_processes: KnownProcesses,
    /// For a run whose processes share no run id.
    binding: Option<Binding>,
    /// For the recording of one run.
    repeats: Option<Repeats>,
    contradictions: u64,
    /// Doubts about the recording, those of earlier recorders included.
    disputes: Disputes,
    /// The writer of each result.
    authors: Authors,
    /// The processes that earlier recorders of the run left out.
    noted_strangers: Vec<StrangerView>,
    /// Time of the last step, since the bus was opened.
    stepped: Option<Duration>,
    /// The recorder had no step for [`STALLED`]. It may have missed the last report of a process that left meanwhile.
    stalled: bool,
    finder: Option<Finder>,
    /// Topics outside the contract that are not recorded.
    left_out: LeftOut,
}

impl Recorder {
    /// Subscribes, strongest demand first, and begins the recording.
    pub fn new(bus: &mut dyn Bus, settings: &Settings, result: ResultSlot) -> Result<Self, NodeError> {
        let failed = |e: &dyn std::fmt::Display| NodeError::new(Exit::Failure, e.to_string());
        let mut channels = Vec::new();
        let mut specs = Vec::new();
        for topic in &settings.topics {
            let demand = Demand::reliable(backlog(topic)).with_burst(BURST);
            let asked = settings.others.as_ref().map_or(*topic, |others| others.requested(topic));
            let name = bus.resolve(&asked)?;
            let source = Source::open(bus, &asked, demand)?;
            specs.push(TopicSpec::of_contract(topic, &name));
            let reports = topic.name == topics::DIAGNOSTICS.name;
            let write_through = topic.qos.transient_local && topic.reproducible;
            channels.push(Channel { topic: *topic, source, name, reports, write_through, of_contract: true });
        }
        let directory = settings.directory().map_err(|e| failed(&e))?;
        let name =
            directory.file_name().map_or_else(|| "recording".into(), |n| n.to_string_lossy().into_owned());
        let mut repeats = settings.whole_run.then(Repeats::default);
        let (mut authors, mut noted_strangers) = (Authors::default(), Vec::new());
        let mut disputes = Disputes::new(settings.scene.as_ref().map(|s| s.scene.fingerprint));
        let before = if settings.append { Recording::open(&directory).ok() } else { None };
        if let Some(recording) = &before {
            authors = strangers::authors(recording);
            disputes.lines = strangers::noted_disputes(recording);
            noted_strangers = strangers::strangers(recording);
            if let Some(repeats) = &mut repeats {
                repeats.remember(recording).map_err(|e| failed(&e))?;
            }
        }
        let begin = if settings.append { RunWriter::append } else { RunWriter::create };
        let begun = begin(&directory, &name, &specs, settings.writer.clone());
        let mut writer = begun.map_err(|e| NodeError::new(e.exit, e.to_string()))?;
        if let Some(scene) = &settings.scene {
            writer.attach("scene.toml", "application/toml", scene.text.as_bytes()).map_err(|e| failed(&e))?;
            writer.set_metadata("scene", &scene.scene.name);
            writer.set_metadata("seed", &scene.scene.seed.to_string());
        }
        writer.set_metadata("grainlab", env!("CARGO_PKG_VERSION"));
        if let Some(commit) = option_env!("GRAINLAB_COMMIT") {
            writer.set_metadata("commit", commit);
        }
        writer.set_metadata("transport", bus.transport());
        writer.set_metadata("host", &host_name());
        for channel in channels.iter().filter(|c| !c.topic.reproducible) {
            writer.ledger_mut().count_from_first(&channel.name);
        }
        let run = bus.identity().run;
        if let Some(run) = run {
            writer.set_metadata("run", &run.to_string());
        }
        log::info!("recording to {}", writer.file().display());
        let known_processes = KnownProcesses::default();
        Ok(Self {
            writer: Some(writer),
            names: channels.iter().map(|c| c.name.clone()).collect(),
            channels,
            result,
            whole_run: settings.whole_run,
            recorded: 0,
            known_processes,
            binding: (settings.whole_run && run.is_none()).then(Binding::default),
            repeats,
            contradictions: 0,
            disputes,
            authors,
            noted_strangers,
            stepped: None,
            stalled: false,
            finder: settings.others.clone().map(Finder::new),
            left_out: LeftOut::default(),
        })
    }

    /// Subscribes to the topics outside the contract that appeared, and declares them.
    fn find(&mut self, bus: &mut dyn Bus) -> Result<(), NodeError> {
        let (Some(finder), Some(writer)) = (&mut self.finder, &mut self.writer) else { return Ok(()) };
        for FoundTopic { topic, spec } in finder.look(bus, &self.names) {
            let Qos { reliable, depth, .. } = topic.qos;
            let demand = Demand { reliable, ..Demand::best_effort(depth).with_burst(FOREIGN_BURST) };
            let source = Source::open(bus, &topic, demand)?;
            writer.add_topic(&spec).map_err(|e| lost(&e))?;
            writer.ledger_mut().count_from_first(&spec.name);
            self.names.insert(spec.name.clone());
            let (name, of_contract) = (spec.name, false);
            self.channels.push(Channel {
                topic,
                source,
                name,
                reports: false,
                write_through: false,
                of_contract,
            });
        }
        Ok(())
    }

    /// Records all samples that arrived; true if there were any.
    fn take_all(&mut self, bus: &mut dyn Bus) -> Result<bool, NodeError> {
        let Some(writer) = self.writer.as_mut() else { return Ok(false) };
        let mut any = false;
        for channel in &mut self.channels {
            while let Some(sample) = channel.source.take(bus)? {
                any = true;
                let (topic, info) = (&channel.topic, &sample.info);
                if let Some(binding) = &mut self.binding
                    && let Err(outside) = binding.takes(topic, info, |t| bus.foreign_writers(t))
                {
                    let who = bus.describe(info.writer);
                    if outside == Outside::Second {
                        self.disputes.second(topic.name, &who.to_string());
                    }
                    note_outside(outside, topic, who, binding);
                    writer.ledger_mut().leave_out(&channel.name, info.writer, info.sequence);
                    continue;
                }
                // Other programs send no reports.
                if channel.of_contract {
                    self.known_processes.note_writer(sample.info.writer);
                }
                if channel.reports && enter_reports(writer, &self.names, &sample) {
                    self.known_processes.left.insert(sample.info.writer.participant());
                }
                if self.whole_run {
                    match topic.name {
                        // Processes without a run may be of another laboratory.
                        name if name == topics::DIAGNOSTICS.name && bus.identity().run.is_some() => {
                            self.disputes.report(&sample, |who| bus.describe(who).to_string());
                        }
                        name if name == topics::PACKING.name => self.disputes.packing(&sample),
                        _ => {}
                    }
                }
                let incoming = incoming(&sample);
                let novelty = self.repeats.as_mut().map_or(Novelty::New, |repeats| {
                    let there = |writer: &Guid| bus.foreign_writers(topic).contains(writer);
                    repeats.enter(topic, sample.info.writer, &sample.body, there)
                });
                if novelty != Novelty::New {
                    let ledger = writer.ledger_mut();
                    if novelty == Novelty::Repeat {
                        ledger.repeat(&channel.name, incoming.guid, incoming.sequence);
                    }
                    if let Novelty::Contradiction { number } = novelty {
                        ledger.conflict(&channel.name, incoming.guid, incoming.sequence);
                        self.contradictions += 1;
                        if self.contradictions.is_power_of_two() {
                            let who = bus.describe(sample.info.writer);
                            log::error!(
                                "{}: message {number} of {who} is not the one that was recorded under this number: it is \
                                 left out ({} so far)",
                                channel.name,
                                self.contradictions
                            );
                        }
                    }
                    continue;
                }
                let outcome = writer.write(&channel.name, &incoming).map_err(|e| lost(&e))?;
                self.recorded += 1;
                if channel.write_through {
                    if let Outcome::Recorded { log_time } = outcome {
                        self.authors.enter(&channel.name, log_time, incoming.guid);
                    }
                    // With this time the writer counts all queued messages as old enough.
                    writer.tick(Instant::now() + OLD_ENOUGH).map_err(|e| lost(&e))?;
                }
            }
        }
        writer.tick(Instant::now()).map_err(|e| lost(&e))?;
        Ok(any)
    }

    /// Waits for messages known to be in transit, then for a short pause if any process may still publish.
    fn last_call(&mut self, bus: &mut dyn Bus) -> Result<(), NodeError> {
        self.known_processes.own = bus.published().first().map(|p| p.writer.participant());
        let end = bus.now() + LAST_CALL;
        let mut quiet_since = bus.now();
        loop {
            let now = bus.now();
            if self.take_all(bus)? {
                quiet_since = now;
            }
            let outstanding = self.writer.as_ref().map_or(0, |w| w.ledger().outstanding());
            let settled = || {
                self.known_processes.all_left(&bus.foreign_writers(&topics::DIAGNOSTICS))
                    || now - quiet_since >= SILENCE
            };
            if now >= end || (outstanding == 0 && settled()) {
                return Ok(());
            }
            bus.wait(Duration::from_millis(20));
        }
    }
}

fn incoming(sample: &Sample) -> Incoming<'_> {
    Incoming {
        guid: sample.info.writer,
        sequence: sample.info.sequence,
        source_time: sample.info.source_time,
        receive_time: sample.info.received,
        payload: &sample.body,
    }
}

/// Logs a process whose messages are left out, once for each kind of message.
fn note_outside(outside: Outside, topic: &Topic, who: Stranger, binding: &Binding) {
    let first =
        binding.ignored().get(&who.participant).is_some_and(|topics| topics.get(topic.name) == Some(&1));
    if !first {
        return;
    }
    match outside {
        Outside::Stranger => log::warn!("{}: {who} is not of this run and is left out", topic.name),
        Outside::Second => log::error!(
            "{}: {who} publishes about this run in addition to the first process: its messages are left out",
            topic.name
        ),
    }
}

/// A recording that cannot continue has lost data.
fn lost(error: &dyn std::fmt::Display) -> NodeError {
    NodeError::new(Exit::DataLoss, error.to_string())
}

/// Passes the counts of a report to the recording, with the node's name; true for the last report of a process.
fn enter_reports(writer: &mut RunWriter, recorded: &BTreeSet<String>, sample: &Sample) -> bool {
    let Ok(message) = from_cdr::<DiagnosticArray>(&sample.body) else { return false };
    let mut is_last_report = false;
    for report in Report::from_message(&message) {
        // A replayed report refers to writers that do not exist.
        let own = |p: &&Published| p.writer.participant() == sample.info.writer.participant();
        is_last_report |= report.is_final() && report.published.iter().any(|p| own(&p));
        for published in report.published.iter().filter(own) {
            let guid = published.writer;
            writer.ledger_mut().name(guid, &report.node);
            // Topics that are not recorded are not counted.
            if recorded.contains(&published.topic) {
                writer.ledger_mut().report(&published.topic, guid, published.count);
            }
        }
    }
    is_last_report
}

impl Node for Recorder {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        let now = bus.now();
        let last = self.stepped.replace(now).unwrap_or(now);
        if now.saturating_sub(last) > STALLED {
            self.stalled = true;
            log::warn!(
                "nothing was recorded for {:.1} s: the recorder was stopped, or its disk was slow",
                (now - last).as_secs_f64()
            );
        }
        // Once a second.
        if self.finder.is_none() && last.as_secs() != now.as_secs() {
            self.left_out.look(bus, &self.names);
        }
        if let Err(error) = self.find(bus).and_then(|()| self.take_all(bus)) {
            // The writer completes the file if it still can.
            self.describe_processes(bus)?;
            return Err(error);
        }
        Ok(Next::Wait(TICK))
    }

    fn health(&self) -> Health {
        let lost: u64 = self.writer.as_ref().map_or(0, |w| w.ledger().tallies().iter().map(|t| t.lost).sum());
        let text = grainlab_console::count(self.recorded, "message");
        if lost == 0 { Health::ok(text) } else { Health::warn(text) }
            .with("recorded", self.recorded)
            .with("missing", lost)
    }

    /// Finishes the file. What this process publishes after that is not recorded.
    fn on_shutdown(&mut self, bus: &mut dyn Bus) -> Result<Exit, NodeError> {
        self.note_announcements(bus);
        let called = self.last_call(bus);
        let missing = self.known_processes.missing(&bus.foreign_writers(&topics::DIAGNOSTICS));
        self.describe_processes(bus)?;
        called?;
        let Some(writer) = self.writer.take() else { return Ok(Exit::Done) };
        let finished = writer.finish().map_err(|e| lost(&e))?;
        let tallies = finished.ledger.tallies();
        let has_mixed_types = self.finder.as_ref().is_some_and(|f| f.report_missing(&self.names, &tallies));
        let (before, after) = losses(&tallies);
        *self.result.borrow_mut() = Some(finished);
        if before > 0 && !self.whole_run {
            log::info!("{before} messages were published before the recording began");
        }
        let lost = if self.whole_run { before + after } else { after };
        if lost > 0 {
            log::error!("{lost} messages were published and are not in the recording");
            return Ok(Exit::DataLoss);
        }
        let refused: u64 = bus.received().iter().map(|r| r.refused).sum();
        if refused > 0 && !self.whole_run {
            log::error!(
                "{refused} messages could not be read, and are not in the recording: the reasons are above"
            );
            return Ok(Exit::DataLoss);
        }
        if self.stalled && missing > 0 && !self.whole_run {
            log::error!(
                "{missing} processes left without a last report, and the recorder was stopped for a while: the number of their \
                 missing messages is not known"
            );
            return Ok(Exit::DataLoss);
        }
        if self.disputes.of_scene {
            return Ok(Exit::Failure);
        }
        if has_mixed_types {
            return Ok(Exit::DataLoss);
        }
        if self.disputes.of_processes || self.contradictions > 0 {
            log::error!(
                "messages of one run contradict each other; the lines above name their processes. If these are two, start each run \
                 with a name of its own (GRAINLAB_RUN); if it is one, it sent two different messages in one place"
            );
            return Ok(Exit::Failure);
        }
        Ok(Exit::Done)
    }
}
