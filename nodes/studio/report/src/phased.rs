//! A series against time in the phases of a run.

use crate::decimated::Decimated;

/// Bins of all phases of a run together.
const BINS: usize = 600;

/// Fewest bins of a phase.
const FEWEST: usize = 24;

/// Most phases; values of later ones join those of the last.
pub(crate) const MOST_PHASES: usize = 1000;

/// A series with bins of its own in each phase, because phases differ much in length.
#[derive(Clone, Debug, Default)]
pub(crate) struct Phased {
    /// In the order of the phases that have values.
    parts: Vec<(u32, Decimated)>,
}

pub(crate) fn bins_of(phases: usize) -> usize {
    (BINS / phases.max(1)).clamp(FEWEST, BINS / 2)
}

impl Phased {
    pub(crate) fn push(&mut self, (phase, bins): (u32, usize), time: f64, value: f64) {
        let is_other = self.parts.last().is_none_or(|(known, _)| *known != phase);
        if is_other && self.parts.len() < MOST_PHASES {
            self.parts.push((phase, Decimated::new(bins)));
        }
        if let Some((_, part)) = self.parts.last_mut() {
            part.push(time, value);
        }
    }

    pub(crate) fn count(&self) -> usize {
        self.parts.iter().map(|(_, part)| part.count()).sum()
    }

    /// The points in order of time.
    pub(crate) fn points(&self) -> Vec<(f64, f64)> {
        self.parts.iter().flat_map(|(_, part)| part.points()).collect()
    }
}

/// Times at which phases begin, and the end of the last one: time as a number of phases.
#[derive(Clone, Debug, Default)]
pub(crate) struct PhaseAxis(pub(crate) Vec<f64>);

impl PhaseAxis {
    /// Number of phases before a time, with the share of the phase under way. A time at which a phase ends belongs to it.
    pub(crate) fn place(&self, time: f64) -> f64 {
        let phases = self.0.len().saturating_sub(1);
        let begun = self.0.iter().take(phases).filter(|begin| **begin < time).count();
        let Some(phase) = begun.checked_sub(1) else { return 0.0 };
        let (from, to) = (self.0[phase], self.0[phase + 1]);
        let share = if to > from { ((time - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
        phase as f64 + share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_phase_is_one_long_and_its_end_belongs_to_it() {
        let axis = PhaseAxis(vec![0.0, 10.0, 11.0, 11.5]);
        let places = [0.0, 5.0, 10.0, 10.5, 11.0, 11.25, 11.5, 99.0].map(|t| axis.place(t));
        assert_eq!(places, [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.0]);
        assert_eq!(PhaseAxis::default().place(1.0), 0.0);
    }

    #[test]
    fn a_short_phase_has_as_many_bins_as_a_long_one() {
        let (mut series, bins) = (Phased::default(), bins_of(10));
        (0..5000).for_each(|n| series.push((0, bins), f64::from(n), f64::from(n % 13)));
        (0..5000).for_each(|n| series.push((1, bins), 5000.0 + 1e-4 * f64::from(n), f64::from(n % 13)));
        let points = series.points();
        let late = points.iter().filter(|p| p.0 >= 5000.0).count();
        assert!(late > 80 && points.len() - late > 80, "{late} of {}", points.len());
        assert_eq!(series.count(), 10_000);
    }
}
