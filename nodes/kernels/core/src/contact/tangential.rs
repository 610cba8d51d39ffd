//! Response of a tangential spring to a change of normal stiffness.

/// Response of the tangential force to a change of normal stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TangentialLaw {
    /// Scaled down with the tangential stiffness on unloading: a closed cycle never creates energy.
    Rescaled,
    /// Kept on unloading: the increments of the stuck network, and LAMMPS's `mindlin/force`.
    Incremental,
}
