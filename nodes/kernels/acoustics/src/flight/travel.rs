//! The speed of one motion along one ray, by sending bursts.

use crate::curve::Curve;
use crate::error::AcousticsError;
use crate::flight::arrival::Arrivals;
use crate::flight::burst::Burst;
use crate::flight::meaning;
use crate::flight::passage::Passage;
use crate::flight::shot::{Answer, Shot};
use crate::flight::{Pick, Settings};
use crate::instrument::{Clock, Heard, Instrument, burst_level};
use crate::measure::Warning;
use crate::noise::seed_at;
use crate::repeat::repeated;
use crate::sample::Sample;
use crate::trace::{Channel, Trace};
use grainlab_core::Vec3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Wavelengths of the frequencies sent where none are named, mean diameters.
const WAVELENGTHS: [f64; 3] = [20.0, 28.0, 40.0];

/// A first shot finds the speed to a few per cent: its wavelength in mean diameters, by a guess of what share of the affine
/// speed the speed is, and where its receivers are, wavelengths.
const ROUGH_WAVELENGTH: f64 = 20.0;
const ROUGH_SHARE: f64 = 0.75;
const ROUGH_RECEIVERS: (u32, f64, f64) = (3, 0.75, 2.0);

/// What half the amplitude changes, times this, is what none at all may change.
const TO_NONE: f64 = 3.0;

/// Relative change of the trace at half the amplitude from which an answer is not in proportion.
const NONLINEAR: f64 = 1e-2;

/// One motion along one ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Travel {
    /// Unit direction of propagation.
    pub(crate) direction: Vec3,
    /// Unit particle motion.
    pub(crate) motion: Vec3,
    /// Lattice planes across the direction.
    pub(crate) indices: [i32; 3],
    /// Which ray and motion it is.
    pub(crate) place: [u64; 2],
}

/// What was found.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub(crate) curve: Curve,
    pub(crate) traces: Vec<Trace>,
    pub(crate) warnings: Vec<Warning>,
}

impl Travel {
    /// Sends all frequencies, picks, and extrapolates.
    pub(crate) fn measured(
        &self,
        sample: &Sample,
        settings: &Settings,
        instrument: &Instrument,
    ) -> Result<Found, AcousticsError> {
        let speed = self.rough_speed(sample, settings)?;
        // The edge of ω = (2 v/a) sin(q a/2), which chains of grains have, with a the mean diameter.
        let cutoff = speed / (PI * sample.diameter);
        let frequencies = settings.frequencies.clone();
        let frequencies =
            frequencies.unwrap_or_else(|| WAVELENGTHS.map(|w| speed / (w * sample.diameter)).to_vec());
        if let Some(frequency) = frequencies.iter().copied().find(|f| *f >= cutoff) {
            return Err(AcousticsError::CutOff { frequency, cutoff, direction: self.direction.into() });
        }
        let bursts: Vec<Burst> =
            frequencies.iter().map(|f| Burst { frequency: *f, cycles: settings.cycles }).collect();
        // A path too short is refused before anything is sent, with the length that the longest wave needs.
        let short = bursts.iter().filter_map(|b| self.passage(sample, settings, b, speed).err());
        if let Some(worst) = short.max_by_key(copies_needed) {
            return Err(worst);
        }
        let send =
            |burst: &Burst| self.send(sample, settings, burst, speed, instrument.rate(burst.frequency)?);
        let answers: Vec<Result<Answer, AcousticsError>> = bursts.par_iter().map(send).collect();
        let answers = answers.into_iter().collect::<Result<Vec<_>, _>>()?;
        let mut traces = Vec::with_capacity(bursts.len());
        let mut arrivals = Vec::with_capacity(bursts.len());
        for (k, (burst, answer)) in bursts.iter().zip(&answers).enumerate() {
            let place = [&self.place[..], &[k as u64]].concat();
            let trace = self.trace(burst, answer, instrument, settings.pick, &place)?;
            let seed = seed_at(instrument.seed, &place);
            arrivals.push(Arrivals::picked(&trace, burst.cycles, settings.pick, seed)?);
            traces.push(trace);
        }
        let mut curve = meaning::curve(&traces, &arrivals, settings.cycles, settings.pick, sample.diameter)?;
        let warnings = self.nonlinear(sample, settings, speed, &bursts, &answers, &mut curve)?;
        Ok(Found { curve, traces, warnings })
    }

    /// The speed of a first burst, m/s: what is sent, and where it is heard, follows from it.
    fn rough_speed(&self, sample: &Sample, settings: &Settings) -> Result<f64, AcousticsError> {
        let guess = ROUGH_SHARE * sample.affine_speed(&self.direction, &self.motion);
        if guess.is_nan() || guess <= 0.0 {
            return Err(AcousticsError::NoSignal {
                what: "wave",
                direction: self.direction.into(),
                motion: self.motion.into(),
                reason: "the contacts resist no such motion".to_owned(),
            });
        }
        let (receivers, nearest, furthest) = ROUGH_RECEIVERS;
        let settings = Settings { receivers, nearest, furthest, copies: None, ..settings.clone() };
        let frequency = guess / (ROUGH_WAVELENGTH * sample.diameter);
        let burst = Burst { frequency, cycles: settings.cycles };
        let instrument = Instrument::default();
        let answer = self.send(sample, &settings, &burst, guess, instrument.rate(frequency)?)?;
        let trace = self.trace(&burst, &answer, &instrument, Pick::CrossCorrelation, &self.place)?;
        let arrivals = Arrivals::picked(&trace, burst.cycles, Pick::CrossCorrelation, instrument.seed)?;
        Ok(1.0 / arrivals.slowness)
    }

