//! The rolling force of a contact, from its resistance to rolling.
//!
//! Iwashita & Oda, J. Eng. Mech. 124, 285 (1998); model C of Ai, Chen, Rotter & Ooi, Powder Technol. 206, 269 (2011). With the
//! definitions of Luding, Granular Matter 10, 235 (2008), and of LAMMPS's `rolling sds`: the rolling velocity
//! v = R* (ω_j − ω_i) × n, a rolling force f = k ∫v dt + γ v of at most μ times the normal force, and the torques R* n × f on i
//! and the opposite one on j. The rolling force is no force on the grains: it makes these torques alone.

use super::rolling_resistance::RollingResistance;
use super::spring_dashpot_slider::{
    ContactKinematics, HistoryStep, SpringDashpotSlider, coulomb_limit, rotate_history,
};
use super::springs::ContactSprings;
use crate::lanes::{LaneVec3, Lanes};

/// Springs of a contact that also resists rolling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingSprings<S> {
    /// The normal and the tangential spring.
    pub springs: S,
    /// The resistance to rolling.
    pub rolling: RollingResistance,
}

/// The rolling force of a contact, in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingForce<L> {
    /// The rolling force, dashpot included, N. The torque on `i` is R* n × this, that on `j` the opposite.
    pub total: LaneVec3<L>,
    /// Elastic part of the rolling force, N: the history.
    pub history: LaneVec3<L>,
}

impl<S: ContactSprings> ContactSprings for RollingSprings<S> {
    const ROLLS: bool = true;

    #[inline(always)]
    fn rolling(&self) -> RollingResistance {
        self.rolling
    }

    #[inline(always)]
    fn normal_stiffness<L: Lanes>(&self, contact_radius: L, overlap: L) -> L {
        self.springs.normal_stiffness(contact_radius, overlap)
    }

    #[inline(always)]
    fn normal_force<L: Lanes>(&self, normal_stiffness: L, overlap: L) -> L {
        self.springs.normal_force(normal_stiffness, overlap)
    }

    #[inline(always)]
    fn normal_energy<L: Lanes>(&self, normal_force: L, contact_radius: L, overlap: L) -> L {
        self.springs.normal_energy(normal_force, contact_radius, overlap)
    }

    #[inline(always)]
    fn tangential_stiffness<L: Lanes>(&self, contact_radius: L, overlap: L, factor: f64) -> L {
        self.springs.tangential_stiffness(contact_radius, overlap, factor)
    }

    fn stiffness_ratio(&self) -> f64 {
        self.springs.stiffness_ratio()
    }

    #[inline(always)]
    fn dashpot_ratio(&self) -> f64 {
        self.springs.dashpot_ratio()
    }

    #[inline(always)]
    fn unloading<L: Lanes>(&self, before: L, contact_radius: L, overlap: L) -> L {
        self.springs.unloading(before, contact_radius, overlap)
    }

    fn collision_overlap(&self, r_eff: f64, m_eff: f64, speed: f64) -> f64 {
        self.springs.collision_overlap(r_eff, m_eff, speed)
    }
}

impl<S: ContactSprings> SpringDashpotSlider<S> {
    /// The rolling force at the rolling velocity `rolling_velocity` = R* (ω_j − ω_i) × n (m/s) and the elastic normal force
    /// `normal_force` (N). Where `ADVANCE` its history is advanced by `dt` (s), else it is used as it is.
    ///
    /// The limit μ F_n applies first to the elastic force, then to the sum of elastic and viscous force, as for the tangential
    /// force. LAMMPS limits the sum alone, by the normal force with damping: without dashpots both are the same.
    #[inline(always)]
    pub fn rolling_force<L: Lanes, const ADVANCE: bool>(
        &self,
        c: &ContactKinematics<L>,
        rolling_velocity: LaneVec3<L>,
        normal_force: L,
        history: LaneVec3<L>,
        dt: f64,
    ) -> RollingForce<L> {
        let resistance = self.springs.rolling();
        let limit = L::splat(resistance.friction) * normal_force;
        let mut f = history;
        if ADVANCE {
            f = coulomb_limit(self.rolling_step(c, rolling_velocity, f, dt).elastic, limit);
        }
        let mut total = f;
        if resistance.damping > 0.0 {
            total = coulomb_limit(f.add_scaled(rolling_velocity, L::splat(resistance.damping)), limit);
        }
        RollingForce { total, history: f }
    }

    /// The rolling history one step further, without the limit.
    #[inline(always)]
    pub fn rolling_step<L: Lanes>(
        &self,
        c: &ContactKinematics<L>,
        rolling_velocity: LaneVec3<L>,
        history: LaneVec3<L>,
        dt: f64,
    ) -> HistoryStep<L> {
        let carried = rotate_history(history, c, c.mean_normal(dt), dt);
        let elastic = carried.add_scaled(rolling_velocity, L::splat(self.springs.rolling().stiffness * dt));
        HistoryStep { carried, elastic }
    }
}
