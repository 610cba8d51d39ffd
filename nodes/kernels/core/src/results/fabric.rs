//! Orientation of the contacts.

use crate::tensor::{SymTensor, Vec3};

/// Bins of x = |n·h| in [`OrientationHistogram`]: equal in x, hence of equal solid angle.
pub const ORIENTATION_BINS: usize = 10;

/// Orientation of the contacts.
///
/// Without contacts the tensors and anisotropies are zero, and the principal axis is the reference axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fabric {
    /// Axis h that ε, the P4 coefficient, the orientation histogram and the fits are about; unit.
    pub reference_axis: Vec3,
    /// Fabric tensor L = ⟨n n⟩, trace 1 (Eq. 2).
    pub contact_fabric: SymTensor,
    /// Fabric tensor weighted by normal force, trace 1.
    pub normal_force_fabric: SymTensor,
    /// Σ |F_t| t⊗t / Σ |F_t| with t = F_t/|F_t|: where tangential forces point. Trace 1, or zero without tangential forces.
    pub tangential_force_fabric: SymTensor,
    /// Fabric tensor weighted by normal stiffness, trace 1.
    pub stiffness_fabric: SymTensor,
    /// ε = 5/2 (L33 − (L11 + L22)/2) about h (Eq. 20).
    pub contact_anisotropy: f64,
    /// Coefficient of P4(n·h) in the contact distribution.
    pub p4_coefficient: f64,
    /// Fabric tensor of fourth order.
    pub fourth_order: FourthOrderFabric,
    /// The principal axis of L that stands out most.
    pub principal_axis: PrincipalAxis,
    /// Contacts and overlaps by orientation.
    pub orientation: OrientationHistogram,
}

impl Fabric {
    /// ε of the contacts weighted by their normal stiffness, about h; 0 without contacts.
    pub fn stiffness_anisotropy(&self) -> f64 {
        contact_anisotropy(&self.stiffness_fabric, &self.reference_axis)
    }
}

/// ε = 5/2 (L_aa − (tr L − L_aa)/2) of a fabric tensor about the unit vector `axis` (Eq. 20).
pub fn contact_anisotropy(fabric: &SymTensor, axis: &Vec3) -> f64 {
    let along = fabric.along(axis);
    2.5 * (along - 0.5 * (fabric.trace() - along))
}

/// The principal axis of the contact fabric that stands out most, and its noise.
///
/// Standard deviations are those of packings prepared alike under the same stress, estimated from this one packing; they
/// are *not* those of independent contacts, which are nearly twice as large.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PrincipalAxis {
    /// Eigenvector of L whose eigenvalue is furthest from 1/3; unit, with a non-negative z component.
    pub direction: Vec3,
    /// ε about it; its magnitude is biased upwards by about one standard deviation where ε is within its noise.
    pub contact_anisotropy: f64,
    /// Standard deviation of ε about a fixed axis; `None` with too few contacts.
    pub contact_anisotropy_stddev: Option<f64>,
    /// Standard deviation of the direction, rad (root mean square angle); `None` where it cannot be estimated, or would
    /// exceed 1 rad.
    pub angle_stddev: Option<f64>,
    /// True if the anisotropy exceeds its noise and one axis stands out. Where it is `false`, any axis is as good.
    pub determined: bool,
}

/// ⟨n n n n⟩ over contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FourthOrderFabric {
    /// The 15 independent components in lexicographic order: xxxx, xxxy, xxxz, xxyy, xxyz, xxzz, xyyy, xyyz, xyzz, xzzz, yyyy,
    /// yyyz, yyzz, yzzz, zzzz. Contracting two indices gives the second-order fabric.
    pub components: [f64; 15],
    /// Magnitude of the harmonic (fully deviatoric) part H: 9 √(35/8) |H|. It is |a4| for a distribution
    /// 1 + a2 P2(x) + a4 P4(x) about any axis, and about 9/√contacts for independent contacts without structure.
    pub magnitude: f64,
}

/// Contacts and overlaps by x = |n·h|.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OrientationHistogram {
    /// Number of contacts of each bin; bin b holds b/10 ≤ x < (b + 1)/10, the last one x = 1 too.
    pub contacts: [u32; ORIENTATION_BINS],
    /// Mean overlap of each bin, m; 0 where there is no contact.
    pub overlap: [f64; ORIENTATION_BINS],
    /// Mean of √overlap of each bin, m^½; 0 where there is no contact.
    pub sqrt_overlap: [f64; ORIENTATION_BINS],
    /// A(d) fitted to the contacts.
    pub contact_fit: Option<OrientationFit>,
    /// √overlap fitted to the contacts.
    pub overlap_fit: Option<OverlapAnisotropyFit>,
}

/// Maximum-likelihood fit of A(d) ∝ (1 − ε) + 3 ε x² (Eq. 6) to the contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OrientationFit {
    /// ε, within [−1/2, 1], where A is nowhere negative.
    pub eps: f64,
    /// Standard error of ε if contacts were independent: an upper bound in a jammed packing, see
    /// [`PrincipalAxis::contact_anisotropy_stddev`].
    pub eps_stddev: f64,
    /// Pearson's χ² of the histogram over its 8 degrees of freedom. About 1 for independent contacts drawn from A(d); use it
    /// from some 50 contacts on.
    pub chi2_per_dof: f64,
}

/// Least squares of √overlap to A (1 + g − 3 g x²) (Eq. 10).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OverlapAnisotropyFit {
    /// g, the ratio γ/Δ fitted to the contacts.
    pub g: f64,
    /// Standard error of g for independent contacts; `None` with fewer than three contacts.
    pub g_stddev: Option<f64>,
}
