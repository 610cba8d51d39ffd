//! The results in the recording of a run: its states, and the counters of its nodes.
//!
//! - `about`: the messages about one packing

mod about;

use about::{About, Unused, enter};

use crate::acoustic::AcousticReport;
use crate::inference::Inference;
use crate::measured_packing::MeasuredPacking;
use crate::measurements::Measurement;
use grainlab_core::notes::Note;
use grainlab_core::results::report_warnings;
use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::{Report, Topic, TypeInfo, msg, topics};
use grainlab_recordings::strangers::{self, Authors, StrangerView};
use grainlab_recordings::{ChannelInfo, Message, OneRun, Recording, RunSign, Selection, SeveralRuns};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// A packing and the estimates from it.
#[derive(Clone, Debug, Serialize)]
pub struct InvertedPacking {
    /// Structure and stiffness.
    #[serde(flatten)]
    pub packing: MeasuredPacking,
    /// Null where no wave speeds were published; of several measurements the first.
    pub acoustic: Option<AcousticReport>,
    /// The other measurements of wave speeds.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub further_acoustic: Vec<AcousticReport>,
    /// Estimates of each model from the data of each topic.
    pub results: Vec<Inference>,
}

impl InvertedPacking {
    /// Every measurement of wave speeds, in the order of arrival.
    pub fn acoustics(&self) -> impl DoubleEndedIterator<Item = &AcousticReport> {
        self.acoustic.iter().chain(&self.further_acoustic)
    }

    /// The measurement that a result is from.
    pub fn acoustic_of(&self, measurement: Option<&Measurement>) -> Option<&AcousticReport> {
        self.acoustics().find(|a| a.measurement.as_ref() == measurement)
    }
}

/// The results read back.
#[derive(Debug, Default)]
pub struct ReadBack {
    /// Every packing, in order of steps.
    pub states: Vec<InvertedPacking>,
    /// The last report of each process, by node and process id.
    pub(crate) reports: BTreeMap<(String, u32), Report>,
    /// Number of packing messages.
    pub packings: usize,
    /// Step of the last packing that a run can be resumed from.
    pub saved_step: Option<u64>,
    /// Engines that made the packings, in order; empty if ours made all.
    pub(crate) engines: Vec<EngineRange>,
    /// Data of packings without a microstructure.
    pub not_inverted: usize,
    /// Messages whose content is refused.
    pub refused: usize,
    /// Inferred from data of an instrument that are not about a packing of the run.
    pub of_instruments: Vec<Inference>,
    /// The recording holds several runs: nothing of it was used.
    pub several_runs: Option<SeveralRuns>,
    /// Packings without a structure.
    pub not_analysed: usize,
    /// Packings published within phases, and the number of those measured. They are only in the recording.
    pub(crate) within_phases: WithinPhases,
    /// Steps of the packings with a result, by topic.
    pub results: BTreeMap<&'static str, BTreeSet<u64>>,
    /// Processes on the bus that are not part of the run.
    pub strangers: Vec<StrangerView>,
    /// It is unknown which of its messages are right.
    pub disputed: bool,
    /// Messages that could not be read.
    pub complaints: Vec<String>,
}

impl ReadBack {
    /// A recording that cannot be read, with the reason.
    pub fn failed(error: impl ToString) -> Self {
        Self { complaints: vec![error.to_string()], ..Self::default() }
    }

    /// Number of times that another engine went on with the run.
    pub fn engine_changes(&self) -> usize {
        self.engines.len().saturating_sub(1)
    }

    fn dispute(&mut self, lines: impl IntoIterator<Item = String>) {
        let before = self.complaints.len();
        self.complaints.extend(lines);
        self.disputed |= self.complaints.len() > before;
    }

    fn of_several_runs(recording: &Recording, sign: RunSign) -> Self {
        let several = SeveralRuns { path: recording.path().to_owned(), sign };
        Self { several_runs: Some(several.clone()), ..Self::failed(several) }
    }
}

/// Packings that one engine made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct EngineRange {
    /// The program, with version and number of processes; `grainlab` for ours.
    pub(crate) engine: String,
    pub(crate) from_step: u64,
}

