//! `Stress`: one request of the lockstep.

use super::check::{Check, component, header, tensor_message};
use super::error::BoundaryError;
use crate::builtin_interfaces::Time;
use crate::msg::Stress;
use grainlab_core::{ComponentControl, ServoLaw, SymTensor};

const CHECK: Check = Check("Stress");

/// One request of the lockstep, with all data for the servo. Voigt order xx, yy, zz, yz, xz, xy, tensor
/// components.
#[derive(Clone, Debug, PartialEq)]
pub struct StressRequest {
    /// Counts requests from 0.
    pub sequence: u64,
    /// Solver steps done.
    pub step: u64,
    /// Number of the phase in the loading path, from 1.
    pub phase: u32,
    /// 10⁹ s + simulated time.
    pub stamp: Time,
    /// Stress, Pa, positive in compression.
    pub stress: SymTensor,
    /// Largest |σ_ij − σ_ji| before the symmetric part was taken, Pa. 0 or more.
    pub asymmetry: f64,
    /// What is imposed on each component.
    pub controls: [ComponentControl; 6],
    /// Strain rate in force, 1/s, positive in extension.
    pub rate: [f64; 6],
    /// Largest magnitude of a component of the answer, 1/s. 0 or more.
    pub rate_limit: f64,
    /// Control law.
    pub law: ServoLaw,
    /// Affine tangent stiffness of the present contacts, Pa: C_iiii (xx, yy, zz) and C_ijij (yz, xz, xy).
    pub tangent: [f64; 6],
    /// Simulated time until the next request, s. More than 0.
    pub control_interval: f64,
    /// Logarithmic strain since the reference state, positive in extension.
    pub strain: SymTensor,
    /// Solid fraction φ. More than 0.
    pub solid_fraction: f64,
    /// Coordination number k. 0 or more.
    pub coordination: f64,
    /// Mean net force of non-rattlers over mean contact force, 1 without contacts.
    pub unbalanced: f64,
}

impl TryFrom<&Stress> for StressRequest {
    type Error = BoundaryError;

    fn try_from(m: &Stress) -> Result<Self, BoundaryError> {
        CHECK.header(&m.header)?;
        let mut controls = [ComponentControl::Held; 6];
        for (i, control) in controls.iter_mut().enumerate() {
            let setpoint = CHECK.finite(&component("setpoint", i), m.setpoint[i])?;
            *control = match m.mode[i] {
                Stress::MODE_HELD => ComponentControl::Held,
                Stress::MODE_STRESS => ComponentControl::Stress(setpoint),
                Stress::MODE_STRAIN_RATE => ComponentControl::StrainRate(setpoint),
                other => {
                    let allowed = "0 (held), 1 (stress), 2 (strain rate)";
                    return Err(CHECK.code(&component("mode", i), other, allowed));
                }
            };
        }
        Ok(Self {
            sequence: m.sequence,
            step: m.step,
            phase: m.phase,
            stamp: m.header.stamp,
            stress: CHECK.tensor("stress", &m.stress)?,
            asymmetry: CHECK.not_negative("asymmetry", m.asymmetry)?,
            controls,
            rate: CHECK.six("rate", &m.rate)?,
            rate_limit: CHECK.not_negative("rate_limit", m.rate_limit)?,
            law: law(m)?,
            tangent: CHECK.tensor("tangent", &m.tangent)?.voigt(),
            control_interval: CHECK.positive("control_interval", m.control_interval)?,
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

impl TryFrom<&StressRequest> for Stress {
    type Error = BoundaryError;

    fn try_from(r: &StressRequest) -> Result<Self, BoundaryError> {
        let (law, gain, leak, response_time) = match r.law {
            ServoLaw::Scaled { response_time } => (Stress::LAW_SCALED, 0.0, 0.0, response_time),
            ServoLaw::Integral { gain, leak } => (Stress::LAW_INTEGRAL, gain, leak, 0.0),
            ServoLaw::Normalised { share, leak } => (Stress::LAW_NORMALISED, share, leak, 0.0),
        };
        let control = r.controls.map(|c| match c {
            ComponentControl::Held => (Stress::MODE_HELD, 0.0),
            ComponentControl::Stress(setpoint) => (Stress::MODE_STRESS, setpoint),
            ComponentControl::StrainRate(setpoint) => (Stress::MODE_STRAIN_RATE, setpoint),
        });
        let message = Stress {
            header: header(r.stamp),
            sequence: r.sequence,
            step: r.step,
            phase: r.phase,
            stress: tensor_message(&r.stress),
            asymmetry: r.asymmetry,
            mode: control.map(|c| c.0),
            setpoint: control.map(|c| c.1),
            rate: r.rate,
            rate_limit: r.rate_limit,
            law,
            gain,
            leak,
            response_time,
            tangent: tensor_message(&SymTensor::from_voigt(r.tangent)),
            control_interval: r.control_interval,
            strain: tensor_message(&r.strain),
            solid_fraction: r.solid_fraction,
            coordination: r.coordination,
            unbalanced_force_ratio: r.unbalanced,
        };
        StressRequest::try_from(&message)?;
        Ok(message)
    }
}
