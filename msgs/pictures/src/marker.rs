//! Properties that all markers have in common.

use crate::colours::Colour;
use grainlab_core::Vec3;
use grainlab_msgs::geometry_msgs::{Point, Vector3};
use grainlab_msgs::std_msgs::{ColorRGBA, Header};
use grainlab_msgs::visualization_msgs::Marker;

/// A marker of a namespace, in one colour. Its pose is the origin.
pub(crate) fn marker(header: &Header, ns: &str, id: usize, kind: i32, colour: Colour) -> Marker {
    let [r, g, b] = colour.map(|c| f32::from(c) / 255.0);
    Marker {
        header: header.clone(),
        ns: ns.to_owned(),
        id: id as i32,
        r#type: kind,
        action: Marker::ADD,
        color: ColorRGBA { r, g, b, a: 1.0 },
        ..Marker::default()
    }
}

/// Lines from the first point to the second, from the third to the fourth, …; the width is in m.
pub(crate) fn lines(
    header: &Header,
    ns: &str,
    id: usize,
    colour: Colour,
    width: f64,
    ends: Vec<Point>,
) -> Marker {
    let mut lines = marker(header, ns, id, Marker::LINE_LIST, colour);
    lines.scale = Vector3 { x: width, y: 0.0, z: 0.0 };
    lines.points = ends;
    lines
}

/// A place in m.
pub(crate) fn point(place: &Vec3) -> Point {
    Point { x: place.x, y: place.y, z: place.z }
}
