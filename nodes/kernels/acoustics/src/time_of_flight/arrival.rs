//! Arrival times of one burst, and the speed from them.
//!
//! The speed is the slope of distance against arrival time, so that delays common to all receivers (source, trigger)
//! cancel. The samples before the trigger give the level of the noise. Its effect on the slope is found by picking
//! again in traces with as much noise added, which includes large errors, such as a correlation that is off by a
//! period.

use super::burst::Burst;
use super::line::Line;
use super::pick::Picker;
use super::settings::ArrivalPick;
use crate::error::{AcousticsError, no_signal, setting};
use crate::noise::Noise;
use crate::trace::Trace;

/// Place of the noise of copies, different from that of shots.
const COPIES_PLACE: u64 = u64::MAX - 1;

/// Number of noisy copies that are picked again.
const COPIES: u64 = 32;

/// Maximum fraction of them without an arrival.
const MAX_LOST: f64 = 0.25;

/// Least number of samples before the trigger from which the noise is determined.
const MIN_QUIET: usize = 8;

/// Least standard deviation of an arrival, periods, in the weights of receivers.
const FLOOR: f64 = 1e-3;

/// Arrivals of one burst at the receivers.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrivals {
    /// Arrival time at each receiver after the trigger, s. For a correlation: the first receiver's peak plus the delay.
    pub times: Vec<f64>,
    /// 1/speed of the picked feature, s/m.
    pub slowness: f64,
    /// Standard deviation of the slowness from noise, or from the scatter about the line where that is larger, s/m.
    pub slowness_stddev: f64,
    /// Root mean square of the noise before the trigger, m/s.
    pub noise: f64,
}

impl Arrivals {
    /// Picks the arrivals in `trace` of a burst of `cycles` periods under a Hann window, which the source
    /// starts at the trigger. `seed` is that of the noisy copies.
    pub fn pick(trace: &Trace, cycles: f64, pick: ArrivalPick, seed: u64) -> Result<Self, AcousticsError> {
        let (burst, picker) = prepared(trace, cycles, pick)?;
        let missing = |reason: String| no_signal("arrival", &trace.direction, &trace.polarization, reason);
        let quiet = ((-trace.start * trace.sample_rate).floor().max(0.0) as usize)
            .min(trace.channels[0].samples.len());
        let noise = noise(trace, quiet);
        let channels: Vec<&[f64]> = trace.channels.iter().map(|c| &c.samples[..]).collect();
        let places: Vec<f64> = trace.channels.iter().map(|c| c.distance).collect();
        let times = picker.times(&channels, noise).map_err(missing)?;
        let repeats = if noise > 0.0 {
            picks_with_noise(&picker, &channels, noise, seed).map_err(missing)?
        } else {
            Vec::new()
        };

        // A shift common to all receivers does not change the slope.
        let off = |repeat: &[f64]| {
            let off: Vec<f64> = repeat.iter().zip(&times).map(|(r, t)| r - t).collect();
            let mean = off.iter().sum::<f64>() / off.len() as f64;
            off.iter().map(|o| o - mean).collect::<Vec<_>>()
        };
        let squares = repeats.iter().map(|r| off(r)).fold(vec![0.0; times.len()], |mut sum, off| {
            sum.iter_mut().zip(&off).for_each(|(s, o)| *s += o * o);
            sum
        });
        let variances: Vec<f64> = squares.iter().map(|s| s / repeats.len().max(1) as f64).collect();
        let floor = (FLOOR * trace.sample_rate / burst.frequency).powi(2);
        let weights: Vec<f64> = variances.iter().map(|v| 1.0 / (v + floor)).collect();
        let line = |times: &[f64]| Line::through(&places, times, &weights);
        let through = line(&times).filter(|l| l.slope > 0.0);
        let through =
            through.ok_or_else(|| missing("the arrival times do not increase with distance".into()))?;
        let slopes: Vec<f64> = repeats.iter().filter_map(|r| line(r)).map(|l| l.slope).collect();
        let by_noise = mean_square(slopes.iter().map(|s| s - through.slope)).sqrt();
        let scatter = if through.scatter.is_finite() { through.scatter } else { 0.0 };
        let rate = trace.sample_rate;
        Ok(Self {
            times: times.iter().map(|t| trace.start + t / rate).collect(),
            slowness: through.slope / rate,
            slowness_stddev: by_noise.max(scatter) / rate,
            noise,
        })
    }
}

fn prepared(trace: &Trace, cycles: f64, pick: ArrivalPick) -> Result<(Burst, Picker), AcousticsError> {
    let Trace { frequency, sample_rate: rate, channels, .. } = trace;
    let positive = |x: f64| x.is_finite() && x > 0.0;
    setting("cycles", cycles, positive(cycles), "more than 0")?;
    setting("frequency", *frequency, positive(*frequency), "more than 0")?;
    let resolved = positive(*rate) && *rate >= 4.0 * frequency;
    setting("sample_rate", *rate, resolved, "at least four samples per period of the centre frequency")?;
    setting("receivers", channels.len() as f64, channels.len() >= 2, "2 or more")?;
    let samples = channels[0].samples.len();
    let same = samples > 0 && channels.iter().all(|c| c.samples.len() == samples);
    setting("samples", samples as f64, same, "the same number at every receiver, 1 or more")?;
    for value in channels.iter().flat_map(|c| c.samples.iter().chain([&c.distance])).chain([&trace.start]) {
        setting("samples", *value, value.is_finite(), "finite")?;
    }
    let burst = Burst { frequency: *frequency, cycles };
    Ok((burst, Picker::new(pick, burst, *rate, samples)))
}

/// Root mean square of the samples before the trigger.
fn noise(trace: &Trace, quiet: usize) -> f64 {
    if quiet < MIN_QUIET {
        return 0.0;
    }
    mean_square(trace.channels.iter().flat_map(|c| c.samples[..quiet].iter().copied())).sqrt()
}

/// Arrivals in noisy copies; an error if too many copies have no arrival.
fn picks_with_noise(
    picker: &Picker,
    channels: &[&[f64]],
    noise: f64,
    seed: u64,
) -> Result<Vec<Vec<f64>>, String> {
    let mut times = Vec::with_capacity(COPIES as usize);
    let mut lost = None;
    for copy in 0..COPIES {
        let mut random = Noise::at(seed, &[COPIES_PLACE, copy]);
        let mut noisy = |channel: &&[f64]| channel.iter().map(|s| s + noise * random.next()).collect();
        let copy: Vec<Vec<f64>> = channels.iter().map(&mut noisy).collect();
        let copy: Vec<&[f64]> = copy.iter().map(Vec::as_slice).collect();
        match picker.times(&copy, noise * std::f64::consts::SQRT_2) {
            Ok(found) => times.push(found),
            Err(reason) => lost = Some(reason),
        }
    }
    let found = times.len() as f64 / COPIES as f64;
    match lost {
        Some(reason) if found < 1.0 - MAX_LOST => Err(format!("the noise is too large: {reason}")),
        _ => Ok(times),
    }
}

fn mean_square(of: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = of.fold((0.0, 0usize), |(sum, n), x| (sum + x * x, n + 1));
    sum / count.max(1) as f64
}
