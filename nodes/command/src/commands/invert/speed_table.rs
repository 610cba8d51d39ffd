//! The rows of a table of wave speeds.

use super::slips;
use csv::StringRecord;
use grainlab_console::{Failure, separated};
use grainlab_core::Vec3;
use grainlab_emt::SpeedMode;
use std::path::Path;

/// The columns: what is of the sample and the state; the wave, by an angle to the axis with a mode or by a direction with a
/// polarization; and the speed.
pub(crate) const COLUMNS: [&str; 27] = [
    "sample",
    "pressure_pa",
    "pressure_sigma_pa",
    "density",
    "density_sigma",
    "grain_density",
    "phi",
    "diameter",
    "roughness",
    "roughness_sigma",
    "frequency",
    "direction",
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
    "speed_shared_sigma",
    "p_pa",
    "p_kpa",
    "pressure_kpa",
    "density_g_cm3",
];

/// Columns in other units or words: the column that is read, and the factor to it.
const ALIASES: [(&str, &str, f64); 4] = [
    ("p_pa", "pressure_pa", 1.0),
    ("p_kpa", "pressure_pa", 1e3),
    ("pressure_kpa", "pressure_pa", 1e3),
    ("density_g_cm3", "density", 1e3),
];

/// One row; lengths in m, speeds in m/s, other units as in the names of the columns.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(crate) struct SpeedLine {
    #[serde(skip_deserializing)]
    pub(super) line: u64,
    #[serde(default)]
    pub(super) sample: String,
    pub(super) pressure_pa: Option<f64>,
    pub(super) pressure_sigma_pa: Option<f64>,
    pub(super) density: Option<f64>,
    pub(super) density_sigma: Option<f64>,
    pub(super) grain_density: Option<f64>,
    pub(super) phi: Option<f64>,
    pub(super) diameter: Option<f64>,
    pub(super) roughness: Option<f64>,
    pub(super) roughness_sigma: Option<f64>,
    pub(super) frequency: Option<f64>,
    direction: Option<String>,
    angle_deg: Option<f64>,
    mode: Option<String>,
    direction_x: Option<f64>,
    direction_y: Option<f64>,
    direction_z: Option<f64>,
    polarization_x: Option<f64>,
    polarization_y: Option<f64>,
    polarization_z: Option<f64>,
    /// `None` is predicted.
    pub(super) speed: Option<f64>,
    pub(super) speed_sigma: Option<f64>,
    /// Error that all rows of this mode and direction share.
    pub(super) speed_shared_sigma: Option<f64>,
    /// Direction and polarization; `None` if the direction is not known.
    #[serde(skip)]
    pub(crate) way: Option<(Vec3, Vec3)>,
    /// The mode in the plane of axis e3 and direction, and the angle between both, rad.
    #[serde(skip, default = "longitudinal")]
    pub(super) wave: (SpeedMode, Option<f64>),
}

impl SpeedLine {
    /// Returns the density, kg/m³: the one that the row states, or the density of its grains times their solid fraction.
    pub(super) fn density(&self) -> Option<f64> {
        self.density.or(self.grain_density.zip(self.phi).map(|(density, phi)| density * phi))
    }
}

fn longitudinal() -> (SpeedMode, Option<f64>) {
    (SpeedMode::P, None)
}

/// sin of an angle up to which a direction is that of the axis.
const AXIAL: f64 = 1e-3;

/// cos of the angle up to which a motion is that of a mode.
const CLEAR: f64 = 0.9;

/// The name of a file in messages, and its rows; `-` is the standard input.
pub(super) fn read(path: &Path) -> Result<(String, Vec<SpeedLine>), Failure> {
    let (name, text) = separated::read(path)?;
    let lines = parsed(&text).map_err(|fault| Failure::usage(format!("{name}: {fault}")))?;
    Ok((name, lines))
}

/// The rows of a table, or the first fault with its line.
fn parsed(text: &str) -> Result<Vec<SpeedLine>, String> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(text.as_bytes());
    let header = reader.headers().map_err(|e| e.to_string())?.clone();
    checked_header(&header, &COLUMNS, &["speed"])?;
    let mut lines = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| e.to_string())?;
        let line = record.position().map_or(0, csv::Position::line);
        if record.iter().all(str::is_empty) {
            continue;
        }
        let row = row(&header, &record).map_err(|fault| format!("line {line}: {fault}"))?;
        lines.push(SpeedLine { line, ..row });
    }
    if lines.iter().all(|l| l.speed.is_none()) {
        return Err("there is no measured speed below the header".to_owned());
    }
    Ok(lines)
}

