//! The messages about one packing.

use crate::inference::{Inference, Origin};
use crate::measurements::{Identity, Measurement, Measurements};
use grainlab_core::notes::Note;
use grainlab_core::results::{PackingReport, geometry_warnings};
use grainlab_core::{Packing, PathPosition};
use grainlab_msgs::boundary::{BoundaryError, ModuliReading, WaveSpeedsReading};
use grainlab_msgs::builtin_interfaces::Time;
use grainlab_msgs::{Topic, msg, topics};
use grainlab_recordings::{Message, OneRun, RunSign};
use std::collections::BTreeMap;

/// Topics of data that an inversion reads.
const INVERTED: [&str; 3] = [topics::PACKING_REPORT.name, topics::MODULI.name, topics::WAVE_SPEEDS.name];

/// A message that is not used.
pub(super) enum Unused {
    /// The content is refused; it is about the packing of this step.
    Refused(u64, String),
    /// It cannot be read.
    Unreadable(String),
    /// It is of another run than the messages before it.
    OfAnotherRun(RunSign),
}

struct Answer {
    source: String,
    identity: Identity,
    /// Number among the answers of this inversion with the same identity.
    nth: usize,
    estimates: Vec<Inference>,
}

/// The messages about one packing; repeated ones are equal.
#[derive(Default)]
pub(super) struct About {
    pub(super) step: u64,
    /// Position on the loading path. A packing within a phase need not be at rest, and may have no results.
    pub(super) position: Option<PathPosition>,
    /// Number of its grains and of its contacts.
    pub(super) packing: Option<(usize, usize)>,
    /// Warnings about its geometry, which the report does not have; of packings at the ends of phases alone.
    geometry: Vec<Note>,
    stamp: Option<Time>,
    pub(super) report: Option<PackingReport>,
    report_stamp: Option<Time>,
    /// Node of the first report.
    report_by: Option<String>,
    /// Another report was sent, too.
    reports_differ: bool,
    /// The node that sent it, if it is another one.
    disputed_by: Option<String>,
    wave_speeds: Vec<(Identity, WaveSpeedsReading)>,
    /// Why the packing has no wave speeds, by the names of the measurements.
    without_speeds: Vec<(String, Note)>,
    answers: Vec<Answer>,
    /// Data sent and answered, by topic.
    pub(super) data: BTreeMap<&'static str, Measurements>,
}

/// Wave speeds with the measurement that they are of, if the packing has several.
pub(super) type Speeds = (Option<Measurement>, WaveSpeedsReading);

impl About {
    pub(super) fn is_within_phase(&self) -> bool {
        self.position.as_ref().is_some_and(|path| !path.end_of_phase)
    }

    /// True if data of the identity are about this packing. Those of an instrument without a simulation have step 0, too, and
    /// the stamp tells them from data of the packing that a run starts from.
    fn is_of_packing(&self, identity: &Identity) -> bool {
        self.packing.is_some() && (self.step > 0 || self.stamp == Some(identity.stamp()))
    }

    /// Notes on the geometry of the packing, and on several results of one kind.
    pub(super) fn notes(&self) -> Vec<Note> {
        let several = "different reports of this packing were sent: that of the last is the one counted";
        let of_reports = (self.reports_differ && self.disputed_by.is_none()).then(|| Note::remark(several));
        let confused = self.data.iter().filter_map(|(topic, data)| data.confusion(topic).map(Note::remark));
        let known =
            self.report.as_ref().and_then(|report| Some(Note::from(report.elasticity.as_ref().err()?)));
        // A packing without a stiffness carries no wave, for the same reason.
        let without = self.without_speeds.iter().filter(|(_, note)| Some(note) != known.as_ref());
        let mut without: Vec<String> = without
            .map(|(name, note)| match name.as_str() {
                "" => format!("no wave speeds: {note}"),
                name => format!("no wave speeds of {name}: {note}"),
            })
            .collect();
        without.dedup();
        let without = without.into_iter().map(Note::remark);
        self.geometry.iter().cloned().chain(of_reports).chain(confused).chain(without).collect()
    }

