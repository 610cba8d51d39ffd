//! Share of a phase that is done, where its end is known beforehand.

use crate::model::{Condition, Measure, Phase, Scene};
use crate::path::{Observation, PathState};
use grainlab_core::SymTensor;

impl PathState {
    /// Share of the present phase that is done, 0 to 1, in simulated time. It is known where every condition follows from
    /// elapsed time and imposed strain rates: a time, an imposed strain, the solid fraction of a cell whose three normal
    /// components are imposed or held. `None` where the phase ends by the answer of the packing (stress, unbalanced force,
    /// speed), and once the path is done.
    pub fn phase_share(&self, scene: &Scene, seen: &Observation) -> Option<f64> {
        let phase = self.phase(scene)?;
        let elapsed = seen.time - self.began;
        let times = phase.until.all.iter();
        let times = times.map(|c| time_until(c, phase, &seen.strain, seen.solid_fraction, elapsed));
        let until_met = times.collect::<Option<Vec<f64>>>()?.into_iter().fold(0.0, f64::max);
        let held = self.holding_since.map_or(0.0, |since| seen.time - since);
        let left = until_met + (phase.until.hold - held).max(0.0);
        let share = elapsed / (elapsed + left);
        share.is_finite().then(|| share.clamp(0.0, 1.0))
    }
}

/// Simulated time until a condition holds, s, at the imposed rates; `None` where these do not determine it.
pub(crate) fn time_until(
    condition: &Condition,
    phase: &Phase,
    strain: &SymTensor,
    solid_fraction: f64,
    elapsed: f64,
) -> Option<f64> {
    // Distance to the bound and the rate at which it shrinks.
    let (distance, rate) = match *condition {
        Condition::AtLeast(Measure::Elapsed, time) => (time - elapsed, 1.0),
        Condition::AtLeast(Measure::Strain(c), bound) => (bound - strain.voigt()[c], phase.imposed_rate(c)?),
        Condition::AtMost(Measure::Strain(c), bound) => (strain.voigt()[c] - bound, -phase.imposed_rate(c)?),
        Condition::AtLeast(Measure::SolidFraction, bound) => {
            // The logarithm of the solid fraction grows as the volumetric strain shrinks.
            ((bound / solid_fraction).ln(), -phase.imposed_volumetric_rate()?)
        }
        _ => return None,
    };
    let is_met = distance <= 0.0 && rate >= 0.0;
    if is_met { Some(0.0) } else { (rate > 0.0).then(|| distance / rate) }
}
