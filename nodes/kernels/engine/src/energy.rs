//! The energy balance of a run.

/// Energies and works since the balance was switched on, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyBalance {
    /// Kinetic and elastic energy at the start.
    pub start: f64,
    /// Work of the strain of the cell.
    pub strain_work: f64,
    /// Present kinetic energy, of velocities relative to the affine motion and of spins.
    pub kinetic: f64,
    /// Present energy of the normal springs.
    pub normal_springs: f64,
    /// Present energy of the tangential springs.
    pub tangential_springs: f64,
    /// Present energy of the rolling springs.
    pub rolling_springs: f64,
    /// Dissipated by normal dashpots.
    pub normal_damping: f64,
    /// Dissipated by tangential dashpots.
    pub tangential_damping: f64,
    /// Dissipated by rolling dashpots.
    pub rolling_damping: f64,
    /// Dissipated by sliding.
    pub sliding: f64,
    /// Dissipated by rolling beyond the limit of the rolling springs.
    pub rolling: f64,
    /// Lost by tangential springs whose stiffness changes, and by tangential and rolling springs whose contact opens.
    pub history: f64,
    /// Dissipated by the drags on velocities and spins.
    pub drag: f64,
    /// Removed by the thermostat.
    pub thermostat: f64,
    /// Created by the finite time step, negative where it removes energy: work of the springs in the kicks, less the work
    /// that they give along the paths of their contacts. Of second order in the time step.
    pub integration: f64,
}

impl EnergyBalance {
    /// Present kinetic and elastic energy, J.
    pub fn stored(&self) -> f64 {
        self.kinetic + self.normal_springs + self.tangential_springs + self.rolling_springs
    }

    /// Dissipated in all channels, J.
    pub fn dissipated(&self) -> f64 {
        self.normal_damping
            + self.tangential_damping
            + self.rolling_damping
            + self.sliding
            + self.rolling
            + self.history
            + self.drag
            + self.thermostat
    }

    /// Gap of the balance, J: start + work of the strain + integration − stored − dissipated. Rounding, in a correct run.
    pub fn residual(&self) -> f64 {
        self.start + self.strain_work + self.integration - self.stored() - self.dissipated()
    }

    /// The residual over the largest term of the balance.
    pub fn relative_residual(&self) -> f64 {
        let terms = [self.start, self.strain_work, self.integration, self.stored(), self.dissipated()];
        self.residual() / terms.into_iter().fold(f64::MIN_POSITIVE, |a, t| a.max(t.abs()))
    }
}