    /// That two processes reported this packing differently.
    pub(super) fn dispute(&self) -> Option<String> {
        let (step, second) = (self.step, self.disputed_by.as_ref()?);
        let first = self.report_by.as_deref().unwrap_or("an unknown process");
        Some(format!(
            "{first} and {second} sent different reports of the packing of step {step}: it is unknown which is right, \
             and that of {first} is shown"
        ))
    }

    /// Every measurement of wave speeds of this packing.
    pub(super) fn speeds(&mut self) -> Vec<Speeds> {
        let all = std::mem::take(&mut self.wave_speeds);
        let known = self.data.get(topics::WAVE_SPEEDS.name);
        let mut counts: BTreeMap<Identity, usize> = BTreeMap::new();
        let labelled = all.into_iter().filter(|(identity, _)| self.is_of_packing(identity));
        labelled
            .map(|(identity, reading)| {
                let nth = counts.entry(identity.clone()).or_default();
                let label = known.and_then(|known| known.label(&identity, *nth));
                *nth += 1;
                (label, reading)
            })
            .collect()
    }

    /// Estimates from data about this packing, and from data that are not about it. Those from one topic by one node are in the order
    /// of arrival, and topics and nodes in a fixed order: which node answers first depends on timing.
    pub(super) fn results(&mut self) -> (Vec<Inference>, Vec<Inference>) {
        let (mut own, mut others) = (Vec::new(), Vec::new());
        let mut answers = std::mem::take(&mut self.answers);
        answers.sort_by_cached_key(|answer| {
            let by = answer.estimates.first().and_then(|found| found.origin.by.clone());
            (answer.source != topics::PACKING_REPORT.name, answer.source.clone(), by.is_none(), by)
        });
        for answer in answers {
            let known = self.data.iter().find(|(topic, _)| **topic == answer.source);
            let known = known.map(|(_, known)| known);
            let (list, label) = if self.is_of_packing(&answer.identity) {
                (&mut own, known.and_then(|k| k.label_of_answer(&answer.identity, answer.nth)))
            } else {
                (&mut others, known.map(|k| k.named(&answer.identity, answer.nth, "answer ")))
            };
            for mut found in answer.estimates {
                found.origin.measurement.clone_from(&label);
                // A restarted process may have sent it again.
                if !list.contains(&found) {
                    list.push(found);
                }
            }
        }
        (own, others)
    }

    /// Sign that the report is not that of the packing: it has another stamp, or other numbers of grains or contacts.
    pub(super) fn contradiction(&self) -> Option<RunSign> {
        let ((grains, contacts), report) = (self.packing?, self.report.as_ref()?);
        let found = &report.contacts;
        let difference = if self.stamp != self.report_stamp {
            "its stamp is another one".to_owned()
        } else if found.grains as usize != grains {
            format!("it has {} grains, and the packing {grains}", found.grains)
        } else if found.contacts as usize != contacts {
            format!("it has {} contacts, and the packing {contacts}", found.contacts)
        } else {
            return None;
        };
        let (topic, step) = (topics::PACKING_REPORT.name, self.step);
        let what =
            format!("the {topic} of step {step} is not that of the packing of this step: {difference}");
        Some(RunSign::new(what))
    }
}

