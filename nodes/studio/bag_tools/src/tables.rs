//! One file per topic.

use crate::cat;
use crate::decoders::{Decoders, schema_of};
use crate::table::{Columns, CsvTable, MOST_COLUMNS, Shape};
use grainlab_any_message::Shown;
use grainlab_console::Failure;
use grainlab_parquet::ParquetTable;
use grainlab_recordings::{ChannelInfo, Message, Recording, Selection};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::Path;
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

/// The files of a folder.
pub(crate) struct Tables<'a> {
    /// Final name of the folder, for messages.
    name: &'a Path,
    folder: &'a Path,
    format: TableFormat,
    /// Longest array that is written as columns.
    widest: usize,
    list: Vec<Table>,
    /// Place in the list by the address of the channel, which stays its own while it is in here.
    places: BTreeMap<usize, (Arc<ChannelInfo>, Option<usize>)>,
    decoders: Decoders,
}

struct Table {
    channel: Arc<ChannelInfo>,
    shape: Shape,
    file: Option<TableFile>,
}

enum TableFile {
    Json(BufWriter<File>),
    Csv(Columns, Box<CsvTable>),
    Parquet(Columns, Box<ParquetTable<File>>),
}

/// A failure of the file system or of a library.
pub(crate) fn failed(path: &Path, error: &dyn Display) -> Failure {
    Failure::failed(format!("{}: {error}", path.display()))
}

impl<'a> Tables<'a> {
    pub(crate) fn new(name: &'a Path, folder: &'a Path, format: TableFormat, widest: usize) -> Self {
        let (list, places, decoders) = (Vec::new(), BTreeMap::new(), Decoders::default());
        Self { name, folder, format, widest, list, places, decoders }
    }

    /// Writes all selected messages; returns their number. The recording is read twice: first for the lengths of arrays.
    pub(crate) fn convert(&mut self, recording: &Recording, selection: &Selection) -> Result<u64, Failure> {
        let messages = || recording.messages(selection).map_err(Failure::failed);
        let mut first = Decoders::default();
        for message in messages()? {
            if let Some(place) = self.place(&message)?
                && self.format != TableFormat::Json
                && let Some(decoded) = first.decode(&message)
            {
                self.list[place].shape.include(&decoded);
            }
        }
        self.create()?;
        let mut count = 0;
        for message in messages()? {
            let decoded = self.decoders.decode(&message);
            let (Some(place), Some(decoded)) = (self.place(&message)?, decoded) else { continue };
            let (log_time, publish_time) = (message.log_time, message.publish_time);
            let wrong = |e: &dyn Display| failed(self.name, e);
            match &mut self.list[place].file {
                Some(TableFile::Json(file)) => {
                    cat::json(file, &message, Shown::new(&decoded)).map_err(|e| wrong(&e))?;
                }
                Some(TableFile::Csv(columns, file)) => {
                    file.row(&columns.row(log_time, publish_time, &decoded)).map_err(|e| wrong(&e))?;
                }
                Some(TableFile::Parquet(columns, file)) => {
                    file.row(columns.row(log_time, publish_time, &decoded)).map_err(|e| wrong(&e))?;
                }
                None => continue,
            }
            count += 1;
        }
        Ok(count)
    }

    /// Completes the files; returns their number and what could not be decoded.
    pub(crate) fn finish(self) -> Result<(usize, Decoders), Failure> {
        let wrong = |e: &dyn Display| failed(self.name, e);
        let mut files = 0;
        for file in self.list.into_iter().filter_map(|table| table.file) {
            match file {
                TableFile::Json(mut file) => file.flush().map_err(|e| wrong(&e))?,
                TableFile::Csv(_, file) => file.finish().map_err(|e| wrong(&e))?,
                TableFile::Parquet(_, file) => file.finish().map_err(|e| wrong(&e))?,
            }
            files += 1;
        }
        Ok((files, self.decoders))
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
            let shape = Shape::of(schema.root(), self.widest).ok_or_else(|| too_wide(channel))?;
            place = Some(self.list.len());
            self.list.push(Table { channel: channel.clone(), shape, file: None });
        }
        self.places.insert(address, (channel.clone(), place));
        Ok(place)
    }

    /// Creates the files.
    fn create(&mut self) -> Result<(), Failure> {
        let mut names: Vec<String> = Vec::new();
        for table in &mut self.list {
            let base = file_name(&table.channel.topic)?;
            let taken = names.iter().filter(|name| **name == base).count();
            let number = if taken == 0 { String::new() } else { format!(".{}", taken + 1) };
            let path = |extension: &str| self.folder.join(format!("{base}{number}.{extension}"));
            let wrong = |e: &dyn Display| failed(self.name, e);
            let columns = || Columns::of(&table.shape, self.widest).ok_or_else(|| too_wide(&table.channel));
            table.file = Some(match self.format {
                TableFormat::Json => {
                    let file = File::create_new(path("jsonl")).map_err(|e| wrong(&e))?;
                    TableFile::Json(BufWriter::with_capacity(1 << 16, file))
                }
                TableFormat::Csv => {
                    let columns = columns()?;
                    let file = CsvTable::create(&path("csv"), &columns.list).map_err(|e| wrong(&e))?;
                    TableFile::Csv(columns, Box::new(file))
                }
                TableFormat::Parquet => {
                    let columns = columns()?;
                    let file = File::create_new(path("parquet")).map_err(Into::into);
                    let file = file.and_then(|file| ParquetTable::new(file, "messages", &columns.list));
                    let file = file.map_err(|e| wrong(&e))?;
                    TableFile::Parquet(columns, Box::new(file))
                }
            });
            names.push(base);
        }
        Ok(())
    }
}

fn too_wide(channel: &ChannelInfo) -> Failure {
    let topic = &channel.topic;
    Failure::usage(format!(
        "{topic}: a message has more than {MOST_COLUMNS} columns: use a smaller --array-columns, or --format json"
    ))
}

/// `/a/b` as `a_b`; other characters than letters, digits, `_`, `-` and `.` become `_`.
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
    Ok(if name.trim_matches('.').is_empty() { "topic".to_owned() } else { name })
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
