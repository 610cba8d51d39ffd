//! A recording of what the node `fabric_analyzer` would publish.

use crate::failure::Failure;
use fabric_analyzer::Measured;
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{to_cdr, topics};
use recordings::{Guid, Incoming, RunWriter, TopicSpec, WriterOptions};
use std::path::Path;

/// Stands for the writer, which no network has named.
const WRITER: Guid = Guid(*b"grainlab analyze");

/// Writes the messages. Their log times are their stamps, moved forward where that takes it: two recordings of the same
/// packings are the same.
pub(super) struct Recorder {
    writer: RunWriter,
    fabrics: i64,
    moduli: i64,
}

impl Recorder {
    /// Begins a recording in this directory.
    pub(super) fn create(directory: &Path) -> Result<Self, Failure> {
        let name = directory.file_name().map(|n| n.to_string_lossy().into_owned());
        let Some(name) = name.filter(|_| directory.extension().is_none_or(|e| e != "mcap")) else {
            let shown = directory.display();
            return Err(Failure::usage(format!(
                "--record {shown} must name a directory, as bag record -o does"
            )));
        };
        let topics = [topics::FABRIC, topics::MODULI].map(|t| TopicSpec::of_contract(&t, &t.absolute_name()));
        let mut writer = RunWriter::create(directory, &name, &topics, WriterOptions::default())
            .map_err(Failure::failed)?;
        writer.set_metadata("grainlab", env!("CARGO_PKG_VERSION"));
        Ok(Self { writer, fabrics: 0, moduli: 0 })
    }

    /// Records the messages about one packing.
    pub(super) fn write(&mut self, measured: &Measured) -> Result<(), Failure> {
        self.fabrics += 1;
        let fabric = &measured.fabric;
        self.put(&topics::FABRIC.absolute_name(), self.fabrics, &fabric.header, &to_cdr(fabric))?;
        if let Ok(moduli) = &measured.moduli {
            self.moduli += 1;
            self.put(&topics::MODULI.absolute_name(), self.moduli, &moduli.header, &to_cdr(moduli))?;
        }
        Ok(())
    }

    fn put(&mut self, topic: &str, sequence: i64, header: &Header, payload: &[u8]) -> Result<(), Failure> {
        let seconds = u64::try_from(header.stamp.sec).unwrap_or(0);
        let time = seconds * 1_000_000_000 + u64::from(header.stamp.nanosec);
        let sample =
            Incoming { guid: WRITER, sequence, source_time: Some(time), receive_time: time, payload };
        self.writer.write(topic, &sample).map(drop).map_err(Failure::failed)
    }

    /// Completes the recording.
    pub(super) fn finish(mut self) -> Result<(), Failure> {
        for (topic, count) in [(topics::FABRIC, self.fabrics), (topics::MODULI, self.moduli)] {
            self.writer.ledger_mut().report(&topic.absolute_name(), WRITER, count as u64);
        }
        self.writer.ledger_mut().name(WRITER, "analyze");
        self.writer.finish().map(drop).map_err(Failure::failed)
    }
}
