//! The time step, from the stiffness of the contacts present.

use crate::engine::{Features, Setting};
use crate::pairs::Pairs;
use crate::state::State;

/// Longest stable time step of the present contacts, s: 2/ω with ω² ≤ max_i (2/m_i) Σ_c κ_c, where κ is the larger of
/// k_n and (1 + m R²/I) k_t (translation and rotation together). Infinite where nothing touches.
///
/// Follows from |B u|² ≤ 2 (|B_i u_i|² + |B_j u_j|²) for each contact, so it is a bound, not an estimate; it lies about
/// 15 % below the true limit in a packing. Viscous contacts take it down by √(1+ζ²) − ζ.
pub(crate) fn stable(state: &State, pairs: &Pairs, setting: &Setting) -> f64 {
    let (normal, tangential) =
        (2.0 * state.material.effective_young(), 8.0 * state.material.effective_shear());
    // I = 2/5 m R²
    let factor = match setting.features() {
        Features::Frictionless => normal,
        Features::Coulomb | Features::Stuck => normal.max(3.5 * tangential),
    };
    let mut sum = vec![0.0; state.grains()];
    for p in 0..pairs.len() {
        if pairs.overlap[p] > 0.0 {
            let (i, j) = (pairs.i[p] as usize, pairs.j[p] as usize);
            let r_eff = grains::material::effective_radius(state.radius[i], state.radius[j]);
            let k = factor * (r_eff * pairs.overlap[p]).sqrt();
            sum[i] += k;
            sum[j] += k;
        }
    }
    let square = (0..sum.len()).map(|i| 2.0 * sum[i] * state.inverse_mass[i]).fold(0.0, f64::max);
    let z = setting.damping;
    2.0 / square.sqrt() * ((1.0 + z * z).sqrt() - z)
}

/// Time a Rayleigh wave takes around half the smallest grain, s: the time step of a packing without contacts.
pub(crate) fn rayleigh(state: &State) -> f64 {
    let m = &state.material;
    let radius = state.radius.iter().copied().fold(f64::INFINITY, f64::min);
    std::f64::consts::PI * radius * (m.density / m.shear_modulus).sqrt() / (0.1631 * m.poisson_ratio + 0.8766)
}

/// Stable time step of a collision at relative speed `speed` (m/s): that of the stiffness at its largest overlap.
pub(crate) fn collision(state: &State, speed: f64, damping: f64) -> f64 {
    let radius = state.largest_radius();
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
