//! Why contacts cannot be found.

/// Why contacts cannot be found. Grains are named by index.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SearchError {
    /// Two grains have the same centre.
    #[error("grains {0} and {1} have the same centre")]
    Coincident(usize, usize),
    /// The image index does not fit its 8 bits.
    #[error("grains {0} and {1} touch across more than 127 cells")]
    FarImage(usize, usize),
    /// The cell is so small, or the grains so large, that a search would take too long.
    #[error(
        "the cell is too small for its grains: they fill it {solid_fraction:.3e} times over, or one is many times as wide"
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
        "the grains lie in a small part of the cell, up to {together} of them in one box of the search: {pairs:.1e} pairs would have to be checked"
    )]
    Clustered {
        /// Largest number of grains in one box.
        together: usize,
        /// Number of pairs to check.
        pairs: f64,
    },
}
