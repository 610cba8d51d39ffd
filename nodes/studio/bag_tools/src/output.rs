//! The recording that a command writes.

use crate::decoders::Decoders;
use crate::opened::losses;
use crate::progress::Progress;
use crate::selection::Topics;
use crate::times::Interval;
use grainlab_console::{Failure, count, print, say, worse};
use grainlab_msgs::Exit;
use grainlab_recordings::copy::{self, CopyOptions, Preset, Select};
use grainlab_recordings::{ChannelInfo, Compression, MessagePath, Recording, Selection};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Output of a copy, and its options.
#[derive(Clone, Debug, clap::Args)]
pub struct Output {
    /// New recording: a directory as rosbag2 has it, or one file if the name ends with .mcap
    #[arg(short, long, alias = "out", value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) form: Form,
}

/// Options of the output.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct Form {
    /// Compression of the chunks [default: zstd]
    #[arg(long, value_enum, value_name = "KIND")]
    compression: Option<Compression>,
    /// Level of the compression, 1 to 22 for zstd [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=22))]
    level: Option<u32>,
    /// Preset of rosbag2; the other options change it
    #[arg(long, value_enum, value_name = "NAME")]
    preset: Option<Preset>,
    /// Uncompressed size of a chunk, bytes [default: 1048576]
    #[arg(long, value_name = "BYTES", value_parser = clap::value_parser!(u64).range(1..=1 << 30))]
    chunk_size: Option<u64>,
}

impl Form {
    /// Refuses options of recordings for another output.
    pub(crate) fn refuse_given(&self) -> Result<(), Failure> {
        let given = [
            ("--compression", self.compression.is_some()),
            ("--level", self.level.is_some()),
            ("--preset", self.preset.is_some()),
            ("--chunk-size", self.chunk_size.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((name, _)) => {
                Err(Failure::usage(format!("{name} is of recordings: leave it out, or choose --format mcap")))
            }
            None => Ok(()),
        }
    }

    fn options(&self, operation: &str) -> Result<CopyOptions, Failure> {
        let mut options = self.preset.map_or_else(CopyOptions::default, CopyOptions::of_preset);
        if let Some(kind) = self.compression {
            options.compression = kind;
            options.chunk_size = options.chunk_size.or(Some(1 << 20));
        }
        if self.level.is_some() && options.compression == Compression::None {
            return Err(Failure::usage(
                "--level has no effect without compression: leave it out, or choose --compression lz4 or zstd",
            ));
        }
        options.level = self.level.unwrap_or(options.level);
        options.chunk_size = self.chunk_size.or(options.chunk_size);
        options.operation = operation.to_owned();
        Ok(options)
    }
}

/// Description of a copy.
pub(crate) struct Job<'a> {
    /// `cut`, `merge`, …
    pub(crate) operation: &'a str,
    pub(crate) paths: &'a [PathBuf],
    pub(crate) topics: &'a Topics,
    pub(crate) interval: &'a Interval,
    /// Copy latched messages from before the start.
    pub(crate) latched: bool,
    /// Add pictures of packings.
    pub(crate) pictures: bool,
    /// Add the definitions that are found here to topics without.
    pub(crate) schemas: Option<&'a MessagePath>,
}

impl Job<'_> {
    /// Copies to `output` with the options of `form`, and prints what was written.
    pub(crate) fn write(&self, output: &Path, form: &Form) -> Result<Exit, Failure> {
        let options = CopyOptions { pictures: self.pictures, ..form.options(self.operation)? };
        let opened = |path| match self.schemas {
            Some(schemas) => schemas.open(path).and_then(|(recording, defined)| decodes(recording, &defined)),
            None => Recording::open(path).map_err(Failure::failed),
        };
        let recordings = self.paths.iter().map(|path| opened(path)).collect::<Result<Vec<_>, _>>()?;
        let topics = self.topics.check(&recordings)?;
        let (start, end) = self.interval.of(&recordings)?;
        let ranges = recordings.iter().filter_map(Recording::time_range);
        let range = ranges.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let progress =
            Progress::new(range.map(|(a, b)| (start.unwrap_or(a).max(a), end.unwrap_or(b).min(b))))?;
        let take = |c: &ChannelInfo| topics.take(c);
        let select =
            Select { topic: &take, start, end, latched: self.latched, progress: &|time| progress.at(time) };
        let copied = copy::copy(&recordings, &select, output, &options)?;
        drop(progress);
        copied.notes.iter().for_each(|note| say!("grainlab: {note}"));
        let latched = match copied.latched {
            0 => String::new(),
            n => format!(", {n} of them latched ones from before the start"),
        };
        let pictures = match copied.pictures {
            0 => String::new(),
            n => format!(", {} of packings", count(n, "picture")),
        };
        print(&format!(
            "{}: {} on {}{latched}{pictures}, {:.3} MB\n",
            copied.path.display(),
            count(copied.messages, "message"),
            count(copied.topics.len() as u64, "topic"),
            copied.bytes as f64 * 1e-6
        ))?;
        let missing = self.schemas.map(|schemas| without_definition(&recordings, schemas)).transpose()?;
        let missing = missing.into_iter().flatten().inspect(|line| say!("grainlab: {line}")).count();
        let complete = if copied.without_picture == 0 && missing == 0 { Exit::Done } else { Exit::DataLoss };
        Ok(worse(losses(&recordings), complete))
    }
}

/// The recording, if every message of these topics is one of the definition that was found for it.
fn decodes(recording: Recording, topics: &[String]) -> Result<Recording, Failure> {
    let mut decoders = Decoders::default();
    for message in recording.messages(&Selection::topics(topics)).map_err(Failure::failed)? {
        decoders.decode(&message);
    }
    if decoders.losses() == Exit::Done {
        return Ok(recording);
    }
    Err(Failure::failed("the definitions found are not those of the messages: nothing was written"))
}

/// Topics that have no definition, with why none was found.
fn without_definition(recordings: &[Recording], schemas: &MessagePath) -> Result<BTreeSet<String>, Failure> {
    let definitions = schemas.definitions()?;
    let channels = recordings.iter().flat_map(Recording::channels);
    let missing = channels.filter(|c| c.is_without_definition());
    let line = |c: Arc<ChannelInfo>| {
        let why = definitions.text(&c.ros_type, &c.type_hash).err().unwrap_or_default();
        format!("{}: left without a definition: {why}", c.topic)
    };
    Ok(missing.map(line).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_without_compression_and_options_of_recordings_for_tables_are_refused() {
        let level = Form { level: Some(5), ..Form::default() };
        assert_eq!(level.options("compress").unwrap().level, 5);
        let none = Form { compression: Some(Compression::None), ..level.clone() };
        let fast = Form { preset: Some(Preset::FastWrite), ..level.clone() };
        for form in [none, fast] {
            assert!(form.options("compress").unwrap_err().to_string().starts_with("--level"));
        }
        assert!(level.refuse_given().unwrap_err().to_string().starts_with("--level"));
        assert!(Form::default().refuse_given().is_ok());
    }
}
