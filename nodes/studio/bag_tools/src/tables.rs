//! One file per topic.

use crate::appended::Appended;
use crate::cat;
use crate::csv_table::{Columns, CsvTable};
use crate::decoders::{Decoders, schema_of};
use crate::progress::Progress;
use crate::selection::Topics;
use crate::shape::{MOST_COLUMNS, Shape};
use grainlab_any_message::{Message as Decoded, Schema, Shown};
use grainlab_console::{Failure, count};
use grainlab_recordings::{ChannelInfo, Message, Recording, Selection};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Bytes of all buffers of CSV files together, and of the buffer of one file at least and at most. The writer of CSV looks through the
/// rest of a value again for each buffer that it fills, so that a large one is faster.
const BUFFERS: usize = 1 << 29;
const BUFFER: (usize, usize) = (1 << 13, 1 << 21);

/// Longest name of a file without number and extension: file systems take 255 bytes.
const LONGEST_NAME: usize = 240;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TableFormat {
    Json,
    Csv,
}

impl TableFormat {
    const fn extension(self) -> &'static str {
        match self {
            Self::Json => "jsonl",
            Self::Csv => "csv",
        }
    }
}

pub(crate) struct Tables<'a> {
    /// Final name of the folder, for messages.
    name: &'a Path,
    folder: &'a Path,
    format: TableFormat,
    /// Longest array that is written as columns of CSV.
    widest: usize,
    /// Channels wanted, where not all of a topic are.
    wanted: Option<Topics>,
    list: Vec<Table>,
    /// Place in the list by topic, type and definition.
    known: BTreeMap<(String, String, Vec<u8>), usize>,
    /// Number of tables by the name of their files without number and extension.
    named: BTreeMap<String, usize>,
    /// Place in the list by the address of the channel, which stays its own while it is in here.
    places: BTreeMap<usize, (Arc<ChannelInfo>, Option<usize>)>,
    decoders: Decoders,
}

struct Table {
    channel: Arc<ChannelInfo>,
    /// Path without the extension.
    base: PathBuf,
    file: TableFile,
    rows: u64,
}

enum TableFile {
    /// The shape of the messages, before the file is begun.
    Shape(Shape),
    Json(BufWriter<Appended>),
    Csv(Box<CsvTable>),
}

impl TableFile {
    fn write(&mut self, message: &Message, row: &Decoded) -> Result<(), String> {
        let times = [message.log_time, message.publish_time];
        match self {
            Self::Shape(shape) => {
                shape.include(row);
                Ok(())
            }
            Self::Json(file) => cat::json(file, message, Shown::new(row)).map_err(|e| e.to_string()),
            Self::Csv(file) => file.row(times, row).map_err(|e| e.to_string()),
        }
    }
}

impl<'a> Tables<'a> {
    /// No files yet; `folder` gets them, and is called `name` at the end.
    pub(crate) fn new(
        name: &'a Path,
        folder: &'a Path,
        format: TableFormat,
        widest: usize,
        wanted: Option<Topics>,
    ) -> Self {
        Self {
            name,
            folder,
            format,
            widest,
            wanted,
            list: Vec::new(),
            known: BTreeMap::new(),
            named: BTreeMap::new(),
            places: BTreeMap::new(),
            decoders: Decoders::default(),
        }
    }

    /// Reads the recording twice for CSV: first for the lengths of arrays.
    pub(crate) fn convert(&mut self, recording: &Recording, selection: &Selection) -> Result<(), Failure> {
        if self.format == TableFormat::Csv {
            self.pass(recording, selection)?;
            self.decoders = Decoders::default();
            let buffer = (BUFFERS / self.list.len().max(1)).clamp(BUFFER.0, BUFFER.1);
            for table in &mut self.list {
                if let TableFile::Shape(shape) = &table.file {
                    let columns = Columns::of(shape, self.widest).ok_or_else(|| too_wide(&table.channel))?;
                    let file = CsvTable::create(&with_extension(&table.base, self.format), columns, buffer);
                    table.file = TableFile::Csv(Box::new(file.map_err(Failure::at(self.name))?));
                }
            }
        }
        self.pass(recording, selection)
    }

    fn pass(&mut self, recording: &Recording, selection: &Selection) -> Result<(), Failure> {
        let progress = Progress::new(recording.time_range())?;
        self.list.iter_mut().for_each(|table| table.rows = 0);
        for message in recording.messages(selection).map_err(Failure::failed)? {
            progress.at(message.log_time)?;
            if self.wanted.as_ref().is_some_and(|w| !w.take(&message.channel)) {
                continue;
            }
            let decoded = self.decoders.decode(&message);
            let (Some(place), Some(decoded)) = (self.place(&message)?, decoded) else { continue };
            let table = &mut self.list[place];
            let written = table.file.write(&message, &decoded);
            let topic = &message.channel.topic;
            written.map_err(|e| Failure::at(self.name)(format!("{topic}: {e}")))?;
            table.rows += 1;
        }
        Ok(())
    }

