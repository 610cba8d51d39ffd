//! Progress of a run for the user: a line for each phase, on stderr.

use grainlab_msgs::boundary::{RunStateReading, RunStatus};
use std::time::{Duration, Instant};

/// Interval of the lines during a long phase.
const STILL: Duration = Duration::from_secs(10);

/// Prints lines with the time since the start.
#[derive(Debug)]
pub(crate) struct Progress {
    begin: Instant,
    phases: usize,
    phase: Option<u32>,
    /// The end conditions of the phase that did not hold when the simulator last reported.
    unmet: String,
    finished: bool,
    printed_at: Instant,
}

impl Progress {
    /// For a path with this many phases.
    pub(crate) fn new(phases: usize) -> Self {
        let now = Instant::now();
        Self { begin: now, phases, phase: None, unmet: String::new(), finished: false, printed_at: now }
    }

    /// Prints a line with the time.
    pub(crate) fn say(&self, text: &str) {
        grainlab_console::say!("[{:7.2} s] {text}", self.begin.elapsed().as_secs_f64());
    }

    /// Prints a line, at most once per interval.
    pub(crate) fn still(&mut self, text: &str) {
        if self.printed_at.elapsed() >= STILL {
            self.printed_at = Instant::now();
            self.say(text);
        }
    }

    /// The end conditions of the present phase that do not hold: for the next line of a long phase.
    pub(crate) fn unmet(&mut self, conditions: String) {
        self.unmet = conditions;
    }

    /// Prints a line if a phase began or takes long.
    pub(crate) fn show(&mut self, state: &RunStateReading) {
        let step = state.step;
        if state.status == RunStatus::Finished {
            if !std::mem::replace(&mut self.finished, true) {
                self.say(&format!("the loading path is done at step {step}"));
            }
            return;
        }
        if state.status == RunStatus::Failed
            || (self.phase == Some(state.phase) && self.printed_at.elapsed() < STILL)
        {
            return;
        }
        self.printed_at = Instant::now();
        let (number, of, name) = (state.phase + 1, self.phases, &state.phase_name);
        if self.phase.replace(state.phase) == Some(state.phase) {
            let unmet = after(": ", &self.unmet);
            self.say(&format!("phase {number} of {of}, {name} continues at step {step}{unmet}"));
        } else {
            self.unmet.clear();
            let left_out = after(", ", &state.message);
            self.say(&format!("phase {number} of {of}, {name} from step {step}{left_out}"));
        }
    }
}

/// A text after a separator; nothing if the text is empty.
fn after(separator: &str, text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("{separator}{text}") }
}