/// Refuses a header with unknown columns without a leading underscore, columns that are there twice, and without one that is needed.
pub(crate) fn checked_header(header: &StringRecord, columns: &[&str], needed: &[&str]) -> Result<(), String> {
    let known = || columns.join(", ");
    for (at, column) in header.iter().enumerate() {
        if let Some(other) = header.iter().take(at).find(|other| read_as(other).0 == read_as(column).0) {
            return Err(match other == column {
                true => format!("column {column} is there twice"),
                false => format!("columns {other} and {column} are one quantity: keep one of them"),
            });
        }
        if columns.contains(&column) || column.starts_with('_') {
            continue;
        }
        let hint = match slips::meant(column, columns) {
            Some(meant) => format!(" (did you mean {meant}?)"),
            None => String::new(),
        };
        return Err(format!("column {column} is unknown{hint}; columns are {}", known()));
    }
    match needed.iter().find(|name| !header.iter().any(|column| column == **name)) {
        Some(missing) => Err(format!("there is no column {missing}; columns are {}", known())),
        None => Ok(()),
    }
}

/// The column that a column is read as, and the factor to it.
fn read_as(column: &str) -> (&str, f64) {
    ALIASES
        .into_iter()
        .find(|(name, ..)| *name == column)
        .map_or((column, 1.0), |(_, name, factor)| (name, factor))
}

fn in_unit(cell: &str, factor: f64) -> String {
    let scaled = cell.parse::<f64>().ok().filter(|_| factor != 1.0).map(|value| (factor * value).to_string());
    scaled.unwrap_or_else(|| cell.to_owned())
}

/// A row without a speed, as a table would have it; `extra` are further columns.
pub(super) fn planned(
    pressure: f64,
    mode: &str,
    angle: Option<f64>,
    extra: &[(&str, Option<f64>)],
) -> Result<SpeedLine, String> {
    let cell = |value: Option<f64>| value.map(|v| v.to_string()).unwrap_or_default();
    let names = ["pressure_pa", "mode", "angle_deg"].into_iter().chain(extra.iter().map(|(name, _)| *name));
    let first = [cell(Some(pressure)), mode.to_owned(), cell(angle)].into_iter();
    row(&names.collect(), &first.chain(extra.iter().map(|(_, value)| cell(*value))).collect())
}

/// A note on angles that are probably in radians.
pub(super) fn in_radians(lines: &[SpeedLine]) -> Option<String> {
    let largest = lines.iter().filter_map(|l| l.angle_deg).fold(0.0, f64::max);
    (largest > 0.0 && largest < 3.2).then(|| {
        format!("no angle_deg is larger than {largest}: degrees are expected, and these look like radians")
    })
}

pub(crate) fn row(header: &StringRecord, record: &StringRecord) -> Result<SpeedLine, String> {
    if record.len() != header.len() {
        return Err(format!("{} cells under {} columns", record.len(), header.len()));
    }
    let read: StringRecord = header.iter().map(|column| read_as(column).0).collect();
    let cells: StringRecord =
        header.iter().zip(record).map(|(column, cell)| in_unit(cell, read_as(column).1)).collect();
    let mut row: SpeedLine = cells.deserialize(Some(&read)).map_err(|e| not_a_number(&e, header, record))?;
    for (column, value) in [
        ("pressure_pa", row.pressure_pa),
        ("density", row.density),
        ("grain_density", row.grain_density),
        ("diameter", row.diameter),
        ("frequency", row.frequency),
        ("speed", row.speed),
    ] {
        if let Some(value) = value.filter(|v| !(*v > 0.0 && v.is_finite())) {
            return Err(format!("{column} = {value} must be positive and finite"));
        }
    }
    for (column, value) in [
        ("pressure_sigma_pa", row.pressure_sigma_pa),
        ("density_sigma", row.density_sigma),
        ("roughness", row.roughness),
        ("roughness_sigma", row.roughness_sigma),
        ("speed_shared_sigma", row.speed_shared_sigma),
    ] {
        if let Some(value) = value.filter(|v| !(*v >= 0.0 && v.is_finite())) {
            return Err(format!("{column} = {value} must be 0 or more and finite"));
        }
    }
    if let Some(sigma) = row.speed_sigma.filter(|s| !(*s > 0.0 && s.is_finite())) {
        return Err(format!(
            "speed_sigma = {sigma} must be positive and finite; leave it empty if it is not known"
        ));
    }
    if let Some(phi) = row.phi.filter(|phi| !(0.3..0.8).contains(phi)) {
        return Err(format!("phi = {phi} must be a solid fraction, from 0.3 to 0.8"));
    }
    row.way = way(&row)?;
    row.wave = match row.way {
        None if row.mode.as_deref().is_some_and(|m| m.eq_ignore_ascii_case("p")) => (SpeedMode::P, None),
        None => (SpeedMode::Sv, None),
        Some((direction, polarization)) => mode_of(&direction, &polarization)?,
    };
    Ok(row)
}

