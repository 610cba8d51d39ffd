//! `EnergyBalance`: where the energy of a phase went.

use super::check::Check;
use super::error::BoundaryError;
use crate::msg::EnergyBalance;

const CHECK: Check = Check("EnergyBalance");

/// The checked energy balance of a phase, J.
#[derive(Clone, Debug, PartialEq)]
pub struct EnergyReading {
    /// Solver steps done.
    pub step: u64,
    /// Number of the phase in the loading path, from 1.
    pub phase: u32,
    /// Name of the phase.
    pub phase_name: String,
    /// Kinetic and elastic energy at the beginning.
    pub start: f64,
    /// Work of the strain of the cell.
    pub strain_work: f64,
    /// Created by the finite time step.
    pub integration: f64,
    /// Energies present at the end, by name.
    pub stored: [(&'static str, f64); 4],
    /// Dissipated energies, by name.
    pub dissipated: [(&'static str, f64); 8],
}

impl EnergyReading {
    /// Energy that the balance misses, J: rounding, in a correct run.
    pub fn residual(&self) -> f64 {
        let sum = |parts: &[(&str, f64)]| parts.iter().map(|(_, value)| value).sum::<f64>();
        self.start + self.strain_work + self.integration - sum(&self.stored) - sum(&self.dissipated)
    }
}

impl TryFrom<&EnergyBalance> for EnergyReading {
    type Error = BoundaryError;

    fn try_from(m: &EnergyBalance) -> Result<Self, BoundaryError> {
        CHECK.header(&m.header)?;
        let part = |name: &'static str, field: &str, value: f64| {
            CHECK.finite(field, value).map(|value| (name, value))
        };
        Ok(Self {
            step: m.step,
            phase: m.phase,
            phase_name: m.phase_name.clone(),
            start: CHECK.finite("start", m.start)?,
            strain_work: CHECK.finite("strain_work", m.strain_work)?,
            integration: CHECK.finite("integration", m.integration)?,
            stored: [
                part("kinetic", "kinetic", m.kinetic)?,
                part("normal springs", "normal_springs", m.normal_springs)?,
                part("tangential springs", "tangential_springs", m.tangential_springs)?,
                part("rolling springs", "rolling_springs", m.rolling_springs)?,
            ],
            dissipated: [
                part("normal dashpots", "normal_damping", m.normal_damping)?,
                part("tangential dashpots", "tangential_damping", m.tangential_damping)?,
                part("rolling dashpots", "rolling_damping", m.rolling_damping)?,
                part("friction", "sliding", m.sliding)?,
                part("rolling friction", "rolling", m.rolling)?,
                part("contacts that change or open", "history", m.history)?,
                part("drag", "drag", m.drag)?,
                part("thermostat", "thermostat", m.thermostat)?,
            ],
        })
    }
}
