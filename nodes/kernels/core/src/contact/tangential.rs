//! Response of a tangential spring to a change of normal stiffness.

/// Response of the tangential force to a change of normal stiffness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TangentialLaw {
    /// Scaled down with the tangential stiffness on unloading: a closed cycle never creates energy.
    #[default]
    Rescaled,
    /// Kept on unloading: the increments of the stuck network, and LAMMPS's `mindlin/force`.
    Incremental,
}

impl TangentialLaw {
    /// Fraction of its tangential force that a contact keeps at least on unloading.
    pub fn kept(self) -> f64 {
        match self {
            TangentialLaw::Rescaled => 0.0,
            TangentialLaw::Incremental => 1.0,
        }
    }
}