/// Direction and polarization of a row; `None` for P or S of unknown direction.
fn way(row: &SpeedLine) -> Result<Option<(Vec3, Vec3)>, String> {
    let vector = |x: Option<f64>, y: Option<f64>, z: Option<f64>| Some(Vec3::new(x?, y?, z?));
    let direction = vector(row.direction_x, row.direction_y, row.direction_z);
    let polarization = vector(row.polarization_x, row.polarization_y, row.polarization_z);
    let named = row.direction.as_deref().map(str::to_ascii_lowercase);
    let angle = match (row.angle_deg, named.as_deref()) {
        (Some(_), Some(_)) => return Err("give angle_deg or direction, not both".to_owned()),
        (angle, None) => angle,
        (None, Some("along")) => Some(0.0),
        (None, Some("across")) => Some(90.0),
        (None, Some(text)) => Some(text.parse::<f64>().map_err(|_| {
            format!(
                "direction {text:?} must be along (the axis of the sample, vertical in most), across (horizontal in most), or the angle to \
                 the axis in degrees"
            )
        })?),
    };
    match (angle, row.mode.as_deref(), direction, polarization) {
        (Some(angle), Some(mode), None, None) => along(angle, mode).map(Some),
        (None, None, Some(direction), Some(polarization)) => Ok(Some((unit(direction)?, unit(polarization)?))),
        (None, Some(mode), None, None) if ["p", "s"].contains(&mode.to_ascii_lowercase().as_str()) => Ok(None),
        (None, Some(mode), None, None) => Err(format!(
            "mode {mode:?} without a direction must be p or s; sv and sh need direction or angle_deg"
        )),
        _ => Err("give mode, with direction or angle_deg if it is known, or direction_x to _z and polarization_x to _z".to_owned()),
    }
}

pub(crate) fn not_a_number(error: &csv::Error, header: &StringRecord, record: &StringRecord) -> String {
    let at = match error.kind() {
        csv::ErrorKind::Deserialize { err, .. } => err.field().map_or(0, |field| field as usize),
        _ => 0,
    };
    let cell = |of: &StringRecord| of.get(at).unwrap_or_default().to_owned();
    format!("column {}: {:?} is not a number", cell(header), cell(record))
}

fn unit(vector: Vec3) -> Result<Vec3, String> {
    let fault = || "a direction or polarization has no length".to_owned();
    vector.try_normalize(f64::MIN_POSITIVE).filter(|v| v.norm().is_finite()).ok_or_else(fault)
}

/// Direction at this angle to the axis, degrees, in the plane of e1 and e3, and the polarization of a mode.
fn along(angle: f64, mode: &str) -> Result<(Vec3, Vec3), String> {
    if !(0.0..=180.0).contains(&angle) {
        return Err(format!("angle = {angle} must be from 0 to 180 degrees"));
    }
    let (sin, cos) = angle.to_radians().sin_cos();
    let direction = Vec3::new(sin, 0.0, cos);
    let polarization = match mode.to_ascii_lowercase().as_str() {
        "p" => direction,
        "s" if sin.abs() > AXIAL => {
            return Err("mode s is two modes across the axis: sv (moves in the plane of wave and axis) or sh (across it)".to_owned());
        }
        "s" | "sv" => Vec3::new(cos, 0.0, -sin),
        "sh" => Vec3::y(),
        _ => {
            return Err(format!(
                "mode {mode:?} must be p, s, sv (moves in the plane of wave and axis) or sh (across it)"
            ));
        }
    };
    Ok((direction, polarization))
}

