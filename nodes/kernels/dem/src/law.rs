//! The contact law: Hertz normal force, Mindlin tangential force with history, Coulomb limit, viscous damping.
//!
//! This scalar form is the specification; faster forms are tested against it.

use grains::{Material, Vec3};

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

/// Geometry and motion of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Unit vector from `i` to `j`.
    pub normal: Vec3,
    /// Distance of the centres, m.
    pub distance: f64,
    /// Full overlap, m, positive.
    pub overlap: f64,
    /// Overlap one step ago, m; 0 for a new contact.
    pub previous_overlap: f64,
    /// Effective radius R*, m.
    pub r_eff: f64,
    /// Effective mass m_i m_j/(m_i + m_j), kg.
    pub m_eff: f64,
    /// Velocity of the centre of `j` relative to `i`, affine part included, m/s.
    pub relative: Vec3,
    /// a_i ω_i + a_j ω_j with levers a = R − δ/2, m/s.
    pub rolling: Vec3,
    /// (ω_i + ω_j)/2, rad/s: its part along the normal twists the tangential force along.
    pub spin: Vec3,
}

/// Forces of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forces {
    /// Normal force, damping included, N, positive in compression, never attractive.
    pub normal: f64,
    /// Tangential force on `i`, damping included, N.
    pub tangential: Vec3,
    /// Elastic part of the tangential force on `i`, N: the history.
    pub history: Vec3,
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

    /// Normal force (elastic, total) of a contact, N.
    #[inline(always)]
    fn normal_force(&self, t: &Touch, root: f64, approach: f64) -> (f64, f64, f64) {
        // F = (4/3) E* √(R*) δ^{3/2} = (2/3) k_n δ
        let k_n = self.normal * root;
        let elastic = 2.0 / 3.0 * k_n * t.overlap;
        let dashpot = if self.damping > 0.0 { 2.0 * self.damping * (t.m_eff * k_n).sqrt() } else { 0.0 };
        (elastic, (elastic + dashpot * approach).max(0.0), dashpot)
    }

    /// A contact without friction.
    #[inline(always)]
    pub fn frictionless(&self, t: &Touch) -> f64 {
        let root = (t.r_eff * t.overlap).sqrt();
        self.normal_force(t, root, -t.relative.dot(&t.normal)).1
    }

    /// A contact with friction, its history brought forward by `dt` (s) where `ADVANCE`, else taken as it is.
    ///
    /// `SLIDING` applies the Coulomb limit; `RESCALED` scales the history down with the stiffness on unloading.
    #[inline(always)]
    pub fn frictional<const ADVANCE: bool, const SLIDING: bool, const RESCALED: bool>(
        &self,
        t: &Touch,
        history: Vec3,
        dt: f64,
    ) -> Forces {
        let n = t.normal;
        let along = t.relative.dot(&n);
        let across = t.relative - n * along;
        let root = (t.r_eff * t.overlap).sqrt();
        let (elastic, normal, dashpot) = self.normal_force(t, root, -along);
        let limit = self.friction * elastic;
        let mut f = history;
        if ADVANCE {
            let mean = n - across * (0.5 * dt / t.distance);
            f = carried(f, t, &mean, dt);
            if RESCALED && t.overlap < t.previous_overlap {
                f *= (t.overlap / t.previous_overlap).sqrt();
            }
            // Levers turn with the mid-step normal, else a pair that spins about an oblique axis would seem to slip.
            let rolling = t.rolling.cross(&mean);
            let slip = across - (rolling - n * rolling.dot(&n));
            f += slip * (self.tangential * root * dt);
            if SLIDING {
                f = limited(f, limit);
            }
        }
        let mut tangential = f;
        if dashpot > 0.0 {
            // From the present velocities alone, so that a resumed state has the same force.
            let slip = across - t.rolling.cross(&n);
            tangential += slip * (dashpot * (self.tangential / self.normal).sqrt());
            if SLIDING {
                tangential = limited(tangential, limit);
            }
        }
        Forces { normal, tangential, history: f }
    }
}

/// Coulomb's limit.
#[inline(always)]
fn limited(f: Vec3, limit: f64) -> Vec3 {
    let square = f.norm_squared();
    if square > limit * limit { f * (limit / square.sqrt()) } else { f }
}

/// The history after the rotation of its contact over one step: the shortest rotation of the normal, then the twist.
///
/// With m the mean of the old and new normal, f − (f·n) m is that rotation. Norm and perpendicularity are kept to third
/// order in the angle of one step (1e-7 rad at most in practice).
#[inline(always)]
fn carried(f: Vec3, t: &Touch, mean: &Vec3, dt: f64) -> Vec3 {
    let n = t.normal;
    let f = f - mean * f.dot(&n);
    let angle = t.spin.dot(mean) * dt;
    f * (1.0 - 0.5 * angle * angle) + n.cross(&f) * angle
}
