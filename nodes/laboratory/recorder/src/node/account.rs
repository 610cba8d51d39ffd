//! What a recording says of the processes of its run, and of the messages that they announced.

use super::{Recorder, lost};
use crate::binding::Binding;
use crate::strangers::grouped;
use grainlab_msgs::Guid;
use grainlab_node_kit::{Bus, NodeError, Stranger};
use grainlab_recordings::strangers::{self, StrangerView};

impl Recorder {
    fn strangers(&self, bus: &dyn Bus) -> Vec<StrangerView> {
        let of_bus = bus.strangers();
        let of_binding = self.binding.iter().flat_map(|b| b.ignored()).map(|(participant, topics)| {
            let ignored = topics.iter().map(|(topic, count)| ((*topic).to_owned(), *count)).collect();
            Stranger { ignored, ..bus.describe(Guid::of_participant(*participant)) }
        });
        grouped(&self.noted_strangers, of_bus.into_iter().chain(of_binding))
    }

    /// Hands what is known about the processes of the run to the writer, for the metadata of the recording.
    pub(super) fn describe_processes(&mut self, bus: &dyn Bus) -> Result<(), NodeError> {
        let strangers = self.strangers(bus);
        let Some(writer) = &mut self.writer else { return Ok(()) };
        let express = |value: serde_json::Result<String>| value.map_err(|e| lost(&e));
        writer.set_metadata(strangers::STRANGERS, &express(serde_json::to_string(&strangers))?);
        if let Some(sentence) = self.left_out.sentence() {
            log::info!("{sentence}");
            writer.set_metadata(strangers::LEFT_OUT, &sentence);
        }
        if !self.disputes.lines.is_empty() {
            writer.set_metadata(strangers::DISPUTES, &express(serde_json::to_string(&self.disputes.lines))?);
        }
        writer.set_metadata(strangers::AUTHORS, &express(serde_json::to_string(&self.authors))?);
        if let Some(run) = self.binding.as_ref().and_then(Binding::run) {
            writer.set_metadata("run", &Guid::of_participant(run).to_string()[..24]);
        }
        Ok(())
    }

    /// Enters what the writers announced until now. What they announce later is not due any longer.
    pub(super) fn note_announcements(&mut self, bus: &dyn Bus) {
        let Some(writer) = &mut self.writer else { return };
        for channel in &self.channels {
            for announced in bus.announced(channel.source.id()) {
                let (name, guid) = (&channel.name, announced.writer);
                let ledger = writer.ledger_mut();
                // A writer that this run did not hear may belong to another laboratory.
                if self.whole_run && !ledger.has_received(name, &guid) {
                    continue;
                }
                ledger.announce(name, guid, announced.first, announced.last);
                if let Some(large) = announced.too_large {
                    ledger.fail(name, guid, large.first, large.last);
                    log::error!(
                        "{name}: {} of {guid} not recorded: the limit is {} bytes, and the largest has {} bytes",
                        grainlab_console::count(large.count, "message"),
                        large.limit,
                        large.largest
                    );
                }
            }
        }
    }
}
