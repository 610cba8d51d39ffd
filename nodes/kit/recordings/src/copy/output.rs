//! The output of a copy: a temporary file or directory that becomes the named one at the end.

use std::borrow::Cow;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, McapError};

use crate::bag_metadata::{BagMetadata, TopicCount};
use crate::compression::Compression;
use crate::failures::{cannot, reason};
use crate::new_path::NewPath;
use crate::reader::{ChannelInfo, FileCount, Message, Recording, StoredFile};
use crate::writer::TopicSpec;
use grainlab_console::Failure;

const BUFFER: usize = 1 << 20;

pub(super) struct Output {
    mcap: mcap::Writer<BufWriter<File>>,
    /// The final name.
    path: PathBuf,
    new: NewPath,
    /// The MCAP file, with its temporary name.
    file: PathBuf,
    is_directory: bool,
    bag: BagMetadata,
    /// Id and topic of each channel, in the order in which they were declared.
    channels: Vec<(u16, String)>,
    counts: Vec<u64>,
    bounds: Option<(u64, u64)>,
}

impl Output {
    /// Begins `path`: one file if its name ends with `.mcap`, else a directory.
    pub(super) fn begin(path: &Path, profile: &str, compression: Compression) -> Result<Self, Failure> {
        let io = |action| cannot::<io::Error>(path, action);
        let new = NewPath::begin(path).map_err(|e| exists_or(path, "begin the output", e))?;
        let is_directory = path.extension().is_none_or(|e| e != "mcap");
        let file = if is_directory {
            fs::create_dir(new.partial()).map_err(io("create the directory"))?;
            let mut first = path.file_name().unwrap_or_default().to_owned();
            first.push("_0.mcap");
            new.partial().join(first)
        } else {
            new.partial().to_owned()
        };
        let opened = File::create_new(&file).map_err(io("create the file"))?;
        let options = mcap::WriteOptions::new()
            .profile(profile)
            .library(format!("grainlab {}, copy", env!("CARGO_PKG_VERSION")))
            .compression(compression.of_chunks())
            .compression_level(1)
            .compression_threads(0)
            .chunk_size(Some(1 << 20));
        let mcap = options.create(BufWriter::with_capacity(BUFFER, opened));
        Ok(Self {
            mcap: mcap.map_err(|e| cannot(path, "write the header")(reason(e)))?,
            path: path.to_owned(),
            new,
            file,
            is_directory,
            bag: BagMetadata::default(),
            channels: Vec::new(),
            counts: Vec::new(),
            bounds: None,
        })
    }

    fn with<T>(
        &mut self,
        action: &'static str,
        run: impl FnOnce(&mut mcap::Writer<BufWriter<File>>) -> Result<T, McapError>,
    ) -> Result<T, Failure> {
        run(&mut self.mcap).map_err(|e| cannot(&self.path, action)(reason(e)))
    }

    pub(super) fn declare(&mut self, channel: &ChannelInfo) -> Result<(), Failure> {
        let id = self.with("declare a topic", |mcap| channel.declare(mcap))?;
        self.channels.push((id, channel.topic.clone()));
        self.counts.push(0);
        let spec = TopicSpec::of_channel(channel);
        self.bag.topics.entry(channel.topic.clone()).or_insert(TopicCount { spec, messages: 0 });
        Ok(())
    }

    /// Writes a schema that no channel needs to have.
    pub(super) fn schema(&mut self, name: &str, encoding: &str, content: &[u8]) -> Result<(), Failure> {
        self.with("write a definition", |mcap| mcap.add_schema(name, encoding, content).map(drop))
    }

    /// Keeps what a user stored in the metadata of the sources; returns notes about what is lost.
    pub(super) fn carry(&mut self, recordings: &[Recording]) -> Vec<String> {
        let path = |r: &Recording| r.path().display().to_string();
        let mut notes = Vec::new();
        for recording in recordings {
            for name in self.bag.carry(recording) {
                notes.push(format!(
                    "custom_data {name} of {} differs; that before it is kept",
                    path(recording)
                ));
            }
        }
        if !self.is_directory && self.bag.custom_data.as_object().is_some_and(|texts| !texts.is_empty()) {
            notes.push(
                "custom_data of metadata.yaml is left out: one file has none; write a directory".to_owned(),
            );
        }
        notes
    }

    /// Writes a payload to the channel at this place, with the sequence and the time of publishing of a message.
    pub(super) fn message(
        &mut self,
        place: usize,
        log_time: u64,
        message: &Message,
        payload: &[u8],
    ) -> Result<(), Failure> {
        let Message { sequence, publish_time, .. } = *message;
        let header = MessageHeader { channel_id: self.channels[place].0, sequence, log_time, publish_time };
        self.with("write a message", |mcap| mcap.write_to_known_channel(&header, payload))?;
        self.counts[place] += 1;
        let (first, last) = self.bounds.unwrap_or((log_time, log_time));
        self.bounds = Some((first.min(log_time), last.max(log_time)));
        Ok(())
    }

    pub(super) fn store(&mut self, file: &StoredFile) -> Result<(), Failure> {
        let attachment = Attachment {
            log_time: file.time,
            create_time: file.created,
            name: file.name.clone(),
            media_type: file.media_type.clone(),
            data: Cow::Borrowed(&file.bytes),
        };
        self.with("store a file", |mcap| mcap.attach(&attachment))
    }

    pub(super) fn metadata(&mut self, metadata: &Metadata) -> Result<(), Failure> {
        self.with("write the metadata", |mcap| mcap.write_metadata(metadata))
    }

    /// Completes the output and gives it its name. Returns its size, bytes.
    pub(super) fn finish(mut self) -> Result<u64, Failure> {
        let path = self.path.clone();
        let io = |action| cannot::<io::Error>(&path, action);
        self.with("write the index", |mcap| mcap.finish().map(drop))?;
        let file = self.mcap.into_inner().into_inner();
        let file = file.map_err(|e| io("write the end of the file")(e.into_error()))?;
        let bytes = file.metadata().map_err(io("query the size"))?.len();
        if self.is_directory {
            let messages = self.counts.iter().sum();
            let name = self.file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
            self.bag.files = vec![FileCount { name, bounds: self.bounds, messages }];
            for ((_, topic), count) in self.channels.iter().zip(&self.counts) {
                if let Some(t) = self.bag.topics.get_mut(topic) {
                    t.messages += count;
                }
            }
            self.bag.write(self.new.partial()).map_err(io("write metadata.yaml"))?;
        }
        self.new.finish().map_err(|e| exists_or(&path, "give the output its name", e))?;
        Ok(bytes)
    }
}

fn exists_or(path: &Path, action: &str, source: io::Error) -> Failure {
    match source.kind() {
        io::ErrorKind::AlreadyExists => {
            let path = path.display();
            Failure::usage(format!("{path} exists: choose another output; nothing is overwritten"))
        }
        _ => cannot(path, action)(source),
    }
}
