//! Ends the processes of a run in order.

use super::child::{Child, Ended};
use super::supervisor::{POLL_PERIOD, STOPPED_AT_MOST, Supervisor};
use super::watch::{Event, Watch};
use crate::last_packing;
use crate::nodes::NodeKind;
use grainlab_console::worse;
use grainlab_dem_simulator::SAVED_WITHIN;
use grainlab_node_kit::Exit;
use std::time::Duration;
use tokio::sync::mpsc::UnboundedReceiver;
use tokio::time::{sleep_until, timeout};

/// Time limit for the end of a process after SIGKILL.
const KILLED_WITHIN: Duration = Duration::from_secs(1);

/// Time that a simulator needs, besides, to end a step and to leave.
const LEAVES_WITHIN: Duration = Duration::from_secs(5);

/// Signal 0: nothing is sent.
const NONE: i32 = 0;

/// Time after which the launcher says what is not done.
const SLOW: Duration = Duration::from_secs(3);

/// The steps of an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ending {
    /// Every node ends and sends its last report, which is recorded.
    Farewell,
    /// The simulator saves its state, and sends its last report.
    Save,
    Record,
    /// Processes that still run are ended by SIGTERM and SIGKILL.
    Exit,
}

impl Ending {
    /// The signals, each with the time until the next one. The recorder syncs its file to the device, which takes many
    /// seconds on a busy disk; a second interrupt of the user ends it earlier.
    fn signals(self) -> [(i32, Duration); 3] {
        let first = match self {
            Ending::Farewell => (libc::SIGINT, Duration::from_secs(5)),
            // It has its SIGINT already: a second one would end it at once.
            Ending::Save => (NONE, SAVED_WITHIN + LEAVES_WITHIN),
            Ending::Record => (libc::SIGINT, Duration::from_secs(60)),
            Ending::Exit => (libc::SIGINT, Duration::from_secs(1)),
        };
        [first, (libc::SIGTERM, Duration::from_secs(1)), (libc::SIGKILL, KILLED_WITHIN)]
    }
}

impl Supervisor {
    /// Ends every process; true if the user interrupted again.
    pub(super) async fn end_all(
        &mut self,
        exit: Exit,
        events: &mut UnboundedReceiver<Event>,
        watch: &Watch,
    ) -> bool {
        let mut hurried = false;
        self.followed.progress.wait_for("ending the processes");
        for ending in [Ending::Farewell, Ending::Save, Ending::Record, Ending::Exit] {
            // An interrupted run ends at once; a complete run waits for stopped processes.
            let waits = exit != Exit::Interrupted && !hurried;
            hurried |= self.end(ending, waits, events).await;
            if ending != Ending::Farewell {
                // It ends together with the processes.
                watch.stop();
            }
        }
        hurried
    }

    /// True if the simulator has a state to save: it has published one.
    fn may_save(&self) -> bool {
        self.followed.first_step.is_some()
    }

    /// True if an end still waits for this child.
    fn awaits(&self, child: &Child, ending: Ending) -> bool {
        let [recorder, simulator] = [NodeKind::Recorder, NodeKind::DemSimulator].map(|n| child.plan.is(n));
        match (ending, child.pid) {
            (_, None) => false,
            (Ending::Farewell, Some(pid)) => !recorder && !self.followed.left.contains(&pid),
            (Ending::Save, Some(pid)) => simulator && self.may_save() && !self.followed.left.contains(&pid),
            (Ending::Record, _) => recorder,
            (Ending::Exit, _) => true,
        }
    }

