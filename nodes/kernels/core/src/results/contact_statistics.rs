//! Number of contacts, and the forces that they carry.

/// Bins of f = F_n/⟨F_n⟩ in [`ForceStatistics`].
pub const FORCE_BINS: usize = 20;

/// Width of a bin of f = F_n/⟨F_n⟩; the last bin has no upper end.
pub const FORCE_BIN_WIDTH: f64 = 0.25;

/// Bins of the mobilised friction in [`MobilisedFriction`]: tenths of the Coulomb limit.
pub const MOBILISATION_BINS: usize = 10;

/// Contacts and the forces they carry.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactStatistics {
    /// Number of grains.
    pub grains: u32,
    /// Number of contacts.
    pub contacts: u32,
    /// Grains without force: recursively fewer than 2 contacts with friction, 4 without.
    pub rattlers: u32,
    /// Coordination number k = 2 contacts/grains, all grains (the paper's).
    pub coordination: f64,
    /// Mechanical coordination number z: k without rattlers and their contacts.
    pub mechanical_coordination: f64,
    /// Fraction of contacts at the Coulomb limit, |F_t| ≥ 0.999 μ F_n; 0 where there is no limit.
    pub sliding_fraction: f64,
    /// Distribution of normal forces; `None` without any.
    pub forces: Option<ForceStatistics>,
    /// Mobilised friction; `None` without contacts and where there is no limit (μ = 0 or infinite).
    pub friction: Option<MobilisedFriction>,
}

/// Distribution of normal forces, f = F_n/⟨F_n⟩.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceStatistics {
    /// Mean normal force ⟨F_n⟩, N.
    pub mean_normal: f64,
    /// Mean tangential force ⟨|F_t|⟩, N.
    pub mean_tangential: f64,
    /// ⟨f²⟩, ⟨f³⟩, ⟨f⁴⟩. An exponential distribution has 2, 6, 24.
    pub moments: [f64; 3],
    /// Largest value of f.
    pub largest: f64,
    /// Number of contacts by f, in bins of [`FORCE_BIN_WIDTH`] from 0; the last bin has no upper end, the first no lower one.
    pub histogram: [u32; FORCE_BINS],
}

/// Mobilised friction m = min(|F_t|/(μ F_n), 1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MobilisedFriction {
    /// Mean value ⟨m⟩.
    pub mean: f64,
    /// Number of contacts by m, in tenths; the last bin also holds those at the limit.
    pub histogram: [u32; MOBILISATION_BINS],
}

impl ForceStatistics {
    /// Participation ratio ⟨F⟩²/⟨F²⟩ in (0, 1]: 1 where all contacts carry alike, 1/2 for exponential forces.
    pub fn participation_ratio(&self) -> f64 {
        1.0 / self.moments[0]
    }
}
