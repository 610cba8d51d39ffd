//! The speed of one polarization along one ray, from bursts.

use super::arrival::Arrivals;
use super::burst::Burst;
use super::burst_run::{BurstResponse, send};
use super::path_plan::{PathPlan, RECEIVERS};
use super::phase_velocity;
use super::settings::{ArrivalPick, Settings};
use super::wave_path::{PathResult, WavePath};
use crate::curve::DispersionCurve;
use crate::error::{AcousticsError, in_brackets, no_signal};
use crate::instrument::{Instrument, ReceiverSignals, SamplingWindow, burst_level};
use crate::noise::seed_at;
use crate::sample::Sample;
use crate::trace::{Channel, Trace};
use grainlab_core::notes::Note;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Wavelengths of the default frequencies, mean diameters.
const WAVELENGTHS: [f64; 3] = [20.0, 28.0, 40.0];

/// The first burst, which gives the speed to a few per cent: its wavelength in mean diameters for a typical speed over
/// the affine one; and number, first and last distance of its receivers, wavelengths.
const FIRST_WAVELENGTH: f64 = 20.0;
const TYPICAL_SPEED: f64 = 0.75;
const FIRST_RECEIVERS: (u32, f64, f64) = (3, 0.75, 2.0);

/// Greatest speed over that of a wave in which every grain follows the mean deformation; more than 1 for noise and for
/// large amplitudes, which stiffen contacts.
const FASTEST: f64 = 2.0;

/// Relative change of the trace at half the amplitude above which the response is nonlinear.
const NONLINEAR: f64 = 1e-2;

/// Ratio of the changes of a speed: from half the amplitude to zero over from the full amplitude to half. The change is
/// proportional to a power of one half or more of the amplitude.
const TO_ZERO: f64 = 3.0;

pub(super) struct TimeOfFlight<'a> {
    pub(super) path: &'a WavePath,
    pub(super) sample: &'a Sample,
}

