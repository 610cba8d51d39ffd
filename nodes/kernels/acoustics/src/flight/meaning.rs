//! What a picked speed is a speed of.
//!
//! Along a path where long waves have the slowness s₀ and others s₀ (1 + β ω²), each pick's slope is s₀ (1 + κ β ω²) at the
//! centre frequency, with a κ of its own: about 1 for a correlation, which follows the crests, about 3 for the peak of an
//! envelope, which goes at group speed, and something between for an onset, whose long waves run ahead. κ follows from
//! picking a burst that was sent along such a path on paper, at the very receivers, with the very noise in mind.

use crate::curve::{Curve, Point};
use crate::error::AcousticsError;
use crate::flight::Pick;
use crate::flight::arrival::Arrivals;
use crate::flight::burst::Burst;
use crate::flight::line::Line;
use crate::flight::pick::Picker;
use crate::flight::spectrum::Spectrum;
use crate::trace::Trace;
use std::f64::consts::TAU;

/// β ω² at which κ is found unless the real one is more.
const SMALL: f64 = 0.003;

/// And the most.
const LARGE: f64 = 0.2;

/// ρ v² of a single frequency is below that of long waves by about so much times (q × mean diameter)²: chains 1/12, packings
/// of 2,000 grains 0.3 to 0.4 (S) and 0.6 to 0.7 (P), repeated along the path.
const SINGLE_BEND: f64 = 0.4;

/// Less bend than this is not believed of any pick.
const LEAST_BEND: f64 = 0.2;

/// How far the law of dispersion and κ are trusted: to this share of what they say of a slowness. Packings repeated along
/// a path have gaps in their spectrum where half a wave is a period, and near them no smooth law; crests feel them least,
/// and an onset, which hangs on all of a spectrum, most. With these shares 54 speeds through two packings of 2,000 grains
/// are within two standard deviations of the frozen network's; correlation took half as much there, and 18 speeds through two
/// other packings asked for more.
fn distrust(pick: Pick) -> f64 {
    match pick {
        Pick::CrossCorrelation => 0.2,
        Pick::Peak => 0.2,
        Pick::FirstArrival => 0.5,
    }
}

/// No speed is stated more exactly than this, of itself.
const EXACT: f64 = 1e-6;

/// κ of a pick in traces like `trace`, whose waves have the slowness `slowness` (s/m), near β ω² = `bend`; 1 where it
/// cannot be found.
fn kappa(trace: &Trace, noise: f64, cycles: f64, pick: Pick, slowness: f64, bend: f64) -> f64 {
    let burst = Burst { frequency: trace.frequency, cycles };
    let bend = if bend.abs() < SMALL { SMALL } else { bend.clamp(-LARGE, LARGE) };
    let samples = trace.channels[0].samples.len();
    let distances: Vec<f64> = trace.channels.iter().map(|c| c.distance).collect();
    let channels = sent(&burst, trace, samples, &distances, slowness, bend);
    let channels: Vec<&[f64]> = channels.iter().map(Vec::as_slice).collect();
    let picker = Picker::new(pick, burst, trace.sample_rate, samples);
    // An onset hangs on the noise, too.
    let largest = |of: &[f64]| of.iter().fold(0.0, |m: f64, s| m.max(s.abs()));
    let noise = noise * largest(channels[0]) / largest(&trace.channels[0].samples);
    let times = picker.times(&channels, noise).or_else(|_| picker.times(&channels, 0.0));
    let weights = vec![1.0; distances.len()];
    let line = times.ok().and_then(|t| Line::through(&distances, &t, &weights));
    line.map_or(1.0, |l| (l.slope / trace.sample_rate / slowness - 1.0) / bend)
}

/// The burst after each distance of a path of slowness s (1 + bend (f/centre)²), sampled as `trace` is.
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
            // Far above the burst's spectrum nothing is sent, and a delay without bounds would wrap around.
            TAU * f * rate * slowness * distance * (1.0 + bend * relative.min(9.0))
        };
        spectrum.delayed(&lines, turned)
    };
    distances.iter().map(delayed).collect()
}

/// The curve through the speeds of crests that the arrivals of each trace mean; `diameter` (m) is the mean grain's.
pub(crate) fn curve(
    traces: &[Trace],
    arrivals: &[Arrivals],
    cycles: f64,
    pick: Pick,
    diameter: f64,
) -> Result<Curve, AcousticsError> {
    let Some(first) = traces.first() else {
        let requirement = "one or more";
        return Err(AcousticsError::Setting { name: "frequencies", value: 0.0, requirement });
    };
    let crests = of_crests(traces, arrivals, cycles, pick, diameter);
    let points = traces.iter().zip(arrivals).zip(&crests).map(|((trace, a), (slowness, more))| Point {
        wavenumber: TAU * trace.frequency * slowness,
        speed: 1.0 / slowness,
        stddev: (a.slowness_stddev.powi(2) + more.powi(2) + (EXACT * slowness).powi(2)).sqrt()
            / slowness.powi(2),
    });
    let points: Vec<Point> = points.collect();
    let alone = || {
        let [point] = points[..] else { return None };
        let unknown = 0.5 * SINGLE_BEND * (point.wavenumber * diameter).powi(2) * point.speed;
        let stddev = point.stddev.hypot(unknown);
        let (direction, motion, speed) = (first.direction, first.motion, point.speed);
        Some(Curve { direction, motion, points: vec![point], speed, stddev, bend: 0.0 })
    };
    let curve = alone().or_else(|| Curve::through(first.direction, first.motion, points.clone()));
    curve.ok_or_else(|| AcousticsError::NoSignal {
        what: "speed of long waves",
        direction: first.direction.into(),
        motion: first.motion.into(),
        reason: format!("those of single frequencies do not extrapolate: {points:?}"),
    })
}

/// Slownesses of several frequencies as those of crests: what [`Arrivals::slowness`] becomes at each centre frequency, and by
/// how much more its standard deviation is, s/m.
fn of_crests(
    traces: &[Trace],
    arrivals: &[Arrivals],
    cycles: f64,
    pick: Pick,
    diameter: f64,
) -> Vec<(f64, f64)> {
    let squares: Vec<f64> = traces.iter().map(|t| (TAU * t.frequency).powi(2)).collect();
    let weights: Vec<f64> =
        arrivals.iter().map(|a| (a.slowness_stddev.max(1e-6 * a.slowness)).powi(-2)).collect();
    let measured: Vec<f64> = arrivals.iter().map(|a| a.slowness).collect();
    // Long waves' slowness and its bend, with κ from the bend of the round before.
    let (mut long, mut bend, mut error) = (measured.iter().copied().fold(f64::INFINITY, f64::min), 0.0, 0.0);
    let mut kappas = vec![1.0; traces.len()];
    for _ in 0..3 {
        let ask = |((t, a), w2): ((&Trace, &Arrivals), &f64)| {
            kappa(t, a.noise, cycles, pick, long, bend / long * w2)
        };
        kappas = traces.iter().zip(arrivals).zip(&squares).map(ask).collect();
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
        let law = distrust(pick) * kappas[k] * (bend * squares[k]).abs().max(least);
        (measured[k] - slip * bend, (slip * error).hypot(law))
    };
    (0..traces.len()).map(turn).collect()
}
