//! What is measured on a contact network beyond coordination and second-order fabric.
//!
//! Tensors are in the frame of the cell. Where a quantity is taken about an axis h, it is [`Structure::reference_axis`];
//! x = |n·h| with n the contact normal.

use crate::tensor::{SymTensor, Vec3};

/// Bins of x = |n·h| in [`Orientation`]: equal in x, hence of equal solid angle.
pub const ORIENTATION_BINS: usize = 10;

/// Bins of f = F_n/⟨F_n⟩ in [`Forces`].
pub const FORCE_BINS: usize = 20;

/// Width of a bin of f = F_n/⟨F_n⟩; the last bin has no upper end.
pub const FORCE_BIN_WIDTH: f64 = 0.25;

/// Bins of the mobilised friction in [`Mobilisation`]: tenths of the Coulomb limit.
pub const MOBILISATION_BINS: usize = 10;

/// Structure of a packing, all but coordination and the second-order fabrics.
///
/// What is undefined (no contacts, no forces, no Coulomb limit) is `None`; tensors whose weights sum to nothing are zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Structure {
    /// Axis h about which ε, the orientation histogram and the fits are taken; unit.
    pub reference_axis: Vec3,
    /// How well the axis found is known.
    pub axis: AxisFound,
    /// Σ |F_t| t⊗t / Σ |F_t| with t = F_t/|F_t|: where tangential forces point. Trace 1, or zero without tangential forces.
    pub tangential_fabric: SymTensor,
    /// Fourth-order fabric.
    pub fourth_order: FourthOrderFabric,
    /// Contacts and overlaps by orientation.
    pub orientation: Orientation,
    /// Stress by kind of force.
    pub stress: StressParts,
    /// The stress-force-fabric relation; `None` without pressure on the contacts.
    pub stress_force_fabric: Option<StressForceFabric>,
    /// Contacts that carry more than the mean normal force: F_n > ⟨F_n⟩.
    pub strong: NetworkPart,
    /// The other contacts.
    pub weak: NetworkPart,
    /// Distribution of normal forces; `None` without any.
    pub forces: Option<Forces>,
    /// Mobilised friction; `None` without contacts and where there is no limit (μ = 0 or infinite).
    pub mobilisation: Option<Mobilisation>,
}

/// The principal axis of the contact fabric that stands out most, and its noise.
///
/// Standard deviations are those of packings prepared alike under the same stress, estimated from this one packing; they
/// are *not* those of independent contacts, which are nearly twice as large.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisFound {
    /// ε about the axis found; its magnitude is biased upwards by about one standard deviation where ε is within its noise.
    pub eps: f64,
    /// Standard deviation of an ε about a fixed axis; `None` with too few contacts.
    pub eps_stddev: Option<f64>,
    /// Standard deviation of the direction of the axis, rad (root mean square angle); `None` where it cannot be told, or
    /// where it would exceed a radian.
    pub angle_stddev: Option<f64>,
    /// Whether the anisotropy exceeds its noise and one axis stands out. Where it is `false`, any axis is as good.
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
pub struct Orientation {
    /// Number of contacts of each bin; bin b holds b/10 ≤ x < (b + 1)/10, the last one x = 1 too.
    pub contacts: [u32; ORIENTATION_BINS],
    /// Mean overlap of each bin, m; 0 where there is no contact.
    pub overlap: [f64; ORIENTATION_BINS],
    /// Mean of √overlap of each bin, m^½; 0 where there is no contact.
    pub sqrt_overlap: [f64; ORIENTATION_BINS],
    /// A(d) fitted to the contacts.
    pub contact_fit: Option<ContactFit>,
    /// √overlap fitted to the contacts.
    pub overlap_fit: Option<OverlapFit>,
}

/// Maximum-likelihood fit of A(d) ∝ (1 − ε) + 3 ε x² (Eq. 6) to the contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactFit {
    /// ε, within [−1/2, 1], where A is nowhere negative.
    pub eps: f64,
    /// Its standard error if contacts were independent: an upper bound in a jammed packing, see [`AxisFound::eps_stddev`].
    pub eps_stddev: f64,
    /// Pearson's χ² of the histogram over its 8 degrees of freedom. About 1 for independent contacts drawn from A(d); trust
    /// it from some 50 contacts on.
    pub chi2_per_dof: f64,
}

/// Least squares of √overlap to A (1 + g − 3 g x²) (Eq. 10).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OverlapFit {
    /// g, the ratio γ/Δ fitted to the contacts.
    pub g: f64,
    /// Its standard error for independent contacts; `None` with fewer than three contacts.
    pub g_stddev: Option<f64>,
}

/// Love–Weber stress by kind of force, Pa, positive in compression; symmetric parts. The two add up to the stress.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StressParts {
    /// (1/V) Σ F_n n ⊗ l.
    pub normal: SymTensor,
    /// (1/V) Σ f_t ⊗ l.
    pub tangential: SymTensor,
}