    /// One step of the end: SIGINT, SIGTERM, SIGKILL at intervals. True if the user interrupted again,
    /// which kills all remaining processes.
    async fn end(&mut self, ending: Ending, waits: bool, events: &mut UnboundedReceiver<Event>) -> bool {
        let mut hurried = false;
        let slow = match ending {
            Ending::Save => Some("the simulator saves its state"),
            Ending::Record => Some("the recorder is writing the recording to the disk"),
            Ending::Farewell | Ending::Exit => None,
        };
        let mut slow_at = slow.map(|_| tokio::time::Instant::now() + SLOW);
        for (signal, time) in ending.signals() {
            let signal = if hurried { libc::SIGKILL } else { signal };
            // A process that sent its last report has received the signal, and a second one would end it at once.
            if ending != Ending::Exit || signal != libc::SIGINT {
                // A simulator that saves its state is given more time, after the others.
                let spares =
                    ending == Ending::Farewell && signal != libc::SIGINT && !hurried && self.may_save();
                let is_meant =
                    |c: &&Child| self.awaits(c, ending) && !(spares && c.plan.is(NodeKind::DemSimulator));
                self.children.iter().filter(is_meant).for_each(|c| c.signal(signal));
            }
            let running = |s: &Self| s.children.iter().any(|c| s.awaits(c, ending));
            let mut deadline = tokio::time::Instant::now() + time;
            let latest = deadline + if waits { STOPPED_AT_MOST } else { Duration::ZERO };
            while running(self) && !hurried {
                let now = tokio::time::Instant::now();
                if now >= deadline {
                    break;
                }
                tokio::select! {
                    biased;
                    _ = self.interrupt.recv() => hurried = true,
                    _ = self.terminate.recv() => hurried = true,
                    Some(ended) = self.ended.recv() => { self.note_end(&ended); }
                    Some(event) = events.recv() => self.followed.take(event),
                    () = sleep_until((now + POLL_PERIOD).min(deadline)) => {
                        if waits && self.look_for_stopped() {
                            deadline = (tokio::time::Instant::now() + time).min(latest);
                        }
                        if slow_at.take_if(|at| tokio::time::Instant::now() >= *at).is_some() {
                            self.followed.progress.say(slow.unwrap_or_default());
                        }
                    }
                }
            }
            if !running(self) {
                return hurried;
            }
            if hurried && signal == libc::SIGKILL {
                while running(self) {
                    let Ok(Some(ended)) = timeout(KILLED_WITHIN, self.ended.recv()).await else { break };
                    self.note_end(&ended);
                }
            }
        }
        hurried
    }

    /// The exit of the run after the end of its recorder.
    pub(super) fn judge_recorder(&mut self, exit: Exit) -> Exit {
        const RECORDER: NodeKind = NodeKind::Recorder;
        if self.code(RECORDER) == Some(0) {
            return exit;
        }
        // Data loss is in the table; other errors are only in the recorder's log.
        let failed = self.children.iter().position(|c| c.plan.is(RECORDER) && c.code == Some(1));
        if let Some(recorder) = failed.filter(|_| self.followed.blame(RECORDER, 1)) {
            self.children[recorder].quote_log(&self.logs);
        }
        // A code of its own says why.
        let by_itself = [Exit::Failure, Exit::DataLoss].map(|exit| Some(i32::from(exit.code())));
        if !by_itself.contains(&self.code(RECORDER)) {
            // It may be killed while it leaves, with its file complete.
            if last_packing::is_complete(&self.directory) {
                return exit;
            }
            self.followed.complain(format!("{RECORDER} was ended before its file was complete"));
        }
        worse(exit, Exit::DataLoss)
    }

    /// Records the end of a process and describes it.
    pub(super) fn note_end(&mut self, ended: &Ended) -> String {
        use std::os::unix::process::ExitStatusExt;
        let child = &mut self.children[ended.index];
        child.pid = None;
        match &ended.status {
            Ok(status) => {
                child.code = status.code();
                match (status.code(), status.signal()) {
                    (Some(code), _) => format!("ended with exit code {code}"),
                    (None, Some(signal)) => format!("was ended by signal {signal}"),
                    (None, None) => "ended".to_owned(),
                }
            }
            Err(error) => format!("cannot be waited for ({error})"),
        }
    }
}
