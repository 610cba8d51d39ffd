//! Wave speeds of a laboratory, from a table: the moduli that fit them, with their covariance.

use super::slips;
use super::state::State;
use csv::StringRecord;
use grainlab_console::Failure;
use grainlab_core::{Vec3, WaveSpeed};
use grainlab_emt::christoffel::moduli_from_speeds;
use grainlab_emt::{Conditions, Measured};
use grainlab_emt_inversion::notes_on_fit;
use grainlab_node_kit::Exit;
use std::io::Read;
use std::path::Path;

/// The columns: an angle to the axis with a mode, or a direction with a polarization; and the speed.
const COLUMNS: [&str; 10] = [
    "angle_deg",
    "mode",
    "direction_x",
    "direction_y",
    "direction_z",
    "polarization_x",
    "polarization_y",
    "polarization_z",
    "speed",
    "speed_sigma",
];

/// A speed, and the line of the file on which it is.
type Measurement = (WaveSpeed, u64);

/// Adds the moduli from the speeds of a file, or of the standard input for `-`, to a state, with notes on what the speeds
/// do not determine, and on whether they contradict each other.
pub(super) fn add(state: &mut State, path: &Path, density: Measured) -> Result<(), Failure> {
    let name = if path.as_os_str() == "-" { "standard input".to_owned() } else { path.display().to_string() };
    let unreadable = |e: std::io::Error| Failure::failed(format!("{name}: {e}"));
    let mut text = String::new();
    if path.as_os_str() == "-" {
        std::io::stdin().read_to_string(&mut text).map_err(unreadable)?;
    } else {
        text = std::fs::read_to_string(path).map_err(unreadable)?;
    }
    let (speeds, lines): (Vec<WaveSpeed>, Vec<u64>) =
        parsed(&text).map_err(|fault| Failure::usage(format!("{name}: {fault}")))?.into_iter().unzip();
    let conditions = Conditions { pressure: state.conditions.pressure, ..Conditions::default() };
    let fitted = moduli_from_speeds(&speeds, density, Some(Vec3::z()), conditions).map_err(|e| {
        let exit = if e.is_input_error() { Exit::Usage } else { Exit::PhysicsInvalid };
        Failure::new(exit, format!("{name}: {e}"))
    })?;
    state.notes = notes_on_fit(&fitted, speeds.len(), |at| format!("that of line {}", lines[at]));
    state.in_conflict = fitted.conflict.is_some();
    state.moduli = fitted.observation.moduli;
    state.full_covariance = fitted.observation.covariance;
    Ok(())
}

/// The speeds of a table, or the first fault with its line.
fn parsed(text: &str) -> Result<Vec<Measurement>, String> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(text.trim_start_matches('\u{feff}').as_bytes());
    let header = reader.headers().map_err(|e| e.to_string())?.clone();
    checked(&header)?;
    let mut speeds = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| e.to_string())?;
        let line = record.position().map_or(0, csv::Position::line);
        let wave = wave(&header, &record).map_err(|fault| format!("line {line}: {fault}"))?;
        speeds.push((wave, line));
    }
    if speeds.is_empty() {
        return Err("there is no speed below the header".to_owned());
    }
    Ok(speeds)
}

/// Refuses unknown columns, and columns that are there twice.
fn checked(header: &StringRecord) -> Result<(), String> {
    for (at, column) in header.iter().enumerate() {
        if header.iter().take(at).any(|other| other == column) {
            return Err(format!("column {column} is there twice"));
        }
        if COLUMNS.contains(&column) {
            continue;
        }
        let hint = match slips::meant(column, &COLUMNS) {
            _ if column.contains([';', '\t']) => "; the separator must be a comma".to_owned(),
            Some(meant) => format!(" (did you mean {meant}?)"),
            None => "; pressure, density and grains are flags, because a file has the speeds of one state"
                .to_owned(),
        };
        return Err(format!("column {column} is unknown{hint}; columns are {}", COLUMNS.join(", ")));
    }
    if !header.iter().any(|column| column == "speed") {
        return Err(format!("there is no column speed; columns are {}", COLUMNS.join(", ")));
    }
    Ok(())
}

