//! Progress of a run for the user, on stderr: a line for each phase, which on a terminal shows its progress while it runs.

use crate::phase_line::{self, PhaseName, Rest};
use grainlab_console::{Pace, Terminal, draw_live_line, duration, erase_live_line, say, say_line};
use grainlab_msgs::PhaseReport;
use grainlab_msgs::msg::RunState;
use std::time::{Duration, Instant};

/// Interval of the lines during a long phase, where there is no terminal.
const STILL: Duration = Duration::from_secs(10);

/// Time over which the pace of a phase is a mean, s.
const PACE: u64 = 10;

/// Prints lines with the time since the start.
#[derive(Debug)]
pub(crate) struct Progress {
    begin: Instant,
    phases: usize,
    phase: Option<Phase>,
    /// Activity while no phase runs.
    activity: &'static str,
    finished: bool,
    printed_at: Instant,
}

/// The phase under way.
#[derive(Debug)]
struct Phase {
    name: PhaseName,
    /// When it was first seen, and the step.
    began: Instant,
    first_step: u64,
    report: PhaseReport,
    pace: Pace<PACE>,
}

impl Progress {
    pub(crate) fn new(phases: usize) -> Self {
        let now = Instant::now();
        let activity = "starting the processes";
        Self { begin: now, phases, phase: None, activity, finished: false, printed_at: now }
    }

    fn seconds(&self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }

    /// Prints a line with the time.
    pub(crate) fn say(&self, text: &str) {
        say!("{} {text}", phase_line::time(self.seconds()));
        self.draw();
    }

    /// Prints a line, at most once per interval.
    pub(crate) fn still(&mut self, text: &str) {
        if self.printed_at.elapsed() >= STILL {
            self.printed_at = Instant::now();
            self.say(text);
        }
    }

    /// Takes what the simulator reports of its phase. A report of the phase before may come late.
    pub(crate) fn report(&mut self, report: PhaseReport) {
        let Some(phase) = self.phase.as_mut().filter(|p| p.name.name == report.name) else { return };
        if let Some(share) = report.share {
            phase.pace.push(phase.began.elapsed(), share);
        }
        phase.report = report;
        self.draw();
    }

    /// Sets the activity that is shown while no phase runs.
    pub(crate) fn wait_for(&mut self, activity: &'static str) {
        self.activity = activity;
        self.phase = None;
        self.draw();
    }

    /// Takes the state of the run: a phase began, is over, or takes long.
    pub(crate) fn show(&mut self, state: &RunState) {
        match state.state {
            RunState::FINISHED if !std::mem::replace(&mut self.finished, true) => {
                self.end_phase(state.step);
                self.activity = "waiting for the results of the last packing";
                self.say(&format!("the loading path is done at step {}", state.step));
            }
            RunState::RUNNING => {
                let phase = self.phase.as_ref();
                if phase.is_none_or(|p| p.name.number != state.phase) {
                    // A restarted simulator may return to an earlier phase.
                    if phase.is_some_and(|p| p.name.number < state.phase) {
                        self.end_phase(state.step);
                    }
                    self.begin_phase(state);
                } else if self.printed_at.elapsed() >= STILL && Terminal::on_stderr().is_none() {
                    self.go_on(state.step);
                }
            }
            _ => {}
        }
        self.draw();
    }

    fn begin_phase(&mut self, state: &RunState) {
        self.printed_at = Instant::now();
        let name = PhaseName { number: state.phase, of: self.phases, name: state.phase_name.clone() };
        self.phase = Some(Phase {
            name: name.clone(),
            began: Instant::now(),
            first_step: state.step,
            report: PhaseReport::default(),
            pace: Pace::default(),
        });
        if Terminal::on_stderr().is_none() {
            let PhaseName { number, of, name } = name;
            self.say(&format!("phase {number} of {of}, {name} from step {}", state.step));
        }
    }

    /// A line of a phase that takes long.
    fn go_on(&mut self, step: u64) {
        self.printed_at = Instant::now();
        let Some(phase) = &self.phase else { return };
        let PhaseName { number, of, name } = &phase.name;
        let rest = match phase.rest() {
            Rest::Unknown => String::new(),
            Rest::Share(share, left) => {
                let left = left.map_or_else(String::new, |s| format!(", about {} left", duration(s)));
                format!(": {:.0} %{left}", (100.0 * share).floor())
            }
            Rest::Unmet(unmet) => format!(": {unmet}"),
        };
        self.say(&format!("phase {number} of {of}, {name} continues at step {step}{rest}"));
    }

    /// On a terminal, the line of the phase that is over stays.
    fn end_phase(&mut self, step: u64) {
        let (Some(phase), Some(terminal)) = (self.phase.take(), Terminal::on_stderr()) else { return };
        let counts = (step.saturating_sub(phase.first_step), phase.began.elapsed().as_secs_f64());
        say_line(phase_line::done(self.seconds(), &phase.name, counts, terminal.width));
    }

    /// Draws the live line again; nothing where there is no terminal.
    pub(crate) fn draw(&self) {
        let Some(Terminal { width, colour }) = Terminal::on_stderr() else { return };
        let line = match &self.phase {
            Some(phase) => phase_line::live(self.seconds(), &phase.name, &phase.rest(), width, colour),
            None => phase_line::activity(self.seconds(), self.activity, width),
        };
        draw_live_line(&line);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        erase_live_line();
    }
}

impl Phase {
    fn rest(&self) -> Rest {
        match (self.report.share, self.report.unmet.as_str()) {
            (Some(share), _) => Rest::Share(share, self.pace.time_until(1.0)),
            (None, "") => Rest::Unknown,
            (None, unmet) => Rest::Unmet(unmet.to_owned()),
        }
    }
}