fn engines(about: &BTreeMap<u64, About>) -> Vec<EngineRange> {
    let simulated = about.values().filter_map(|a| Some((a.position.as_ref()?, a.step)));
    let named = simulated
        .map(|(path, step)| (path.engine.as_ref().map_or("grainlab".to_owned(), ToString::to_string), step));
    let mut found: Vec<EngineRange> =
        named.map(|(engine, from_step)| EngineRange { engine, from_step }).collect();
    found.dedup_by(|next, known| next.engine == known.engine);
    if found.iter().all(|range| range.engine == "grainlab") { Vec::new() } else { found }
}

/// Packings published within phases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct WithinPhases {
    pub(crate) packings: usize,
    /// Number with a structure.
    pub(crate) structures: usize,
    /// Number with moduli.
    pub(crate) moduli: usize,
}

/// Topics with results.
const RESULTS: [Topic; 6] = [
    topics::PACKING,
    topics::PACKING_REPORT,
    topics::MODULI,
    topics::WAVE_SPEEDS,
    topics::MICROSTRUCTURE,
    topics::DIAGNOSTICS,
];

fn topic_of(channel: &ChannelInfo) -> Option<&'static Topic> {
    Topic::of_channel(&channel.topic, &channel.ros_type).filter(|t| RESULTS.iter().any(|r| r.name == t.name))
}

/// Reads a recording back.
pub fn read(recording: &Recording) -> ReadBack {
    recording.differing().iter().for_each(|line| grainlab_console::say!("grainlab: {line}"));
    let mut back = ReadBack { strangers: strangers::strangers(recording), ..ReadBack::default() };
    back.dispute(strangers::disputes(recording));
    back.complaints.extend(recording.ended_early());
    let channels = recording.channels();
    let names = channels.iter().filter(|c| topic_of(c).is_some()).map(|c| c.topic.clone());
    let messages = match recording.messages(&Selection::topics(names)) {
        Ok(messages) => messages,
        Err(error) => {
            back.complaints.push(error.to_string());
            return back;
        }
    };
    let sorted = OneRun::scenes(recording).and_then(|()| back.sort(messages, &Names::of(recording)));
    let about = match sorted {
        Ok(about) => about,
        Err(sign) => return ReadBack::of_several_runs(recording, sign),
    };
    back.engines = engines(&about);
    let source = recording.path().display().to_string();
    let is_of_earlier_version =
        channels.iter().any(|c| c.ros_type == TypeInfo::of::<msg::Fabric>().type_name);
    if is_of_earlier_version {
        back.complaints.push(format!(
            "an earlier version recorded {source}: what it measured of packings, on the topics fabric and moduli, is not read; \
             `grainlab analyze {source}` measures the packings again"
        ));
    }
    for (step, about) in about {
        if !back.add(step, about, &source) {
            back.not_analysed += 1;
            if !is_of_earlier_version {
                back.complaints.push(format!("the packing of step {step} was not analysed"));
            }
        }
    }
    back.complaints.extend(recording.warnings().iter().map(ToString::to_string));
    back
}

impl ReadBack {
    /// Sorts messages by the packings that they are about.
    ///
    /// # Errors
    /// A sign that the messages are of several runs.
    fn sort(
        &mut self,
        messages: impl Iterator<Item = Message>,
        authors: &Names,
    ) -> Result<BTreeMap<u64, About>, RunSign> {
        let (mut all, mut run) = (BTreeMap::new(), OneRun::default());
        for message in messages {
            let Some(topic) = topic_of(&message.channel) else { continue };
            if topic.name == topics::DIAGNOSTICS.name {
                if let Err(problem) = reports(&mut self.reports, &message) {
                    self.complaints.push(complaint(&message, &problem));
                }
                continue;
            }
            let by = authors.node(&message.channel.topic, message.log_time);
            let step = match enter(&mut all, &mut run, topic, &message, by) {
                Ok(step) => step,
                Err(Unused::OfAnotherRun(sign)) => return Err(sign),
                Err(Unused::Unreadable(problem)) => {
                    self.complaints.push(complaint(&message, &problem));
                    continue;
                }
                // It is in the recording all the same.
                Err(Unused::Refused(step, problem)) => {
                    self.refused += 1;
                    self.complaints.push(complaint(&message, &problem));
                    step
                }
            };
            if topic.name != topics::PACKING.name {
                self.results.entry(topic.name).or_default().insert(step);
            } else if let Some(about) = all.get(&step) {
                self.packings += 1;
                self.saved_step = if about.position.is_some() { Some(step) } else { self.saved_step };
            }
        }
        all.values().find_map(About::contradiction).map_or(Ok(all), Err)
    }

