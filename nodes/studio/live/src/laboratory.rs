//! Knowledge of the run that the page shows, in bounded memory.

use grainlab_console::Pace;
use grainlab_core::Packing;
use grainlab_core::results::PackingReport;
use grainlab_msgs::{PhaseReport, msg, simulated_seconds};
use grainlab_node_kit::{Exit, Report, RunId};
use grainlab_report::{Timeline, view};
use grainlab_results::{Inference, Measurement, Origin};
use grainlab_servo::ServoRequest;
use grainlab_viewer::View;
use std::time::Duration;

/// Phases of a run of which nothing is known yet: they share the bins of the curves. A phase has twice the bins of a report, to
/// zoom in.
const PHASES: usize = 3;

/// Time over which the rate of the simulation is a mean, s.
const RATE_WINDOW: u64 = 3;

/// Time over which the pace of a phase is a mean, s.
const PHASE_WINDOW: u64 = 10;

/// Most estimates that are kept of one packing.
const ESTIMATES: usize = 64;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Complete,
    Early(String),
    /// The simulator has left without a report of the end.
    Vanished,
}

/// One run. Messages are taken as they arrive; times are those of the reader's clock.
#[derive(Debug, Default)]
pub struct Laboratory {
    /// The id that the launcher gave, if it was launched.
    pub(crate) run: Option<RunId>,
    pub(crate) scene: String,
    pub(crate) timeline: Timeline,
    pub(crate) latest: Option<ServoRequest>,
    pub(crate) state: Option<msg::RunState>,
    pub(crate) report: Option<PackingReport>,
    /// The estimates from one packing, with its step.
    pub(crate) inferred: (u64, Vec<Inference>),
    pub(crate) grains: Option<u32>,
    pub(crate) steps: Pace<RATE_WINDOW>,
    pub(crate) of_phase: PhaseReport,
    /// The share of the phase under way.
    pub(crate) pace: Pace<PHASE_WINDOW>,
    pub(crate) end: Option<End>,
    /// When it was first heard of.
    pub(crate) began: Duration,
    /// When the simulator was heard last.
    pub(crate) heard: Duration,
    /// The grains between two packings, with their step.
    sampled: Option<(u64, View)>,
    /// Number of packings taken for pictures.
    pub(crate) pictured: u64,
    /// Messages that do not satisfy the contract.
    pub(crate) refused: u64,
}

impl Laboratory {
    /// A run that was first heard of at this time.
    pub fn new(run: Option<RunId>, now: Duration) -> Self {
        Self { run, timeline: Timeline::of_phases(PHASES), began: now, heard: now, ..Self::default() }
    }

    /// Takes a request of the lockstep.
    pub fn request(&mut self, message: &msg::Stress, now: Duration) {
        let Ok(request) = ServoRequest::try_from(message) else { return self.refused += 1 };
        self.heard = now;
        if self.timeline.request(&request) {
            self.steps.push(now, request.step as f64);
            self.latest = Some(request);
        }
    }

    /// Takes the state of the run.
    pub fn run_state(&mut self, message: &msg::RunState, now: Duration) {
        let Ok(state) = message.checked() else { return self.refused += 1 };
        self.heard = now;
        self.timeline.name(state.phase, &state.phase_name);
        self.steps.push(now, state.step as f64);
        self.end = match state.state {
            // A restarted simulator goes on.
            msg::RunState::RUNNING => None,
            msg::RunState::FINISHED => Some(End::Complete),
            _ => Some(End::Early(state.message.clone())),
        };
        self.state = Some(state.clone());
    }

    /// Takes a packing.
    pub fn packing(&mut self, message: &msg::Packing) {
        let Ok(packing) = Packing::try_from(message) else { return self.refused += 1 };
        self.scene.clone_from(&message.scene);
        self.grains = u32::try_from(packing.grains()).ok();
        if self.timeline.packing(packing) {
            self.pictured += 1;
        }
    }

    /// Takes the grains between two packings: in the pictures until there is a later state.
    pub fn state_of_grains(&mut self, message: &msg::Packing) {
        let Ok(packing) = Packing::try_from(message) else { return self.refused += 1 };
        self.scene.clone_from(&message.scene);
        let mut view = view(&packing);
        view.label += ", now";
        self.sampled = Some((packing.step, view));
        self.pictured += 1;
    }

    /// The states for pictures: the packings, and the grains of now if they are later and as many.
    pub(crate) fn views(&self) -> Vec<&View> {
        let mut views = self.timeline.film().states();
        let last = self.timeline.last().map(|p| (p.step, p.grains()));
        let sampled = self.sampled.as_ref().filter(|(step, view)| {
            self.end.is_none() && last.is_none_or(|(s, n)| s < *step && n == view.grains())
        });
        views.extend(sampled.map(|(_, view)| view));
        views
    }

    /// Takes the report of a packing.
    pub fn packing_report(&mut self, message: &msg::PackingReport) {
        let Ok(report) = PackingReport::try_from(message) else { return self.refused += 1 };
        self.timeline.structure(simulated_seconds(&message.header.stamp), &report);
        self.report = Some(report);
    }

    /// Takes what was inferred from a packing.
    pub fn microstructure(&mut self, message: &msg::Microstructure) {
        let Ok(results) = message.results() else { return self.refused += 1 };
        let (step, known) = &mut self.inferred;
        if *step != message.source_step {
            (*step, *known) = (message.source_step, Vec::new());
        }
        for estimate in results {
            // A name tells several measurements of a packing apart.
            let measurement = (!message.name.is_empty()).then(|| Measurement::named(&message.name));
            let found = Inference {
                origin: Origin { source: Some(message.source.clone()), by: None, measurement },
                estimate,
            };
            if known.len() < ESTIMATES && !known.contains(&found) {
                known.push(found);
            }
        }
    }

    pub(crate) fn simulator(&mut self, report: &Report, now: Duration) {
        self.heard = now;
        let health = &report.health;
        self.grains = health.value("grains").and_then(|n| n.parse().ok()).or(self.grains);
        if let Some(scene) = health.value("scene") {
            scene.clone_into(&mut self.scene);
        }
        let of_phase = health.phase().unwrap_or_default();
        if of_phase.name != self.of_phase.name {
            self.pace = Pace::default();
        }
        if let Some(share) = of_phase.share {
            self.pace.push(now, share);
        }
        self.of_phase = of_phase;
        match report.exit {
            Some(exit) if self.end.is_none() => {
                self.end =
                    Some(if exit == Exit::Done { End::Complete } else { End::Early(exit.to_string()) });
            }
            _ => {}
        }
    }

    /// The simulator has left the bus.
    pub(crate) fn left(&mut self) {
        self.end.get_or_insert(End::Vanished);
    }

    pub(crate) fn silence(&self, now: Duration) -> Duration {
        now.saturating_sub(self.heard)
    }

    /// Number of the phase under way, from 1.
    pub(crate) fn phase(&self) -> Option<u32> {
        let of_state = self.state.as_ref().map(|s| s.phase);
        of_state.max(self.latest.as_ref().map(|r| r.phase))
    }

    /// Step of the values that are shown: that of the last request.
    pub(crate) fn step(&self) -> Option<u64> {
        self.latest.as_ref().map(|r| r.step).or_else(|| self.state.as_ref().map(|s| s.step))
    }
}

#[cfg(test)]
pub(crate) mod tests;
