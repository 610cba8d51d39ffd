//! The tables and figures of the paper from simulated packings: one HTML page, JSON and CSV.
//!
//! - [`Reproduction`]: the packings, compared and judged, and where they come from
//! - [`paper`]: its tables, and packings compared with them
//! - [`campaign_text`]: the campaign that prepares them
//! - `page`: the HTML page; `tables`, `figures`, `inversions`: its parts
//! - `data`: the same as JSON and CSV; `text`: a summary for a terminal

mod data;
mod figures;
mod inversions;
mod page;
pub mod paper;
mod plan;
mod tables;
mod text;

pub use plan::{Size, campaign_text, pressure_of_phase, sample_of_scene};

use paper::claims::{Claim, claims};
use paper::inversion::{Judged, judge};
use paper::{Comparison, States, compare};

/// Origin of the packings.
#[derive(Clone, Debug)]
pub struct Provenance {
    /// Version of the program.
    pub version: String,
    /// The command that made the report.
    pub command: String,
    /// Folder of the campaign, as in the commands of the report.
    pub folder: String,
    /// Grains of each packing.
    pub grains: u32,
    /// Seeds of each sample.
    pub seeds: Vec<u64>,
}

/// The packings compared with the paper.
#[derive(Clone, Debug)]
pub struct Reproduction {
    provenance: Provenance,
    states: States,
    compared: Vec<Comparison>,
    judged: Vec<Judged>,
    claims: Vec<Claim>,
}

impl Reproduction {
    /// Compares and judges.
    pub fn new(states: States, provenance: Provenance) -> Self {
        let (compared, judged) = (compare(&states), judge(&states));
        let claims = claims(&compared, &judged);
        Self { provenance, states, compared, judged, claims }
    }

    fn judged(&self, model: &str, gamma: Option<&str>, calibration: &str) -> Option<&Judged> {
        Judged::find(&self.judged, model, gamma, calibration)
    }

    fn get(&self, quantity: crate::paper::Quantity, sample: usize, pressure: usize) -> Option<&Comparison> {
        Comparison::find(&self.compared, quantity, sample, pressure)
    }
}
