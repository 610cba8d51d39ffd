//! Wave speeds of a laboratory, from a table: the moduli that fit them, with their covariance.

use super::state::State;
use grainlab_console::{Failure, say};
use grainlab_core::{Vec3, WaveSpeed};
use grainlab_emt::christoffel::{SpeedFit, moduli_from_speeds};
use grainlab_emt::{Conditions, Measured};
use grainlab_node_kit::Exit;
use serde::Deserialize;
use std::io::Read;
use std::path::Path;

/// One speed, as written. The direction is an angle to the axis with a mode, or a direction with a polarization.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    angle_deg: Option<f64>,
    mode: Option<String>,
    direction_x: Option<f64>,
    direction_y: Option<f64>,
    direction_z: Option<f64>,
    polarization_x: Option<f64>,
    polarization_y: Option<f64>,
    polarization_z: Option<f64>,
    speed: f64,
    speed_sigma: Option<f64>,
}

/// Adds the moduli from the speeds of a file, or of the standard input for `-`, to a state. Says on stderr what the speeds
/// do not determine, and whether they contradict each other.
pub(super) fn add(state: &mut State, path: &Path, density: Measured) -> Result<(), Failure> {
    let name = if path.as_os_str() == "-" { "standard input".to_owned() } else { path.display().to_string() };
    let unreadable = |e: std::io::Error| Failure::failed(format!("{name}: {e}"));
    let mut text = String::new();
    if path.as_os_str() == "-" {
        std::io::stdin().read_to_string(&mut text).map_err(unreadable)?;
    } else {
        text = std::fs::read_to_string(path).map_err(unreadable)?;
    }
    let speeds = parsed(&text).map_err(|fault| Failure::usage(format!("{name}: {fault}")))?;
    let conditions = Conditions { pressure: state.pressure, ..Conditions::at(state.pressure.value) };
    let fitted = moduli_from_speeds(&speeds, density, Some(Vec3::z()), conditions).map_err(|e| {
        let exit = if e.is_input_error() { Exit::Usage } else { Exit::PhysicsInvalid };
        Failure::new(exit, format!("{name}: {e}"))
    })?;
    tell(&name, &fitted, &speeds);
    state.moduli = fitted.observation.moduli;
    state.full_covariance = fitted.observation.covariance;
    Ok(())
}

fn tell(name: &str, fitted: &SpeedFit, speeds: &[WaveSpeed]) {
    if !fitted.undetermined.is_empty() {
        let open: Vec<&str> = fitted.undetermined.iter().map(|m| m.name()).collect();
        say!("grainlab: {name}: the speeds do not determine {}", open.join(", "));
    }
    if let Some(scatter) = &fitted.anisotropy_scatter {
        say!(
            "grainlab: {name}: rho v^2 scatters by {:.1} % about a medium isotropic about the axis, more than the errors: added \
             to the error of every speed",
            100.0 * scatter.scatter
        );
    }
    if let Some(conflict) = &fitted.conflict {
        say!(
            "grainlab: {name}: the speeds contradict each other: that of line {} is {:.1} sigma from the prediction by the others",
            conflict.worst + 2,
            conflict.sigma
        );
    }
    if fitted.assumed > 0 {
        say!(
            "grainlab: {name}: {} of {} speeds have no speed_sigma: the largest relative one of the others was taken",
            fitted.assumed,
            speeds.len()
        );
    }
}

/// The speeds of a table, or the first fault with its line.
fn parsed(text: &str) -> Result<Vec<WaveSpeed>, String> {
    let mut reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
    let mut speeds = Vec::new();
    for record in reader.deserialize::<Line>() {
        let line = record.map_err(|e| e.to_string())?;
        let number = speeds.len() + 2;
        speeds.push(wave(&line).map_err(|fault| format!("line {number}: {fault}"))?);
    }
    if speeds.is_empty() {
        return Err("there is no speed below the header".to_owned());
    }
    Ok(speeds)
}

