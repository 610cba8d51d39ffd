//! `WaveSpeeds`: the results of an acoustic instrument, real or virtual.

use super::check::{Check, vector_message};
use super::error::BoundaryError;
use super::note::{note_message, notes};
use crate::builtin_interfaces::Time;
use crate::msg;
use crate::std_msgs::Header;
use grainlab_core::contact::ContactLaw;
use grainlab_core::notes::{Note, Status, texts};
use grainlab_core::{MeasuredWave, Vec3, WaveMethod, WaveSpeed};

const CHECK: Check = Check("WaveSpeeds");

impl msg::WaveSpeed {
    /// The code of a method in messages.
    pub const fn code(method: WaveMethod) -> u8 {
        match method {
            WaveMethod::FirstArrival => Self::METHOD_FIRST_ARRIVAL,
            WaveMethod::CrossCorrelation => Self::METHOD_CROSS_CORRELATION,
            WaveMethod::Peak => Self::METHOD_PEAK,
            WaveMethod::StandingWave => Self::METHOD_STANDING_WAVE,
            WaveMethod::Dispersion => Self::METHOD_DISPERSION,
        }
    }
}

/// Checked wave speeds for an inversion, with `None` for values unknown to the sender.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveSpeedsReading {
    /// Stamp of the source.
    pub stamp: Time,
    /// Name of the sample or the measurement; empty: none.
    pub name: String,
    /// Step of the packing probed; `None` if it is not from a simulation.
    pub source_step: Option<u64>,
    /// Number of grains of the sample.
    pub grains: Option<u32>,
    /// Density of the mass that moves with the wave, kg/m³, more than 0.
    pub density: f64,
    /// Standard deviation of that, kg/m³.
    pub density_stddev: Option<f64>,
    /// Confining pressure, Pa, 0 or more.
    pub pressure: f64,
    /// Standard deviation of that, Pa; 0: exact, or not stated.
    pub pressure_stddev: f64,
    /// Solid fraction φ.
    pub solid_fraction: Option<f64>,
    /// Axial stress less the lateral one over pressure, (σ_hh − (tr σ − σ_hh)/2)/p, about the axis, e3 if unknown.
    pub stress_ratio: Option<f64>,
    /// Standard deviation of that; 0: exact, or not stated.
    pub stress_ratio_stddev: f64,
    /// Standard deviation of the radii over their mean.
    pub size_spread: Option<f64>,
    /// Unit axis of symmetry.
    pub axis: Option<Vec3>,
    /// Shear modulus of the grains, Pa, more than 0.
    pub grain_shear_modulus: f64,
    /// Standard deviation of that, Pa; 0: exact, or not stated.
    pub grain_shear_modulus_stddev: f64,
    /// Poisson ratio of the grains, in [0, 0.5].
    pub grain_poisson_ratio: f64,
    /// Standard deviation of that; 0: exact, or not stated.
    pub grain_poisson_ratio_stddev: f64,
    /// Contact law of the grains.
    pub contact_law: Option<ContactLaw>,
    /// True if the sample was measured without tangential springs.
    pub smooth: bool,
    /// The speeds, in the order of the message; empty if the sender found none, and the notes then say why.
    pub speeds: Vec<MeasuredWave>,
    /// Notes; may be empty.
    pub notes: Vec<Note>,
}

impl WaveSpeedsReading {
    /// True if the sender found no speeds, and says why.
    pub fn is_declined(&self) -> bool {
        self.speeds.is_empty() && !self.notes.is_empty()
    }

    /// Direction, polarization and speed, as used by the kernels.
    pub fn measured(&self) -> Vec<WaveSpeed> {
        self.speeds.iter().map(|s| s.wave).collect()
    }
}

/// The message of a measurement; `header` is that of the measured packing, and replaces the stamp of the
/// reading.
pub fn wave_speeds_message(
    header: Header,
    found: &WaveSpeedsReading,
) -> Result<msg::WaveSpeeds, BoundaryError> {
    let message = msg::WaveSpeeds {
        header,
        name: found.name.clone(),
        source_step: found.source_step.unwrap_or(0),
        grains: found.grains.unwrap_or(0),
        density: found.density,
        density_stddev: found.density_stddev.unwrap_or(0.0),
        pressure: found.pressure,
        pressure_stddev: found.pressure_stddev,
        solid_fraction: found.solid_fraction.unwrap_or(0.0),
        stress_ratio: found.stress_ratio.into_iter().collect(),
        stress_ratio_stddev: found.stress_ratio_stddev,
        size_spread: found.size_spread.into_iter().collect(),
        axis: vector_message(&found.axis.unwrap_or_default()),
        grain_shear_modulus: found.grain_shear_modulus,
        grain_shear_modulus_stddev: found.grain_shear_modulus_stddev,
        grain_poisson_ratio: found.grain_poisson_ratio,
        grain_poisson_ratio_stddev: found.grain_poisson_ratio_stddev,
        contact_law: found.contact_law.map_or_else(String::new, |law| law.name().to_owned()),
        contact_law_parameters: found.contact_law.map_or_else(Vec::new, |law| law.parameters()),
        smooth: found.smooth,
        speeds: found.speeds.iter().map(speed_message).collect(),
        warnings: texts(&found.notes),
        notes: found.notes.iter().map(note_message).collect(),
    };
    WaveSpeedsReading::try_from(&message)?;
    Ok(message)
}

