//! The speed of one motion along one ray, by standing waves.

use crate::curve::{Curve, Point};
use crate::error::AcousticsError;
use crate::instrument::{Clock, Heard, Instrument};
use crate::measure::Warning;
use crate::ray::Ray;
use crate::repeat::{Repeated, repeated};
use crate::sample::Sample;
use crate::standing::Settings;
use crate::standing::ringing::{Ringing, Strike};
use crate::standing::tone::Tone;
use crate::trace::{Channel, Trace};
use grainlab_core::{Vec3, WaveMethod};
use std::f64::consts::TAU;

/// Fewest copies a period: nearer to two the packing scatters a wave back.
const COPIES_PER_PERIOD: f64 = 2.5;

/// Shortest wave, and shortest path, mean diameters.
const SHORTEST_WAVE: f64 = 20.0;
const SHORTEST_PATH: f64 = 60.0;

/// Most waves.
const MOST_WAVES: u32 = 4;

/// Moments a period of the longest wave, as the affine speed has it, at which it is heard.
const MOMENTS_PER_PERIOD: f64 = 64.0;

/// Looks at the contacts for every estimate of how long it is to ring.
const LOOKS: usize = 6;

/// Speeds looked for, shares of the affine speed.
const SPEEDS: [f64; 2] = [0.1, 1.1];

/// What share of the affine speed a speed is: as a guess, for the strain.
const ROUGH_SHARE: f64 = 0.8;

/// Share of the first period that is left out.
const LEFT_OUT: f64 = 0.25;

/// A speed moves with the amplitude to the power of one half or more: from half of it to none by three times as much as from all
/// to half.
const TO_NONE: f64 = 3.0;

/// Share of the dispersion of the longest wave by which speeds depart from a smooth law, as waves meet motions of a few loose
/// grains of their own frequency: what covers packings of 2,000 grains that did not set it, too.
const STRUCTURE: f64 = 0.2;

/// Relative change of the traces at half the amplitude from which the answer is not in proportion.
const NONLINEAR: f64 = 1e-3;

/// Smallest relative standard deviation of a frequency: rounding.
const ROUNDING: f64 = 1e-10;

/// One motion along one ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Resonance {
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
    pub(crate) trace: Trace,
    pub(crate) warnings: Vec<Warning>,
}

