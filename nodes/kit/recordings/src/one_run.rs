//! Signs that a recording is of several runs. A merged one, or one of a recorder that heard two runs, has packings and results of several
//! runs under the same steps; what is joined by its step would then be joined across runs.

use std::collections::{BTreeMap, BTreeSet};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;

use grainlab_core::Packing;
use grainlab_msgs::{Topic, msg, topics};

use crate::reader::{ChannelInfo, Recording, Selection};

/// Most requests whose content is kept, 40 MB: those of two runs differ soon after their beginning.
const REQUESTS: usize = 1 << 20;

/// A recording holds several runs.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path} holds several runs: {sign}. Results of several runs are not joined: {}", sign.way_out)]
pub struct SeveralRuns {
    /// Path of the recording.
    pub path: PathBuf,
    /// Sign of several runs.
    pub sign: RunSign,
}

impl SeveralRuns {
    /// Sign in the scenes, packings and requests of a recording; `None` if it is of one run.
    pub fn of(recording: &Recording) -> Option<Self> {
        let sign = || OneRun::messages(recording).err();
        let path = recording.path();
        Self::of_scenes(recording).or_else(|| Some(Self { path: path.to_owned(), sign: sign()? }))
    }

    /// Sign in the scenes alone, without reading messages.
    pub fn of_scenes(recording: &Recording) -> Option<Self> {
        let sign = OneRun::scenes(recording).err()?;
        Some(Self { path: recording.path().to_owned(), sign })
    }
}

/// Sign that a recording holds several runs.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}")]
pub struct RunSign {
    what: String,
    way_out: &'static str,
}

impl RunSign {
    /// A sign that was found in the messages.
    pub fn new(what: String) -> Self {
        let way_out = "give the recording of one of them, or cut one out by its time (grainlab bag convert --start, --end)";
        Self { what, way_out }
    }
}

/// Compares the packings and requests of a recording, in their order. What was published again has the same content.
#[derive(Clone, Debug, Default)]
pub struct OneRun {
    topic: Option<String>,
    grains: Option<usize>,
    /// A fingerprint of the packing of each step.
    packings: BTreeMap<u64, u64>,
    /// A fingerprint of each request, by its number.
    requests: BTreeMap<u64, u64>,
}

impl OneRun {
    /// Takes a packing of a topic.
    ///
    /// # Errors
    /// If it cannot be of the run of the packings before it.
    pub fn packing(&mut self, topic: &str, packing: &Packing) -> Result<(), RunSign> {
        let first = self.topic.get_or_insert_with(|| topic.to_owned());
        if first != topic {
            let what = format!("there are packings on {first} and on {topic}");
            return Err(RunSign {
                what,
                way_out: "take the topics of one of them (grainlab bag convert --topics)",
            });
        }
        let (step, grains) = (packing.step, packing.grains());
        let first = *self.grains.get_or_insert(grains);
        if first != grains {
            return Err(RunSign::new(format!("there are packings of {first} and of {grains} grains")));
        }
        let last = self.packings.last_key_value().map(|(step, _)| *step);
        let found = state(packing);
        match (self.packings.get(&step), last) {
            (Some(known), _) if *known == found => {}
            (Some(_), _) => {
                return Err(RunSign::new(format!("there are two different packings of step {step}")));
            }
            (None, Some(before)) if before > step => {
                return Err(RunSign::new(format!(
                    "a packing of step {step} comes after one of step {before}"
                )));
            }
            (None, _) => _ = self.packings.insert(step, found),
        }
        Ok(())
    }

    /// Takes a request of the lockstep, with the bytes of its content.
    ///
    /// # Errors
    /// If another one has its number.
    pub fn request(&mut self, sequence: u64, content: &[u8]) -> Result<(), RunSign> {
        let found = fingerprint(|hasher| content.hash(hasher));
        match self.requests.get(&sequence) {
            Some(known) if *known != found => {
                let what = format!("there are two different requests of number {sequence} on stress");
                return Err(RunSign::new(what));
            }
            None if self.requests.len() < REQUESTS => _ = self.requests.insert(sequence, found),
            _ => {}
        }
        Ok(())
    }

    /// Compares all packings and requests of a recording. Those that cannot be read show nothing.
    fn messages(recording: &Recording) -> Result<(), RunSign> {
        let of = |c: &ChannelInfo| Topic::of_channel(&c.topic, &c.ros_type).map(|t| t.name);
        let wanted = [topics::PACKING.name, topics::STRESS.name];
        let channels = recording.channels();
        let names = channels.iter().filter(|c| of(c).is_some_and(|name| wanted.contains(&name)));
        let selection = Selection::topics(names.map(|c| c.topic.clone()));
        let mut run = Self::default();
        for message in recording.messages(&selection).into_iter().flatten() {
            if of(&message.channel) == Some(topics::PACKING.name) {
                let packing = message.decoded::<msg::Packing>().ok();
                if let Some(packing) = packing.and_then(|m| Packing::try_from(&m).ok()) {
                    run.packing(&message.channel.topic, &packing)?;
                }
            } else if let Ok(request) = message.decoded::<msg::Stress>() {
                run.request(request.sequence, &message.payload)?;
            }
        }
        Ok(())
    }

