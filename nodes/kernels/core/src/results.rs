//! What the kernels report.

use crate::stiffness::Stiffness;
use crate::structure::Structure;
use crate::tensor::{SymTensor, Vec3};

/// The three ratios γ/Δ of deviatoric to volumetric strain about e3 (γ = (E33 − (E11 + E22)/2)/2, Δ = −tr E).
///
/// They are different quantities: `total` is mostly plastic history, `elastic` belongs to the frozen network,
/// `contact` to the overlaps. `None` where one is not defined.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Anisotropy {
    /// Of the logarithmic strain since the reference state.
    pub total: Option<f64>,
    /// Of the strain that an isotropic stress increment causes in the frozen network.
    pub elastic: Option<f64>,
    /// Least squares of the contacts' √overlap to A(1 + g − 3 g x²), x = n·e3.
    pub contact: Option<f64>,
}

/// Structure of a packing.
#[derive(Clone, Debug, PartialEq)]
pub struct Fabric {
    /// Number of grains.
    pub grains: u32,
    /// Number of contacts.
    pub contacts: u32,
    /// Grains that carry nothing: recursively fewer than 2 contacts with friction, 4 without.
    pub rattlers: u32,
    /// Coordination number k = 2 contacts/grains, all grains (the paper's).
    pub k: f64,
    /// Coordination number without rattlers and their contacts.
    pub z: f64,
    /// Fabric tensor L = ⟨n n⟩, trace 1 (Eq. 2).
    pub contact_fabric: SymTensor,
    /// The same weighted by normal force, trace 1.
    pub force_fabric: SymTensor,
    /// The same weighted by normal stiffness, trace 1.
    pub stiffness_fabric: SymTensor,
    /// ε = 5/2 (L33 − (L11 + L22)/2) about e3 (Eq. 20).
    pub eps: f64,
    /// Eigenvector of the contact fabric whose eigenvalue is furthest from 1/3; unit, with a non-negative z component.
    pub axis: Vec3,
    /// Coefficient of P4(cos θ) in the contact distribution about e3.
    pub fourth_order: f64,
    /// The three ratios γ/Δ.
    pub anisotropy: Anisotropy,
    /// Share of contacts at the Coulomb limit, |F_t| ≥ 0.999 μ F_n.
    pub mobilised: f64,
    /// Everything beyond: forces, networks, distributions, the noise of the axis.
    pub structure: Structure,
}

/// How a stiffness was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Linear response of the frozen contact network.
    FrozenNetwork,
    /// The same with the prestress term.
    PrestressedNetwork,
    /// Small strains imposed on the packing with its whole contact law.
    Probe,
}

/// Effective stiffness of a packing.
#[derive(Clone, Debug, PartialEq)]
pub struct Moduli {
    /// How [`Moduli::stiffness`] was found.
    pub method: Method,
    /// Relaxed stiffness.
    pub stiffness: Stiffness,
    /// Standard error of each entry of [`Moduli::stiffness`], Pa, as a measurement of this packing: what the solve or the
    /// probe left open. How much packings of one kind differ is not in it.
    pub stddev: Stiffness,
    /// Affine (Voigt) stiffness: every grain moves with the mean deformation.
    pub affine: Stiffness,
    /// The same where all grains also spin alike: between relaxed and affine.
    pub mean_spin: Stiffness,
    /// Lower bound of the bulk modulus under isotropic stress, Pa; `None` without forces.
    pub reuss_bound: Option<f64>,
    /// Relative residual of the solve, the worst of the six columns.
    pub residual: f64,
    /// Iterations of the solve.
    pub iterations: u32,
}
