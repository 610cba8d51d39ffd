//! Simulated packings, by sample and pressure.

use super::tables::{PRESSURES, SAMPLES};
use grainlab_core::results::PackingReport;

/// One simulated packing.
#[derive(Clone, Debug, PartialEq)]
pub struct Observed {
    /// Index of the sample in [`super::PAPER`].
    pub sample: usize,
    /// Index of the pressure in [`super::PRESSURE`].
    pub pressure: usize,
    /// Seed of its run.
    pub seed: u64,
    /// Report of the packing.
    pub report: PackingReport,
}

/// All simulated packings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct States(Vec<Observed>);

impl States {
    /// In the order of sample, pressure and seed.
    pub fn new(mut all: Vec<Observed>) -> Self {
        all.sort_by_key(|o| (o.sample, o.pressure, o.seed));
        Self(all)
    }

    /// All of them.
    pub fn all(&self) -> &[Observed] {
        &self.0
    }

    /// Those of one sample at one pressure, one for each seed.
    pub fn of(&self, sample: usize, pressure: usize) -> impl Iterator<Item = &Observed> {
        self.0.iter().filter(move |o| o.sample == sample && o.pressure == pressure)
    }

    /// Every sample and pressure.
    pub fn places() -> impl Iterator<Item = (usize, usize)> {
        (0..SAMPLES).flat_map(|sample| (0..PRESSURES).map(move |pressure| (sample, pressure)))
    }

    /// The samples and pressures without a packing.
    pub fn missing(&self) -> Vec<(usize, usize)> {
        Self::places().filter(|(s, p)| self.of(*s, *p).next().is_none()).collect()
    }
}
