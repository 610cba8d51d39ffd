//! The calibrations that come with the crate.

use super::constants::Calibration;
use super::discrepancy::ModelDiscrepancy;
use std::sync::LazyLock;

impl Calibration {
    /// The names of [`Calibration::builtin`].
    pub const BUILTIN: [&str; 2] = ["paper", "grainlab"];

    /// `paper`: the constants of the paper. `grainlab`: learned from simulated packings of 2,000 grains, with
    /// k̂ and k counted over all grains.
    pub fn builtin(name: &str) -> Option<&'static Self> {
        static PAPER: Calibration = Calibration::PAPER;
        static GRAINLAB: LazyLock<Option<Calibration>> =
            LazyLock::new(|| Calibration::parse(include_str!("grainlab.toml")).ok());
        match name {
            "paper" => Some(&PAPER),
            "grainlab" => GRAINLAB.as_ref(),
            _ => None,
        }
    }

    /// The errors of the models with the constants of the paper, on the packings of the calibration `grainlab`.
    pub(super) fn errors_with_paper() -> &'static [ModelDiscrepancy] {
        static ERRORS: LazyLock<Option<Calibration>> =
            LazyLock::new(|| Calibration::parse(include_str!("paper.toml")).ok());
        ERRORS.as_ref().map_or(&[], |calibration| &calibration.discrepancies)
    }
}