    /// Adds what is known about the packing of `step`; false if the packing has no report.
    fn add(&mut self, step: u64, mut about: About, source: &str) -> bool {
        self.note_unanswered(step, &about);
        self.dispute(about.dispute());
        if about.is_within_phase() {
            let is_jammed = about.report.as_ref().is_some_and(|report| report.stiffness().is_some());
            self.within_phases.packings += 1;
            self.within_phases.structures += usize::from(about.report.is_some());
            self.within_phases.moduli += usize::from(is_jammed);
            return true;
        }
        let ((results, others), speeds, notes) = (about.results(), about.speeds(), about.notes());
        self.of_instruments.extend(others);
        match (about.packing, about.report) {
            (Some(_), Some(report)) => {
                let why_no_stiffness = report.elasticity.as_ref().err().map(Note::from);
                let notes =
                    why_no_stiffness.into_iter().chain(report_warnings(&report)).chain(notes).collect();
                let (grains, density) = (report.contacts.grains, report.bulk_density());
                let mut acoustic = speeds.into_iter().map(|(measurement, reading)| AcousticReport {
                    measurement,
                    ..AcousticReport::new(grains, density, reading)
                });
                let packing = MeasuredPacking {
                    position: about.position,
                    notes,
                    ..MeasuredPacking::new(source.to_owned(), report)
                };
                let (first, further) = (acoustic.next(), acoustic.collect());
                self.states.push(InvertedPacking {
                    packing,
                    acoustic: first,
                    further_acoustic: further,
                    results,
                });
                true
            }
            // Data of an external instrument do not belong to a packing of the run.
            (None, None) if step == 0 => true,
            (None, _) => {
                self.complaints.push(format!("the packing of step {step} is not in the recording"));
                true
            }
            (Some(_), None) => false,
        }
    }

    /// Counts data without an answer, and answers without their data. Those of packings within a phase may have none.
    fn note_unanswered(&mut self, step: u64, about: &About) {
        for (topic, data) in about.data.iter().filter(|_| step > 0 && !about.is_within_phase()) {
            if let lost @ 1.. = data.not_found() {
                self.complaints.push(format!(
                    "{lost} {topic} of step {step} were inverted, and are not in the recording"
                ));
            }
            match data.unanswered() {
                (_, 0) => {}
                (sent, open) if sent == open => {
                    self.not_inverted += 1;
                    self.complaints.push(format!(
                        "the recording has no estimate from the {topic} of step {step}: they were not inverted, or it was \
                         lost; `grainlab analyze RUN --format csv | grainlab invert --table -` infers from the packings"
                    ));
                }
                (sent, open) => {
                    self.not_inverted += open;
                    self.complaints
                        .push(format!("{open} of {sent} {topic} of step {step} have no estimate of their own in the recording"));
                }
            }
        }
    }
}

fn complaint(message: &Message, problem: &str) -> String {
    format!("message {} on {}: {problem}", message.sequence, message.channel.topic)
}

/// Nodes by the messages that they sent.
struct Names {
    authors: Authors,
    nodes: BTreeMap<String, String>,
}

impl Names {
    fn of(recording: &Recording) -> Self {
        let tallies = recording.ledger().unwrap_or_default();
        let writers = tallies.into_iter().flat_map(|t| t.writers);
        let nodes = writers.filter_map(|w| Some((w.guid, w.node?))).collect();
        Self { authors: strangers::authors(recording), nodes }
    }

    /// The node that sent the message of a topic at this log time.
    fn node(&self, topic: &str, log_time: u64) -> Option<&str> {
        self.nodes.get(self.authors.writer(topic, log_time)?).map(String::as_str)
    }
}

fn reports(known: &mut BTreeMap<(String, u32), Report>, recorded: &Message) -> Result<(), String> {
    let message: DiagnosticArray = recorded.decoded()?;
    for report in Report::from_message(&message) {
        known.insert((report.node.clone(), report.pid), report);
    }
    Ok(())
}

#[cfg(test)]
mod tests;
