//! The dashpots of the contacts at one wave vector.

use crate::backbone::Backbone;
use crate::dispersion::bloch::Bloch;
use grainlab_core::Vec3;
use grainlab_micromechanics::network::ContactSpring;

/// The operator C(q) of the contact law's dashpots: c = 2ζ √(m* k) beside each normal and tangential spring k, with the
/// share ζ of critical damping `damping` and m* = m_i m_j/(m_i + m_j). Those of the engine
/// ([`grainlab_core::contact::SpringDashpotSlider`]), without the Coulomb limit. Rolling dashpots are left out, as rolling
/// springs are.
pub(super) fn dashpots<'a>(backbone: &'a Backbone, q: &Vec3, damping: f64) -> Bloch<'a> {
    Bloch::with(backbone, q, |spring: ContactSpring| {
        let [m, n] = [spring.i, spring.j].map(|g| backbone.mass[g as usize]);
        let dashpot = |stiffness: f64| 2.0 * damping * (m * n / (m + n) * stiffness.max(0.0)).sqrt();
        let tangential = dashpot(spring.tangential);
        let normal = dashpot(spring.kn_minus_kt + spring.tangential);
        ContactSpring { tangential, kn_minus_kt: normal - tangential, ..spring }
    })
}
