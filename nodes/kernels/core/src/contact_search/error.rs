//! Why contacts cannot be found.

/// Why contacts cannot be found. Grains are named by index, or by id in an import.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SearchError {
    /// Two grains have the same centre.
    #[error("grains {0} and {1} have the same centre: their contact has no direction")]
    Coincident(usize, usize),
    /// The image index does not fit its 8 bits.
    #[error(
        "grains {0} and {1} touch across more than 127 cells: fold positions into the cell, or check its size"
    )]
    FarImage(usize, usize),
    /// The cell is so small, or the grains so large, that a search would take too long.
    #[error(
        "the cell is too small for its grains, or too skewed: they fill it {solid_fraction:.3e} times over, the largest is {diameter:.3e} m wide and the cell {width:.3e} m between its sides: check the units of the cell and of the radii, or state the shortest edges"
    )]
    Crowded {
        /// Volume of the spheres over volume of the cell.
        solid_fraction: f64,
        /// Largest diameter, m.
        diameter: f64,
        /// Narrowest width of the cell, m.
        width: f64,
    },
    /// The grains are in so small a part of the cell that a search would take too long.
    #[error(
        "the grains lie in a tiny part of the cell ({together} of them in one box of the search, {pairs:.1e} pairs to check): check the cell, or list the contacts in the file"
    )]
    Clustered {
        /// Largest number of grains in one box.
        together: usize,
        /// Number of pairs to check.
        pairs: f64,
    },
}

impl SearchError {
    /// Error with these ids of the grains in place of their indices.
    pub(super) fn with_ids(self, ids: &[u32]) -> Self {
        let id = |k: usize| ids[k] as usize;
        match self {
            Self::Coincident(i, j) => Self::Coincident(id(i), id(j)),
            Self::FarImage(i, j) => Self::FarImage(id(i), id(j)),
            other => other,
        }
    }
}
