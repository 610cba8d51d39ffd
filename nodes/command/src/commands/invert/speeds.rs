//! Wave speeds of one state, for the models of smooth spheres: the moduli that fit them, with their covariance.

use super::speed_table::{SpeedLine, in_radians};
use super::state::State;
use grainlab_console::Failure;
use grainlab_core::{Vec3, WaveSpeed};
use grainlab_emt::christoffel::moduli_from_speeds;
use grainlab_emt::{Conditions, Measured};
use grainlab_emt_inversion::notes_on_fit;
use grainlab_node_kit::Exit;

/// Adds the moduli from speeds to a state, with notes on what the speeds do not determine, and on whether they contradict each
/// other. `name` is that of the file.
pub(super) fn add(
    state: &mut State,
    name: &str,
    lines: &[SpeedLine],
    density: Measured,
) -> Result<(), Failure> {
    let usage =
        |line: &SpeedLine, fault: &str| Failure::usage(format!("{name}: line {}: {fault}", line.line));
    let speed = |line: &SpeedLine| {
        let (direction, polarization) = line.way.ok_or_else(|| {
            usage(line, "give angle_deg and mode, or direction_x to _z and polarization_x to _z")
        })?;
        let speed = line.speed.ok_or_else(|| usage(line, "column speed is empty"))?;
        let shared = line.speed_shared_sigma.unwrap_or(0.0);
        Ok(WaveSpeed {
            direction,
            polarization,
            speed,
            stddev: line.speed_sigma.map(|own| own.hypot(shared)),
        })
    };
    let speeds = lines.iter().map(speed).collect::<Result<Vec<_>, Failure>>()?;
    let conditions = Conditions { pressure: state.conditions.pressure, ..Conditions::default() };
    let fitted = moduli_from_speeds(&speeds, density, Some(Vec3::z()), conditions).map_err(|e| {
        let exit = if e.is_input_error() { Exit::Usage } else { Exit::PhysicsInvalid };
        Failure::new(exit, format!("{name}: {e}"))
    })?;
    state.notes = notes_on_fit(&fitted, speeds.len(), |at| format!("that of line {}", lines[at].line));
    state.notes.extend(in_radians(lines));
    state.in_conflict = fitted.conflict.is_some();
    state.moduli = fitted.observation.moduli;
    state.full_covariance = fitted.observation.covariance;
    Ok(())
}