    /// Compares the scenes stored in a recording: `scene.toml`, and `scene.2.toml` and so on in a merged one.
    ///
    /// # Errors
    /// If they differ.
    pub fn scenes(recording: &Recording) -> Result<(), RunSign> {
        let is_scene = |name: &str| {
            let number = name.strip_prefix("scene.").and_then(|rest| rest.strip_suffix(".toml"));
            name == "scene.toml" || number.is_some_and(|n| n.parse::<u32>().is_ok())
        };
        let scenes: Vec<_> =
            recording.stored_files().into_iter().filter(|file| is_scene(&file.name)).collect();
        let count = scenes.iter().map(|file| &file.bytes).collect::<BTreeSet<_>>().len();
        if count < 2 {
            return Ok(());
        }
        let names: BTreeSet<&str> = scenes.iter().map(|file| file.name.as_str()).collect();
        let names = names.into_iter().collect::<Vec<_>>().join(", ");
        Err(RunSign {
            what: format!("it has {count} different scenes ({names})"),
            // A cut keeps all stored files.
            way_out: "give one of the recordings that it was merged from, which its metadata grainlab_copy names",
        })
    }
}

/// Fingerprint of where the grains are, without what a phase sets: that differs between its end and the next beginning.
pub(crate) fn state(packing: &Packing) -> u64 {
    let number = |hasher: &mut DefaultHasher, value: f64| value.to_bits().hash(hasher);
    fingerprint(|hasher| {
        number(hasher, packing.time);
        packing.ids.hash(hasher);
        packing.radii.iter().for_each(|r| number(hasher, *r));
        packing.cell.matrix().iter().for_each(|x| number(hasher, *x));
        packing.positions.iter().flat_map(|v| v.iter()).for_each(|x| number(hasher, *x));
    })
}

fn fingerprint(content: impl FnOnce(&mut DefaultHasher)) -> u64 {
    let mut hasher = DefaultHasher::new();
    content(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::{Cell, Vec3};

    fn packing(step: u64, x: f64, grains: usize) -> Packing {
        Packing {
            step,
            time: 1e-6 * step as f64,
            friction: 0.3,
            time_step: 1e-7,
            ..Packing::at_rest(
                Cell::cube(4e-3).unwrap(),
                vec![1e-3; grains],
                vec![Vec3::new(x, 1e-3, 1e-3); grains],
            )
        }
    }

    #[test]
    fn packings_of_two_runs_are_told_apart_and_those_of_one_are_not() {
        let last = |packings: &[Packing]| {
            let mut run = OneRun::default();
            packings.iter().try_for_each(|p| run.packing("/packing", p))
        };
        let again = Packing { friction: 0.5, ..packing(7, 1e-3, 2) };
        assert_eq!(
            last(&[packing(0, 1e-3, 2), packing(7, 1e-3, 2), again.clone(), packing(9, 2e-3, 2)]),
            Ok(())
        );
        assert_eq!(last(&[packing(7, 1e-3, 2), packing(9, 1e-3, 2), again]), Ok(()), "published again");
        for (other, sign) in [
            (packing(7, 1.1e-3, 2), "two different packings of step 7"),
            (packing(8, 1e-3, 2), "step 8 comes after one of step 9"),
            (packing(10, 1e-3, 3), "of 2 and of 3 grains"),
        ] {
            let found = last(&[packing(7, 1e-3, 2), packing(9, 1e-3, 2), other]).unwrap_err();
            assert!(found.to_string().contains(sign), "{found}");
        }
        let mut run = OneRun::default();
        run.packing("/left/packing", &packing(0, 1e-3, 2)).unwrap();
        let other = run.packing("/right/packing", &packing(1, 1e-3, 2)).unwrap_err();
        assert!(other.to_string().contains("on /left/packing and on /right/packing"), "{other}");
    }

    #[test]
    fn a_number_is_that_of_one_request() {
        let mut run = OneRun::default();
        assert_eq!(run.request(0, b"a").and(run.request(1, b"b")).and(run.request(0, b"a")), Ok(()));
        assert!(run.request(1, b"c").unwrap_err().to_string().contains("requests of number 1"));
    }
}
