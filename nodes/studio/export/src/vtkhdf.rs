//! Writes VTKHDF files: HDF5 with the layout of `vtkPolyData`, for ParaView, VTK and every reader of HDF5.

use crate::columns::{self, Column, Piece, Values};
use grainlab_core::Packing;
use hdf5_pure::{AttrValue, DatasetBuilder, FileBuilder, GroupBuilder};

/// The piece as a file.
///
/// # Errors
/// If there are more numbers than the format can address.
pub(crate) fn vtkhdf(packing: &Packing, piece: &Piece) -> Result<Vec<u8>, String> {
    let Piece { points, cells: count, points_per_cell: each, place, data } = piece;
    let kind = if *each == 1 { "Vertices" } else { "Lines" };
    let mut file = FileBuilder::new();
    let mut root = file.create_group("VTKHDF");
    root.set_attr("Version", AttrValue::I64Array(vec![2, 0]));
    root.set_attr("Type", AttrValue::AsciiString("PolyData".into()));
    root.create_dataset("NumberOfPoints").with_i64_data(&[points.len() as i64]);
    let coordinates: Vec<f64> = points.iter().flatten().copied().collect();
    root.create_dataset("Points").with_f64_data(&coordinates).with_shape(&[points.len() as u64, 3]);
    for name in ["Vertices", "Lines", "Polygons", "Strips"] {
        let (cells, ends) = if name == kind { (*count, points.len()) } else { (0, 0) };
        let mut group = root.create_group(name);
        group.create_dataset("NumberOfConnectivityIds").with_i64_data(&[ends as i64]);
        group.create_dataset("NumberOfCells").with_i64_data(&[cells as i64]);
        let offsets: Vec<i64> = (0..=cells).map(|k| (k * each) as i64).collect();
        group.create_dataset("Offsets").with_i64_data(&offsets);
        let connectivity: Vec<i64> = (0..ends as i64).collect();
        group.create_dataset("Connectivity").with_i64_data(&connectivity);
        root.add_group(group.finish());
    }
    let mut group = root.create_group(place);
    data.iter().for_each(|column| dataset(&mut group, column));
    root.add_group(group.finish());
    let mut group = root.create_group("FieldData");
    columns::state(packing).iter().for_each(|c| dataset(&mut group, &Column { components: 1, ..c.clone() }));
    root.add_group(group.finish());
    file.add_group(root.finish());
    // Words have no place among the numbers of VTK.
    let mut own = file.create_group("grainlab");
    own.set_attr("contact_law", AttrValue::AsciiString(packing.law.name().into()));
    own.set_attr("contact_law_parameters", AttrValue::F64Array(packing.law.parameters()));
    file.add_group(own.finish());
    file.finish().map_err(|e| format!("HDF5: {e}"))
}

fn dataset(group: &mut GroupBuilder, column: &Column) {
    fn shaped(set: &mut DatasetBuilder, numbers: usize, components: usize) {
        if components > 1 {
            set.with_shape(&[(numbers / components) as u64, components as u64]);
        }
    }
    let set = group.create_dataset(column.name);
    match &column.values {
        Values::Float(v) => shaped(set.with_f64_data(v), v.len(), column.components),
        Values::Unsigned(v) => shaped(set.with_u32_data(v), v.len(), column.components),
        Values::Signed(v) => shaped(set.with_i32_data(v), v.len(), column.components),
    }
}
