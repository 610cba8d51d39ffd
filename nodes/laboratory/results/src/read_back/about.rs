//! The messages about one packing.

use crate::inference::Inference;
use crate::measurements::{Identity, Measurement, Measurements};
use grainlab_core::Packing;
use grainlab_core::results::ElasticStiffness;
use grainlab_experiment::PathPosition;
use grainlab_msgs::boundary::{
    BoundaryError, FabricReading, MicrostructureReading, ModuliReading, WaveSpeedsReading,
};
use grainlab_msgs::builtin_interfaces::Time;
use grainlab_msgs::{Topic, msg, topics};
use grainlab_recordings::{Message, RunSign};
use std::collections::BTreeMap;

/// Topics of data that an inversion reads.
const INVERTED: [&str; 2] = [topics::MODULI.name, topics::WAVE_SPEEDS.name];

/// A message that is not used.
pub(super) enum Unused {
    /// Its content is refused; it is about the packing of this step.
    Refused(u64, String),
    /// It cannot be read.
    Unreadable(String),
}

/// The answer to one set of data.
struct Answer {
    /// Topic of the data.
    source: String,
    identity: Identity,
    /// Number among the answers of this inversion with the same identity.
    nth: usize,
    estimates: Vec<Inference>,
}

/// What one message of moduli has of the stiffness.
struct Stiffness {
    identity: Identity,
    by: Option<String>,
    tensor: Option<ElasticStiffness>,
}

/// The messages about one packing; repeated ones are equal.
#[derive(Default)]
pub(super) struct About {
    /// Position on the loading path. A packing within a phase need not be at rest, and may have no results.
    pub(super) position: Option<PathPosition>,
    pub(super) packing: Option<Packing>,
    stamp: Option<Time>,
    pub(super) fabric: Option<FabricReading>,
    fabric_stamp: Option<Time>,
    /// The node that measured it.
    fabric_by: Option<String>,
    /// Another structure was sent, too.
    fabrics_differ: bool,
    /// The moduli that were sent, and the stiffness of each.
    moduli: Vec<Stiffness>,
    wave_speeds: Vec<(Identity, WaveSpeedsReading)>,
    answers: Vec<Answer>,
    /// What was sent and answered, by topic.
    pub(super) data: BTreeMap<&'static str, Measurements>,
}

/// Wave speeds with the measurement that they are of, if the packing has several.
pub(super) type Speeds = (Option<Measurement>, WaveSpeedsReading);

impl About {
    pub(super) fn is_within_phase(&self) -> bool {
        self.position.is_some_and(|p| !p.end_of_phase)
    }

    /// Whether data of the identity are about this packing. Those of an instrument without a simulation have step 0, too, and
    /// the stamp tells them from data of the packing that a run starts from.
    fn is_of_packing(&self, identity: &Identity) -> bool {
        self.packing.as_ref().is_some_and(|p| p.step > 0 || self.stamp == Some(identity.stamp()))
    }

    /// The stiffness: that of the node that measured the structure, else the first one.
    pub(super) fn stiffness(&self) -> Option<ElasticStiffness> {
        let mut own: Vec<&Stiffness> =
            self.moduli.iter().filter(|m| self.is_of_packing(&m.identity)).collect();
        own.sort_by_key(|m| m.by != self.fabric_by);
        own.into_iter().find_map(|m| m.tensor)
    }

