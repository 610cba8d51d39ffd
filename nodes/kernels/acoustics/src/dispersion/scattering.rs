//! Loss of coherence of a plane wave by scattering from disorder, without dissipation.
//!
//! The coherent amplitude of a plane wave ([`Coherence`]) is fitted by a damped tone, e^(−γt) cos(ωt + φ), and 1/Q = 2γ/ω.
//!
//! A periodic sample of the volume V has discrete modes, g(ω) = V ω²/(2π²) Σ 1/c³ of them per unit of ω at a wave vector. A
//! wave loses its coherence to them only until the time 2π g; then it returns. A line of the width 2γ therefore has the
//! width of a larger sample only if it holds many modes, 2γ g ≥ [`RESOLVED`]. With Rayleigh's law, 1/Q ∝ ω³, 2γ g grows as
//! ω⁶ times the number of grains: eight times the grains show scattering down to 0.7 of the frequency. In two pairs of
//! packings of 2,000 and of 8,000 grains, with coordination numbers of 5.0 and 3.9, 1/Q agrees within the stated
//! error where it is resolved, is lower by a tenth on average in the smaller ones, and grows faster than ω³ at its lower
//! end; the range of Rayleigh's law is at lower frequencies than such samples resolve.

use crate::dispersion::alignment::nearest_of;
use crate::dispersion::bloch::Bloch;
use crate::dispersion::coherence::Coherence;
use crate::dispersion::joint_diagonal::joint_diagonal;
use crate::standing_wave::tone::Tone;
use grainlab_core::results::{RESOLVED, Scattering};
use grainlab_core::{Mat3, Vec3};
use std::f64::consts::{PI, TAU};

/// Wave number times the cube root of the volume of the cell below which no mode of the sample is as slow as the wave,
/// whatever its kind.
const ALONE: f64 = 1.5;

/// Samples per period at the affine speed.
const SAMPLES: f64 = 16.0;

/// Range of frequencies that are searched, over that at the affine speed.
const RANGE: [f64; 2] = [0.05, 1.3];

/// Fitted time in units of 1/γ, and its least and greatest length in periods. The first quarter period is left out: there
/// grains still move with the mean deformation.
const DECAYS: f64 = 3.0;
const PERIODS: [f64; 2] = [3.0, 40.0];
const LEFT_OUT: f64 = 0.25;

/// Relative standard deviation of γ between samples whose lines hold one mode, by the scatter of rays and the difference
/// between 2,000 and 8,000 grains. It falls as one over the root of the number of modes.
const SAMPLING: f64 = 1.0;

/// The decay of the modes nearest to each of three perpendicular polarizations. `None` where there is no tone, and for all
/// where the wave is so long that it has no other mode to scatter to.
pub(super) fn scattering(
    bloch: &Bloch<'_>,
    wavenumber: f64,
    direction: &Vec3,
    polarizations: &[Vec3; 3],
) -> [Option<Scattering>; 3] {
    let volume = bloch.backbone.volume();
    if wavenumber * volume.cbrt() < ALONE {
        return [None; 3];
    }
    let affine = polarizations.map(|p| bloch.backbone.affine_speed(direction, &p) * wavenumber);
    let [fastest, slowest] =
        [affine.iter().copied().fold(0.0, f64::max), affine.iter().copied().fold(f64::INFINITY, f64::min)];
    if slowest.is_nan() || slowest <= 0.0 {
        return [None; 3];
    }
    let mut coherence = Coherence::new(bloch, polarizations, TAU / fastest / SAMPLES);
    let longest = PERIODS[1] * TAU / (RANGE[0] * slowest);
    let first = PERIODS[0] * TAU / (0.5 * slowest);
    let mut until = first;
    loop {
        coherence.run_until(until);
        let signals = Signals::of(&coherence, polarizations);
        let tones = [0, 1, 2].map(|k| signals.tone(k, f64::INFINITY, fastest));
        let found: Vec<Tone> = tones.iter().flatten().copied().collect();
        let speeds = found.iter().map(|tone| tone.omega / wavenumber);
        // Two shear waves of which one has no tone are as fast as each other.
        let softness = 3.0 / found.len().max(1) as f64 * speeds.map(|c| c.powi(-3)).sum::<f64>();
        let density = |omega: f64| volume * omega.powi(2) / (2.0 * PI * PI) * softness;
        let needed = |tone: &Tone| {
            let period = TAU / tone.omega;
            let recurrence = TAU * density(tone.omega);
            let decay = DECAYS / tone.decay.max(f64::MIN_POSITIVE);
            decay.min(recurrence).clamp(PERIODS[0] * period, PERIODS[1] * period)
        };
        // A softer packing has longer periods; a wave without a tone by then has none.
        let missing = found.len() < 3 && until < 4.0 * first;
        let need = found.iter().map(&needed).fold(if missing { 2.0 * until } else { 0.0 }, f64::max);
        if need > 1.05 * coherence.duration() && coherence.duration() < longest {
            until = need.min(2.0 * until);
            continue;
        }
        let measured = |k: usize| {
            let until = needed(tones[k].as_ref()?);
            let whole = signals.tone(k, until, fastest)?;
            let half = signals.tone(k, 0.5 * until, fastest)?;
            let omega = coherence.without_time_step(whole.omega);
            let loss = 2.0 * whole.decay / omega;
            let modes_in_width = 2.0 * whole.decay.max(0.0) * density(omega);
            let fit = 2.0 * whole.decay_stddev.hypot(whole.decay - half.decay) / omega;
            let sampling = SAMPLING * loss / modes_in_width.max(1.0).sqrt();
            let least_loss = RESOLVED / (density(omega) * omega);
            Some(Scattering { omega, loss, stddev: fit.hypot(sampling), modes_in_width, least_loss })
        };
        return [measured(0), measured(1), measured(2)];
    }
}

/// Coherent amplitudes of the modes over time.
struct Signals {
    channels: [Vec<f64>; 3],
    interval: f64,
}

impl Signals {
    /// In the polarizations of the modes: those with the least motion along each other. Otherwise beats between two
    /// shear waves would look like a decay.
    fn of(coherence: &Coherence<'_>, polarizations: &[Vec3; 3]) -> Self {
        let rotation = joint_diagonal(&coherence.overlaps);
        let frame = Mat3::from_columns(polarizations);
        let modes: Vec<Vec3> = (frame * rotation).column_iter().map(|c| c.into_owned()).collect();
        let modes = nearest_of(polarizations, modes);
        let shares = [0, 1, 2].map(|k| frame.transpose() * modes[k]);
        let channel = |share: &Vec3| coherence.overlaps.iter().map(|a| share.dot(&(a * share))).collect();
        Self {
            channels: [channel(&shares[0]), channel(&shares[1]), channel(&shares[2])],
            interval: coherence.interval(),
        }
    }

    /// The tone of a mode until the time `until` (s), with a frequency of at most about `fastest` (rad/s).
    fn tone(&self, mode: usize, until: f64, fastest: f64) -> Option<Tone> {
        let all = &self.channels[mode];
        let range = RANGE.map(|r| r * fastest);
        let rough = Tone::found(all, 0.0, self.interval, range)?.omega;
        let begin = (LEFT_OUT * TAU / rough / self.interval).ceil() as usize;
        let end = ((until / self.interval).ceil()).min(all.len() as f64) as usize;
        let samples = all.get(begin..end)?;
        Tone::found(samples, begin as f64 * self.interval, self.interval, range)
    }
}
