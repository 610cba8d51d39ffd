//! `Stress`: one request of the lockstep.

use super::check::{Check, Component, header, tensor_message};
use super::error::BoundaryError;
use crate::msg::Stress;
use crate::{simulated_seconds, stamp};
use grainlab_core::{ComponentControl, ServoLaw, SymTensor};
use grainlab_servo::{ServoInput, ServoRequest};

const CHECK: Check = Check("Stress");

impl TryFrom<&Stress> for ServoRequest {
    type Error = BoundaryError;

    fn try_from(m: &Stress) -> Result<Self, BoundaryError> {
        CHECK.header(&m.header)?;
        let mut controls = [ComponentControl::Held; 6];
        for (i, control) in controls.iter_mut().enumerate() {
            let setpoint = CHECK.finite(Component("setpoint", i), m.setpoint[i])?;
            *control = match m.mode[i] {
                Stress::MODE_HELD => ComponentControl::Held,
                Stress::MODE_STRESS => ComponentControl::Stress(setpoint),
                Stress::MODE_STRAIN_RATE => ComponentControl::StrainRate(setpoint),
                other => {
                    let allowed = "0 (held), 1 (stress), 2 (strain rate)";
                    return Err(CHECK.code(Component("mode", i), other, allowed));
                }
            };
        }
        Ok(Self {
            sequence: m.sequence,
            step: m.step,
            phase: m.phase,
            time: simulated_seconds(&m.header.stamp),
            input: ServoInput {
                stress: CHECK.tensor("stress", &m.stress)?,
                controls,
                rate: CHECK.six("rate", &m.rate)?,
                rate_limit: CHECK.not_negative("rate_limit", m.rate_limit)?,
                law: law(m)?,
                tangent: CHECK
                    .optional("tangent", &m.tangent, |field, t| CHECK.tensor(field, t))?
                    .map(|t| t.voigt()),
                control_interval: CHECK.positive("control_interval", m.control_interval)?,
            },
            asymmetry: CHECK.not_negative("asymmetry", m.asymmetry)?,
            strain: CHECK.tensor("strain", &m.strain)?,
            solid_fraction: CHECK.positive("solid_fraction", m.solid_fraction)?,
            coordination: CHECK.not_negative("coordination", m.coordination)?,
            unbalanced: CHECK.not_negative("unbalanced_force_ratio", m.unbalanced_force_ratio)?,
        })
    }
}

fn law(m: &Stress) -> Result<ServoLaw, BoundaryError> {
    match m.law {
        Stress::LAW_SCALED => {
            Ok(ServoLaw::Scaled { response_time: CHECK.positive("response_time", m.response_time)? })
        }
        Stress::LAW_INTEGRAL => Ok(ServoLaw::Integral {
            gain: CHECK.not_negative("gain", m.gain)?,
            leak: CHECK.share("leak", m.leak)?,
        }),
        Stress::LAW_NORMALISED => Ok(ServoLaw::Normalised {
            share: CHECK.positive("gain", m.gain)?,
            leak: CHECK.share("leak", m.leak)?,
        }),
        other => Err(CHECK.code("law", other, "0 (scaled), 1 (integral), 2 (normalised)")),
    }
}

/// True if all numbers are finite that a simulation computes, and that are not when it becomes unstable.
fn is_finite(r: &ServoRequest) -> bool {
    let ServoInput { stress, rate, tangent, control_interval, .. } = &r.input;
    let tensors = [stress.voigt(), *rate, tangent.unwrap_or_default(), r.strain.voigt()];
    let numbers = [*control_interval, r.asymmetry, r.solid_fraction, r.coordination, r.unbalanced];
    tensors.as_flattened().iter().chain(&numbers).all(|v| v.is_finite())
}

impl TryFrom<&ServoRequest> for Stress {
    type Error = BoundaryError;

    fn try_from(r: &ServoRequest) -> Result<Self, BoundaryError> {
        let input = &r.input;
        let (law, gain, leak, response_time) = match input.law {
            ServoLaw::Scaled { response_time } => (Stress::LAW_SCALED, 0.0, 0.0, response_time),
            ServoLaw::Integral { gain, leak } => (Stress::LAW_INTEGRAL, gain, leak, 0.0),
            ServoLaw::Normalised { share, leak } => (Stress::LAW_NORMALISED, share, leak, 0.0),
        };
        let control = input.controls.map(|c| match c {
            ComponentControl::Held => (Stress::MODE_HELD, 0.0),
            ComponentControl::Stress(setpoint) => (Stress::MODE_STRESS, setpoint),
            ComponentControl::StrainRate(setpoint) => (Stress::MODE_STRAIN_RATE, setpoint),
        });
        let message = Stress {
            header: header(stamp(r.time)),
            sequence: r.sequence,
            step: r.step,
            phase: r.phase,
            stress: tensor_message(&input.stress),
            asymmetry: r.asymmetry,
            mode: control.map(|c| c.0),
            setpoint: control.map(|c| c.1),
            rate: input.rate,
            rate_limit: input.rate_limit,
            law,
            gain,
            leak,
            response_time,
            tangent: input.tangent.map(|t| tensor_message(&SymTensor::from_voigt(t))).into_iter().collect(),
            control_interval: input.control_interval,
            strain: tensor_message(&r.strain),
            solid_fraction: r.solid_fraction,
            coordination: r.coordination,
            unbalanced_force_ratio: r.unbalanced,
        };
        if !is_finite(r) {
            ServoRequest::try_from(&message)?;
        }
        debug_assert_eq!(ServoRequest::try_from(&message).err(), None);
        Ok(message)
    }
}
