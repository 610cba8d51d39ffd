//! States from a CSV file.

use super::Args;
use super::inputs::Inputs;
use crate::failure::Failure;
use std::path::Path;

/// Reads a table of states: a header line, then one state a line; lines that begin with `#` are comments.
pub(super) fn read(path: &Path, args: &Args) -> Result<Vec<Inputs>, Failure> {
    let text =
        std::fs::read_to_string(path).map_err(|e| Failure::failed(format!("{}: {e}", path.display())))?;
    parse(&text, args).map_err(|e| Failure::usage(format!("{}: {e}", path.display())))
}

fn parse(text: &str, args: &Args) -> Result<Vec<Inputs>, String> {
    // Spreadsheets begin their files with a byte order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty() && !l.starts_with('#'));
    let header: Vec<&str> =
        lines.next().map(|(_, l)| l.split(',').map(str::trim).collect()).ok_or("the table is empty")?;
    let at = |name: &str| header.iter().position(|h| *h == name);
    let need =
        |name: &str| at(name).ok_or_else(|| format!("no column {name}; there are: {}", header.join(", ")));
    let (g12, g13, theta) = (need("g12_pa")?, need("g13_pa")?, need("theta_pa")?);
    let (pressure, scale) = match at("p_pa") {
        Some(column) => (column, 1.0),
        None => (need("p_kpa")?, 1e3),
    };
    let mut states = Vec::new();
    for (number, line) in lines {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if cells.len() != header.len() {
            return Err(format!("line {}: {} cells under {} columns", number + 1, cells.len(), header.len()));
        }
        let value = |column: usize| -> Result<f64, String> {
            let bad = |_| {
                format!("line {}, column {}: {:?} is not a number", number + 1, header[column], cells[column])
            };
            cells[column].parse().map_err(bad)
        };
        let optional = |name: &str| match at(name).filter(|c| !cells[*c].is_empty()) {
            Some(column) => value(column).map(Some),
            None => Ok(None),
        };
        let moduli = [value(g12)?, value(g13)?, value(theta)?, value(pressure)? * scale];
        let g = optional("gamma_over_delta")?;
        let mut state = Inputs::new(args, moduli, g).map_err(|e| e.to_string())?;
        state.theta_printed_pa = optional("theta_printed_pa")?;
        state.sample = at("sample").map(|c| cells[c].to_owned());
        states.push(state);
    }
    if states.is_empty() { Err("there is no state below the header".to_owned()) } else { Ok(states) }
}
