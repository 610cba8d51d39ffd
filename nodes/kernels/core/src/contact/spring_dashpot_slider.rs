//! The part of a contact law that does not depend on its springs: damping, tangential history, Coulomb limit.

use super::springs::ContactSprings;
use crate::lanes::{LaneVec3, Lanes, rsqrt};

/// Geometry and motion of a contact, in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactKinematics<L> {
    /// Unit vector from `i` to `j`.
    pub normal: LaneVec3<L>,
    /// 1/distance of the centres, 1/m.
    pub inverse_distance: L,
    /// Full overlap δ, m, positive.
    pub overlap: L,
    /// Contact radius √(R* δ), m.
    pub contact_radius: L,
    /// Contact radius of the step before, m; 0 where the contact is new.
    pub contact_radius_before: L,
    /// Effective mass m_i m_j/(m_i + m_j), kg.
    pub m_eff: L,
    /// Velocity of the centre of `j` relative to `i`, affine part included, m/s.
    pub relative_velocity: LaneVec3<L>,
    /// a_i ω_i + a_j ω_j with levers a = R − δ/2, m/s.
    pub spin_velocity: LaneVec3<L>,
    /// ω_i + ω_j, rad/s. Half its component along the normal turns the tangential force about the normal.
    pub spin_sum: LaneVec3<L>,
}

impl<L: Lanes> ContactKinematics<L> {
    /// Velocity of `j` relative to `i` across the normal, m/s.
    #[inline(always)]
    fn across(&self) -> LaneVec3<L> {
        self.relative_velocity.sub_scaled(self.normal, self.relative_velocity.dot(self.normal))
    }

    /// The normal half a step of `dt` (s) ago.
    #[inline(always)]
    pub(super) fn mean_normal(&self, dt: f64) -> LaneVec3<L> {
        self.normal.sub_scaled(self.across(), L::splat(0.5 * dt) * self.inverse_distance)
    }
}

/// Forces of a contact, in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForces<L> {
    /// Elastic normal force, N, positive in compression.
    pub elastic: L,
    /// Normal force with damping, N, never attractive.
    pub normal: L,
    /// Tangential force on `i`, damping included, N.
    pub tangential: LaneVec3<L>,
    /// Elastic part of the tangential force on `i`, N: the history.
    pub history: LaneVec3<L>,
}

/// The history of a contact over one step, before the Coulomb limit, in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HistoryStep<L> {
    /// The force of the step before, rotated with the contact and scaled with the stiffness, N.
    pub carried: LaneVec3<L>,
    /// This force after the slip of the step, N.
    pub elastic: LaneVec3<L>,
}

/// Springs with dashpots in parallel, and a slider in series with the tangential ones: a contact law in one phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringDashpotSlider<S> {
    /// Springs of the law.
    pub springs: S,
    /// Friction coefficient of the phase.
    pub friction: f64,
    /// Damping, as a fraction of critical.
    pub damping: f64,
    /// Fraction of its tangential force that a contact keeps at least on unloading; see [`TangentialLaw::kept`](super::TangentialLaw::kept).
    pub kept: f64,
}

impl<S: ContactSprings> SpringDashpotSlider<S> {
    /// Elastic normal force, normal force with damping, N, and the coefficient of the dashpot, N s/m.
    #[inline(always)]
    fn normal<L: Lanes>(&self, overlap: L, contact_radius: L, m_eff: L, separation_speed: L) -> (L, L, L) {
        let k_n = self.springs.normal_stiffness(contact_radius, overlap);
        let elastic = self.springs.normal_force(k_n, overlap);
        if self.damping == 0.0 {
            return (elastic, elastic, L::splat(0.0));
        }
        let dashpot = L::splat(2.0 * self.damping) * (m_eff * k_n).sqrt();
        (elastic, dashpot.neg_mul_add(separation_speed, elastic).max(L::splat(0.0)), dashpot)
    }

    /// A contact without friction: normal force with damping, N, from overlap (m), contact radius (m), effective mass (kg)
    /// and the speed at which the grains separate (m/s).
    #[inline(always)]
    pub fn normal_force<L: Lanes>(&self, overlap: L, contact_radius: L, m_eff: L, separation_speed: L) -> L {
        self.normal(overlap, contact_radius, m_eff, separation_speed).1
    }

