//! The stability limit of Eq. 1.
//!
//! Eq. 1, ε̇ ← ε̇ + g (σ − σ*) once per control interval h, makes the stress error accelerate the strain: ε̈
//! = (g/h)(σ − σ*). The cell has an inertia of h/g per volume and oscillates with the stiffness of its
//! packing, as in a constant-stress ensemble (Andersen, J. Chem. Phys. 72, 2384 (1980); Parrinello and
//! Rahman, J. Appl. Phys. 52, 7182 (1981)), at ω = √(gK/h).
//!
//! The response of the packing to a small strain of frequency ω is C(ω) = A − Σ_k Ξ_k² (1 + iβω)/(ω_k² − ω² + iω(γ +
//! βω_k²))/V, with A the affine stiffness, Ξ_k the coupling of mode k to the strain, γ the drag and β the contact
//! damping over stiffness: the elastic stress of the contacts, whose dashpots also act on the affine motion. Its
//! imaginary part has the sign of Σ_k Ξ_k² ω (γ + βω²) and is positive at every frequency: stress leads strain, and the
//! cell loses energy to the grains. In continuous time Eq. 1 is therefore stable for any gain, and a packing whose modes
//! couple to the strain damps it without a leak.
//!
//! A lattice has no such modes (Ξ_k = 0 by symmetry). A few large grains that bear the load, with rattlers between them, form
//! one in a periodic cell. C is then A, which is real, and the stress swings for ever; the rate limit r bounds the swing to
//! about r √(K h/g), 3 % of 100 kPa in a cell of three large grains and 600 rattlers. Stress with the part of the dashpots
//! (η = βA) would damp it, but is unstable itself once the dashpots of heavy grains relax more slowly than the interval:
//! gη > 2. The leak damps it whatever the packing is, by √(1 − λ) an interval. Its price is an error of λ ε̇/g while the rate
//! is held up.
//!
//! The limit is due to sampling: over one interval the pair (rate, error) is multiplied by
//!
//! ```text
//! | 1 − λ            g    |      characteristic polynomial   z² − (2 − λ − gKh) z + 1 − λ
//! | −(1 − λ) K h   1 − gKh |
//! ```
//!
//! (λ the leak) whose root leaves the unit circle at z = −1, a stress error that changes sign every interval, once gKh
//! ≥ 4 − 2λ. At that frequency, π/h, only the stiffness K = Re C(π/h) counts: the affine one for intervals short
//! compared with the periods of the grains' modes, close to the relaxed one for long ones. The affine one is the safe
//! choice. With all components servoed the isotropic direction is the stiffest and becomes unstable first; in it the
//! two hardly differ (6 % at a coordination number of 5).
//!
//! Below the limit a slow instability is possible if the contacts are nearly undamped, do not slide, and the interval
//! is as long as the periods of the grains' slow modes: sampling aliases the response at 2π/h − ω, whose phase then has
//! the wrong sign. It was observed at 0.9 of the limit with a damping ratio of 0.05, a friction of 10 and 50 steps per
//! interval, but never with the damping ratio of 0.3 of the scenes.

use grainlab_core::ComponentControl;

/// Change of stress of each servoed component per unit of all servoed strains of its kind, Pa; 0 for components that
/// are not servoed.
///
/// `tangent` is C_iiii (xx, yy, zz) and C_ijij (yz, xz, xy) in Pa. An off-diagonal tensor strain counts twice: 2 C_ijij.
/// Normal strains act together: C_iiii + Σ C_iijj over the other servoed ones, a row sum and therefore an upper bound of the
/// largest eigenvalue. C_iijj follows from the isotropic relation C_iiii − 2 C_ijij of the means.
pub(crate) fn closed_loop_stiffness(tangent: &[f64; 6], controls: &[ComponentControl; 6]) -> [f64; 6] {
    let servoed = controls.map(|c| matches!(c, ComponentControl::Stress(_)));
    let mean = |c: &[f64]| c.iter().map(|c| c / 3.0).sum::<f64>();
    let lateral = (mean(&tangent[..3]) - 2.0 * mean(&tangent[3..])).max(0.0);
    let others = servoed[..3].iter().filter(|s| **s).count().saturating_sub(1) as f64;
    std::array::from_fn(|i| match servoed[i] {
        false => 0.0,
        true if i < 3 => tangent[i] + others * lateral,
        true => 2.0 * tangent[i],
    })
}

/// The gain g above which Eq. 1 is unstable, 1/(Pa s): g h K = 4 − 2 leak, with K of the stiffest servoed direction.
///
/// `tangent` is the affine tangent stiffness of the present contacts (C_iiii for xx, yy, zz, then C_ijij for yz, xz, xy;
/// Pa, not negative), `controls` gives the servoed components, `control_interval` is h (s, positive) and `leak` the fraction
/// by which the rate decays each interval, from 0 (exactly Eq. 1) to 1. Infinite without contacts or without a servoed
/// component. The derivation is in this module's source. Packings of 200 grains from 1 kPa to 5 MPa become unstable at 0.98
/// to 1.16 times this gain for 1 to 20 steps per interval, any leak and one or all components servoed; at 1.3 to 1.6 times
/// for 100 steps and a single component, since the grains then have time to relax.
///
/// The limit is proportional to 1/h and changes with the time step: a gain tuned at one pressure or control period is
/// wrong at another. [`grainlab_core::ServoLaw::Normalised`] takes the gain as a fraction of this one instead.
///
/// ```
/// use grainlab_core::ComponentControl;
/// let tangent = [400.0e6, 400.0e6, 400.0e6, 200.0e6, 200.0e6, 200.0e6];
/// let controls = [ComponentControl::Stress(50.0e3); 6];
/// let gain = grainlab_servo::critical_gain(&tangent, &controls, 1.0e-6, 0.0);
/// assert!((gain - 4.0 / (1.0e-6 * 400.0e6)).abs() < 1e-15);
/// ```
pub fn critical_gain(
    tangent: &[f64; 6],
    controls: &[ComponentControl; 6],
    control_interval: f64,
    leak: f64,
) -> f64 {
    let stiffest = closed_loop_stiffness(tangent, controls).into_iter().fold(0.0, f64::max);
    (4.0 - 2.0 * leak) / (control_interval * stiffest)
}
