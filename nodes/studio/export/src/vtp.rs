//! Writes VTK XML files, which ParaView and PyVista open: grains as points, contacts as lines, and a collection of the
//! states of a run.

use crate::columns::{self, Column, Values};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use grainlab_core::{Packing, Vec3};
use std::fmt::Write as _;

/// The grains as points folded into the cell (`.vtp`): radius, id, mass, velocities, number of contacts, position as held.
pub fn vtp_grains(packing: &Packing) -> String {
    let points = columns::folded(packing);
    let vertices = Cells::new("Verts", points.len(), 1);
    poly_data(packing, &points, &vertices, ("PointData", &columns::grains(packing)))
}

/// The contacts as lines between centres (`.vtp`): pair of ids, image, overlap, normal force, normal, tangential force,
/// mobilisation.
pub fn vtp_contacts(packing: &Packing) -> String {
    let points = columns::ends(packing);
    let lines = Cells::new("Lines", packing.contacts.len(), 2);
    poly_data(packing, &points, &lines, ("CellData", &columns::contacts(packing)))
}

/// A collection (`.pvd`): the time of each state, s, and its files.
pub fn pvd(states: &[(f64, Vec<String>)]) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, files) in states {
        for (part, file) in files.iter().enumerate() {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "<DataSet timestep=\"{time:e}\" part=\"{part}\" file=\"{file}\"/>");
        }
    }
    text + "</Collection>\n</VTKFile>\n"
}

/// Cells of one kind, with the same number of consecutive points each.
struct Cells {
    kind: &'static str,
    count: usize,
    points: usize,
}

impl Cells {
    fn new(kind: &'static str, count: usize, points: usize) -> Self {
        Self { kind, count, points }
    }

    fn of(&self, kind: &str) -> usize {
        if kind == self.kind { self.count } else { 0 }
    }
}

fn poly_data(packing: &Packing, points: &[Vec3], cells: &Cells, (place, data): (&str, &[Column])) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n",
    );
    for column in columns::state(packing) {
        // A field has rows of any number, so that its numbers are its tuples.
        array(&mut text, &Column { components: 1, ..column }, true);
    }
    let (n, vertices, lines) = (points.len(), cells.of("Verts"), cells.of("Lines"));
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "</FieldData>\n<Piece NumberOfPoints=\"{n}\" NumberOfVerts=\"{vertices}\" NumberOfLines=\"{lines}\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<{place}>"
    );
    for column in data {
        array(&mut text, column, false);
    }
    let _ = writeln!(text, "</{place}>\n<Points>");
    let coordinates = Values::Float(points.iter().flatten().copied().collect());
    array(&mut text, &Column { name: "Points", components: 3, values: coordinates }, false);
    let _ = writeln!(text, "</Points>\n<{}>", cells.kind);
    let indices =
        |count: usize, step: usize, first: usize| (0..count).map(move |k| (first + k * step) as i64);
    data_array(&mut text, "connectivity", "Int64", 1, None, &bytes(indices(n, 1, 0).map(i64::to_le_bytes)));
    let offsets = indices(cells.count, cells.points, cells.points);
    data_array(&mut text, "offsets", "Int64", 1, None, &bytes(offsets.map(i64::to_le_bytes)));
    let _ = writeln!(text, "</{}>\n</Piece>\n</PolyData>\n</VTKFile>", cells.kind);
    text
}

fn array(text: &mut String, column: &Column, is_field: bool) {
    let (kind, count, content) = match &column.values {
        Values::Float(v) => ("Float64", v.len(), bytes(v.iter().map(|x| x.to_le_bytes()))),
        Values::Unsigned(v) => ("UInt32", v.len(), bytes(v.iter().map(|x| x.to_le_bytes()))),
        Values::Signed(v) => ("Int32", v.len(), bytes(v.iter().map(|x| x.to_le_bytes()))),
    };
    data_array(text, column.name, kind, column.components, is_field.then_some(count), &content);
}

fn bytes<const N: usize>(values: impl Iterator<Item = [u8; N]>) -> Vec<u8> {
    values.flatten().collect()
}

/// Base64 of the number of bytes and of the bytes.
fn data_array(
    text: &mut String,
    name: &str,
    kind: &str,
    components: usize,
    tuples: Option<usize>,
    content: &[u8],
) {
    let tuples = tuples.map_or_else(String::new, |n| format!(" NumberOfTuples=\"{n}\""));
    let header = (content.len() as u64).to_le_bytes();
    // Writing to a String cannot fail.
    let _ = write!(
        text,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\"{tuples} format=\"binary\">"
    );
    STANDARD.encode_string([&header[..], content].concat(), text);
    text.push_str("</DataArray>\n");
}
