//! The parameters of the node.

use grainlab_core::Vec3;
use grainlab_micromechanics::TOLERANCES;
use grainlab_micromechanics::network::Springs;
use grainlab_micromechanics::probe::StrainProbe;
use grainlab_node_kit::{ParameterSpec, Parameters, Range, parameters};

/// The parameters of the node.
pub fn parameters() -> Vec<ParameterSpec> {
    let default = grainlab_micromechanics::Settings::default();
    let axis: Vec<f64> = default.axis.iter().copied().collect();
    parameters! {
        "tolerance" 0.0, Range::Double { min: 0.0, max: *TOLERANCES.end() },
            "relative residual at which the stiffness solve stops, from 1e-13, 1; 0: 1e-9, and 1e-5 from 50,000 grains";
        "axis" axis, Range::Double { min: -1e9, max: 1e9 },
            "axis of eps, of the ratios gamma/Delta and of G12 and G13: x, y, z, of any length above zero; messages include it; \
             the 36 entries of a stiffness stay in the frame of the cell";
        "method" "network", Range::Choice(&["network", "prestressed", "probe"]),
            "method of the stiffness: network (frozen), prestressed (the same for smooth grains, with the prestress term), \
             probe (small strains of the packing itself, a hundred times slower)";
        "springs" "carried", Range::Choice(&["carried", "both", "normal"]),
            "springs of the contacts: carried (no tangential ones in a packing without friction), both, normal; without effect \
             on the method prestressed, which has normal ones";
        "amplitude" StrainProbe::default().amplitude, Range::Double { min: 1e-12, max: 1e-2 }, "strain of the probe, 1";
    }
}

/// The values of the parameters: how a packing is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings(pub(crate) grainlab_micromechanics::Settings);

/// Parameters whose values are in range but invalid. The process then ends with
/// [`grainlab_node_kit::Exit::Usage`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// The axis has not three components, or only zeros.
    #[error(
        "parameter \"axis\" = {0:?} is not a direction: it must have three components that are not all zero"
    )]
    Axis(Vec<f64>),
    /// Finer than double precision allows.
    #[error("parameter \"tolerance\" = {0:e} is below 1e-13: it must be 1e-13 to 1e-5, or 0 for the default")]
    Tolerance(f64),
}

impl TryFrom<&Parameters> for Settings {
    type Error = SettingsError;

    fn try_from(parameters: &Parameters) -> Result<Self, SettingsError> {
        let axis: Vec<f64> = parameters.get("axis");
        let direction = <[f64; 3]>::try_from(axis.as_slice()).ok().map(Vec3::from).filter(|v| v.norm() > 0.0);
        let axis = direction.ok_or(SettingsError::Axis(axis))?;
        let tolerance = Some(parameters.get("tolerance")).filter(|t: &f64| *t > 0.0);
        if let Some(too_fine) = tolerance.filter(|t| t < TOLERANCES.start()) {
            return Err(SettingsError::Tolerance(too_fine));
        }
        let method: String = parameters.get("method");
        let amplitude = parameters.get("amplitude");
        let springs: String = parameters.get("springs");
        let (springs, friction) = match springs.as_str() {
            _ if method == "prestressed" => (Springs::PrestressedNormal, None),
            "both" => (Springs::NormalAndTangential, Some(f64::INFINITY)),
            "normal" => (Springs::Normal, Some(0.0)),
            _ => (Springs::Carried, None),
        };
        let probe = StrainProbe { amplitude, friction, ..StrainProbe::default() };
        Ok(Self(grainlab_micromechanics::Settings {
            tolerance,
            axis,
            springs,
            probe: (method == "probe").then_some(probe),
            ..grainlab_micromechanics::Settings::default()
        }))
    }
}
