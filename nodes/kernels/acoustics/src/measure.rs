//! One measurement of one packing.

use crate::backbone::Backbone;
use crate::curve::DispersionCurve;
use crate::dispersion::{Alignment, Dispersion};
use crate::effective_density::EffectiveDensity;
use crate::error::{AcousticsError, in_brackets, no_signal};
use crate::instrument::Instrument;
use crate::noise::{Noise, seed_at};
use crate::settings::{MethodSettings, Settings};
use crate::survey::Survey;
use crate::trace::Trace;
use crate::{dispersion, time_of_flight};
use grainlab_core::notes::{Code, Note};
use grainlab_core::results::{StiffnessMethod, spring_notes};
use grainlab_core::{MeasuredWave, Packing, Vec3, WaveMethod, WaveSpeed};

/// Relative standard deviation of a speed above which there is a warning.
const NOISY: f64 = 0.1;

/// Place of the noise of speeds, different from the places of all other noise.
const SPEEDS: u64 = u64::MAX;

/// Place of the seed of the noise of the modes' speeds.
const MODES: u64 = u64::MAX - 1;

/// Result of a measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The speeds of long waves.
    pub waves: Vec<MeasuredWave>,
    /// Speeds along the polarizations of the packing's own modes, quasi-P and quasi-S, which an instrument measures
    /// (dispersion only). [`Measurement::waves`] are projections on the polarizations of a medium isotropic about the axis:
    /// their squares average over azimuths to the moduli of the transversely isotropic projection, those of the modes do
    /// not.
    pub modes: Vec<MeasuredWave>,
    /// The waves are those of grains without tangential springs.
    pub smooth: bool,
    /// Density of the mass that moves with them.
    pub effective_density: EffectiveDensity,
    /// Density to use with the speeds, kg/m³.
    pub density: f64,
    /// Standard deviation of the density: differences between polarizations, and between the frequencies used.
    pub density_stddev: f64,
    /// The axis about which the rays were chosen.
    pub axis: Option<Vec3>,
    /// The curves from which the speeds were extrapolated.
    pub curves: Vec<DispersionCurve>,
    /// The traces from which the curves were evaluated; empty for dispersion.
    pub traces: Vec<Trace>,
    /// Limitations of the measurement.
    pub notes: Vec<Note>,
}