impl TimeOfFlight<'_> {
    /// Sends bursts of all frequencies, picks arrivals, and extrapolates to long waves.
    pub(super) fn measure(
        &self,
        settings: &Settings,
        instrument: &Instrument,
    ) -> Result<PathResult, AcousticsError> {
        let diameter = self.sample.diameter;
        let speed = self.first_speed(settings)?;
        // The band edge of ω = (2 v/a) sin(q a/2), the dispersion of a chain, with a the mean diameter.
        let cutoff = speed / (PI * diameter);
        let frequencies = settings.frequencies.clone();
        let frequencies = frequencies.unwrap_or_else(|| WAVELENGTHS.map(|w| speed / (w * diameter)).to_vec());
        if let Some(frequency) = frequencies.iter().copied().find(|f| *f >= cutoff) {
            return Err(AcousticsError::CutOff { frequency, cutoff, direction: self.path.direction.into() });
        }
        let bursts: Vec<Burst> =
            frequencies.iter().map(|f| Burst { frequency: *f, cycles: settings.cycles }).collect();
        // A path that is too short is refused before a burst is sent, with the length that the longest wave
        // needs.
        let (path, sample) = (self.path, self.sample);
        let plan = |burst: &Burst| PathPlan::new(path, sample, RECEIVERS, settings.copies, burst, speed);
        if let Some(worst) = bursts.iter().filter_map(|b| plan(b).err()).max_by_key(copies_needed) {
            return Err(worst);
        }
        let sent = |burst: &Burst| {
            let rate = instrument.rate(burst.frequency)?;
            send(path, sample, &plan(burst)?, burst, settings.amplitude, speed, rate)
        };
        let responses: Vec<Result<BurstResponse, AcousticsError>> = bursts.par_iter().map(sent).collect();
        let responses = responses.into_iter().collect::<Result<Vec<_>, _>>()?;
        let mut traces = Vec::with_capacity(bursts.len());
        let mut arrivals = Vec::with_capacity(bursts.len());
        for (k, (burst, response)) in bursts.iter().zip(&responses).enumerate() {
            let place = [&self.path.place[..], &[k as u64]].concat();
            let trace = self.trace(burst, response, instrument, settings.pick, &place)?;
            let seed = seed_at(instrument.seed, &place);
            arrivals.push(Arrivals::pick(&trace, burst.cycles, settings.pick, seed)?);
            traces.push(trace);
        }
        let mut curve = phase_velocity::curve(&traces, &arrivals, settings.cycles, settings.pick, diameter)?;
        // No long wave is faster than one in which every grain follows the mean deformation.
        let affine = self.sample.affine_speed(&self.path.direction, &self.path.polarization);
        if curve.speed > FASTEST * affine {
            let reason = "the picked feature is faster than any long wave; the burst is lost to scattering, use longer waves";
            return Err(no_signal("arrival", &path.direction, &path.polarization, reason));
        }
        // Contact forces change rho v^2 of moving grains by the order of the pressure.
        let modulus = self.sample.density() * curve.speed.powi(2);
        curve.stddev = curve.stddev.hypot(0.5 * self.sample.pressure() / modulus * curve.speed);
        let notes = self.nonlinearity(settings, speed, &bursts, &responses, &mut curve)?;
        Ok(PathResult { curve, traces, notes })
    }

    /// The speed of a first burst, m/s, from which frequencies and receivers follow.
    fn first_speed(&self, settings: &Settings) -> Result<f64, AcousticsError> {
        let guess = TYPICAL_SPEED * self.sample.affine_speed(&self.path.direction, &self.path.polarization);
        if guess.is_nan() || guess <= 0.0 {
            let reason = "the contacts have no stiffness for this polarization";
            return Err(no_signal("wave", &self.path.direction, &self.path.polarization, reason));
        }
        let frequency = guess / (FIRST_WAVELENGTH * self.sample.diameter);
        let burst = Burst { frequency, cycles: settings.cycles };
        let instrument = Instrument::default();
        let pick = ArrivalPick::CrossCorrelation;
        let plan = PathPlan::new(self.path, self.sample, FIRST_RECEIVERS, None, &burst, guess)?;
        let rate = instrument.rate(frequency)?;
        let response = send(self.path, self.sample, &plan, &burst, settings.amplitude, guess, rate)?;
        let trace = self.trace(&burst, &response, &instrument, pick, &self.path.place)?;
        let arrivals = Arrivals::pick(&trace, burst.cycles, pick, instrument.seed)?;
        Ok(1.0 / arrivals.slowness)
    }

    /// The trace that the instrument records, which starts one burst duration before the trigger.
    fn trace(
        &self,
        burst: &Burst,
        response: &BurstResponse,
        instrument: &Instrument,
        pick: ArrivalPick,
        place: &[u64],
    ) -> Result<Trace, AcousticsError> {
        let ReceiverSignals { start, interval, channels } = &response.signals;
        let rate = instrument.rate(burst.frequency)?;
        let before = (burst.duration() * rate).ceil();
        let end = channels.first().map_or(0.0, |c| start + interval * (c.len() as f64 - 2.0));
        let window = SamplingWindow {
            start: -before / rate,
            rate,
            samples: (before + (end * rate).floor().max(0.0)) as usize,
        };
        let level = channels.first().map_or(0.0, |c| burst_level(c, (burst.duration() / interval) as usize));
        let samples = instrument.record(&response.signals, &window, level, place);
        let channels = response.distances.iter().zip(samples);
        Ok(Trace {
            direction: self.path.direction,
            polarization: self.path.polarization,
            method: pick.method(),
            frequency: burst.frequency,
            sample_rate: rate,
            start: window.start,
            channels: channels.map(|(d, samples)| Channel { distance: *d, samples }).collect(),
        })
    }

    /// If contacts opened or closed, sends the burst of the highest frequency again at half the amplitude and adds the
    /// change to the uncertainty.
    fn nonlinearity(
        &self,
        settings: &Settings,
        speed: f64,
        bursts: &[Burst],
        responses: &[BurstResponse],
        curve: &mut DispersionCurve,
    ) -> Result<Vec<Note>, AcousticsError> {
        let (opened, closed) = responses.iter().fold((0, 0), |(o, c), a| (o + a.opened, c + a.closed));
        let shortest = bursts.iter().zip(responses).max_by(|a, b| a.0.frequency.total_cmp(&b.0.frequency));
        let Some((burst, full)) = shortest.filter(|_| opened + closed > 0) else { return Ok(Vec::new()) };
        let instrument = Instrument::default();
        let plan = PathPlan::new(self.path, self.sample, RECEIVERS, settings.copies, burst, speed)?;
        let (rate, amplitude) = (instrument.rate(burst.frequency)?, settings.amplitude);
        let half = send(self.path, self.sample, &plan, burst, 0.5 * amplitude, speed, rate)?;
        let slowness = |response: &BurstResponse| {
            let trace = self.trace(burst, response, &instrument, settings.pick, &self.path.place)?;
            Ok::<f64, AcousticsError>(Arrivals::pick(&trace, burst.cycles, settings.pick, 1)?.slowness)
        };
        let moved = (slowness(&half)? / slowness(full)? - 1.0).abs();
        let channels = full.signals.channels.iter().zip(&half.signals.channels);
        let change = relative_change(channels.flat_map(|(f, h)| f.iter().zip(h)));
        // A trace of another shape at half the amplitude cannot be extrapolated to zero amplitude.
        let unknown = if change > NONLINEAR { 0.5 * change } else { 0.0 };
        curve.stddev = curve.stddev.hypot((TO_ZERO * moved).hypot(unknown) * curve.speed);
        let [direction, polarization] =
            [self.path.direction, self.path.polarization].map(|v| in_brackets(&v.into()));
        let note = || {
            Note::nonlinear(direction, polarization, amplitude, f64::from(opened), f64::from(closed), change)
        };
        Ok((change > NONLINEAR).then(note).into_iter().collect())
    }
}

/// Root mean square of full − 2 × half over that of the full signal, for pairs of samples (full, half).
fn relative_change<'a>(pairs: impl Iterator<Item = (&'a f64, &'a f64)>) -> f64 {
    let (mut difference, mut square) = (0.0, 0.0);
    for (full, half) in pairs {
        difference += (full - 2.0 * half).powi(2);
        square += full * full;
    }
    (difference / square).sqrt()
}

fn copies_needed(error: &AcousticsError) -> u32 {
    if let AcousticsError::PathTooShort { enough, .. } = error { *enough } else { u32::MAX }
}
