//! Hertz's elastic impact in closed form.
//!
//! Hertz, J. reine angew. Math. 92, 156 (1881); Timoshenko & Goodier, Theory of Elasticity, § 142.

/// An elastic impact of two spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Impact {
    /// Largest overlap, m.
    pub(crate) overlap: f64,
    /// Largest force, N.
    pub(crate) force: f64,
    /// Duration of contact, s.
    pub(crate) duration: f64,
}

/// The impact for E* (Pa), R* (m), m* (kg) and speed of approach (m/s).
pub(crate) fn impact(young: f64, radius: f64, mass: f64, speed: f64) -> Impact {
    // m v²/2 = (8/15) E* √R* δ^{5/2}
    let overlap = (15.0 / 16.0 * mass * speed * speed / (young * radius.sqrt())).powf(0.4);
    let force = 4.0 / 3.0 * young * radius.sqrt() * overlap.powf(1.5);
    // 2 ∫₀¹ dx/√(1 − x^{5/2}) = 2 √π Γ(7/5)/Γ(9/10)
    Impact { overlap, force, duration: 2.943_275_1 * overlap / speed }
}