/// Measures the wave speeds of `packing`. The result is the same to the last bit for any number of threads.
///
/// Dispersion uses the frozen network; in time of flight grains move. A wave without a speed is left
/// out with a warning. If no speed is left, that is an error.
pub fn measure(packing: &Packing, settings: &Settings) -> Result<Measurement, AcousticsError> {
    settings.check()?;
    let backbone = Backbone::new(packing)?;
    let axis = settings.axis.map(|a| a.normalize());
    let about = axis.unwrap_or_else(Vec3::z);
    let survey = if axis.is_some() { settings.survey } else { Survey::Hemisphere };
    // Noise differs between packings.
    let seed = seed_at(settings.instrument.seed, &[packing.step]);
    let instrument = &Instrument { seed, ..settings.instrument };
    let (mut curves, modes, traces, mut notes) = match &settings.method {
        MethodSettings::Dispersion(of) => {
            of.validated()?;
            let rays = survey.rays(&about, settings.modes);
            let diameter = dispersion::mean_diameter(packing);
            let alignment = if axis.is_some() { Alignment::InPlane } else { Alignment::Free };
            let method = Dispersion { backbone: &backbone, diameter, alignment, settings: of };
            let (found, notes, _) = method.curves(&rays)?;
            (found.curves, found.modes, Vec::new(), notes)
        }
        MethodSettings::TimeOfFlight(of) => {
            let rays = survey.lattice_rays(&packing.cell, &about, settings.modes);
            let (curves, traces, notes) = time_of_flight::curves(packing, &rays, of, instrument)?;
            (curves, Vec::new(), traces, notes)
        }
    };
    let (of_network, friction, method, strain_amplitude) = match &settings.method {
        MethodSettings::Dispersion(_) => (StiffnessMethod::FrozenNetwork, None, WaveMethod::Dispersion, 0.0),
        MethodSettings::TimeOfFlight(of) => {
            (StiffnessMethod::StrainProbe, of.friction, of.pick.method(), of.amplitude)
        }
    };
    let smooth = friction.map_or_else(|| backbone.network.smooth(), |friction| friction == 0.0);
    let springs = spring_notes("waves", packing, of_network, smooth).into_iter();
    // Grains that move slide by themselves.
    notes.extend(springs.filter(|note| method == WaveMethod::Dispersion || !note.is(Code::SlidingStuck)));
    let [least, most] = frequencies(&curves);
    let effective_density = backbone.effective_density(least);
    for curve in &mut curves {
        let drift = drift(curve, &backbone, &effective_density);
        curve.stddev = curve.stddev.hypot(0.5 * drift * curve.speed);
    }
    let wave = |curve: &DispersionCurve| MeasuredWave {
        wave: WaveSpeed {
            direction: curve.direction,
            polarization: curve.polarization,
            speed: curve.speed,
            stddev: Some(curve.stddev),
        },
        method,
        // The speed is extrapolated to long waves.
        frequency: None,
        strain_amplitude,
    };
    let waves: Vec<MeasuredWave> = curves.iter().map(wave).collect();
    let mut waves = with_speed_noise(&waves, instrument.speed_noise, instrument.seed);
    let modes: Vec<MeasuredWave> = modes.iter().map(wave).collect();
    let mut modes = with_speed_noise(&modes, instrument.speed_noise, seed_at(instrument.seed, &[MODES]));
    modes.retain(is_speed);
    notes.extend(waves.iter().filter(|w| !is_speed(w)).map(|MeasuredWave { wave, .. }| {
        let reason = "the noise of speeds is as large as the speed";
        Note::left_out(no_signal("speed", &wave.direction, &wave.polarization, reason).to_string())
    }));
    waves.retain(is_speed);
    notes.extend(noisy(&waves));
    let density = effective_density.mean();
    let density_stddev = effective_density.spread().hypot(density - backbone.effective_density(most).mean());
    // A smaller one is rounding.
    let density_stddev = if density_stddev > 1e-9 * density { density_stddev } else { 0.0 };
    Ok(Measurement {
        waves,
        modes,
        smooth,
        effective_density,
        density,
        density_stddev,
        axis,
        curves,
        traces,
        notes,
    })
}

/// Speeds with an additional independent relative error of standard deviation `noise`, included in
/// their uncertainty. The same seed gives the same errors.
pub fn with_speed_noise(waves: &[MeasuredWave], noise: f64, seed: u64) -> Vec<MeasuredWave> {
    let mut waves = waves.to_vec();
    for (index, MeasuredWave { wave, .. }) in waves.iter_mut().enumerate().filter(|_| noise > 0.0) {
        let error = noise * wave.speed;
        wave.speed += error * Noise::at(seed, &[SPEEDS, index as u64]).next();
        wave.stddev = wave.stddev.map(|stddev| stddev.hypot(error));
    }
    waves
}

/// Lowest and highest angular frequency of the curves, rad/s.
fn frequencies(curves: &[DispersionCurve]) -> [f64; 2] {
    let all = || curves.iter().flat_map(|c| &c.points).map(|p| p.speed * p.wavenumber);
    [all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)]
}

/// Relative difference between `density` and that of the mass which follows the polarization at the frequencies of the
/// curve: motions of a few grains whose own frequency is near follow some of its waves only.
fn drift(curve: &DispersionCurve, backbone: &Backbone, density: &EffectiveDensity) -> f64 {
    let of = |d: &EffectiveDensity| curve.polarization.dot(&(d.density * curve.polarization));
    let whole = of(density);
    let differences = frequencies(std::slice::from_ref(curve))
        .into_iter()
        .map(|f| (of(&backbone.effective_density(f)) - whole).abs() / whole);
    differences.fold(0.0, f64::max)
}

fn is_speed(measured: &MeasuredWave) -> bool {
    measured.wave.speed > 0.0
}

fn noisy(waves: &[MeasuredWave]) -> Vec<Note> {
    let of = |m: &MeasuredWave| {
        let relative = m.wave.stddev? / m.wave.speed;
        let [direction, polarization] =
            [m.wave.direction, m.wave.polarization].map(|v| in_brackets(&v.into()));
        (relative > NOISY).then(|| Note::noisy(direction, polarization, relative))
    };
    waves.iter().filter_map(of).collect()
}
