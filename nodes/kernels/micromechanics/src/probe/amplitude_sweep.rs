//! Probes of several amplitudes, and the range of strain over which the response is linear.

use super::settings::StrainProbe;
use super::strain_probe::{StrainProbeResult, strain_probe};
use crate::error::ProbeError;
use grainlab_core::Packing;
use std::ops::RangeInclusive;

/// Stiffnesses of the same packing by strains of several amplitudes.
#[derive(Clone, Debug, PartialEq)]
pub struct AmplitudeSweep {
    /// From the smallest amplitude to the largest. A failed probe has its reason: at a small amplitude the
    /// packing cannot be brought to rest accurately enough, at a large one it does not settle.
    pub probes: Vec<(f64, Result<StrainProbeResult, ProbeError>)>,
    /// Indices in `probes` of the linear regime: the longest sequence of amplitudes whose stiffnesses all
    /// agree within the tolerance; of two of equal length the one at smaller strains. `None` if no two
    /// neighbours agree.
    pub linear: Option<RangeInclusive<usize>>,
}

/// Probes `packing` with each of the `amplitudes`, with the other settings as given. Two stiffnesses agree if
/// no entry differs by more than `agreement` times the largest entry. An amplitude out of range is an error
/// at once.
pub fn amplitude_sweep(
    packing: &Packing,
    settings: &StrainProbe,
    amplitudes: &[f64],
    agreement: f64,
) -> Result<AmplitudeSweep, ProbeError> {
    let mut sorted = amplitudes.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let mut probes = Vec::with_capacity(sorted.len());
    for amplitude in sorted {
        let found = match strain_probe(packing, &StrainProbe { amplitude, ..*settings }) {
            Err(error @ (ProbeError::Setting { .. } | ProbeError::NotJammed(_))) => return Err(error),
            found => found,
        };
        probes.push((amplitude, found));
    }
    let linear = longest_run(probes.len(), |a, b| match (&probes[a].1, &probes[b].1) {
        (Ok(a), Ok(b)) => {
            let (a, b) = (a.stiffness.0, b.stiffness.0);
            (a - b).amax() <= agreement * b.amax()
        }
        _ => false,
    });
    Ok(AmplitudeSweep { probes, linear })
}

/// The longest sequence of at least two places in which every pair agrees; the first among equals.
fn longest_run(places: usize, agree: impl Fn(usize, usize) -> bool) -> Option<RangeInclusive<usize>> {
    let mut best: Option<RangeInclusive<usize>> = None;
    for first in 0..places {
        let mut last = first;
        while last + 1 < places && (first..=last).all(|place| agree(place, last + 1)) {
            last += 1;
        }
        let longer = best.as_ref().is_none_or(|run| last - first > run.end() - run.start());
        if last > first && longer {
            best = Some(first..=last);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_run_in_which_all_agree_is_found() {
        let within = |values: &'static [f64]| {
            longest_run(values.len(), move |a, b| (values[a] - values[b]).abs() <= 1.0)
        };
        assert_eq!(within(&[9.0, 5.0, 5.5, 5.8, 3.0, 2.9]), Some(1..=3));
        // All neighbours agree, the ends do not.
        assert_eq!(within(&[0.0, 0.9, 1.8, 2.7]), Some(0..=1));
        assert_eq!(within(&[1.0, 3.0, 5.0]), None);
        assert_eq!(within(&[1.0]), None);
        assert_eq!(within(&[]), None);
    }
}