/// The mode of a motion, and the angle of the direction to the axis e3, rad.
fn mode_of(direction: &Vec3, polarization: &Vec3) -> Result<(SpeedMode, Option<f64>), String> {
    let across = direction.xy().norm();
    let angle = across.atan2(direction.z.abs());
    let normal = direction.cross(&Vec3::z()).try_normalize(AXIAL);
    let sideways = normal.map_or(0.0, |n| n.dot(polarization).abs());
    let mode = match direction.dot(polarization).abs() {
        p if p > CLEAR => SpeedMode::P,
        p if p < 1.0 - CLEAR && sideways > CLEAR => SpeedMode::Sh,
        p if p < 1.0 - CLEAR && sideways < 1.0 - CLEAR => SpeedMode::Sv,
        _ => return Err("the polarization is between those of two modes".to_owned()),
    };
    Ok((mode, Some(angle)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_with_modes_and_vectors_are_the_same_waves() {
        let by_angle =
            parsed("angle_deg,mode,speed,speed_sigma\n0,P,500,1\n90,SH,300,\n45,sv,310,2\n").unwrap();
        assert_eq!(by_angle[0].way.unwrap().0, Vec3::z());
        assert_eq!((by_angle[1].way.unwrap().1, by_angle[1].speed_sigma), (Vec3::y(), None));
        assert_eq!(by_angle[1].wave, (SpeedMode::Sh, Some(90f64.to_radians())));
        let (direction, polarization) = by_angle[2].way.unwrap();
        assert!(direction.dot(&polarization).abs() < 1e-15 && by_angle[2].wave.0 == SpeedMode::Sv);
        let header = "direction_x,direction_y,direction_z,polarization_x,polarization_y,polarization_z,speed";
        let by_vector = parsed(&format!("{header}\n0,0,2,0,0,-1,500\n")).unwrap();
        assert_eq!((by_vector[0].way.unwrap().0, by_vector[0].speed), (Vec3::z(), Some(500.0)));
        let named = parsed("direction,mode,speed\nalong,s,300\nacross,p,\n,s,290\n").unwrap();
        let waves = named.iter().map(|l| l.wave).collect::<Vec<_>>();
        let across = Some(90f64.to_radians());
        assert_eq!(waves, [(SpeedMode::Sv, Some(0.0)), (SpeedMode::P, across), (SpeedMode::Sv, None)]);
    }

    #[test]
    fn pressures_in_kpa_and_densities_in_g_per_cm3_are_read_in_si() {
        let read =
            parsed("pressure_kpa,density_g_cm3,mode,speed,speed_shared_sigma\n50,1.6,p,500,2\n,,s,300,\n")
                .unwrap();
        assert_eq!((read[0].pressure_pa, read[0].density), (Some(5e4), Some(1600.0)));
        assert_eq!((read[0].speed_shared_sigma, read[1].pressure_pa), (Some(2.0), None));
    }

    #[test]
    fn angles_that_are_all_small_look_like_radians() {
        let found = |second: f64| {
            in_radians(&parsed(&format!("angle_deg,mode,speed\n0,p,500\n{second},p,480\n")).unwrap())
        };
        assert!(found(1.55).unwrap().contains("look like radians"));
        assert_eq!((found(0.0), found(90.0)), (None, None));
    }

    #[test]
    fn each_fault_is_named_with_its_line() {
        for (text, fault) in [
            ("angle_deg,mode,speed\n", "no measured speed below the header"),
            ("angle_deg,mode,speed\n0,p,-5\n", "line 2: speed = -5"),
            ("angle_deg,mode,speed\n0,p,500\n0,x,500\n", "line 3: mode \"x\""),
            ("angle_deg,mode,speed\n0,,500\n", "line 2: give mode, with direction or angle_deg"),
            ("angle_deg,mode,speed\n90,s,500\n", "line 2: mode s is two modes"),
            ("angle_deg,mode,speed\n,sv,500\n", "line 2: mode \"sv\" without a direction"),
            ("angle_deg,mode,speed,speed_sigma\nnan,p,500,1\n", "line 2: angle = NaN"),
            ("angle_deg,mode,speed\n400,p,500\n", "line 2: angle = 400"),
            ("angle_deg,mode,_velocity\n0,p,500\n", "there is no column speed"),
            ("angle_deg,mode,velocity\n0,p,500\n", "column velocity is unknown; columns are sample"),
            ("pressure_pa,phi,mode,speed\n1e5,62,p,500\n", "line 2: phi = 62"),
            (
                "angle_deg,mode,speed,sigma\n0,p,500,1\n",
                "column sigma is unknown (did you mean speed_sigma?); columns are",
            ),
            ("Angle_deg,mode,speed\n0,p,500\n", "column Angle_deg is unknown (did you mean angle_deg?)"),
            (
                "direction,mode,speed\nvertical,p,500\n",
                "must be along (the axis of the sample, vertical in most)",
            ),
            ("p_kpa,pressure_pa,mode,speed\n", "columns p_kpa and pressure_pa are one quantity"),
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
