//! The control of all components.

use crate::check::check;
use crate::error::ServoError;
use crate::input::{ServoInput, ServoOutput};
use crate::law;
use crate::stability::closed_loop_stiffness;
use grainlab_core::ComponentControl;

/// The strain rate for one input.
///
/// - Held: zero.
/// - A strain rate: the setpoint, limited to the rate limit.
/// - A stress target under [`grainlab_core::ServoLaw::Scaled`]: (σ − σ*)/(K τ), limited to the rate limit. K is the
///   change of the stress component per unit of the *tensor* strain component: C_iiii on the diagonal, 2 C_ijij off it.
///   For K = 0 (no contacts) the output is the limit of the law for K → 0: the rate limit with the sign of the error, zero without an
///   error.
/// - A stress target under [`grainlab_core::ServoLaw::Normalised`]: (1 − leak)·rate + share·(4 − 2 leak)/(K h)·(σ −
///   σ*), limited to the rate limit. K is the closed-loop stiffness: as above, plus for a normal component C_iijj of every other servoed one.
/// - A stress target under [`grainlab_core::ServoLaw::Integral`]: (1 − leak)·rate + gain·(σ − σ*), limited to the rate
///   limit. An error from [`crate::critical_gain`] on.
///
/// Under the last two laws the rate is the integral, so that the limit prevents windup: an unreachable target
/// saturates, and the rate reverses with the first error of the other sign.
///
/// ```
/// use grainlab_core::{ComponentControl, ServoLaw, SymTensor};
/// let input = grainlab_servo::ServoInput {
///     stress: SymTensor::isotropic(40.0e3),
///     controls: std::array::from_fn(|i| if i < 3 { ComponentControl::Stress(50.0e3) } else { ComponentControl::Held }),
///     rate: [0.0; 6],
///     rate_limit: 10.0,
///     law: ServoLaw::Scaled { response_time: 1.0e-4 },
///     tangent: Some([200.0e6, 200.0e6, 200.0e6, 70.0e6, 70.0e6, 70.0e6]),
///     control_interval: 2.0e-8,
/// };
/// let output = grainlab_servo::control(&input).unwrap();
/// // 10 kPa too little compression, over 200 MPa and 0.1 ms: compress at 0.5 per second.
/// assert!((output.rate[0] + 0.5).abs() < 1e-15 && !output.saturated[0]);
/// ```
pub fn control(input: &ServoInput) -> Result<ServoOutput, ServoError> {
    check(input)?;
    // The integral law uses no stiffness; the others are refused without.
    let tangent = input.tangent.unwrap_or_default();
    let stiffness = closed_loop_stiffness(&tangent, &input.controls);
    let mut output = ServoOutput { rate: [0.0; 6], saturated: [false; 6] };
    for (i, stress) in input.stress.voigt().into_iter().enumerate() {
        let wanted = match input.controls[i] {
            ComponentControl::Held => 0.0,
            ComponentControl::StrainRate(rate) => rate,
            ComponentControl::Stress(target) => law::rate(
                &input.law,
                &law::Component {
                    error: stress - target,
                    rate: input.rate[i],
                    diagonal_stiffness: law::stiffness(&tangent, i),
                    closed_loop_stiffness: stiffness[i],
                    interval: input.control_interval,
                },
            ),
        };
        output.rate[i] = wanted.clamp(-input.rate_limit, input.rate_limit);
        output.saturated[i] = wanted.abs() > input.rate_limit;
    }
    Ok(output)
}
