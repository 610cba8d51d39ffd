//! Conversion of picked speeds to phase velocities.
//!
//! On a path where waves have the slowness s₀ (1 + β ω²), the slope of a pick is s₀ (1 + κ β ω²) at the centre
//! frequency, with κ depending on the pick: about 1 for a correlation, which follows the crests; about 3 for the peak
//! of an envelope, which moves with the group velocity; and between for an onset, where long waves arrive first. κ is
//! found by picking a burst computed for such a path, at the same receivers.

use super::arrival::Arrivals;
use super::burst::Burst;
use super::line::Line;
use super::pick::Picker;
use super::settings::ArrivalPick;
use super::spectrum::Spectrum;
use crate::curve::{DispersionCurve, DispersionPoint};
use crate::error::{AcousticsError, no_signal};
use crate::trace::{Channel, Trace};
use std::f64::consts::TAU;

/// Least and greatest |β ω²| at which κ is computed.
const SMALL: f64 = 0.003;
const LARGE: f64 = 0.2;

/// Assumed relative difference of ρ v² at a single frequency from that of long waves, over (q × mean diameter)²: 1/12
/// for chains, 0.3 to 0.4 (S) and 0.6 to 0.7 (P) for supercells of packings of 2,000 grains.
const SINGLE_BEND: f64 = 0.4;

/// Least dispersion assumed for the uncertainty of a pick, in the same units.
const LEAST_BEND: f64 = 0.2;

/// Relative uncertainty of the correction of a slowness by the dispersion law and κ. Supercells have gaps in their
/// spectrum where half the wavelength is a period of the packing, and no smooth dispersion law near them; this affects
/// crests least, and onsets, which depend on the whole spectrum, most.
fn correction_error(pick: ArrivalPick) -> f64 {
    match pick {
        ArrivalPick::CrossCorrelation => 0.1,
        ArrivalPick::Peak => 0.2,
        ArrivalPick::FirstArrival => 1.0,
    }
}

/// Relative error of the speed of long waves over the part of its amplitude that the longest burst loses per wavelength.
/// A wave that loses amplitude to soft motions is slower than long waves (Kramers and Kronig): for a loss that is the
/// same at all frequencies by 1/π² of it for each e-fold of the frequency. Three to four of them, to waves that the
/// soft motions follow, are the deviations of packings of z 4.3 to 4.9. The peak moves with the group, which is slower.
fn slowed(pick: ArrivalPick) -> f64 {
    match pick {
        ArrivalPick::CrossCorrelation | ArrivalPick::FirstArrival => 0.35,
        ArrivalPick::Peak => 0.7,
    }
}

/// Least relative standard deviation of a speed.
const EXACT: f64 = 1e-6;

/// κ of a pick in traces like `trace`, for the slowness `slowness` (s/m) and β ω² near `bend`; 1 if it cannot be found.
fn kappa(trace: &Trace, cycles: f64, pick: ArrivalPick, slowness: f64, bend: f64) -> f64 {
    let burst = Burst { frequency: trace.frequency, cycles };
    let bend = if bend.abs() < SMALL { SMALL } else { bend.clamp(-LARGE, LARGE) };
    let samples = trace.channels[0].samples.len();
    let distances: Vec<f64> = trace.channels.iter().map(|c| c.distance).collect();
    let channels = sent(&burst, trace, samples, &distances, slowness, bend);
    let channels: Vec<&[f64]> = channels.iter().map(Vec::as_slice).collect();
    let picker = Picker::new(pick, burst, trace.sample_rate, samples);
    let times = picker.times(&channels, 0.0);
    let weights = vec![1.0; distances.len()];
    let line = times.ok().and_then(|t| Line::through(&distances, &t, &weights));
    line.map_or(1.0, |l| (l.slope / trace.sample_rate / slowness - 1.0) / bend)
}

/// The burst at each distance on a path of slowness s (1 + bend (f/centre)²), sampled like `trace`.
fn sent(
    burst: &Burst,
    trace: &Trace,
    samples: usize,
    distances: &[f64],
    slowness: f64,
    bend: f64,
) -> Vec<Vec<f64>> {
    let spectrum = Spectrum::new(samples, 1);
    let rate = trace.sample_rate;
    let at_source: Vec<f64> = (0..samples).map(|k| burst.at(trace.start + k as f64 / rate)).collect();
    let lines = spectrum.of(&at_source);
    let delayed = |distance: &f64| {
        let turned = |f: f64| {
            let relative = (f * rate / burst.frequency).powi(2);
            // Above the burst's spectrum the delay is bounded, so that it does not wrap around.
            TAU * f * rate * slowness * distance * (1.0 + bend * relative.min(9.0))
        };
        spectrum.delayed(&lines, turned)
    };
    distances.iter().map(delayed).collect()
}

