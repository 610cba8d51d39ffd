//! Numbers of packings compared with those of the paper.

use super::quantity::{Printed, Quantity};
use super::sample::States;
use super::scatter::of_one;
use grainlab_page::Mean;

/// Seeds from which their own scatter gives the error.
const ENOUGH: usize = 5;

/// One quantity of one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Quantity that is compared.
    pub quantity: Quantity,
    /// Index of the sample.
    pub sample: usize,
    /// Index of the pressure.
    pub pressure: usize,
    /// Mean over seeds.
    pub ours: Mean,
    /// Standard error expected of packings of this size and number, from those of other seeds.
    pub expected: Option<f64>,
    /// Number of the paper.
    pub paper: Option<Printed>,
}

impl Comparison {
    /// The one of a quantity of a state.
    pub fn find(all: &[Self], quantity: Quantity, sample: usize, pressure: usize) -> Option<&Self> {
        all.iter().find(|c| c.quantity == quantity && c.sample == sample && c.pressure == pressure)
    }

    /// Ours less the paper's.
    pub fn difference(&self) -> Option<f64> {
        Some(self.ours.value - self.paper?.value)
    }

    /// Relative difference, over the paper's.
    pub fn relative(&self) -> Option<f64> {
        Some(self.difference()? / self.paper?.value)
    }

    /// Standard error of our mean: that over seeds, or the expected one of a few.
    pub fn error(&self) -> Option<f64> {
        self.ours.error.filter(|_| self.ours.count >= ENOUGH).or(self.expected).or(self.ours.error)
    }

    /// The difference in units of its error: that of our mean and of the paper's rounding. The paper's own scatter, of one
    /// sample each, is not known.
    pub fn in_errors(&self) -> Option<f64> {
        let error = self.error()?.hypot(self.paper?.rounding);
        (error > 0.0).then_some(self.difference()? / error)
    }
}

/// Every quantity of every state that was simulated.
pub fn compare(states: &States) -> Vec<Comparison> {
    let one = |quantity: Quantity, (sample, pressure): (usize, usize)| {
        let ours = Mean::of(states.of(sample, pressure).filter_map(|o| quantity.measured(&o.report)))?;
        let grains = states.of(sample, pressure).map(|o| o.report.contacts.grains).min()?;
        let expected =
            of_one(quantity, sample, ours.value, grains as f64).map(|s| s / (ours.count as f64).sqrt());
        let paper = quantity.in_paper(sample, pressure);
        Some(Comparison { quantity, sample, pressure, ours, expected, paper })
    };
    let all = Quantity::ALL.into_iter();
    all.flat_map(|(q, _)| States::places().filter_map(move |place| one(q, place))).collect()
}