/// Second-order anisotropies of contacts and forces, and the deviatoric stress they predict.
///
/// Contact directions are distributed as (1/4π)(1 + a^c:nn), normal forces are on average f₀ (1 + a^n:nn), branch lengths
/// l₀ (1 + a^l:nn), tangential forces f₀ (a^t n − (n·a^t n) n); all four tensors are symmetric and traceless. Then
/// s/p = (2/5)(a^c + a^n + a^l + (3/2) a^t) to first order in the anisotropies (Rothenburg & Bathurst 1989 in 3D).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StressForceFabric {
    /// a^c = (15/2) dev L.
    pub contacts: SymTensor,
    /// a^n, least squares over contacts.
    pub normal_forces: SymTensor,
    /// a^l, least squares over contacts; rounding for grains of one size.
    pub branches: SymTensor,
    /// a^t, least squares over contacts.
    pub tangential_forces: SymTensor,
}

/// One of the two networks, strong or weak.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NetworkPart {
    /// Number of its contacts.
    pub contacts: u32,
    /// ⟨n n⟩ of its contacts, trace 1, or zero without contacts.
    pub fabric: SymTensor,
    /// ε of its contacts (Eq. 20).
    pub eps: f64,
    /// The stress it carries, Pa; both networks add up to the stress.
    pub stress: SymTensor,
}

/// Distribution of normal forces, f = F_n/⟨F_n⟩.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Forces {
    /// ⟨F_n⟩, N.
    pub mean_normal: f64,
    /// ⟨|F_t|⟩, N.
    pub mean_tangential: f64,
    /// ⟨f²⟩, ⟨f³⟩, ⟨f⁴⟩. An exponential distribution has 2, 6, 24.
    pub moments: [f64; 3],
    /// Largest f.
    pub largest: f64,
    /// Number of contacts by f, in bins of [`FORCE_BIN_WIDTH`] from 0; the last bin has no upper end, the first no lower one.
    pub contacts: [u32; FORCE_BINS],
}

/// Mobilised friction m = min(|F_t|/(μ F_n), 1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mobilisation {
    /// ⟨m⟩.
    pub mean: f64,
    /// Number of contacts by m, in tenths; the last bin holds those at the limit too.
    pub contacts: [u32; MOBILISATION_BINS],
}

impl StressParts {
    /// The stress, Pa.
    pub fn total(&self) -> SymTensor {
        sum(&[(1.0, self.normal), (1.0, self.tangential)])
    }
}

impl StressForceFabric {
    /// s/p = (2/5)(a^c + a^n + a^l + (3/2) a^t), dimensionless: the deviatoric stress over the pressure that the
    /// anisotropies predict.
    ///
    /// From σ = (N_c/V) ∫ (1/4π)(1 + a^c:nn) f(n) ⊗ l(n) dΩ with ⟨n_i n_j⟩ = δ_ij/3 and
    /// ⟨n_i n_j n_k n_l⟩ = (δδ + δδ + δδ)/15 over the sphere: a^c, a^n and a^l each enter as (2/15) a, a^t as
    /// (1/3 − 2/15) a, over a mean of 1/3.
    ///
    /// ```
    /// use grainlab_core::structure::StressForceFabric;
    /// use grainlab_core::SymTensor;
    /// let of = |a: f64| SymTensor::from_voigt([-a / 3.0, -a / 3.0, 2.0 * a / 3.0, 0.0, 0.0, 0.0]);
    /// let (contacts, normal_forces, tangential_forces) = (of(0.3), of(-0.2), of(0.1));
    /// let a = StressForceFabric { contacts, normal_forces, tangential_forces, ..Default::default() };
    /// // q/p = (2/5)(a_c + a_n + (3/2) a_t)
    /// assert!((a.stress_ratio().deviatoric_invariant() - 0.4 * (0.3 - 0.2 + 0.15)).abs() < 1e-15);
    /// ```
    pub fn stress_ratio(&self) -> SymTensor {
        let parts = [
            (0.4, self.contacts),
            (0.4, self.normal_forces),
            (0.4, self.branches),
            (0.6, self.tangential_forces),
        ];
        sum(&parts)
    }
}

impl Forces {
    /// Participation ratio ⟨F⟩²/⟨F²⟩ in (0, 1]: 1 where all contacts carry alike, 1/2 for exponential forces.
    pub fn participation(&self) -> f64 {
        1.0 / self.moments[0]
    }
}

fn sum(parts: &[(f64, SymTensor)]) -> SymTensor {
    SymTensor::from_voigt(std::array::from_fn(|k| parts.iter().map(|(w, t)| w * t.voigt()[k]).sum()))
}
