//! Writes VTK XML files, which ParaView and PyVista open: grains as points, contacts as lines, and a collection of the
//! states of a run.

use crate::columns::{self, Column, Piece, Values};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use grainlab_core::Packing;
use std::fmt::Write as _;

/// A collection (`.pvd`): the time of each state, s, and its file.
pub(crate) fn pvd<'a>(states: impl Iterator<Item = (f64, &'a str)>) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, file) in states {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "<DataSet timestep=\"{time:e}\" part=\"0\" file=\"{file}\"/>");
    }
    text + "</Collection>\n</VTKFile>\n"
}

/// The piece as a file (`.vtp`).
pub(crate) fn vtp(packing: &Packing, piece: &Piece) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n",
    );
    for column in columns::state(packing) {
        // A field has rows of any number, so that its numbers are its tuples.
        array(&mut text, &Column { components: 1, ..column }, true);
    }
    let Piece { points, cells, points_per_cell: each, place, data } = piece;
    let (n, each) = (points.len(), *each);
    let (kind, vertices, lines) = if each == 1 { ("Verts", *cells, 0) } else { ("Lines", 0, *cells) };
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
    let _ = writeln!(text, "</Points>\n<{kind}>");
    let connectivity = bytes((0..n as i64).map(i64::to_le_bytes));
    data_array(&mut text, "connectivity", "Int64", 1, None, &connectivity);
    let offsets = bytes((1..=*cells).map(|k| ((k * each) as i64).to_le_bytes()));
    data_array(&mut text, "offsets", "Int64", 1, None, &offsets);
    let _ = writeln!(text, "</{kind}>\n</Piece>\n</PolyData>\n</VTKFile>");
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