/// Adds one message; returns the step of its packing.
pub(super) fn enter(
    all: &mut BTreeMap<u64, About>,
    run: &mut OneRun,
    topic: &Topic,
    recorded: &Message,
    by: Option<&str>,
) -> Result<u64, Unused> {
    let refused = |step: u64| move |e: BoundaryError| Unused::Refused(step, e.to_string());
    match topic.name {
        name if name == topics::PACKING.name => {
            let message: msg::Packing = read(recorded)?;
            let packing = Packing::try_from(&message).map_err(refused(message.step))?;
            run.packing(&recorded.channel.topic, &packing).map_err(Unused::OfAnotherRun)?;
            let about = about(all, packing.step);
            about.position.clone_from(&packing.path);
            about.stamp = Some(message.header.stamp);
            about.packing = Some((packing.grains(), packing.contacts.len()));
            if !about.is_within_phase() {
                about.geometry = geometry_warnings(&packing);
            }
            Ok(packing.step)
        }
        name if name == topics::PACKING_REPORT.name => {
            let message: msg::PackingReport = read(recorded)?;
            let (step, stamp) = (message.source_step, message.header.stamp);
            let about = about(all, step);
            // Nothing is inferred from a packing without a stiffness.
            if !message.stiffness.is_empty() {
                sent(about, &topics::PACKING_REPORT, Identity::new("", stamp), by, recorded);
            }
            let report = PackingReport::try_from(&message).map_err(refused(step))?;
            let by = by.map(str::to_owned);
            let differs = about.report.as_ref().is_some_and(|known| *known != report);
            about.reports_differ |= differs;
            if differs && by != about.report_by {
                about.disputed_by = Some(by.unwrap_or_else(|| "an unknown process".to_owned()));
                return Ok(step);
            }
            (about.report, about.report_stamp, about.report_by) = (Some(report), Some(stamp), by);
            Ok(step)
        }
        name if name == topics::MODULI.name => {
            let message: msg::Moduli = read(recorded)?;
            let step = message.source_step;
            let identity = Identity::new(&message.name, message.header.stamp);
            if sent(about(all, step), &topics::MODULI, identity, by, recorded) {
                ModuliReading::try_from(&message).map_err(refused(step))?;
            }
            Ok(step)
        }
        name if name == topics::WAVE_SPEEDS.name => {
            let message: msg::WaveSpeeds = read(recorded)?;
            let step = message.source_step;
            let about = about(all, step);
            let reading = WaveSpeedsReading::try_from(&message).map_err(refused(step));
            // Nothing is inferred from a packing without wave speeds.
            if let Ok(declined) = reading.as_ref()
                && declined.is_declined()
            {
                let why = declined.notes.iter().map(|note| (declined.name.clone(), note.clone()));
                about.without_speeds.extend(why);
                return Ok(step);
            }
            let identity = Identity::new(&message.name, message.header.stamp);
            if sent(about, &topics::WAVE_SPEEDS, identity.clone(), by, recorded) {
                about.wave_speeds.push((identity, reading?));
            }
            Ok(step)
        }
        _ => {
            let message: msg::Microstructure = read(recorded)?;
            let step = message.source_step;
            let results = message.results().map_err(refused(step))?;
            // The data have nothing to invert.
            if results.is_empty() {
                return Ok(step);
            }
            let by = by.map(str::to_owned);
            let about = about(all, step);
            let identity = Identity::new(&message.name, message.header.stamp);
            let data = INVERTED.into_iter().find(|topic| *topic == message.source);
            let nth = data
                .map_or(0, |data| about.data.entry(data).or_default().answered(identity.clone(), by.clone()));
            let origin = Origin { source: Some(message.source.clone()), by, measurement: None };
            let of = |estimate| Inference { origin: origin.clone(), estimate };
            let estimates = results.into_iter().map(of).collect();
            about.answers.push(Answer { source: message.source, identity, nth, estimates });
            Ok(step)
        }
    }
}

fn about(all: &mut BTreeMap<u64, About>, step: u64) -> &mut About {
    all.entry(step).or_insert_with(|| About { step, ..About::default() })
}

/// Notes data; false if they were sent before.
fn sent(
    about: &mut About,
    topic: &'static Topic,
    identity: Identity,
    by: Option<&str>,
    recorded: &Message,
) -> bool {
    about.data.entry(topic.name).or_default().sent(identity, by, &recorded.payload)
}

fn read<T: grainlab_msgs::Message>(recorded: &Message) -> Result<T, Unused> {
    recorded.decoded().map_err(Unused::Unreadable)
}