    /// Completes the files; returns a line about each, and what could not be decoded.
    pub(crate) fn finish(self) -> Result<(Vec<String>, Decoders), Failure> {
        let wrong = |e: &dyn Display| Failure::at(self.name)(e);
        let mut lines = Vec::new();
        for table in self.list {
            let name = table.base.file_name().unwrap_or_default().to_string_lossy();
            let (topic, extension) = (&table.channel.topic, self.format.extension());
            lines.push(format!("  {name}.{extension}  {topic}  {}\n", count(table.rows, "row")));
            match table.file {
                TableFile::Shape(_) => {}
                TableFile::Json(mut file) => file.flush().map_err(|e| wrong(&e))?,
                TableFile::Csv(file) => file.finish().map_err(|e| wrong(&e))?,
            }
        }
        Ok((lines, self.decoders))
    }

    /// The table of a message; `None` if its type cannot be decoded.
    fn place(&mut self, message: &Message) -> Result<Option<usize>, Failure> {
        let channel = &message.channel;
        let address = Arc::as_ptr(channel).addr();
        if let Some((_, place)) = self.places.get(&address) {
            return Ok(*place);
        }
        let key = (channel.topic.clone(), channel.ros_type.clone(), channel.schema.clone());
        let mut place = self.known.get(&key).copied();
        if place.is_none()
            && let Ok(schema) = schema_of(channel)
        {
            let new = self.list.len();
            let table = self.begin(channel, &schema)?;
            self.list.push(table);
            self.known.insert(key, new);
            place = Some(new);
        }
        self.places.insert(address, (channel.clone(), place));
        Ok(place)
    }

    fn begin(&mut self, channel: &Arc<ChannelInfo>, schema: &Schema) -> Result<Table, Failure> {
        let name = file_name(&channel.topic)?;
        let taken = self.named.entry(name.clone()).or_default();
        *taken += 1;
        let number = if *taken == 1 { String::new() } else { format!(".{taken}") };
        let base = self.folder.join(format!("{name}{number}"));
        let wrong = |e: &dyn Display| Failure::at(self.name)(e);
        let file = match self.format {
            TableFormat::Json => {
                let file = Appended::create(&with_extension(&base, self.format)).map_err(|e| wrong(&e))?;
                TableFile::Json(BufWriter::with_capacity(1 << 16, file))
            }
            TableFormat::Csv => {
                TableFile::Shape(Shape::of(schema.root(), self.widest).ok_or_else(|| too_wide(channel))?)
            }
        };
        Ok(Table { channel: channel.clone(), base, file, rows: 0 })
    }
}

/// The path with an extension behind its name, which may have dots.
fn with_extension(base: &Path, format: TableFormat) -> PathBuf {
    let mut path = base.as_os_str().to_owned();
    path.push(".");
    path.push(format.extension());
    path.into()
}

fn too_wide(channel: &ChannelInfo) -> Failure {
    let topic = &channel.topic;
    Failure::usage(format!(
        "{topic}: a message has more than {MOST_COLUMNS} columns: use a smaller --array-columns, or --format json"
    ))
}

/// `/a/b` as `a_b`; other characters than letters, digits, `_`, `-` and `.` become `_`, and a dot at the beginning.
fn file_name(topic: &str) -> Result<String, Failure> {
    let safe = |c: char| if c.is_ascii_alphanumeric() || "-.".contains(c) { c } else { '_' };
    let name: String = topic.trim_matches('/').chars().map(safe).collect();
    if name.len() > LONGEST_NAME {
        return Err(Failure::usage(format!(
            "{topic}: a file can have a name of {LONGEST_NAME} characters at most, and this would be {}: leave the topic out \
             (--exclude), or use --format mcap",
            name.len()
        )));
    }
    Ok(match name.strip_prefix('.') {
        Some(rest) => format!("_{rest}"),
        None if name.is_empty() => "topic".to_owned(),
        None => name,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::recording;

    /// A recording may have 65,535 topics, and a process 1024 open files.
    #[test]
    fn no_file_of_a_topic_stays_open() {
        let text = ["std_msgs/msg/String", "string data\n"];
        let hi = b"\0\x01\0\0\x03\0\0\0hi\0";
        let recording = recording((0..20).map(|n| (format!("/t{n}"), "cdr", text, hi.to_vec())));
        for format in [TableFormat::Json, TableFormat::Csv] {
            let folder = tempfile::tempdir().unwrap();
            let mut tables = Tables::new(folder.path(), folder.path(), format, 36, None);
            tables.convert(&recording, &Selection::default()).unwrap();
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 20);
            let open = std::fs::read_dir("/proc/self/fd").unwrap().flatten();
            let open = open.filter_map(|link| std::fs::read_link(link.path()).ok());
            assert_eq!(open.filter(|path| path.starts_with(folder.path())).count(), 0, "{format:?}");
            tables.finish().unwrap();
            let sizes =
                std::fs::read_dir(folder.path()).unwrap().map(|file| file.unwrap().metadata().unwrap().len());
            assert!(sizes.min() > Some(20), "{format:?}");
        }
    }

    #[test]
    fn a_topic_too_long_for_the_name_of_a_file_is_refused() {
        let of = |length: usize| format!("/{}", "a".repeat(length));
        assert_eq!(file_name("/a/b c").unwrap(), "a_b_c");
        assert_eq!(file_name(&of(LONGEST_NAME)).unwrap().len(), LONGEST_NAME);
        assert!(file_name(&of(300)).unwrap_err().to_string().contains("this would be 300"));
    }
}
