//! Files, tables and packings of `tests/golden`.

use flate2::read::GzDecoder;
use grainlab_core::{Cell, Contact, Mat3, Material, Packing, Vec3};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../golden").join(name)
}

/// Returns the text of a file, decompressed if its name ends in `.gz`.
pub fn text(name: &str) -> String {
    let path = path(name);
    let bytes = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut text = String::new();
    let read = match name.ends_with(".gz") {
        true => GzDecoder::new(&bytes[..]).read_to_string(&mut text),
        false => (&bytes[..]).read_to_string(&mut text),
    };
    read.unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    text
}

/// Returns the value of a JSON file.
pub fn json(name: &str) -> Value {
    serde_json::from_str(&text(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Header and rows of a CSV file.
#[derive(Debug)]
pub struct Table {
    header: Vec<String>,
    /// The rows, each with its cells.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a CSV file without its lines that begin with `#`.
    pub fn read(name: &str) -> Self {
        let text = text(name);
        let lines = text.lines().filter(|l| !l.starts_with('#'));
        let mut rows: Vec<Vec<String>> = lines.map(|l| l.split(',').map(String::from).collect()).collect();
        Self { header: rows.remove(0), rows }
    }

    /// True if the table has this column.
    pub fn has(&self, column: &str) -> bool {
        self.header.iter().any(|h| h == column)
    }

    /// Returns the cell of a row.
    pub fn cell<'a>(&self, row: &'a [String], column: &str) -> &'a str {
        let at = self.header.iter().position(|h| h == column);
        &row[at.unwrap_or_else(|| panic!("no column {column}"))]
    }

    /// Returns the number in a cell of a row.
    pub fn number(&self, row: &[String], column: &str) -> f64 {
        let cell = self.cell(row, column);
        cell.parse().unwrap_or_else(|e| panic!("{column} is {cell:?}: {e}"))
    }
}

/// Reads a packing from `NAME.csv.gz` and its sidecar `NAME.json`, contacts in the order of the rows.
///
/// Values that the sidecar lacks are those of a packing without a history. Rows are `p,id,x,y,z,radius,mass,v…,w…` and
/// `c,i,j,nx,ny,nz,delta,fn,ftx,fty,ftz`, with n from j to i and the force on i.
pub fn packing(name: &str) -> Packing {
    let json = json(&format!("{name}.json"));
    let number = |key: &str| json[key].as_f64().unwrap_or_else(|| panic!("{name}: {key} is no number"));
    let entry = |key: &str, i: usize, j: usize| json[key][i][j].as_f64().unwrap_or(f64::NAN);
    let matrix = |key: &str| json[key].is_array().then(|| Mat3::from_fn(|i, j| entry(key, i, j)));
    let edges = || Mat3::from_diagonal(&Vec3::from_fn(|k, _| json["box_L"][k].as_f64().unwrap_or(f64::NAN)));
    let cell = Cell::new(matrix("cell").unwrap_or_else(edges)).unwrap_or_else(|| panic!("{name}: no cell"));
    let (shear_modulus, poisson_ratio, density) = (number("G"), number("nu"), number("density"));
    let mut p = Packing {
        step: json["step"].as_u64().unwrap_or(0),
        time: json["time"].as_f64().unwrap_or(0.0),
        deformation: matrix("deformation").unwrap_or_else(Mat3::identity),
        material: Material { shear_modulus, poisson_ratio, density },
        friction: number("mu_prep"),
        time_step: json["time_step"].as_f64().unwrap_or(0.0),
        ..Packing::at_rest(cell, Vec::new(), Vec::new())
    };
    let text = text(&format!("{name}.csv.gz"));
    let row = |line: &str| -> Vec<f64> {
        let numbers = line.split(',').skip(1).map(|s| s.parse());
        numbers.collect::<Result<_, _>>().unwrap_or_else(|e| panic!("{name}: {line}: {e}"))
    };
    for v in text.lines().filter(|l| l.starts_with("p,")).map(row) {
        p.ids.push(v[0] as u32);
        p.positions.push(Vec3::new(v[1], v[2], v[3]));
        p.radii.push(v[4]);
        p.velocities.push(Vec3::new(v[6], v[7], v[8]));
        p.spins.push(Vec3::new(v[9], v[10], v[11]));
    }
    let index: BTreeMap<u32, usize> = p.ids.iter().enumerate().map(|(k, id)| (*id, k)).collect();
    for v in text.lines().filter(|l| l.starts_with("c,")).map(row) {
        let (i, j) = (index[&(v[0] as u32)], index[&(v[1] as u32)]);
        let apart = p.cell.fractional(&(p.positions[j] - p.positions[i]));
        let normal = -Vec3::new(v[2], v[3], v[4]);
        // The periodic image whose branch vector is parallel to the normal.
        let branch = p.cell.fractional(&(normal * (p.radii[i] + p.radii[j] - v[5])));
        let image = [0, 1, 2].map(|k| (branch[k] - apart[k]).round() as i8);
        let pressed = Contact::pressed([i as u32, j as u32], image, normal, v[5], v[6]);
        p.contacts.push(Contact { tangential_force: Vec3::new(v[7], v[8], v[9]), ..pressed });
    }
    p
}