    /// A contact with friction. Where `ADVANCE` its history is advanced by `dt` (s), else it is used as it is.
    ///
    /// `SLIDING` applies the Coulomb limit, first to the elastic force, then to the sum of elastic and viscous force. (Limiting
    /// the elastic force to what the viscous one leaves of the limit, as in Luding, Granular Matter 10, 235 (2008), saves a
    /// root. But then the elastic stress falls with the strain rate, and a stress servo becomes unstable early.)
    #[inline(always)]
    pub fn full_force<L: Lanes, const ADVANCE: bool, const SLIDING: bool>(
        &self,
        c: &ContactKinematics<L>,
        history: LaneVec3<L>,
        dt: f64,
    ) -> ContactForces<L> {
        let n = c.normal;
        let separation_speed = c.relative_velocity.dot(n);
        let across = c.relative_velocity.sub_scaled(n, separation_speed);
        let (elastic, normal, dashpot) = self.normal(c.overlap, c.contact_radius, c.m_eff, separation_speed);
        // The viscous force depends on the present velocities alone, so that a resumed state has the same force.
        let dashpot_ratio = self.springs.dashpot_ratio();
        let limit = L::splat(self.friction) * elastic;
        let mut f = history;
        if ADVANCE {
            f = self.history_step(c, f, dt).elastic;
            if SLIDING {
                f = coulomb_limit(f, limit);
            }
        }
        let mut tangential = f;
        if self.damping > 0.0 {
            tangential =
                f.add_scaled(across.sub_cross(c.spin_velocity, n), dashpot * L::splat(dashpot_ratio));
            if SLIDING {
                tangential = coulomb_limit(tangential, limit);
            }
        }
        ContactForces { elastic, normal, tangential, history: f }
    }

    /// The history one step further, without the Coulomb limit.
    #[inline(always)]
    pub fn history_step<L: Lanes>(
        &self,
        c: &ContactKinematics<L>,
        history: LaneVec3<L>,
        dt: f64,
    ) -> HistoryStep<L> {
        let (n, across, mean) = (c.normal, c.across(), c.mean_normal(dt));
        let unloading = self.springs.unloading(c.contact_radius_before, c.contact_radius, c.overlap);
        // Not a branch, which costs more than the quotient.
        let carried = rotate_history(history, c, mean, dt).scale(unloading.max(L::splat(self.kept)));
        // With the mid-step normal: else a pair that spins about an oblique axis would seem to slip.
        let slip = across.sub_cross(c.spin_velocity, mean);
        let slip = slip.sub_scaled(n, slip.dot(n));
        let stiffness = self.springs.tangential_stiffness(c.contact_radius, c.overlap, dt);
        let elastic = carried.add_scaled(slip, stiffness);
        HistoryStep { carried, elastic }
    }
}

/// Scales a force down to Coulomb's limit where it exceeds it.
#[inline(always)]
pub(super) fn coulomb_limit<L: Lanes>(f: LaneVec3<L>, limit: L) -> LaneVec3<L> {
    let square = f.dot(f);
    let sliding = square.gt(limit * limit);
    if !L::any(sliding) {
        return f;
    }
    LaneVec3::select(sliding, f.scale(limit * rsqrt(square)), f)
}

/// The history, rotated with its contact over one step: by the shortest rotation of the normal, then by the twist about it.
///
/// With m the mean of the old and new normal, f − (f·n) m is that rotation. Norm and perpendicularity are kept to third
/// order in the angle of one step (1e-7 rad at most in practice).
#[inline(always)]
pub(super) fn rotate_history<L: Lanes>(
    f: LaneVec3<L>,
    c: &ContactKinematics<L>,
    mean: LaneVec3<L>,
    dt: f64,
) -> LaneVec3<L> {
    let n = c.normal;
    let f = f.sub_scaled(mean, f.dot(n));
    let angle = c.spin_sum.dot(mean) * L::splat(0.5 * dt);
    let cosine = (L::splat(0.5) * angle).neg_mul_add(angle, L::splat(1.0));
    f.scale(cosine).add_scaled(n.cross(f), angle)
}