    fn passage(
        &self,
        sample: &Sample,
        settings: &Settings,
        burst: &Burst,
        speed: f64,
    ) -> Result<Passage, AcousticsError> {
        let planes = sample.packing.cell.inverse().transpose() * Vec3::from(self.indices.map(f64::from));
        // Planes (2 0 0) are every other one of (1 0 0).
        let divisor = self.indices.iter().fold(0, |a, b| gcd(a, b.unsigned_abs()));
        Passage::planned(settings, burst, speed, sample.diameter, f64::from(divisor) / planes.norm())
    }

    fn send(
        &self,
        sample: &Sample,
        settings: &Settings,
        burst: &Burst,
        speed: f64,
        rate: f64,
    ) -> Result<Answer, AcousticsError> {
        let passage = self.passage(sample, settings, burst, speed)?;
        let repeated = repeated(&sample.packing, self.indices, passage.copies)?;
        let shot = Shot {
            repeated: &repeated,
            present: &sample.present,
            setting: sample.setting,
            motion: self.motion,
            burst: *burst,
            amplitude: settings.amplitude,
            speed,
            thickness: settings.thickness * sample.diameter,
            receivers: &passage.receivers,
            duration: passage.duration,
            rate,
        };
        shot.sent()
    }

    /// What the instrument writes down: from a burst's length before the trigger on.
    fn trace(
        &self,
        burst: &Burst,
        answer: &Answer,
        instrument: &Instrument,
        pick: Pick,
        place: &[u64],
    ) -> Result<Trace, AcousticsError> {
        let Heard { start, interval, channels } = &answer.heard;
        let rate = instrument.rate(burst.frequency)?;
        let before = (burst.duration() * rate).ceil();
        let heard = channels.first().map_or(0.0, |c| start + interval * (c.len() as f64 - 2.0));
        let clock = Clock {
            start: -before / rate,
            rate,
            samples: (before + (heard * rate).floor().max(0.0)) as usize,
        };
        let level = channels.first().map_or(0.0, |c| burst_level(c, (burst.duration() / interval) as usize));
        let samples = instrument.record(&answer.heard, &clock, level, place);
        let channels = answer.distances.iter().zip(samples);
        Ok(Trace {
            direction: self.direction,
            motion: self.motion,
            method: pick.method(),
            frequency: burst.frequency,
            sample_rate: rate,
            start: clock.start,
            channels: channels.map(|(d, samples)| Channel { distance: *d, samples }).collect(),
        })
    }

    /// Where contacts came or went, the burst of the highest frequency is sent again at half the amplitude, and what that
    /// changes is added to the uncertainty.
    fn nonlinear(
        &self,
        sample: &Sample,
        settings: &Settings,
        speed: f64,
        bursts: &[Burst],
        answers: &[Answer],
        curve: &mut Curve,
    ) -> Result<Vec<Warning>, AcousticsError> {
        let (opened, closed) = answers.iter().fold((0, 0), |(o, c), a| (o + a.opened, c + a.closed));
        let shortest = bursts.iter().zip(answers).max_by(|a, b| a.0.frequency.total_cmp(&b.0.frequency));
        let Some((burst, full)) = shortest.filter(|_| opened + closed > 0) else { return Ok(Vec::new()) };
        let instrument = Instrument::default();
        let settings = Settings { amplitude: 0.5 * settings.amplitude, ..settings.clone() };
        let half = self.send(sample, &settings, burst, speed, instrument.rate(burst.frequency)?)?;
        let slowness = |answer: &Answer| {
            let trace = self.trace(burst, answer, &instrument, settings.pick, &self.place)?;
            Ok::<f64, AcousticsError>(Arrivals::picked(&trace, burst.cycles, settings.pick, 1)?.slowness)
        };
        let moved = (slowness(&half)? / slowness(full)? - 1.0).abs();
        let change = change(&full.heard, &half.heard);
        // A trace that is another one at half the amplitude does not tell what none would do.
        let unknown = if change > NONLINEAR { 0.5 * change } else { 0.0 };
        curve.stddev = curve.stddev.hypot((TO_NONE * moved).hypot(unknown) * curve.speed);
        let warning = Warning::Nonlinear {
            direction: self.direction.into(),
            motion: self.motion.into(),
            amplitude: 2.0 * settings.amplitude,
            opened,
            closed,
            change,
        };
        Ok(if change > NONLINEAR { vec![warning] } else { Vec::new() })
    }
}

fn copies_needed(error: &AcousticsError) -> u32 {
    if let AcousticsError::PathTooShort { enough, .. } = error { *enough } else { u32::MAX }
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// How far twice the second differs from the first, of the first, root mean square.
fn change(full: &Heard, half: &Heard) -> f64 {
    let pairs = || full.channels.iter().zip(&half.channels).flat_map(|(f, h)| f.iter().zip(h));
    let difference: f64 = pairs().map(|(f, h)| (2.0 * h - f).powi(2)).sum();
    (difference / pairs().map(|(f, _)| f * f).sum::<f64>()).sqrt()
}
