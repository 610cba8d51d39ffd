//! The checks before the first request: no other simulator, enough readers, one servo.

use super::{DemSimulator, Stage};
use crate::duplicate_simulators::Verdict;
use crate::partner::{different, predecessor};
use grainlab_msgs::topics;
use grainlab_node_kit::{Bus, BusError, Exit, Next, NodeError};
use std::time::Duration;

/// Period at which a waiting start checks again.
const LOOK_AGAIN: Duration = Duration::from_millis(50);

/// A crashed servo stays in the graph until its lease ends, within a minute. Two servos that are present for longer are
/// an error.
const TWO_SERVOS: Duration = Duration::from_secs(75);

impl DemSimulator {
    pub(super) fn receive_run_states(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<(), BusError> {
        while let Some((_, info)) = self.run_states.take_valid(bus)? {
            if predecessor(&info.writer.participant(), &self.servo.own()) {
                continue;
            }
            if self.duplicates.note_state(info.writer, now) && self.stage != Stage::Starting {
                log::error!(
                    "a second simulator ({}) publishes on our topics; it should end by itself",
                    info.writer
                );
            }
        }
        Ok(())
    }

    pub(super) fn start(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<Next, NodeError> {
        let looked = now.saturating_sub(self.created_at);
        if looked < self.settings.look_around {
            return Ok(Next::Wait(self.settings.look_around - looked));
        }
        let mut simulators = bus.foreign_writers(&topics::STRESS);
        // The process that this one replaces stays in the graph for a while.
        simulators.retain(|writer| !predecessor(&writer.participant(), &self.servo.own()));
        match self.duplicates.verdict(&simulators, now) {
            Verdict::Clear => {}
            Verdict::Wait(writer) => {
                self.awaited = "a silent simulator to publish or leave".into();
                if self.notice_due(now) {
                    log::warn!(
                        "another writer of stress ({writer}) is present and silent; waiting until it publishes or leaves"
                    );
                }
                return Ok(Next::Wait(LOOK_AGAIN));
            }
            Verdict::Refuse(writer) => {
                let message = format!(
                    "another simulator (writer {writer}) is on topic stress; two would mix their runs. Stop it, or start \
                     this one in another ROS_DOMAIN_ID or namespace (--ros-args -r __ns:=/other)"
                );
                return Err(NodeError::new(Exit::Failure, message));
            }
        }
        let servos = different(&bus.foreign_writers(&topics::STRAIN_RATE));
        if let [first, second, ..] = servos[..] {
            let both = format!("{} and {}", bus.describe(first), bus.describe(second));
            if looked > TWO_SERVOS {
                let message = format!(
                    "two writers of strain_rate: {both}. It is unknown which of them is the servo of this run: stop one, or \
                     give the processes of this run a run of their own (GRAINLAB_RUN=any_name for each of them)"
                );
                return Err(NodeError::new(Exit::Failure, message));
            }
            self.awaited = "one of two servos to leave".into();
            if self.notice_due(now) {
                log::warn!("two writers of strain_rate: {both}; waiting for one to leave");
            }
            return Ok(Next::Wait(LOOK_AGAIN));
        }
        if let Some(missing) = self.missing(bus) {
            self.awaited.clone_from(&missing);
            if self.notice_due(now) {
                log::info!("waiting for {missing}");
            }
            return Ok(Next::Wait(LOOK_AGAIN));
        }
        self.began = now;
        if let Some(results) = &mut self.results {
            results.begin(bus)?;
        }
        if let Some(packing) = self.resumed.take() {
            self.publication.first_packing(&packing);
        }
        self.exchange(bus, now)
    }

    /// The first condition of the start that is not met.
    fn missing(&self, bus: &dyn Bus) -> Option<String> {
        let of_all = self.settings.min_readers;
        for topic in &self.settings.wait_for {
            let needed = match topic.name {
                name if name == topics::PACKING.name => self.settings.min_packing_readers.unwrap_or(of_all),
                name if name == topics::CLOCK.name => 1,
                _ => of_all,
            };
            let is_stress = topic.name == topics::STRESS.name;
            let publisher = if is_stress { self.servo.stress() } else { self.publication.publisher(topic) };
            let found = bus.readers(publisher);
            if found < needed {
                return Some(format!("{needed} readers of {}; there are {found}", topic.name));
            }
        }
        (!self.servo.is_present(bus)).then(|| {
            "a servo: a reader of stress that writes strain_rate (same domain and namespace?)".into()
        })
    }
}
