//! One file per topic.

use crate::cat;
use crate::decoders::{Decoders, schema_of};
use crate::progress::Progress;
use crate::selection::Topics;
use crate::table::{Columns, CsvTable, MOST_COLUMNS, Shape, time_columns};
use grainlab_any_message::{Exploded, Length, Message as Decoded, MessageType, Schema, Shown, Value};
use grainlab_console::{Failure, count};
use grainlab_parquet::{Column, Kind, ParquetError, ParquetTable};
use grainlab_recordings::{ChannelInfo, Message, Recording, Selection};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Longest name of a file without number and extension: file systems take 255 bytes.
const LONGEST_NAME: usize = 240;

/// Formats of one file per topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TableFormat {
    Json,
    Csv,
    Parquet,
}

impl TableFormat {
    const fn extension(self) -> &'static str {
        match self {
            Self::Json => "jsonl",
            Self::Csv => "csv",
            Self::Parquet => "parquet",
        }
    }
}

/// The files of a folder.
pub(crate) struct Tables<'a> {
    /// Final name of the folder, for messages.
    name: &'a Path,
    folder: &'a Path,
    format: TableFormat,
    /// Longest array that is written as columns of CSV.
    widest: usize,
    /// Array with a row for each of its values.
    explode: Option<&'a str>,
    /// Channels wanted, where not all of a topic are.
    wanted: Option<Topics>,
    list: Vec<Table>,
    /// Place in the list by the address of the channel, which stays its own while it is in here.
    places: BTreeMap<usize, (Arc<ChannelInfo>, Option<usize>)>,
    decoders: Decoders,
}

struct Table {
    channel: Arc<ChannelInfo>,
    /// Path without the extension.
    base: PathBuf,
    exploded: Option<Exploded>,
    file: TableFile,
    rows: u64,
}

enum TableFile {
    /// The shape of the messages, before the file is begun.
    Shape(Shape),
    Json(BufWriter<File>),
    Csv(Box<CsvTable>),
    Parquet(Box<ParquetTable<File>>),
}

