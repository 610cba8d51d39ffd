//! The results in the recording of a run: its states, and the counters of its nodes.

use crate::acoustic::AcousticReport;
use crate::inference::Inference;
use crate::measured_packing::MeasuredPacking;
use crate::state_warnings::of_springs;
use grainlab_core::results::{ElasticStiffness, Elasticity, NotJammed, PackingReport};
use grainlab_core::{Packing, PackingError};
use grainlab_experiment::PathPosition;
use grainlab_micromechanics::{PackingView, ReportParts, min_contacts, report};
use grainlab_msgs::boundary::{FabricReading, MicrostructureReading, ModuliReading, WaveSpeedsReading};
use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::{Topic, msg, topics};
use grainlab_node_kit::Report;
use grainlab_recorder::strangers::{self, Authors, StrangerView};
use grainlab_recordings::{ChannelInfo, Message, Recording, Selection};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// A packing and the estimates from it.
#[derive(Clone, Debug, Serialize)]
pub struct InvertedPacking {
    /// Structure and stiffness.
    #[serde(flatten)]
    pub packing: MeasuredPacking,
    /// Null where no wave speeds were published.
    pub acoustic: Option<AcousticReport>,
    /// What each model infers from the data of each topic.
    pub results: Vec<Inference>,
}

/// Topics of data that an inversion reads.
const INVERTED: [&str; 2] = [topics::MODULI.name, topics::WAVE_SPEEDS.name];

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
    /// Data of packings without a microstructure.
    pub not_inverted: usize,
    /// Packings without a structure.
    pub not_analysed: usize,
    /// Packings published within phases, and the number of those measured. They are only in the recording.
    pub(crate) film: Film,
    /// Microstructures, by the topic of their data and the step of the packing.
    pub(crate) inverted: BTreeSet<(String, u64)>,
    /// Steps of the packings with a result, by topic.
    pub results: BTreeMap<&'static str, BTreeSet<u64>>,
    /// Processes on the bus that are not part of the run.
    pub strangers: Vec<StrangerView>,
    /// Messages that could not be read.
    pub complaints: Vec<String>,
}

impl ReadBack {
    /// A recording that cannot be read, with the reason.
    pub fn failed(error: impl ToString) -> Self {
        Self { complaints: vec![error.to_string()], ..Self::default() }
    }
}

/// Packings published within phases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Film {
    /// Number of packings.
    pub(crate) packings: usize,
    /// Number with a structure.
    pub(crate) structures: usize,
    /// Number with moduli.
    pub(crate) moduli: usize,
}

/// The messages about one packing; repeated ones are equal.
#[derive(Default)]
struct About {
    /// Position on the loading path. A packing within a phase need not be at rest, and may have no results.
    position: Option<PathPosition>,
    packing: Option<Packing>,
    fabric: Option<FabricReading>,
    stiffness: Option<ElasticStiffness>,
    wave_speeds: Option<WaveSpeedsReading>,
    /// In the order of arrival.
    results: Vec<Inference>,
}

impl About {
    fn is_within_phase(&self) -> bool {
        self.position.is_some_and(|p| !p.end_of_phase)
    }
}

