//! `sensor_msgs/PointCloud2`: one point a grain.

use crate::colours::of_grains;
use crate::drawn::Drawn;
use grainlab_msgs::boundary::packing_header;
use grainlab_msgs::sensor_msgs::{PointCloud2, PointField};

/// Name, offset in bytes and type of each field. Viewers expect positions as `float32`. Rerun takes sizes and colours from fields
/// with the names of its own components, `radii` and `colors` (0xRRGGBBAA).
const FIELDS: [(&str, u32, u8); 10] = [
    ("x", 0, PointField::FLOAT32),
    ("y", 4, PointField::FLOAT32),
    ("z", 8, PointField::FLOAT32),
    ("radius", 12, PointField::FLOAT32),
    ("id", 16, PointField::UINT32),
    ("coordination", 20, PointField::UINT32),
    ("normal_force", 24, PointField::FLOAT32),
    ("radii", 28, PointField::FLOAT32),
    ("colors", 32, PointField::UINT32),
    ("rattler", 36, PointField::UINT8),
];

/// Bytes of a point, three of which are unused, so that every point is aligned.
const STEP: usize = 40;

/// One point per grain, in the order of the packing, within the cell: position and radius in m, id, number of contacts that are
/// not with rattlers, mean normal force of its contacts in N, 1 for a rattler, and its colour.
pub fn points(drawn: &Drawn<'_>) -> PointCloud2 {
    let packing = drawn.packing;
    let colours = of_grains(drawn);
    let mut data = Vec::with_capacity(STEP * packing.grains());
    for (grain, [r, g, b]) in colours.into_iter().enumerate() {
        let mut point = [0; STEP];
        let centre = drawn.centre(grain);
        let numbers = [centre.x, centre.y, centre.z, packing.radii[grain]];
        let mut put = |offset: usize, bytes: [u8; 4]| point[offset..offset + 4].copy_from_slice(&bytes);
        numbers.iter().enumerate().for_each(|(k, v)| put(4 * k, (*v as f32).to_le_bytes()));
        put(16, packing.ids[grain].to_le_bytes());
        put(20, drawn.coordination[grain].to_le_bytes());
        put(24, (drawn.force[grain] as f32).to_le_bytes());
        put(28, (packing.radii[grain] as f32).to_le_bytes());
        put(32, u32::from_be_bytes([r, g, b, 255]).to_le_bytes());
        point[36] = u8::from(drawn.rattler[grain]);
        data.extend(point);
    }
    let field = |(name, offset, datatype): (&str, u32, u8)| PointField {
        name: name.to_owned(),
        offset,
        datatype,
        count: 1,
    };
    PointCloud2 {
        header: packing_header(packing),
        height: 1,
        width: packing.grains() as u32,
        fields: FIELDS.map(field).to_vec(),
        is_bigendian: false,
        point_step: STEP as u32,
        row_step: data.len() as u32,
        data,
        is_dense: true,
    }
}