/// A line of the table.
#[derive(serde::Deserialize)]
struct Line {
    angle_deg: Option<f64>,
    mode: Option<String>,
    direction_x: Option<f64>,
    direction_y: Option<f64>,
    direction_z: Option<f64>,
    polarization_x: Option<f64>,
    polarization_y: Option<f64>,
    polarization_z: Option<f64>,
    speed: Option<f64>,
    speed_sigma: Option<f64>,
}

fn wave(header: &StringRecord, record: &StringRecord) -> Result<WaveSpeed, String> {
    if record.len() != header.len() {
        return Err(format!("{} cells under {} columns", record.len(), header.len()));
    }
    let line: Line = record.deserialize(Some(header)).map_err(|e| not_a_number(&e, header, record))?;
    let speed = line.speed.ok_or("column speed is empty")?;
    if !(speed > 0.0 && speed.is_finite()) {
        return Err(format!("speed = {speed} must be positive and finite"));
    }
    if let Some(sigma) = line.speed_sigma.filter(|s| !(*s >= 0.0 && s.is_finite())) {
        return Err(format!("speed_sigma = {sigma} must be 0 or more and finite"));
    }
    let vector = |x: Option<f64>, y: Option<f64>, z: Option<f64>| Some(Vec3::new(x?, y?, z?));
    let direction = vector(line.direction_x, line.direction_y, line.direction_z);
    let polarization = vector(line.polarization_x, line.polarization_y, line.polarization_z);
    let (direction, polarization) = match (line.angle_deg, line.mode.as_deref(), direction, polarization) {
        (Some(angle), Some(mode), None, None) => along(angle, mode)?,
        (None, None, Some(direction), Some(polarization)) => (unit(direction)?, unit(polarization)?),
        _ => return Err("give angle_deg and mode, or direction_x to _z and polarization_x to _z".to_owned()),
    };
    Ok(WaveSpeed { direction, polarization, speed, stddev: line.speed_sigma.filter(|s| *s > 0.0) })
}

/// The cell that could not be read.
fn not_a_number(error: &csv::Error, header: &StringRecord, record: &StringRecord) -> String {
    let at = match error.kind() {
        csv::ErrorKind::Deserialize { err, .. } => err.field().map_or(0, |field| field as usize),
        _ => 0,
    };
    let cell = |of: &StringRecord| of.get(at).unwrap_or_default().to_owned();
    format!("column {}: {:?} is not a number", cell(header), cell(record))
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
        let only = |text: &str| parsed(text).unwrap().into_iter().map(|(wave, _)| wave).collect::<Vec<_>>();
        let by_angle = only("angle_deg,mode,speed,speed_sigma\n0,P,500,1\n90,SH,300,\n45,sv,310,2\n");
        assert_eq!(by_angle[0].direction, Vec3::z());
        assert_eq!((by_angle[1].polarization, by_angle[1].stddev), (Vec3::y(), None));
        assert!(by_angle[2].direction.dot(&by_angle[2].polarization).abs() < 1e-15);
        let header = "direction_x,direction_y,direction_z,polarization_x,polarization_y,polarization_z,speed";
        let by_vector = only(&format!("{header}\n0,0,2,0,0,-1,500\n"));
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
            ("angle_deg,mode,velocity\n0,p,500\n", "column velocity is unknown; pressure, density"),
            (
                "angle_deg,mode,speed,sigma\n0,p,500,1\n",
                "column sigma is unknown (did you mean speed_sigma?); columns are",
            ),
            ("Angle_deg,mode,speed\n0,p,500\n", "column Angle_deg is unknown (did you mean angle_deg?)"),
            ("angle_deg;mode;speed\n0;p;500\n", "the separator must be a comma; columns are angle_deg"),
            ("angle_deg,mode,speed,speed\n0,p,500,1\n", "column speed is there twice"),
            ("angle_deg,mode\n0,p\n", "there is no column speed; columns are"),
            ("angle_deg,mode,speed\n0,p,fast\n", "line 2: column speed: \"fast\" is not a number"),
            ("# a note\nangle_deg,mode,speed\n# another\n0,p,500\n0,p\n", "line 5: 2 cells under 3 columns"),
            ("angle_deg,mode,speed,speed_sigma\n0,p,500,-1\n", "line 2: speed_sigma = -1"),
        ] {
            let found = parsed(text).unwrap_err();
            assert!(found.contains(fault) && !found.contains("CSV"), "{text:?}: {found}");
        }
    }
}