/// The curve of the phase velocities from the arrivals of each trace; `diameter` is the mean grain diameter, m.
pub(crate) fn curve(
    traces: &[Trace],
    arrivals: &[Arrivals],
    cycles: f64,
    pick: ArrivalPick,
    diameter: f64,
) -> Result<DispersionCurve, AcousticsError> {
    let Some(first) = traces.first() else {
        let requirement = "one or more";
        return Err(AcousticsError::Setting { name: "frequencies", value: 0.0, requirement });
    };
    let crests = of_crests(traces, arrivals, cycles, pick, diameter);
    let points =
        traces.iter().zip(arrivals).zip(&crests).map(|((trace, a), (slowness, more))| DispersionPoint {
            wavenumber: TAU * trace.frequency * slowness,
            speed: 1.0 / slowness,
            stddev: (a.slowness_stddev.powi(2) + more.powi(2) + (EXACT * slowness).powi(2)).sqrt()
                / slowness.powi(2),
        });
    let points: Vec<DispersionPoint> = points.collect();
    let alone = || {
        let [point] = points[..] else { return None };
        let unknown = 0.5 * SINGLE_BEND * (point.wavenumber * diameter).powi(2) * point.speed;
        let stddev = point.stddev.hypot(unknown);
        let (direction, polarization, speed) = (first.direction, first.polarization, point.speed);
        let (points, dispersion_coefficient) = (vec![point], 0.0);
        Some(DispersionCurve { direction, polarization, points, speed, stddev, dispersion_coefficient })
    };
    let curve = alone().or_else(|| DispersionCurve::fit(first.direction, first.polarization, points.clone()));
    let longest = traces.iter().zip(arrivals).min_by(|a, b| a.0.frequency.total_cmp(&b.0.frequency));
    let slowed = longest.map_or(0.0, |(trace, arrivals)| slowed(pick) * loss(trace, arrivals));
    let curve = curve.map(|c| DispersionCurve { stddev: c.stddev.hypot(slowed * c.speed), ..c });
    let reason = || {
        let each = points.iter().map(|p| format!("{:.4} m/s at {:.4} rad/m", p.speed, p.wavenumber));
        let each = each.collect::<Vec<_>>().join(", ");
        format!("the speeds at single frequencies have no limit at long waves: {each}")
    };
    curve.ok_or_else(|| no_signal("speed of long waves", &first.direction, &first.polarization, reason()))
}

/// Part of its amplitude that a burst loses per wavelength between the first and the last receiver, 0 or more, from its
/// energy above that of the noise.
fn loss(trace: &Trace, arrivals: &Arrivals) -> f64 {
    let energy = |channel: &Channel| {
        let noise = arrivals.noise.powi(2) * channel.samples.len() as f64;
        channel.samples.iter().map(|s| s * s).sum::<f64>() - noise
    };
    let [first, .., last] = &trace.channels[..] else { return 0.0 };
    let wavelengths = (last.distance - first.distance) * trace.frequency * arrivals.slowness;
    let left = 0.5 * (energy(last) / energy(first)).ln();
    if left.is_finite() { (-left / wavelengths).max(0.0) } else { 0.0 }
}

/// Phase slowness at each centre frequency from [`Arrivals::slowness`], and the standard deviation of the correction,
/// s/m.
fn of_crests(
    traces: &[Trace],
    arrivals: &[Arrivals],
    cycles: f64,
    pick: ArrivalPick,
    diameter: f64,
) -> Vec<(f64, f64)> {
    let squares: Vec<f64> = traces.iter().map(|t| (TAU * t.frequency).powi(2)).collect();
    let weights: Vec<f64> =
        arrivals.iter().map(|a| (a.slowness_stddev.max(1e-6 * a.slowness)).powi(-2)).collect();
    let measured: Vec<f64> = arrivals.iter().map(|a| a.slowness).collect();
    // Slowness of long waves and its dispersion, with κ from the dispersion of the previous round.
    let (mut long, mut bend, mut error) = (measured.iter().copied().fold(f64::INFINITY, f64::min), 0.0, 0.0);
    let mut kappas = vec![1.0; traces.len()];
    for _ in 0..3 {
        let ask = |(t, w2): (&Trace, &f64)| kappa(t, cycles, pick, long, bend / long * w2);
        kappas = traces.iter().zip(&squares).map(ask).collect();
        let places: Vec<f64> = squares.iter().zip(&kappas).map(|(w2, k)| w2 * k).collect();
        let Some(line) = Line::through(&places, &measured, &weights) else { break };
        let total: f64 = weights.iter().sum();
        let mean = |of: &[f64]| of.iter().zip(&weights).map(|(x, w)| x * w).sum::<f64>() / total;
        let spread: f64 = places.iter().zip(&weights).map(|(p, w)| w * (p - mean(&places)).powi(2)).sum();
        bend = line.slope;
        long = (mean(&measured) - bend * mean(&places)).max(0.3 * mean(&measured));
        let scatter = if line.scatter.is_finite() { line.scatter } else { 0.0 };
        error = scatter.max(spread.sqrt().recip());
    }
    let turn = |k: usize| {
        let slip = (kappas[k] - 1.0) * squares[k];
        let least = 0.5 * LEAST_BEND * squares[k] * (measured[k] * diameter).powi(2) * long;
        let law = correction_error(pick) * kappas[k] * (bend * squares[k]).abs().max(least);
        (measured[k] - slip * bend, (slip * error).hypot(law))
    };
    (0..traces.len()).map(turn).collect()
}
