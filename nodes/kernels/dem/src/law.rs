//! The contact law: Hertz normal force, Mindlin tangential force with history, Coulomb limit, viscous damping.
//!
//! Written once for any number of lanes: with `f64` it is the scalar specification, with the lanes of an instruction
//! set it is what the engine runs.

use crate::lanes::{Lanes, V3, inverse_root};
use grainlab_core::Material;

/// Coefficients of the contact law for one phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// 2 E*, Pa: k_n = this × √(R* δ).
    pub normal: f64,
    /// 8 G*, Pa: k_t = this × √(R* δ).
    pub tangential: f64,
    /// Friction coefficient.
    pub friction: f64,
    /// Damping, share of critical.
    pub damping: f64,
}

/// Geometry and motion of a contact in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch<L> {
    /// Unit vector from `i` to `j`.
    pub normal: V3<L>,
    /// 1/distance of the centres, 1/m.
    pub inverse_distance: L,
    /// Full overlap δ, m, positive.
    pub overlap: L,
    /// Radius of the contact area √(R* δ), m.
    pub root: L,
    /// By how much the contact area shrank over the step: √(R* δ) over what it was, 1 where it grew or is new.
    pub unloading: L,
    /// Effective mass m_i m_j/(m_i + m_j), kg.
    pub m_eff: L,
    /// Velocity of the centre of `j` relative to `i`, affine part included, m/s.
    pub relative: V3<L>,
    /// a_i ω_i + a_j ω_j with levers a = R − δ/2, m/s.
    pub rolling: V3<L>,
    /// ω_i + ω_j, rad/s: half its part along the normal twists the tangential force along.
    pub spin: V3<L>,
}

/// Forces of a contact in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forces<L> {
    /// Elastic normal force, N, positive in compression.
    pub elastic: L,
    /// Normal force with damping, N, never attractive.
    pub normal: L,
    /// Tangential force on `i`, damping included, N.
    pub tangential: V3<L>,
    /// Elastic part of the tangential force on `i`, N: the history.
    pub history: V3<L>,
}

impl Law {
    /// Coefficients for grains of `material`.
    pub fn new(material: &Material, friction: f64, damping: f64) -> Self {
        Self {
            normal: 2.0 * material.effective_young(),
            tangential: 8.0 * material.effective_shear(),
            friction,
            damping,
        }
    }

    /// Normal force (elastic, with damping), N, and the coefficient of its dashpot, N s/m.
    #[inline(always)]
    fn normal_force<L: Lanes>(&self, overlap: L, root: L, m_eff: L, along: L) -> (L, L, L) {
        // F = (4/3) E* √(R*) δ^{3/2} = (2/3) k_n δ
        let k_n = L::splat(self.normal) * root;
        let elastic = L::splat(2.0 / 3.0) * k_n * overlap;
        if self.damping == 0.0 {
            return (elastic, elastic, L::splat(0.0));
        }
        let dashpot = L::splat(2.0 * self.damping) * (m_eff * k_n).sqrt();
        (elastic, dashpot.mul_sub_from(along, elastic).max(L::splat(0.0)), dashpot)
    }

    /// A contact without friction: normal force with damping, N, from overlap (m), √(R* δ) (m), effective mass (kg) and
    /// the speed at which the grains part (m/s).
    #[inline(always)]
    pub fn frictionless<L: Lanes>(&self, overlap: L, root: L, m_eff: L, along: L) -> L {
        self.normal_force(overlap, root, m_eff, along).1
    }

    /// A contact with friction, its history brought forward by `dt` (s) where `ADVANCE`, else taken as it is.
    ///
    /// `SLIDING` applies the Coulomb limit, to the elastic force and then to it and the viscous one together. (To leave
    /// the elastic force what the viscous one leaves of the limit, as in Luding, Granular Matter 10, 235 (2008), spares a
    /// root, but lets the elastic stress fall with the strain rate, and a stress servo goes unstable early.) `RESCALED`
    /// scales the history down with the stiffness on unloading.
    #[inline(always)]
    pub fn frictional<L: Lanes, const ADVANCE: bool, const SLIDING: bool, const RESCALED: bool>(
        &self,
        t: &Touch<L>,
        history: V3<L>,
        dt: f64,
    ) -> Forces<L> {
        let n = t.normal;
        let along = t.relative.dot(n);
        let across = t.relative.minus(n, along);
        let (elastic, normal, dashpot) = self.normal_force(t.overlap, t.root, t.m_eff, along);
        // From the present velocities alone, whatever the time step, so that a resumed state has the same force.
        let share = (self.tangential / self.normal).sqrt();
        let limit = L::splat(self.friction) * elastic;
        let mut f = history;
        if ADVANCE {
            let mean = n.minus(across, L::splat(0.5 * dt) * t.inverse_distance);
            f = carried(f, t, mean, dt);
            if RESCALED {
                f = f.scale(t.unloading);
            }
            // Levers turn with the mid-step normal, else a pair that spins about an oblique axis would seem to slip.
            let slip = across.minus_cross(t.rolling, mean);
            let slip = slip.minus(n, slip.dot(n));
            f = f.plus(slip, L::splat(self.tangential * dt) * t.root);
            if SLIDING {
                f = limited(f, limit);
            }
        }
        let mut tangential = f;
        if self.damping > 0.0 {
            tangential = f.plus(across.minus_cross(t.rolling, n), dashpot * L::splat(share));
            if SLIDING {
                tangential = limited(tangential, limit);
            }
        }
        Forces { elastic, normal, tangential, history: f }
    }
}

/// Coulomb's limit.
#[inline(always)]
fn limited<L: Lanes>(f: V3<L>, limit: L) -> V3<L> {
    let square = f.dot(f);
    let sliding = square.gt(limit * limit);
    if !L::any(sliding) {
        return f;
    }
    V3::select(sliding, f.scale(limit * inverse_root(square)), f)
}

/// The history after the rotation of its contact over one step: the shortest rotation of the normal, then the twist.
///
/// With m the mean of the old and new normal, f − (f·n) m is that rotation. Norm and perpendicularity are kept to third
/// order in the angle of one step (1e-7 rad at most in practice).
#[inline(always)]
fn carried<L: Lanes>(f: V3<L>, t: &Touch<L>, mean: V3<L>, dt: f64) -> V3<L> {
    let n = t.normal;
    let f = f.minus(mean, f.dot(n));
    let angle = t.spin.dot(mean) * L::splat(0.5 * dt);
    let shrink = (L::splat(0.5) * angle).mul_sub_from(angle, L::splat(1.0));
    f.scale(shrink).plus(n.cross(f), angle)
}
