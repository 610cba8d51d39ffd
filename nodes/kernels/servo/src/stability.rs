//! When Eq. 1 is stable.
//!
//! Eq. 1, ε̇ ← ε̇ + g (σ − σ*) once each control interval h, makes the rate of strain a velocity that the stress error
//! accelerates: ε̈ = (g/h)(σ − σ*). The cell has got an inertia of h/g per volume and swings on the stiffness of its
//! packing, as in a constant-stress ensemble (Andersen, J. Chem. Phys. 72, 2384 (1980); Parrinello and Rahman,
//! J. Appl. Phys. 52, 7182 (1981)), at ω = √(gK/h).
//!
//! What the packing answers to a small strain of frequency ω is C(ω) = A − Σ_k Ξ_k² (1 + iβω)/(ω_k² − ω² +
//! iω(γ + βω_k²))/V, with A the affine stiffness, Ξ_k the coupling of mode k to the strain, γ the drag and β the
//! contact damping over stiffness: the contacts' elastic stress, whose dashpots also see the affine motion. Its
//! imaginary part has the sign of Σ_k Ξ_k² ω (γ + βω²) and is positive at every frequency: stress leads strain, and the
//! swinging cell loses energy to the grains. So with time continuous Eq. 1 is stable for any gain, and a passive packing
//! damps it without a leak. What sets the limit is the sampling: over one interval the pair (rate, error) is multiplied by
//!
//! ```text
//! | 1 − λ            g    |      characteristic polynomial   z² − (2 − λ − gKh) z + 1 − λ
//! | −(1 − λ) K h   1 − gKh |
//! ```
//!
//! (λ the leak) whose root leaves the unit circle at z = −1, a stress error that changes sign every interval, once
//! gKh ≥ 4 − 2λ. At that frequency, π/h, only the stiffness K = Re C(π/h) counts: the affine one for intervals short
//! against the grains' modes, towards the relaxed one for long ones. The affine one is the safe choice. With all
//! components servoed the isotropic direction is the stiffest and goes first, and in it the two hardly differ (6 % at a
//! coordination of 5).
//!
//! Below the limit a slow instability remains possible where the contacts are nearly undamped, sliding is absent and the
//! interval as long as the grains' slow modes: sampling folds what the packing does at 2π/h − ω, where its lag counts
//! with the wrong sign. Seen at 0.9 of the limit with a damping of 0.05, a friction of 10 and 50 steps an interval;
//! never with the damping of 0.3 that the scenes use.

use grainlab_core::ComponentControl;

/// Stress that each servoed component gains when all servoed strains of its kind grow by one, Pa; 0 where not servoed.
///
/// `tangent` holds C_iiii (xx, yy, zz) and C_ijij (yz, xz, xy) in Pa. An off-diagonal tensor strain enters twice:
/// 2 C_ijij. Normal strains act together: C_iiii + Σ C_iijj over the other servoed ones, a row sum, and so a bound on
/// the largest eigenvalue. C_iijj is taken from the isotropic relation C_iiii − 2 C_ijij of the means.
pub(crate) fn loop_stiffness(tangent: &[f64; 6], controls: &[ComponentControl; 6]) -> [f64; 6] {
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

/// The gain g of Eq. 1 at which it goes unstable, 1/(Pa s): g h K = 4 − 2 leak, with K of the stiffest servoed direction.
///
/// `tangent` is the affine tangent stiffness of the present contacts (C_iiii for xx, yy, zz, then C_ijij for yz, xz, xy;
/// Pa, not negative), `controls` says which components are servoed, `control_interval` is h (s, positive) and `leak` the
/// share of the rate forgotten each interval, from 0 (Eq. 1 to the letter) to 1. Infinite without contacts or without a
/// servoed component. The derivation is in this module's source. Packings of 200 grains from 1 kPa to 5 MPa go unstable at
/// 0.98 to 1.16 times this gain for 1 to 20 steps an interval, any leak and one or all components servoed; at 1.3 to 1.6
/// times for 100 steps and a lone component, since the grains then have time to give way.
///
/// The limit scales as 1/h: it follows the time step, and a gain tuned at one pressure or control period is wrong at
/// another. [`grainlab_core::ServoLaw::Normalised`] takes it as a share of this gain instead.
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
    let stiffest = loop_stiffness(tangent, controls).into_iter().fold(0.0, f64::max);
    (4.0 - 2.0 * leak) / (control_interval * stiffest)
}
