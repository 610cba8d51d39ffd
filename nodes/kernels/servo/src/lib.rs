//! Control laws: the strain rate that answers a stress.
//!
//! [`answer`] is a pure function of one [`Request`]: it remembers nothing, so a servo that died and came back, or that
//! is asked twice, answers the same. Stress is positive in compression and strain rate in extension, so that too much
//! compression is answered by extension (Eq. 1 of La Ragione & Magnanimo, PRE 85, 031304, has its printed sign with
//! that pair only). Six components, Voigt order xx, yy, zz, yz, xz, xy, are controlled one by one.

mod error;
mod law;
mod stability;

pub use error::{ServoError, check_stability};
pub use stability::critical_gain;

use grainlab_core::{ComponentControl, ServoLaw, SymTensor};

/// Everything a servo needs to answer, and nothing it must remember.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Stress now, Pa, positive in compression.
    pub stress: SymTensor,
    /// What is imposed on each component.
    pub controls: [ComponentControl; 6],
    /// Strain rate in force, 1/s, tensor components, positive in extension. What Eq. 1 integrates.
    pub rate: [f64; 6],
    /// Largest magnitude of a component of the answer, 1/s. Positive.
    pub rate_limit: f64,
    /// The law that turns a stress error into a rate.
    pub law: ServoLaw,
    /// Tangent stiffness of the present contacts, Pa, not negative: C_iiii (xx, yy, zz) and C_ijij (yz, xz, xy). Zero
    /// where there is no contact.
    pub tangent: [f64; 6],
    /// Simulated time until the next request, s. Positive.
    pub control_interval: f64,
}

/// The strain rate that answers a [`Request`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Strain rate, 1/s, tensor components, positive in extension. Finite, at most `rate_limit` in magnitude.
    pub rate: [f64; 6],
    /// Whether the component was cut off at `rate_limit`.
    pub saturated: [bool; 6],
}

/// Answers one request.
///
/// - Held: zero.
/// - A strain rate: the setpoint, cut off at the limit.
/// - A stress target under [`ServoLaw::Scaled`]: (σ − σ*)/(K τ), cut off at the limit. K is what the stress component
///   gains per unit of the *tensor* strain component: C_iiii on the diagonal, 2 C_ijij off it. Where K is zero (no
///   contacts) the answer is the limit of the law for K → 0: the full rate limit with the sign of the error, zero
///   without an error.
/// - A stress target under [`ServoLaw::Normalised`]: (1 − leak)·rate + share·(4 − 2 leak)/(K h)·(σ − σ*), cut off at the
///   limit. K is the stiffness of the loop: as above, plus for a normal component C_iijj of every other servoed one.
/// - A stress target under [`ServoLaw::Integral`]: (1 − leak)·rate + gain·(σ − σ*), cut off at the limit. Refused from
///   [`critical_gain`] on.
///
/// Rate and integral are one under the last two laws, so that the limit bounds what can wind up: a target out of reach
/// saturates, and the rate turns with the first error of the other sign.
///
/// ```
/// use grainlab_core::{ComponentControl, ServoLaw, SymTensor};
/// let request = grainlab_servo::Request {
///     stress: SymTensor::isotropic(40.0e3),
///     controls: std::array::from_fn(|i| if i < 3 { ComponentControl::Stress(50.0e3) } else { ComponentControl::Held }),
///     rate: [0.0; 6],
///     rate_limit: 10.0,
///     law: ServoLaw::Scaled { response_time: 1.0e-4 },
///     tangent: [200.0e6, 200.0e6, 200.0e6, 70.0e6, 70.0e6, 70.0e6],
///     control_interval: 2.0e-8,
/// };
/// let answer = grainlab_servo::answer(&request).unwrap();
/// // 10 kPa too little compression, over 200 MPa and 0.1 ms: compress at 0.5 per second.
/// assert!((answer.rate[0] + 0.5).abs() < 1e-15 && !answer.saturated[0]);
/// ```
pub fn answer(request: &Request) -> Result<Answer, ServoError> {
    error::check(request)?;
    let loop_stiffness = stability::loop_stiffness(&request.tangent, &request.controls);
    let mut answer = Answer { rate: [0.0; 6], saturated: [false; 6] };
    for (i, stress) in request.stress.voigt().into_iter().enumerate() {
        let wanted = match request.controls[i] {
            ComponentControl::Held => 0.0,
            ComponentControl::StrainRate(rate) => rate,
            ComponentControl::Stress(target) => law::rate(
                &request.law,
                &law::Component {
                    error: stress - target,
                    rate: request.rate[i],
                    own_stiffness: law::stiffness(&request.tangent, i),
                    loop_stiffness: loop_stiffness[i],
                    interval: request.control_interval,
                },
            ),
        };
        answer.rate[i] = wanted.clamp(-request.rate_limit, request.rate_limit);
        answer.saturated[i] = wanted.abs() > request.rate_limit;
    }
    Ok(answer)
}
