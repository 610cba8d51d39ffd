//! Deviatoric over volumetric strain.

/// The three ratios γ/Δ of deviatoric to volumetric strain about h (γ = (E_hh − (tr E − E_hh)/2)/2, Δ = −tr E).
///
/// They are different quantities: `total` is mostly plastic history, `elastic` belongs to the frozen network,
/// `contact` to the overlaps. `None` where one is not defined.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StrainRatios {
    /// Ratio of the logarithmic strain since the reference state.
    pub total: Option<f64>,
    /// Ratio of the strain that an isotropic stress increment causes in the frozen network.
    pub elastic: Option<f64>,
    /// Least squares of the contacts' √overlap to A(1 + g − 3 g x²), x = n·h.
    pub contact: Option<f64>,
}
