//! One method at one setting.

use serde::Serialize;

/// Quantities whose errors are comparable: a colour of the figure and a front each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Family {
    /// Contact anisotropy inferred from moduli.
    InversionEps,
    /// Coordination inferred from moduli.
    InversionZ,
    /// The stiffness of the contact network.
    Stiffness,
    /// Energy created by the time step of the engine.
    EngineEnergy,
    /// Packings prepared by the engine.
    EnginePacking,
    /// Wave speeds.
    Waves,
}

impl Family {
    /// In the order of the table.
    pub(super) const ALL: [Self; 6] = [
        Self::InversionEps,
        Self::InversionZ,
        Self::Stiffness,
        Self::EngineEnergy,
        Self::EnginePacking,
        Self::Waves,
    ];

    /// Name in tables and legends.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::InversionEps => "inversion, eps",
            Self::InversionZ => "inversion, z",
            Self::Stiffness => "stiffness",
            Self::EngineEnergy => "engine, energy",
            Self::EnginePacking => "engine, packing",
            Self::Waves => "waves",
        }
    }

    /// The workload that is timed.
    pub(super) fn work(self) -> &'static str {
        match self {
            Self::InversionEps | Self::InversionZ => "one state, uncertainty included",
            Self::Stiffness => "all 21 constants of 2,000 grains",
            Self::EngineEnergy | Self::EnginePacking => "200 grains, from a gas to 50 kPa",
            Self::Waves => "9 speeds in 500 grains",
        }
    }

    /// The quantity whose error is given.
    pub(super) fn error_of(self) -> &'static str {
        match self {
            Self::InversionEps => "contact anisotropy, rms",
            Self::InversionZ => "coordination without rattlers, rms",
            Self::Stiffness => "largest entry, over C11",
            Self::EngineEnergy => {
                "energy created by the time step, over the largest term of the balance, rms of the seeds"
            }
            Self::EnginePacking => {
                "k, eps, phi, G12 and Theta of the packing, over their scatter from seed to seed, rms"
            }
            Self::Waves => "rho v^2, relative, rms",
        }
    }
}

/// One method at one setting.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    pub(super) family: Family,
    pub(super) method: String,
    /// The value that is varied, or empty.
    pub(super) setting: String,
    /// CPU time of all threads, median, s.
    pub(super) seconds: f64,
    /// Measurements of the time.
    pub(super) repetitions: usize,
    /// Pure number.
    pub(super) error: f64,
    /// Whether the error is only known to be less than that.
    pub(super) upper_bound: bool,
    pub(super) error_of: &'static str,
    pub(super) time_of: &'static str,
    pub(super) reference: &'static str,
    /// Whether no other row of the family is as fast and as accurate, and better in one of the two.
    pub(super) on_front: bool,
}

impl Row {
    pub(super) fn new(
        family: Family,
        (method, setting): (impl Into<String>, impl Into<String>),
        (seconds, repetitions): (f64, usize),
        (error, reference): (f64, &'static str),
    ) -> Self {
        Self {
            family,
            method: method.into(),
            setting: setting.into(),
            seconds,
            repetitions,
            error,
            upper_bound: false,
            error_of: family.error_of(),
            time_of: family.work(),
            reference,
            on_front: false,
        }
    }
}
