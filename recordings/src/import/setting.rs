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
    /// Name in messages to the user.
    pub fn what(self) -> &'static str {
        match self {
            Self::Cell => "the cell",
            Self::ShearModulus => "the grain's shear modulus",
            Self::PoissonRatio => "the grain's Poisson ratio",
            Self::Density => "the grain's density",
            Self::Friction => "the friction coefficient",
            Self::Radius => "the radius of the grains",
        }
    }

    /// Flag on the command line, with the unit.
    pub fn flag(self) -> &'static str {
        match self {
            Self::Cell => "--cell LX,LY,LZ or nine numbers row by row, m",
            Self::ShearModulus => "--shear-modulus PA",
            Self::PoissonRatio => "--poisson NU",
            Self::Density => "--density KG_PER_M3",
            Self::Friction => "--friction MU",
            Self::Radius => "--radius M",
        }
    }
}
