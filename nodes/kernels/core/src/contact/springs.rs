//! Springs of a contact law.

use super::rolling_resistance::RollingResistance;
use crate::lanes::Lanes;

/// The elastic part of a contact law, with its coefficients: a normal and a tangential spring.
///
/// Written for any number of lanes: with `f64` it is the scalar specification; the force kernel runs it in the lanes of an
/// instruction set. The contact radius is a = √(R* δ) for every law, with δ the full overlap.
pub trait ContactSprings: Copy + Send + Sync {
    /// True if contacts resist rolling.
    const ROLLS: bool = false;

    /// The resistance to rolling; without effect unless [`ContactSprings::ROLLS`].
    #[inline(always)]
    fn rolling(&self) -> RollingResistance {
        RollingResistance::NONE
    }

    /// Normal stiffness k_n = dF/dδ, N/m, from contact radius and overlap, m.
    fn normal_stiffness<L: Lanes>(&self, contact_radius: L, overlap: L) -> L;

    /// Elastic normal force F, N, from the normal stiffness, N/m, and the overlap, m.
    fn normal_force<L: Lanes>(&self, normal_stiffness: L, overlap: L) -> L;

    /// Energy U of the normal spring, J, with F = dU/dδ, from the elastic normal force, N, contact radius and overlap, m.
    fn normal_energy<L: Lanes>(&self, normal_force: L, contact_radius: L, overlap: L) -> L;

    /// `factor` times the tangential stiffness k_t, N/m, from contact radius and overlap, m.
    fn tangential_stiffness<L: Lanes>(&self, contact_radius: L, overlap: L, factor: f64) -> L;

    /// Ratio of stiffnesses k_t/k_n.
    fn stiffness_ratio(&self) -> f64;

    /// Ratio of the dashpots, c_t/c_n = √(k_t/k_n).
    fn dashpot_ratio(&self) -> f64;

    /// k_t over that of the step before, where it fell; 1 where it rose or the contact is new. From the contact radius of the
    /// step before, and the present one with its overlap, m.
    fn unloading<L: Lanes>(&self, before: L, contact_radius: L, overlap: L) -> L;

    /// Largest overlap of an elastic collision, m, from effective radius (m), effective mass (kg) and relative speed (m/s).
    fn collision_overlap(&self, r_eff: f64, m_eff: f64, speed: f64) -> f64;
}

/// Work that is compiled for each law.
pub trait LawVisitor {
    /// Result of the work.
    type Output;
    /// Does the work.
    fn visit<S: ContactSprings>(self, springs: S) -> Self::Output;
}