impl Resonance {
    /// Strikes the packing, listens, and extrapolates.
    pub(crate) fn measured(
        &self,
        sample: &Sample,
        settings: &Settings,
        instrument: &Instrument,
    ) -> Result<Found, AcousticsError> {
        let repeated = self.repeated(sample, settings)?;
        let mass = sample.masses();
        let waves = (f64::from(settings.copies) / COPIES_PER_PERIOD)
            .min(repeated.path / (SHORTEST_WAVE * sample.diameter))
            .clamp(2.0, f64::from(MOST_WAVES)) as u32;
        let affine = sample.affine_speed(&self.direction, &self.motion);
        let time_step = sample.packing.time_step;
        let dense = MOMENTS_PER_PERIOD * affine / repeated.path;
        let rate = instrument.sample_rate.map_or(dense, |rate| rate.max(dense));
        let strike = Strike {
            repeated: &repeated,
            mass: &mass,
            setting: sample.setting,
            motion: self.motion,
            aside: self.aside(),
            velocity: settings.amplitude * ROUGH_SHARE * affine / f64::from(waves),
            waves,
            stride: (1.0 / (rate * time_step)).max(1.0) as u32,
        };
        let mut ringing = Ringing::new(strike)?;
        let longest = self.rung(&mut ringing, settings.periods, affine)?;
        let heard = Heard {
            start: ringing.start(),
            interval: ringing.interval(),
            channels: ringing.channels.clone(),
        };
        let trace = self.trace(&heard, &repeated, longest, settings.periods, instrument)?;
        let tones = self.tones(&trace.channels, trace.start, trace.sample_rate, settings.periods, affine)?;
        let point = |(tone, wave): (&Tone, u32)| {
            let wavenumber = repeated.wavenumber(wave);
            Point { wavenumber, speed: tone.omega / wavenumber, stddev: tone.stddev / wavenumber }
        };
        let mut points: Vec<Point> = tones.iter().zip(1..).map(point).collect();
        let mut warnings = Vec::new();
        let (opened, closed) = ringing.changes();
        if opened + closed > 0 {
            // Without noise, so that nothing but the amplitude differs.
            let mut half = Ringing::new(Strike { velocity: 0.5 * strike.velocity, ..strike })?;
            half.listen(ringing.samples(), LOOKS)?;
            let full = channels(&repeated, heard.channels);
            let half = channels(&repeated, half.channels);
            let tones = |channels: &[Channel]| {
                self.tones(channels, heard.start, 1.0 / heard.interval, settings.periods, affine)
            };
            for (point, (full, half)) in points.iter_mut().zip(tones(&full)?.iter().zip(tones(&half)?)) {
                let moved = TO_NONE * (full.omega - half.omega).abs() / point.wavenumber;
                point.stddev = point.stddev.hypot(moved);
            }
            let change = change(&full, &half);
            if change > NONLINEAR {
                let (direction, motion) = (self.direction.into(), self.motion.into());
                let amplitude = settings.amplitude;
                warnings.push(Warning::Nonlinear { direction, motion, amplitude, opened, closed, change });
            }
        }
        let curve = Curve::through(self.direction, self.motion, points);
        let mut curve =
            curve.ok_or_else(|| self.silent("its speeds at several wavelengths have no limit"))?;
        // Half of what ρv² is uncertain by.
        let modulus = sample.density() * curve.speed.powi(2);
        let dispersed = curve.bend * repeated.wavenumber(1).powi(2);
        let beyond = (sample.pressure() / modulus).hypot(ringing.aside()).hypot(STRUCTURE * dispersed);
        curve.stddev = curve.stddev.hypot(0.5 * beyond * curve.speed);
        Ok(Found { curve, trace, warnings })
    }

    /// Motions of waves of another kind: across the ray for one along it, along the ray for one across.
    fn aside(&self) -> [Vec3; 2] {
        let others = |v: &Vec3| Ray::motions_about(v, &self.direction);
        let along = self.motion.dot(&self.direction);
        if 2.0 * along * along > 1.0 {
            let [_, one, other] = others(&self.motion);
            [one, other]
        } else {
            [(self.direction - self.motion * along).normalize(), Vec3::zeros()]
        }
    }

    /// The packing, repeated as often as told, and as the path must be long.
    fn repeated(&self, sample: &Sample, settings: &Settings) -> Result<Repeated, AcousticsError> {
        let one = repeated(&sample.packing, self.indices, 1)?.path;
        let enough = (SHORTEST_PATH * sample.diameter / one).ceil() as u32;
        repeated(&sample.packing, self.indices, settings.copies.max(enough))
    }

    /// Listens for `periods` of the longest wave; its ω (rad/s).
    fn rung(&self, ringing: &mut Ringing<'_>, periods: f64, affine: f64) -> Result<f64, AcousticsError> {
        let q = ringing.wavenumber(1);
        let range = SPEEDS.map(|share| share * affine * q);
        let interval = ringing.interval();
        let enough = |omega: f64| (periods * TAU / omega / interval).ceil() as usize + 1;
        let (most, mut needed) = (enough(range[0]), enough(range[1]));
        loop {
            ringing.listen(needed, LOOKS)?;
            let tone = Tone::found(&ringing.channels[0], ringing.start(), interval, range);
            let now = ringing.samples();
            needed = match tone {
                Some(tone) if enough(tone.omega) <= now => return Ok(tone.omega),
                // A first estimate may be far off.
                Some(tone) => enough(tone.omega).min(2 * now),
                None => now + now.div_ceil(2),
            };
            if now >= most {
                return Err(self.silent("nothing rings at a tenth or more of the affine speed"));
            }
        }
    }

