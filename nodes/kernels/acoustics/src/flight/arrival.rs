//! What the traces of one burst say of the speed.
//!
//! The speed is the slope of distance against arrival, so that what delays all receivers alike (source, trigger) drops out.
//! The noise is what is heard before the trigger. How much it may have moved the slope is found by picking again in traces
//! with as much noise added: that includes what no formula for small errors has, as when a correlation is taken a period off.

use crate::error::AcousticsError;
use crate::flight::Pick;
use crate::flight::burst::Burst;
use crate::flight::line::Line;
use crate::flight::pick::Picker;
use crate::noise::Noise;
use crate::trace::Trace;

/// Place of the noise of copies, apart from that of shots.
const COPIES_PLACE: u64 = u64::MAX - 1;

/// Noisy copies that are picked again.
const COPIES: u64 = 32;

/// Share of them that may show no arrival.
const MOST_LOST: f64 = 0.25;

/// Fewest samples before the trigger that tell the noise.
const FEWEST_QUIET: usize = 8;

/// Standard deviation of an arrival, periods, that no pick is better than, for the weights of receivers.
const FLOOR: f64 = 1e-3;

/// Arrivals of one burst at the receivers, and what they say.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrivals {
    /// Time of each receiver's arrival after the trigger, s. Of a correlation: delay after the first receiver's peak.
    pub times: Vec<f64>,
    /// Standard deviation of each, s, by noise alone.
    pub stddevs: Vec<f64>,
    /// 1/speed of what was picked, s/m.
    pub slowness: f64,
    /// Its standard deviation: by noise, or by the scatter about the line where that is more, s/m.
    pub slowness_stddev: f64,
    /// Root mean square of the noise found in the samples before the trigger, m/s.
    pub noise: f64,
}

impl Arrivals {
    /// The arrivals in `trace`, of a burst of so many `cycles`, under a Hann window, which the source began at the trigger.
    /// `seed` is that of the noisy copies.
    pub fn picked(trace: &Trace, cycles: f64, pick: Pick, seed: u64) -> Result<Self, AcousticsError> {
        let (burst, picker) = prepared(trace, cycles, pick)?;
        let missing = |reason| AcousticsError::NoSignal {
            what: "arrival",
            direction: trace.direction.into(),
            motion: trace.motion.into(),
            reason,
        };
        let quiet = ((-trace.start * trace.sample_rate).floor().max(0.0) as usize)
            .min(trace.channels[0].samples.len());
        let noise = noise(trace, quiet);
        let channels: Vec<&[f64]> = trace.channels.iter().map(|c| &c.samples[..]).collect();
        let places: Vec<f64> = trace.channels.iter().map(|c| c.distance).collect();
        let times = picker.times(&channels, noise).map_err(missing)?;
        let repeats = if noise > 0.0 {
            repeated(&picker, &channels, noise, seed).map_err(missing)?
        } else {
            Vec::new()
        };

        // What moves all receivers alike moves no slope.
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
        let through = through.ok_or_else(|| missing("the arrivals are not the later the farther".into()))?;
        let slopes: Vec<f64> = repeats.iter().filter_map(|r| line(r)).map(|l| l.slope).collect();
        let by_noise = mean_square(slopes.iter().map(|s| s - through.slope)).sqrt();
        let scatter = if through.scatter.is_finite() { through.scatter } else { 0.0 };
        let rate = trace.sample_rate;
        Ok(Self {
            times: times.iter().map(|t| trace.start + t / rate).collect(),
            stddevs: variances.iter().map(|v| v.sqrt() / rate).collect(),
            slowness: through.slope / rate,
            slowness_stddev: by_noise.max(scatter) / rate,
            noise,
        })
    }
}

/// Burst and picker of a trace that can be picked.
fn prepared(trace: &Trace, cycles: f64, pick: Pick) -> Result<(Burst, Picker), AcousticsError> {
    let fault = |name, value, requirement| Err(AcousticsError::Setting { name, value, requirement });
    let positive = |x: f64| x.is_finite() && x > 0.0;
    if !positive(cycles) {
        return fault("cycles", cycles, "more than 0");
    }
    if !positive(trace.frequency) {
        return fault("frequency", trace.frequency, "more than 0");
    }
    if !(positive(trace.sample_rate) && trace.sample_rate >= 4.0 * trace.frequency) {
        return fault(
            "sample_rate",
            trace.sample_rate,
            "at least four samples a period of the centre frequency",
        );
    }
    if trace.channels.len() < 2 {
        return fault("receivers", trace.channels.len() as f64, "2 or more");
    }
    let samples = trace.channels[0].samples.len();
    if samples == 0 || trace.channels.iter().any(|c| c.samples.len() != samples) {
        return fault("samples", samples as f64, "as many at every receiver, 1 or more");
    }
    let numbers = trace.channels.iter().flat_map(|c| c.samples.iter().chain([&c.distance]));
    if let Some(value) = numbers.chain([&trace.start]).find(|x| !x.is_finite()) {
        return fault("samples", *value, "finite");
    }
    let burst = Burst { frequency: trace.frequency, cycles };
    Ok((burst, Picker::new(pick, burst, trace.sample_rate, samples)))
}

/// Root mean square of what is heard before the trigger.
fn noise(trace: &Trace, quiet: usize) -> f64 {
    if quiet < FEWEST_QUIET {
        return 0.0;
    }
    mean_square(trace.channels.iter().flat_map(|c| c.samples[..quiet].iter().copied())).sqrt()
}

/// Arrivals in noisy copies, of which not too many may show none.
fn repeated(picker: &Picker, channels: &[&[f64]], noise: f64, seed: u64) -> Result<Vec<Vec<f64>>, String> {
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
        Some(reason) if found < 1.0 - MOST_LOST => Err(format!("noise all but hides it: {reason}")),
        _ => Ok(times),
    }
}

fn mean_square(of: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = of.fold((0.0, 0usize), |(sum, n), x| (sum + x * x, n + 1));
    sum / count.max(1) as f64
}
