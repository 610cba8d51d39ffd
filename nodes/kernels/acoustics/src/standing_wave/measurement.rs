//! The speed of one polarization along one ray, from standing waves.

use super::free_vibration::{Excitation, FreeVibration};
use super::settings::Settings;
use super::tone::Tone;
use crate::curve::{DispersionCurve, DispersionPoint};
use crate::error::AcousticsError;
use crate::instrument::{Instrument, ReceiverSignals, SamplingWindow};
use crate::nonlinearity::{TO_ZERO, relative_change};
use crate::ray::Ray;
use crate::sample::Sample;
use crate::supercell::{Supercell, supercell};
use crate::trace::{Channel, Trace};
use crate::warning::Warning;
use crate::wave_path::{PathResult, WavePath};
use grainlab_core::{Vec3, WaveMethod};
use std::f64::consts::TAU;

/// Least number of copies per period: near two copies per period the packing reflects the wave.
const COPIES_PER_PERIOD: f64 = 2.5;

/// Shortest wave, and shortest path, mean diameters.
const SHORTEST_WAVE: f64 = 20.0;
const SHORTEST_PATH: f64 = 60.0;

/// Maximum number of waves.
const MAX_WAVES: u32 = 4;

/// Samples per period of the longest wave at the affine speed.
const SAMPLES_PER_PERIOD: f64 = 64.0;

/// Number of comparisons of the contacts for each estimate of the duration.
const LOOKS: usize = 6;

/// Range of speeds that are searched, over the affine speed.
const SPEEDS: [f64; 2] = [0.1, 1.1];

/// Typical speed over the affine speed, for the strain.
const TYPICAL_SPEED: f64 = 0.8;

/// Part of the first period that is left out.
const LEFT_OUT: f64 = 0.25;

/// Change of ρv² by contact forces over the pressure, for P and S waves: forces that turn with the contacts reduce it, by
/// 0.4 and 0.8 of the pressure in isotropic packings if all grains moved with the mean deformation.
const STRESSED: [f64; 2] = [0.6, 1.0];

/// Part of the dispersion of the longest wave by which speeds depart from a smooth law, because waves couple
/// to motions of a few loosely held grains at the frequencies of these.
const STRUCTURE: f64 = 0.12;

/// Relative change of the traces at half the amplitude above which the response is nonlinear.
const NONLINEAR: f64 = 1e-3;

/// Smallest relative standard deviation of a frequency: rounding.
const ROUNDING: f64 = 1e-10;

/// Excites standing waves on `path`, evaluates their frequencies, and extrapolates to long waves.
pub(super) fn measure(
    path: &WavePath,
    sample: &Sample,
    settings: &Settings,
    instrument: &Instrument,
) -> Result<PathResult, AcousticsError> {
    let affine_speed = sample.affine_speed(&path.direction, &path.polarization);
    StandingWave { path, sample, settings, affine_speed }.measure(instrument)
}

struct StandingWave<'a> {
    path: &'a WavePath,
    sample: &'a Sample,
    settings: &'a Settings,
    /// m/s.
    affine_speed: f64,
}