fn wave(line: &Line) -> Result<WaveSpeed, String> {
    if !(line.speed > 0.0 && line.speed.is_finite()) {
        return Err(format!("speed = {} must be positive and finite", line.speed));
    }
    if let Some(sigma) = line.speed_sigma.filter(|s| !(*s >= 0.0 && s.is_finite())) {
        return Err(format!("speed_sigma = {sigma} must be 0 or more and finite"));
    }
    let vector = |x: Option<f64>, y: Option<f64>, z: Option<f64>| {
        x.zip(y).zip(z).map(|((x, y), z)| Vec3::new(x, y, z))
    };
    let direction = vector(line.direction_x, line.direction_y, line.direction_z);
    let polarization = vector(line.polarization_x, line.polarization_y, line.polarization_z);
    let (direction, polarization) = match (line.angle_deg, &line.mode, direction, polarization) {
        (Some(angle), Some(mode), None, None) => along(angle, mode)?,
        (None, None, Some(direction), Some(polarization)) => (unit(direction)?, unit(polarization)?),
        _ => return Err("give angle_deg and mode, or direction_x to _z and polarization_x to _z".to_owned()),
    };
    let stddev = line.speed_sigma.filter(|s| *s > 0.0);
    Ok(WaveSpeed { direction, polarization, speed: line.speed, stddev })
}

fn unit(vector: Vec3) -> Result<Vec3, String> {
    vector
        .try_normalize(f64::MIN_POSITIVE)
        .ok_or_else(|| "a direction or polarization has no length".to_owned())
}

/// Direction at this angle to the axis, degrees, in the plane of e1 and e3, and the polarization of a mode.
fn along(angle: f64, mode: &str) -> Result<(Vec3, Vec3), String> {
    if !angle.is_finite() {
        return Err(format!("angle_deg = {angle} is not finite"));
    }
    let (sin, cos) = angle.to_radians().sin_cos();
    let direction = Vec3::new(sin, 0.0, cos);
    let polarization = match mode.to_ascii_lowercase().as_str() {
        "p" => direction,
        "sv" => Vec3::new(cos, 0.0, -sin),
        "sh" => Vec3::y(),
        _ => {
            return Err(format!(
                "mode {mode:?} must be p, sv (moves in the plane of wave and axis) or sh (across it)"
            ));
        }
    };
    Ok((direction, polarization))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_with_modes_and_vectors_are_the_same_waves() {
        let by_angle =
            parsed("angle_deg,mode,speed,speed_sigma\n0,P,500,1\n90,SH,300,\n45,sv,310,2\n").unwrap();
        assert_eq!(by_angle[0].direction, Vec3::z());
        assert_eq!((by_angle[1].polarization, by_angle[1].stddev), (Vec3::y(), None));
        assert!(by_angle[2].direction.dot(&by_angle[2].polarization).abs() < 1e-15);
        let header = "direction_x,direction_y,direction_z,polarization_x,polarization_y,polarization_z,speed";
        let by_vector = parsed(&format!("{header}\n0,0,2,0,0,-1,500\n")).unwrap();
        assert_eq!((by_vector[0].direction, by_vector[0].speed), (Vec3::z(), 500.0));
    }

    #[test]
    fn each_fault_is_named_with_its_line() {
        for (text, fault) in [
            ("angle_deg,mode,speed\n", "no speed below the header"),
            ("angle_deg,mode,speed\n0,p,-5\n", "line 2: speed = -5"),
            ("angle_deg,mode,speed\n0,p,500\n0,x,500\n", "line 3: mode \"x\""),
            ("angle_deg,mode,speed\n0,,500\n", "line 2: give angle_deg and mode"),
            ("angle_deg,mode,speed,speed_sigma\nnan,p,500,1\n", "line 2: angle_deg = NaN"),
            ("angle_deg,mode,velocity\n0,p,500\n", "velocity"),
            ("angle_deg,mode,speed,speed_sigma\n0,p,500,-1\n", "line 2: speed_sigma = -1"),
        ] {
            let found = parsed(text).unwrap_err();
            assert!(found.contains(fault), "{text:?}: {found}");
        }
    }
}
