//! The calibrations that come with the crate.

use super::constants::Calibration;
use super::discrepancy::ModelDiscrepancy;
use grainlab_core::results::InferredQuantity;
use std::borrow::Cow;
use std::sync::LazyLock;

impl Calibration {
    /// The names of [`Calibration::builtin`].
    pub const BUILTIN: [&str; 3] = ["paper", "grainlab", "grainlab-z"];

    /// `paper`: the constants of the paper. `grainlab`: learned from simulated packings of 2,000 grains, with
    /// k̂ and k counted over all grains. `grainlab-z`: learned from the same packings, with rattlers left out
    /// of the count.
    pub fn builtin(name: &str) -> Option<&'static Self> {
        static PAPER: Calibration = Calibration::PAPER;
        static BY_K: LazyLock<Option<Calibration>> =
            LazyLock::new(|| Calibration::parse(include_str!("grainlab.toml")).ok());
        static BY_Z: LazyLock<Option<Calibration>> = LazyLock::new(|| {
            let by_z = BY_K.as_ref()?.with_coordination_kind(InferredQuantity::Z)?;
            Some(Calibration { name: Cow::Borrowed("grainlab-z"), ..by_z })
        });
        match name {
            "paper" => Some(&PAPER),
            "grainlab" => BY_K.as_ref(),
            "grainlab-z" => BY_Z.as_ref(),
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