    /// Notes on several results of one kind.
    pub(super) fn notes(&self) -> Vec<String> {
        let moduli = self.moduli.iter().filter(|m| self.is_of_packing(&m.identity)).count();
        let of_moduli = (moduli > 1).then(|| {
            format!("{moduli} different moduli of this packing were sent: the stiffness is that of the node that measured its structure")
        });
        let of_fabrics = self.fabrics_differ.then(|| {
            "different structures of this packing were sent: that of the last is the one counted".to_owned()
        });
        let confused = self.data.iter().filter_map(|(topic, data)| data.confusion(topic));
        of_moduli.into_iter().chain(of_fabrics).chain(confused).collect()
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

    /// What was inferred from data about this packing, and from data that are not about it, in the order of arrival.
    pub(super) fn results(&mut self) -> (Vec<Inference>, Vec<Inference>) {
        let (mut own, mut others) = (Vec::new(), Vec::new());
        self.data.values_mut().for_each(|data| data.analyzer.clone_from(&self.fabric_by));
        for answer in std::mem::take(&mut self.answers) {
            let known = self.data.iter().find(|(topic, _)| **topic == answer.source);
            let known = known.map(|(_, known)| known);
            let (list, label) = if self.is_of_packing(&answer.identity) {
                (&mut own, known.and_then(|k| k.label_of_answer(&answer.identity, answer.nth)))
            } else {
                (&mut others, known.map(|k| k.named(&answer.identity, answer.nth, "answer ")))
            };
            for estimate in answer.estimates {
                let found = Inference { measurement: label.clone(), ..estimate };
                // A restarted process may have sent it again.
                if !list.contains(&found) {
                    list.push(found);
                }
            }
        }
        (own, others)
    }

    /// What shows that the structure is not that of the packing: it has another stamp, or other numbers of grains or contacts.
    pub(super) fn contradiction(&self, step: u64) -> Option<RunSign> {
        let (packing, fabric) = (self.packing.as_ref()?, self.fabric.as_ref()?);
        let difference = if self.stamp != self.fabric_stamp {
            "its stamp is another one".to_owned()
        } else if fabric.contacts.grains as usize != packing.grains() {
            format!("it has {} grains, and the packing {}", fabric.contacts.grains, packing.grains())
        } else if fabric.contacts.contacts as usize != packing.contacts.len() {
            format!(
                "it has {} contacts, and the packing {}",
                fabric.contacts.contacts,
                packing.contacts.len()
            )
        } else {
            return None;
        };
        Some(RunSign::Result { topic: topics::FABRIC.name, step, difference })
    }
}

/// Adds one message; returns the step of its packing.
pub(super) fn enter(
    about: &mut BTreeMap<u64, About>,
    topic: &Topic,
    recorded: &Message,
    by: Option<&str>,
) -> Result<u64, Unused> {
    let refused = |step: u64| move |e: BoundaryError| Unused::Refused(step, e.to_string());
    match topic.name {
        name if name == topics::PACKING.name => {
            let message: msg::Packing = read(recorded)?;
            let packing = Packing::try_from(&message).map_err(refused(message.step))?;
            let step = packing.step;
            let about = about.entry(step).or_default();
            about.position = PathPosition::of(&message.run_state);
            about.stamp = Some(message.header.stamp);
            about.packing = Some(packing);
            Ok(step)
        }
        name if name == topics::FABRIC.name => {
            let message: msg::Fabric = read(recorded)?;
            let step = message.source_step;
            let reading = FabricReading::try_from(&message).map_err(refused(step))?;
            let about = about.entry(step).or_default();
            about.fabrics_differ |= about.fabric.as_ref().is_some_and(|known| *known != reading);
            (about.fabric, about.fabric_stamp) = (Some(reading), Some(message.header.stamp));
            about.fabric_by = by.map(str::to_owned);
            Ok(step)
        }
        name if name == topics::MODULI.name => {
            let message: msg::Moduli = read(recorded)?;
            let step = message.source_step;
            let about = about.entry(step).or_default();
            let identity = Identity::new(&message.name, message.header.stamp);
            if sent(about, &topics::MODULI, identity.clone(), by, recorded) {
                let tensor = ModuliReading::try_from(&message).map_err(refused(step))?.stiffness;
                about.moduli.push(Stiffness { identity, by: by.map(str::to_owned), tensor });
            }
            Ok(step)
        }
        name if name == topics::WAVE_SPEEDS.name => {
            let message: msg::WaveSpeeds = read(recorded)?;
            let step = message.source_step;
            let about = about.entry(step).or_default();
            let identity = Identity::new(&message.name, message.header.stamp);
            if sent(about, &topics::WAVE_SPEEDS, identity.clone(), by, recorded) {
                about
                    .wave_speeds
                    .push((identity, WaveSpeedsReading::try_from(&message).map_err(refused(step))?));
            }
            Ok(step)
        }
        _ => {
            let message: msg::Microstructure = read(recorded)?;
            let step = message.source_step;
            let reading = MicrostructureReading::try_from(&message).map_err(refused(step))?;
            let by = by.map(str::to_owned);
            let about = about.entry(step).or_default();
            let identity = Identity::new(&message.name, message.header.stamp);
            let data = INVERTED.into_iter().find(|topic| *topic == message.source);
            let nth = data
                .map_or(0, |data| about.data.entry(data).or_default().answered(identity.clone(), by.clone()));
            let of = |e| Inference { by: by.clone(), ..Inference::of_reading(&reading.source, e) };
            let estimates = reading.estimates.iter().map(of).collect();
            about.answers.push(Answer { source: message.source, identity, nth, estimates });
            Ok(step)
        }
    }
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