fn speed_message(measured: &MeasuredWave) -> msg::WaveSpeed {
    let wave = &measured.wave;
    msg::WaveSpeed {
        method: msg::WaveSpeed::code(measured.method),
        direction: vector_message(&wave.direction),
        polarization: vector_message(&wave.polarization),
        speed: wave.speed,
        speed_stddev: wave.stddev.unwrap_or(0.0),
        frequency: measured.frequency.unwrap_or(0.0),
        strain_amplitude: measured.strain_amplitude,
    }
}

impl TryFrom<&msg::WaveSpeeds> for WaveSpeedsReading {
    type Error = BoundaryError;

    fn try_from(m: &msg::WaveSpeeds) -> Result<Self, BoundaryError> {
        CHECK.header(&m.header)?;
        let (modulus, ratio) = ("grain_shear_modulus", "grain_poisson_ratio");
        let is_ratio = (0.0..=0.5).contains(&m.grain_poisson_ratio);
        Ok(Self {
            stamp: m.header.stamp,
            name: m.name.clone(),
            source_step: Some(m.source_step).filter(|step| *step > 0),
            grains: Some(m.grains).filter(|grains| *grains > 0),
            density: CHECK.positive("density", m.density)?,
            density_stddev: CHECK.known("density_stddev", m.density_stddev)?,
            pressure: CHECK.not_negative("pressure", m.pressure)?,
            pressure_stddev: CHECK.not_negative("pressure_stddev", m.pressure_stddev)?,
            solid_fraction: Some(CHECK.share("solid_fraction", m.solid_fraction)?).filter(|phi| *phi > 0.0),
            stress_ratio: CHECK.optional_finite("stress_ratio", &m.stress_ratio)?,
            stress_ratio_stddev: CHECK.stddev(
                "stress_ratio_stddev",
                m.stress_ratio_stddev,
                !m.stress_ratio.is_empty(),
            )?,
            size_spread: CHECK.optional_not_negative("size_spread", &m.size_spread)?,
            axis: CHECK.direction("axis", &m.axis)?,
            grain_shear_modulus: CHECK.positive(modulus, m.grain_shear_modulus)?,
            grain_shear_modulus_stddev: CHECK
                .not_negative("grain_shear_modulus_stddev", m.grain_shear_modulus_stddev)?,
            grain_poisson_ratio: CHECK.that(is_ratio, ratio, m.grain_poisson_ratio, "between 0 and 0.5")?,
            grain_poisson_ratio_stddev: CHECK
                .not_negative("grain_poisson_ratio_stddev", m.grain_poisson_ratio_stddev)?,
            contact_law: CHECK.optional_contact_law(&m.contact_law, &m.contact_law_parameters)?,
            smooth: m.smooth,
            speeds: m.speeds.iter().enumerate().map(|(i, s)| speed(i, s)).collect::<Result<_, _>>()?,
            notes: notes(CHECK, &m.notes, &m.warnings, Status::Ok)?,
        })
    }
}

fn speed(index: usize, s: &msg::WaveSpeed) -> Result<MeasuredWave, BoundaryError> {
    let name = |field: &str| format!("speeds[{index}].{field}");
    Ok(MeasuredWave {
        method: method(CHECK, &name("method"), s.method)?,
        wave: WaveSpeed {
            direction: CHECK.unit(&name("direction"), &s.direction)?,
            polarization: CHECK.unit(&name("polarization"), &s.polarization)?,
            speed: CHECK.positive(name("speed"), s.speed)?,
            stddev: CHECK.known(&name("speed_stddev"), s.speed_stddev)?,
        },
        frequency: CHECK.known(&name("frequency"), s.frequency)?,
        strain_amplitude: CHECK.not_negative(name("strain_amplitude"), s.strain_amplitude)?,
    })
}

pub(super) fn method(check: Check, field: &str, number: u8) -> Result<WaveMethod, BoundaryError> {
    WaveMethod::ALL.into_iter().find(|m| msg::WaveSpeed::code(*m) == number).ok_or_else(|| {
        let known = "0 (first arrival), 1 (cross correlation), 2 (peak), 3 (standing wave), 4 (dispersion)";
        check.code(field, number, known)
    })
}