/// Reads a recording back.
pub fn read(recording: &Recording) -> ReadBack {
    let mut back = ReadBack::default();
    recording.differing().iter().for_each(|line| grainlab_console::say!("grainlab: {line}"));
    let wanted = [
        topics::PACKING,
        topics::FABRIC,
        topics::MODULI,
        topics::WAVE_SPEEDS,
        topics::MICROSTRUCTURE,
        topics::DIAGNOSTICS,
    ];
    let of = |c: &ChannelInfo| {
        Topic::of_channel(&c.topic, &c.ros_type).filter(|t| wanted.iter().any(|w| w.name == t.name))
    };
    let channels = recording.channels();
    let names = channels.iter().filter(|c| of(c).is_some()).map(|c| c.topic.clone());
    let authors = Names::of(recording);
    back.strangers = strangers::strangers(recording);
    let mut about: BTreeMap<u64, About> = BTreeMap::new();
    let messages = match recording.messages(&Selection::topics(names)) {
        Ok(messages) => messages,
        Err(error) => {
            back.complaints.push(error.to_string());
            return back;
        }
    };
    for message in messages {
        let Some(topic) = of(&message.channel) else { continue };
        let taken = if topic.name == topics::DIAGNOSTICS.name {
            reports(&mut back.reports, &message)
        } else {
            let by = authors.node(&message.channel.topic, message.log_time);
            enter(&mut about, topic, &message, by).map(|step| {
                if topic.name == topics::MICROSTRUCTURE.name
                    && let Ok(found) = message.decoded::<msg::Microstructure>()
                {
                    back.inverted.insert((found.source, step));
                }
                if topic.name == topics::PACKING.name {
                    back.packings += 1;
                    let on_path = about.get(&step).is_some_and(|a| a.position.is_some());
                    back.saved_step = if on_path { Some(step) } else { back.saved_step };
                } else {
                    back.results.entry(topic.name).or_default().insert(step);
                }
            })
        };
        if let Err(problem) = taken {
            back.complaints
                .push(format!("message {} on {}: {problem}", message.sequence, message.channel.topic));
        }
    }
    let source = recording.path().display().to_string();
    let film: BTreeSet<u64> =
        about.iter().filter(|(_, a)| a.is_within_phase()).map(|(step, _)| *step).collect();
    for (step, about) in about {
        if about.is_within_phase() {
            back.film.packings += 1;
            back.film.structures += usize::from(about.fabric.is_some());
            back.film.moduli += usize::from(about.stiffness.is_some());
            continue;
        }
        match (about.packing, about.fabric) {
            (Some(packing), Some(fabric)) => {
                let report = match reported(&packing, fabric, about.stiffness) {
                    Ok(report) => report,
                    Err(why) => {
                        back.complaints.push(format!("the packing of step {step}: {why}"));
                        continue;
                    }
                };
                let mut measured = MeasuredPacking::new(source.clone(), report).at(about.position);
                measured.warnings.extend(measured.report.elasticity.not_jammed().map(ToString::to_string));
                measured.warnings.extend(of_springs(&packing, &measured.report));
                let acoustic = about.wave_speeds.map(|reading| AcousticReport::new(&packing, reading));
                back.states.push(InvertedPacking { packing: measured, acoustic, results: about.results });
            }
            // Data of an external instrument do not belong to a packing of the run.
            (None, None) if step == 0 => {}
            (None, _) => back.complaints.push(format!("the packing of step {step} is not in the recording")),
            (_, None) => {
                back.not_analysed += 1;
                back.complaints.push(format!("the packing of step {step} was not analysed"));
            }
        }
    }
    for (topic, steps) in back.results.iter().filter(|(topic, _)| INVERTED.contains(topic)) {
        for step in steps.iter().filter(|step| **step > 0 && !film.contains(step)) {
            if !back.inverted.contains(&((*topic).to_owned(), *step)) {
                back.not_inverted += 1;
                back.complaints.push(format!("the {topic} of step {step} were not inverted"));
            }
        }
    }
    back.complaints.extend(recording.warnings().iter().map(ToString::to_string));
    back
}

/// The report from the messages about a packing.
fn reported(
    packing: &Packing,
    found: FabricReading,
    stiffness: Option<ElasticStiffness>,
) -> Result<PackingReport, PackingError> {
    let FabricReading { contacts, fabric, stress_decomposition, strain_ratios } = found;
    let elasticity = match (stiffness, packing.ids.len()) {
        (Some(stiffness), _) => Elasticity::Jammed(Box::new(stiffness)),
        (None, grains) => Elasticity::NotJammed(match contacts.contacts as usize {
            0 => NotJammed::NoContacts { grains },
            _ if contacts.rattlers as usize == grains => {
                NotJammed::OnlyRattlers { grains, needed: min_contacts(packing.friction) }
            }
            _ => NotJammed::NotReported,
        }),
    };
    let parts = ReportParts { contacts, fabric, stress_decomposition, strain_ratios, elasticity };
    Ok(report(&PackingView::new(packing)?, parts))
}

/// Adds one message; returns the step of its packing.
fn enter(
    about: &mut BTreeMap<u64, About>,
    topic: &Topic,
    recorded: &Message,
    by: Option<&str>,
) -> Result<u64, String> {
    let text = |e: grainlab_msgs::boundary::BoundaryError| e.to_string();
    match topic.name {
        name if name == topics::PACKING.name => {
            let message: msg::Packing = recorded.decoded()?;
            let packing = Packing::try_from(&message).map_err(text)?;
            let step = packing.step;
            let about = about.entry(step).or_default();
            about.position = PathPosition::of(&message.run_state);
            about.packing = Some(packing);
            Ok(step)
        }
        name if name == topics::FABRIC.name => {
            let message: msg::Fabric = recorded.decoded()?;
            about.entry(message.source_step).or_default().fabric =
                Some(FabricReading::try_from(&message).map_err(text)?);
            Ok(message.source_step)
        }
        name if name == topics::MODULI.name => {
            let message: msg::Moduli = recorded.decoded()?;
            let about = about.entry(message.source_step).or_default();
            about.stiffness = ModuliReading::try_from(&message).map_err(text)?.stiffness;
            Ok(message.source_step)
        }
        name if name == topics::WAVE_SPEEDS.name => {
            let message: msg::WaveSpeeds = recorded.decoded()?;
            let reading = WaveSpeedsReading::try_from(&message).map_err(text)?;
            about.entry(message.source_step).or_default().wave_speeds = Some(reading);
            Ok(message.source_step)
        }
        _ => {
            let message: msg::Microstructure = recorded.decoded()?;
            let reading = MicrostructureReading::try_from(&message).map_err(text)?;
            let known = &mut about.entry(reading.source_step).or_default().results;
            for estimate in &reading.estimates {
                let by = by.map(str::to_owned);
                let found = Inference { by, ..Inference::of_reading(&reading.source, estimate) };
                // A restarted process may have sent it again.
                if !known.contains(&found) {
                    known.push(found);
                }
            }
            Ok(reading.source_step)
        }
    }
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