    /// What the instrument writes down.
    fn trace(
        &self,
        heard: &Heard,
        repeated: &Repeated,
        omega: f64,
        periods: f64,
        instrument: &Instrument,
    ) -> Result<Trace, AcousticsError> {
        let longest = &heard.channels[0];
        let waves = heard.channels.len() as f64;
        if instrument.sample_rate.is_some() {
            // The shortest wave has the highest frequency.
            instrument.rate(waves * omega / TAU)?;
        }
        let rate = instrument.sample_rate.unwrap_or(1.0 / heard.interval);
        let length = heard.interval * (longest.len() - 1) as f64;
        let clock = Clock { start: heard.start, rate, samples: (length * rate + 0.5).floor() as usize };
        let window = (periods * TAU / omega / heard.interval) as usize;
        let square: f64 = longest.iter().take(window).map(|s| s * s).sum();
        let signal = (square / window.min(longest.len()) as f64).sqrt();
        let samples = instrument.record(heard, &clock, signal, &self.place);
        Ok(Trace {
            direction: self.direction,
            motion: self.motion,
            method: WaveMethod::StandingWave,
            frequency: omega / TAU,
            sample_rate: rate,
            start: clock.start,
            channels: channels(repeated, samples),
        })
    }

    /// The tone of every channel.
    fn tones(
        &self,
        channels: &[Channel],
        start: f64,
        rate: f64,
        periods: f64,
        affine: f64,
    ) -> Result<Vec<Tone>, AcousticsError> {
        let tone = |channel: &Channel| {
            let range = SPEEDS.map(|share| share * affine * TAU / channel.distance);
            tone(&channel.samples, start, 1.0 / rate, periods, range)
        };
        let silent = || {
            self.silent("no damped tone stands out; send with more copies, a larger amplitude or less noise")
        };
        channels.iter().map(|c| tone(c).ok_or_else(silent)).collect()
    }

    fn silent(&self, reason: &str) -> AcousticsError {
        AcousticsError::NoSignal {
            what: "ringing",
            direction: self.direction.into(),
            motion: self.motion.into(),
            reason: reason.to_owned(),
        }
    }
}

fn channels(repeated: &Repeated, samples: Vec<Vec<f64>>) -> Vec<Channel> {
    let channel = |(samples, wave)| Channel { distance: TAU / repeated.wavenumber(wave), samples };
    samples.into_iter().zip(1..).map(channel).collect()
}

/// The tone of one wave over its own `periods`, ω (rad/s) within `range`.
fn tone(samples: &[f64], start: f64, interval: f64, periods: f64, range: [f64; 2]) -> Option<Tone> {
    let within = |omega: f64, from: f64, to: f64| {
        let place = |turns: f64| (turns * TAU / omega / interval).ceil() as usize;
        let end = place(to).min(samples.len());
        let begin = place(from).min(end);
        Tone::found(&samples[begin..end], start + begin as f64 * interval, interval, range)
    };
    let rough = Tone::found(samples, start, interval, range)?.omega;
    let tone = within(rough, LEFT_OUT, periods)?;
    let half = within(rough, LEFT_OUT, LEFT_OUT + 0.5 * (periods - LEFT_OUT))?;
    let apart = (tone.omega - half.omega).abs();
    Some(Tone { stddev: tone.stddev.hypot(apart).max(ROUNDING * tone.omega), ..tone })
}

/// Root mean square of by how much twice the half differs from the full, over that of the full.
fn change(full: &[Channel], half: &[Channel]) -> f64 {
    let (mut difference, mut square) = (0.0, 0.0);
    for (a, b) in full.iter().zip(half).flat_map(|(f, h)| f.samples.iter().zip(&h.samples)) {
        difference += (a - 2.0 * b).powi(2);
        square += a * a;
    }
    (difference / square).sqrt()
}
