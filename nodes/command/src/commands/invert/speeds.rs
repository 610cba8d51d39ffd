//! Wave speeds of one state, for the models of smooth spheres: the moduli that fit them, with their covariance.

use super::speed_table::{SpeedLine, in_radians};
use super::state::State;
use grainlab_console::Failure;
use grainlab_core::notes::Note;
use grainlab_core::{Vec3, WaveSpeed};
use grainlab_emt::christoffel::moduli_from_speeds;
use grainlab_emt::{Conditions, Measured, Probe};
use grainlab_emt_inversion::notes_on_fit;
use grainlab_node_kit::Exit;

pub(super) const NO_DENSITY: &str =
    "column density is empty: give it, or grain_density and phi, or --density";

/// Densities closer than this relative difference are one.
const SAME_DENSITY: f64 = 1e-6;

/// Adds the moduli from speeds to a state, with notes on what the speeds do not determine, and on whether they contradict each
/// other. `name` is the name of the file. `by_flags` has the density and its standard deviation, for a file without them.
pub(super) fn add(
    state: &mut State,
    name: &str,
    lines: &[SpeedLine],
    by_flags: (Option<f64>, f64),
) -> Result<(), Failure> {
    let usage =
        |line: &SpeedLine, fault: &str| Failure::usage(format!("{name}: line {}: {fault}", line.line));
    if let Some(other) = lines.iter().find(|line| line.sample != lines[0].sample) {
        let (first, second) = (&lines[0].sample, &other.sample);
        return Err(usage(
            other,
            &format!("sample {second:?} after {first:?}: smooth spheres at one pressure are one sample"),
        ));
    }
    let phi = lines[0].phi.filter(|phi| lines.iter().all(|line| line.phi == Some(*phi)));
    state.conditions.solid_fraction = state.conditions.solid_fraction.or(phi.map(Measured::exact));
    let density = density_of(lines, by_flags).map_err(|(line, fault)| usage(line, &fault))?;
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
    state.notes.extend(in_radians(lines).map(Note::remark));
    // Waves are elastic.
    state.probe = Some(Probe::Sticking);
    state.moduli = fitted.observation.moduli;
    state.full_covariance = fitted.observation.covariance;
    Ok(())
}

/// The density of the one state of all rows, from their columns or else the flags, with its standard deviation; or a row and its fault.
fn density_of(
    lines: &[SpeedLine],
    (by_flag, stddev_by_flag): (Option<f64>, f64),
) -> Result<Measured, (&SpeedLine, String)> {
    let mut found: Option<(&SpeedLine, f64)> = None;
    for line in lines {
        let value = line.density().or(by_flag).ok_or_else(|| (line, NO_DENSITY.to_owned()))?;
        let (first, density) = *found.get_or_insert((line, value));
        if (value / density - 1.0).abs() > SAME_DENSITY {
            let fault = format!(
                "density {value} kg/m3, and {density} in line {}: speeds of one state have one density",
                first.line
            );
            return Err((line, fault));
        }
    }
    let stddevs = lines.iter().map(|line| line.density_sigma.unwrap_or(stddev_by_flag));
    let stddev = stddevs.sum::<f64>() / lines.len() as f64;
    Ok(Measured { value: found.map_or(f64::NAN, |(_, density)| density), stddev })
}
