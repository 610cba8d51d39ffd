//! After the loading path: the last messages, and the results of the last packing.

use super::DemSimulator;
use crate::messages::Remark;
use crate::publication::{HOLD, PATIENT_FLUSH_LIMIT, flush_last_messages};
use crate::run_end::Verdict;
use crate::settings::Finish;
use grainlab_msgs::msg::RunState;
use grainlab_node_kit::{Bus, Exit, Next, NodeError};

impl DemSimulator {
    pub(super) fn wait_after_end(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        self.publication.deliver(bus)?;
        if !self.publication.queue().is_empty() {
            return Ok(Next::Wait(HOLD));
        }
        let finish = self.settings.finish;
        if finish == Finish::AtOnce {
            flush_last_messages(bus, PATIENT_FLUSH_LIMIT);
            return Ok(Next::Finished(Exit::Done));
        }
        if let Some(Verdict { exit, reason }) = self.verdict.as_ref().filter(|_| finish == Finish::Inverted) {
            flush_last_messages(bus, PATIENT_FLUSH_LIMIT);
            return match exit {
                Exit::Done => Ok(Next::Finished(Exit::Done)),
                exit => Err(NodeError::new(*exit, reason)),
            };
        }
        if self.verdict.is_none() && self.judge(bus) {
            return Ok(Next::Wait(HOLD));
        }
        Ok(Next::Wait(self.publication.next_beat().saturating_sub(bus.now())))
    }

    /// Judges the end of the run by the results of the last packing, and publishes the exit; false while results are awaited.
    fn judge(&mut self, bus: &mut dyn Bus) -> bool {
        let packings = self.publication.packings();
        let judged = match &mut self.results {
            Some(results) if packings.count > 0 => results.look(bus, packings.last_step),
            _ => Ok(Verdict { exit: Exit::Done, reason: String::new() }),
        };
        match judged {
            Err(what) => {
                self.remark = format!("waiting for {what}").into();
                if self.notice_due(bus.now()) {
                    log::info!("{}", self.remark.text);
                }
                false
            }
            Ok(verdict) => {
                // A process that ends says its error itself.
                if verdict.exit != Exit::Done && self.settings.finish == Finish::Never {
                    log::error!("{}", verdict.reason);
                }
                self.remark = Remark { text: verdict.reason.clone(), exit: Some(verdict.exit) };
                self.publication.state(self.run.simulation(), RunState::FINISHED, self.remark.clone());
                self.verdict = Some(verdict);
                true
            }
        }
    }

    /// Returns the exit of a simulator that is asked to end after the loading path.
    pub(super) fn exit_after_end(&self) -> Exit {
        match (&self.verdict, self.settings.finish) {
            (Some(verdict), Finish::Inverted) => verdict.exit,
            (None, Finish::Inverted) => Exit::Interrupted,
            _ => Exit::Done,
        }
    }
}
