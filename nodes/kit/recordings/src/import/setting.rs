//! Required properties of a packing.

/// A required property of a packing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Setting {
    /// The periodic cell.
    Cell,
    /// Shear modulus of the grain.
    ShearModulus,
    /// Poisson ratio of the grain.
    PoissonRatio,
    /// Density of the grain.
    Density,
    /// Coefficient of friction.
    Friction,
    /// Radius of the grains.
    Radius,
}

impl Setting {
    /// Name in messages to the user, and flag on the command line with its unit.
    pub fn described(self) -> (&'static str, &'static str) {
        match self {
            Self::Cell => ("the cell", "--cell LX,LY,LZ or nine numbers row by row, m"),
            Self::ShearModulus => ("the grain's shear modulus", "--shear-modulus PA"),
            Self::PoissonRatio => ("the grain's Poisson ratio", "--poisson NU"),
            Self::Density => ("the grain's density", "--density KG_PER_M3"),
            Self::Friction => ("the friction coefficient", "--friction MU"),
            Self::Radius => ("the radius of the grains", "--radius M"),
        }
    }
}