impl StandingWave<'_> {
    fn measure(&self, instrument: &Instrument) -> Result<PathResult, AcousticsError> {
        let (path, sample, settings) = (self.path, self.sample, self.settings);
        let supercell = self.supercell()?;
        let mass = sample.masses();
        let waves = (f64::from(settings.copies) / COPIES_PER_PERIOD)
            .min(supercell.path / (SHORTEST_WAVE * sample.diameter))
            .clamp(2.0, f64::from(MAX_WAVES)) as u32;
        let time_step = sample.packing.time_step;
        let dense = SAMPLES_PER_PERIOD * self.affine_speed / supercell.path;
        let rate = instrument.sample_rate.map_or(dense, |rate| rate.max(dense));
        let excitation = Excitation {
            supercell: &supercell,
            mass: &mass,
            setting: sample.setting,
            polarization: path.polarization,
            transverse: self.transverse(),
            velocity: settings.amplitude * TYPICAL_SPEED * self.affine_speed / f64::from(waves),
            waves,
            stride: (1.0 / (rate * time_step)).max(1.0) as u32,
        };
        let mut vibration = FreeVibration::new(excitation)?;
        let longest = self.record_periods(&mut vibration)?;
        let signals = ReceiverSignals {
            start: vibration.start(),
            interval: vibration.interval(),
            channels: vibration.channels.clone(),
        };
        let trace = self.trace(&signals, &supercell, longest, instrument)?;
        let tones = self.tones(&trace.channels, trace.start, trace.sample_rate)?;
        let point = |(tone, wave): (&Tone, u32)| {
            let wavenumber = supercell.wavenumber(wave);
            DispersionPoint { wavenumber, speed: tone.omega / wavenumber, stddev: tone.stddev / wavenumber }
        };
        let mut points: Vec<DispersionPoint> = tones.iter().zip(1..).map(point).collect();
        let mut warnings = Vec::new();
        let (opened, closed) = (vibration.changes.opened(), vibration.changes.closed());
        if opened + closed > 0 {
            // Without noise, so that only the amplitude differs.
            let half = Excitation { velocity: 0.5 * excitation.velocity, ..excitation };
            let mut half = FreeVibration::new(half)?;
            half.run_until(vibration.samples(), LOOKS)?;
            let full = channels(&supercell, signals.channels);
            let half = channels(&supercell, half.channels);
            let tones = |channels: &[Channel]| self.tones(channels, signals.start, 1.0 / signals.interval);
            for (point, (full, half)) in points.iter_mut().zip(tones(&full)?.iter().zip(tones(&half)?)) {
                let moved = TO_ZERO * (full.omega - half.omega).abs() / point.wavenumber;
                point.stddev = point.stddev.hypot(moved);
            }
            let pairs = full.iter().zip(&half).flat_map(|(f, h)| f.samples.iter().zip(&h.samples));
            let change = relative_change(pairs);
            if change > NONLINEAR {
                let (direction, polarization) = (path.direction.into(), path.polarization.into());
                let amplitude = settings.amplitude;
                let nonlinear =
                    Warning::Nonlinear { direction, polarization, amplitude, opened, closed, change };
                warnings.push(nonlinear);
            }
        }
        let curve = DispersionCurve::fit(path.direction, path.polarization, points);
        let mut curve =
            curve.ok_or_else(|| self.no_tone("its speeds at several wavelengths have no limit"))?;
        // The relative error of a speed is half that of ρv².
        let modulus = sample.density() * curve.speed.powi(2);
        let along = path.polarization.dot(&path.direction).powi(2);
        let stressed = (along * STRESSED[0] + (1.0 - along) * STRESSED[1]) * sample.pressure() / modulus;
        let dispersed = curve.dispersion_coefficient * supercell.wavenumber(1).powi(2);
        let scatter = (curve.stddev / curve.speed).hypot(0.5 * vibration.misalignment());
        curve.stddev = curve.speed * scatter.hypot(0.5 * stressed).hypot(0.5 * STRUCTURE * dispersed);
        Ok(PathResult { curve, traces: vec![trace], warnings, scatter })
    }

    /// Polarizations of the waves of another kind: across the ray for a P wave, along the ray for an S wave.
    fn transverse(&self) -> [Vec3; 2] {
        let WavePath { direction, polarization, .. } = *self.path;
        let along = polarization.dot(&direction);
        if 2.0 * along * along > 1.0 {
            let [_, one, other] = Ray::polarizations_about(&polarization, &direction);
            [one, other]
        } else {
            [(direction - polarization * along).normalize(), Vec3::zeros()]
        }
    }

    /// The packing, repeated as often as set, or more where the path would be too short.
    fn supercell(&self) -> Result<Supercell, AcousticsError> {
        let one = supercell(&self.sample.packing, self.path.indices, 1)?.path;
        let enough = (SHORTEST_PATH * self.sample.diameter / one).ceil() as u32;
        supercell(&self.sample.packing, self.path.indices, self.settings.copies.max(enough))
    }

    /// Runs until the set number of periods of the longest wave is recorded; its ω, rad/s.
    fn record_periods(&self, vibration: &mut FreeVibration<'_>) -> Result<f64, AcousticsError> {
        let q = vibration.wavenumber(1);
        let range = SPEEDS.map(|speed| speed * self.affine_speed * q);
        let interval = vibration.interval();
        let enough = |omega: f64| (self.settings.periods * TAU / omega / interval).ceil() as usize + 1;
        let (most, mut needed) = (enough(range[0]), enough(range[1]));
        loop {
            vibration.run_until(needed, LOOKS)?;
            let tone = Tone::found(&vibration.channels[0], vibration.start(), interval, range);
            let now = vibration.samples();
            needed = match tone {
                Some(tone) if enough(tone.omega) <= now => return Ok(tone.omega),
                // A first estimate may be far off.
                Some(tone) => enough(tone.omega).min(2 * now),
                None => now + now.div_ceil(2),
            };
            if now >= most {
                return Err(self.no_tone("there is no tone at a tenth or more of the affine speed"));
            }
        }
    }

    /// The trace that the instrument records.
    fn trace(
        &self,
        signals: &ReceiverSignals,
        supercell: &Supercell,
        omega: f64,
        instrument: &Instrument,
    ) -> Result<Trace, AcousticsError> {
        let longest = &signals.channels[0];
        let waves = signals.channels.len() as f64;
        if instrument.sample_rate.is_some() {
            // The shortest wave has the highest frequency.
            instrument.rate(waves * omega / TAU)?;
        }
        let rate = instrument.sample_rate.unwrap_or(1.0 / signals.interval);
        let length = signals.interval * (longest.len() - 1) as f64;
        let window =
            SamplingWindow { start: signals.start, rate, samples: (length * rate + 0.5).floor() as usize };
        let evaluated = (self.settings.periods * TAU / omega / signals.interval) as usize;
        let square: f64 = longest.iter().take(evaluated).map(|s| s * s).sum();
        let signal = (square / evaluated.min(longest.len()) as f64).sqrt();
        let samples = instrument.record(signals, &window, signal, &self.path.place);
        Ok(Trace {
            direction: self.path.direction,
            polarization: self.path.polarization,
            method: WaveMethod::StandingWave,
            frequency: omega / TAU,
            sample_rate: rate,
            start: window.start,
            channels: channels(supercell, samples),
        })
    }

    /// The tone of every channel.
    fn tones(&self, channels: &[Channel], start: f64, rate: f64) -> Result<Vec<Tone>, AcousticsError> {
        let tone = |channel: &Channel| {
            let range = SPEEDS.map(|speed| speed * self.affine_speed * TAU / channel.distance);
            tone(&channel.samples, start, 1.0 / rate, self.settings.periods, range)
        };
        let none = || {
            self.no_tone("no damped tone is significant; use more copies, a larger amplitude or less noise")
        };
        channels.iter().map(|c| tone(c).ok_or_else(none)).collect()
    }

    fn no_tone(&self, reason: &str) -> AcousticsError {
        self.path.no_signal("standing wave", reason)
    }
}

fn channels(supercell: &Supercell, samples: Vec<Vec<f64>>) -> Vec<Channel> {
    let channel = |(samples, wave)| Channel { distance: TAU / supercell.wavenumber(wave), samples };
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
    Some(Tone { omega: tone.omega, stddev: tone.stddev.hypot(apart).max(ROUNDING * tone.omega) })
}
