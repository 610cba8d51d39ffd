//! The time step, from the stiffness of the contacts present.

use crate::contacts::Contacts;
use crate::engine::{Features, Setting};
use crate::state::State;

/// Longest stable time step of the present contacts, s. Infinite where nothing touches.
///
/// For each contact |B u|² ≤ 2 (|B_i u_i|² + |B_j u_j|²), so ω² ≤ K = max_i (2/m_i) Σ_c κ_c, where κ is the larger of k_n
/// and (1 + m R²/I) k_t (translation and rotation together), and in the same way the damping matrix is at most
/// C = (2/m_i) Σ_c of its coefficients. With velocities half a step behind, a mode is stable while 4 − h² K − 2 h C ≥ 0.
/// A bound, not an estimate: without damping it lies at 0.61 to 0.67 of the true limit of frictional packings (a test
/// holds it between 0.45 and 1).
pub(crate) fn stable(state: &State, contacts: &Contacts, setting: &Setting) -> f64 {
    let (normal, tangential) =
        (2.0 * state.material.effective_young(), 8.0 * state.material.effective_shear());
    // I = 2/5 m R²
    let rolling = 3.5;
    let frictional = setting.features() != Features::Frictionless;
    let stiffness = if frictional { normal.max(rolling * tangential) } else { normal };
    // c_t = c_n √(k_t/k_n)
    let dashpot = if frictional { (rolling * (tangential / normal).sqrt()).max(1.0) } else { 1.0 };
    let (mut springs, mut dashpots) = (vec![0.0; state.grains()], vec![0.0; state.grains()]);
    for p in contacts.touching() {
        let (i, j) = (p.i as usize, p.j as usize);
        let root = p.root;
        let m_eff = 1.0 / (state.inverse_mass[i] + state.inverse_mass[j]);
        let c = dashpot * 2.0 * setting.damping * (m_eff * normal * root).sqrt();
        for grain in [i, j] {
            springs[grain] += stiffness * root;
            dashpots[grain] += c;
        }
    }
    let of = |i: usize| {
        let (k, c) = (2.0 * springs[i] * state.inverse_mass[i], 2.0 * dashpots[i] * state.inverse_mass[i]);
        4.0 / (c + (c * c + 4.0 * k).sqrt())
    };
    (0..state.grains()).map(of).fold(f64::INFINITY, f64::min)
}

/// Time a Rayleigh wave takes around half the smallest grain, s: the time step of a packing without contacts.
pub(crate) fn rayleigh(state: &State) -> f64 {
    let m = &state.material;
    let radius = state.smallest_radius;
    std::f64::consts::PI * radius * (m.density / m.shear_modulus).sqrt() / (0.1631 * m.poisson_ratio + 0.8766)
}

/// Stable time step of a collision at relative speed `speed` (m/s): that of the stiffness at its largest overlap.
pub(crate) fn collision(state: &State, speed: f64, damping: f64) -> f64 {
    let radius = state.largest_radius;
    let (r_eff, m_eff) = (0.5 * radius, 0.5 * state.material.sphere_mass(radius));
    let young = state.material.effective_young();
    // m v²/2 = (8/15) E* √R* δ^{5/2}
    let overlap = (15.0 / 16.0 * m_eff * speed * speed / (young * r_eff.sqrt())).powf(0.4);
    let stiffness = state.material.normal_stiffness(r_eff, overlap);
    2.0 * (m_eff / stiffness).sqrt() * ((1.0 + damping * damping).sqrt() - damping)
}

/// The step to take: `wanted` rounded down to a power of 2^(1/4), so that it changes rarely; down at once, up only by
/// two notches or more.
pub(crate) fn settle(current: f64, wanted: f64) -> f64 {
    let step = 2f64.powf((wanted.log2() * 4.0).floor() / 4.0);
    let up = step > 1.4 * current;
    if step < current || up { step } else { current }
}