impl Table {
    /// The rows of a message.
    fn rows(&self, message: Decoded) -> Vec<Decoded> {
        match &self.exploded {
            Some(exploded) => exploded.rows(&message),
            None => vec![message],
        }
    }
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
            Self::Parquet(file) => {
                let times = times.map(Value::U64);
                file.row(times.iter().chain(&row.values).map(Some)).map_err(|e| e.to_string())
            }
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
        explode: Option<&'a str>,
        wanted: Option<Topics>,
    ) -> Self {
        let (list, places, decoders) = (Vec::new(), BTreeMap::new(), Decoders::default());
        Self { name, folder, format, widest, explode, wanted, list, places, decoders }
    }

    /// Writes all selected messages. For CSV the recording is read twice: first for the lengths of
    /// arrays.
    pub(crate) fn convert(&mut self, recording: &Recording, selection: &Selection) -> Result<(), Failure> {
        self.check_explode(recording, selection)?;
        if self.format == TableFormat::Csv {
            self.pass(recording, selection)?;
            self.decoders = Decoders::default();
            for table in &mut self.list {
                if let TableFile::Shape(shape) = &table.file {
                    let columns = Columns::of(shape, self.widest).ok_or_else(|| too_wide(&table.channel))?;
                    let file = CsvTable::create(&with_extension(&table.base, self.format), columns);
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
            for row in table.rows(decoded) {
                let topic = &message.channel.topic;
                table
                    .file
                    .write(&message, &row)
                    .map_err(|e| Failure::at(self.name)(format!("{topic}: {e}")))?;
                table.rows += 1;
            }
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
                TableFile::Parquet(file) => file.finish().map(drop).map_err(|e| wrong(&e))?,
            }
        }
        Ok((lines, self.decoders))
    }

    /// An error if no topic has the array to explode.
    fn check_explode(&self, recording: &Recording, selection: &Selection) -> Result<(), Failure> {
        let Some(array) = self.explode else { return Ok(()) };
        let taken = |c: &ChannelInfo| selection.topics.as_ref().is_none_or(|t| t.contains(&c.topic));
        let channels = recording.channels().into_iter().filter(|c| taken(c));
        let schemas: Vec<Schema> = channels.filter_map(|c| schema_of(&c).ok()).collect();
        if schemas.iter().any(|s| Exploded::of(s.root(), array).is_some()) {
            return Ok(());
        }
        let fields = schemas.iter().flat_map(|s| &s.root().fields);
        let arrays: BTreeSet<&str> =
            fields.filter(|f| f.kind.length != Length::One).map(|f| f.name.as_str()).collect();
        let arrays = arrays.into_iter().collect::<Vec<_>>().join(", ");
        Err(Failure::usage(format!(
            "--explode {array}: no topic has an array of this name; they have: {arrays}"
        )))
    }

    /// The table of a message; `None` if its type cannot be decoded.
    fn place(&mut self, message: &Message) -> Result<Option<usize>, Failure> {
        let channel = &message.channel;
        let address = Arc::as_ptr(channel).addr();
        if let Some((_, place)) = self.places.get(&address) {
            return Ok(*place);
        }
        let key = |c: &ChannelInfo| (c.topic.clone(), c.ros_type.clone(), c.schema.clone());
        let mut place = self.list.iter().position(|t| key(&t.channel) == key(channel));
        if place.is_none()
            && let Ok(schema) = schema_of(channel)
        {
            place = Some(self.list.len());
            let table = self.begin(channel, &schema)?;
            self.list.push(table);
        }
        self.places.insert(address, (channel.clone(), place));
        Ok(place)
    }

    fn begin(&self, channel: &Arc<ChannelInfo>, schema: &Schema) -> Result<Table, Failure> {
        let name = file_name(&channel.topic)?;
        let same = |t: &&Table| file_name(&t.channel.topic).is_ok_and(|other| other == name);
        let number = match self.list.iter().filter(same).count() {
            0 => String::new(),
            taken => format!(".{}", taken + 1),
        };
        let base = self.folder.join(format!("{name}{number}"));
        let exploded = self.explode.and_then(|array| Exploded::of(schema.root(), array));
        let kind = exploded.as_ref().map_or(schema.root(), Exploded::kind);
        let wrong = |e: &dyn Display| Failure::at(self.name)(e);
        let file = match self.format {
            TableFormat::Json => {
                let file = File::create_new(with_extension(&base, self.format)).map_err(|e| wrong(&e))?;
                TableFile::Json(BufWriter::with_capacity(1 << 16, file))
            }
            TableFormat::Csv => {
                TableFile::Shape(Shape::of(kind, self.widest).ok_or_else(|| too_wide(channel))?)
            }
            TableFormat::Parquet => {
                let file = parquet_table(&with_extension(&base, self.format), kind);
                TableFile::Parquet(Box::new(file.map_err(|e| wrong(&format!("{}: {e}", channel.topic)))?))
            }
        };
        Ok(Table { channel: channel.clone(), base, exploded, file, rows: 0 })
    }
}

/// The path with an extension behind its name, which may have dots.
fn with_extension(base: &Path, format: TableFormat) -> PathBuf {
    let mut path = base.as_os_str().to_owned();
    path.push(".");
    path.push(format.extension());
    path.into()
}

/// A Parquet file for the messages of a type.
fn parquet_table(path: &Path, kind: &MessageType) -> Result<ParquetTable<File>, ParquetError> {
    let times = time_columns(|time| kind.fields.iter().any(|f| f.name == time));
    let fields = kind.fields.iter().map(|f| (f.name.clone(), Kind::Field(f.kind.clone())));
    let columns = times.map(|name| (name, Kind::Time)).into_iter().chain(fields);
    let columns: Vec<Column> = columns.map(|(name, kind)| Column { name, kind }).collect();
    ParquetTable::new(File::create_new(path)?, "messages", &columns)
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

    #[test]
    fn a_topic_too_long_for_the_name_of_a_file_is_refused() {
        let of = |length: usize| format!("/{}", "a".repeat(length));
        assert_eq!(file_name("/a/b c").unwrap(), "a_b_c");
        assert_eq!(file_name(&of(LONGEST_NAME)).unwrap().len(), LONGEST_NAME);
        assert!(file_name(&of(300)).unwrap_err().to_string().contains("this would be 300"));
    }
}
