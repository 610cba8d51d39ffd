//! `visualization_msgs/MarkerArray`: grains, contacts and cell.

use crate::colours::{Colour, of_grains, ramp};
use crate::drawn::{Drawn, DrawnContact};
use grainlab_core::{Cell, Vec3};
use grainlab_msgs::boundary::packing_header;
use grainlab_msgs::geometry_msgs::{Point, Vector3};
use grainlab_msgs::std_msgs::{ColorRGBA, Header};
use grainlab_msgs::visualization_msgs::{Marker, MarkerArray};
use std::collections::BTreeMap;

/// Colour of the edges of the cell: seen on a light and on a dark background.
const EDGES: [u8; 3] = [128, 128, 128];

/// Width of the edges of the cell, mean radii.
const EDGE_WIDTH: f64 = 0.08;

/// Widths and colours of lines: a list of lines has one of each.
const CLASSES: usize = 12;

/// Width of the widest line, mean radii.
const WIDEST: f64 = 0.5;

/// Markers in the namespaces `grains`, `contacts` and `cell`, after one that deletes those of the state before.
pub fn markers(drawn: &Drawn<'_>) -> MarkerArray {
    let header = packing_header(drawn.packing);
    let mut markers =
        vec![Marker { action: Marker::DELETEALL, ..marker(&header, "", 0, Marker::ARROW, EDGES) }];
    markers.extend(spheres(drawn, &header));
    markers.extend(chains(drawn, &header));
    let width = EDGE_WIDTH * drawn.mean_radius();
    markers.push(lines(&header, "cell", 0, EDGES, width, edges(&drawn.packing.cell)));
    MarkerArray { markers }
}

/// The ends of the twelve edges of the cell, m.
fn edges(cell: &Cell) -> Vec<Point> {
    let corner = |bits: usize| {
        let share = |k: usize| (bits >> k & 1) as f64;
        point(&(cell.matrix() * Vec3::new(share(0), share(1), share(2))))
    };
    let from = |axis: usize| (0..8).filter(move |bits| bits >> axis & 1 == 0);
    let edges = (0..3).flat_map(|axis| from(axis).map(move |bits| (bits, bits | 1 << axis)));
    edges.flat_map(|(a, b)| [corner(a), corner(b)]).collect()
}

/// The grains, coloured by coordination, rattlers grey.
///
/// All spheres of a list have one diameter and, without a colour for each, one colour: grains of equal size and colour are one
/// list, and a grain that has no equal is a sphere of its own. Sizes are compared as `float32`, as viewers draw.
fn spheres(drawn: &Drawn<'_>, header: &Header) -> Vec<Marker> {
    let colours = of_grains(drawn);
    let mut groups: BTreeMap<(u32, Colour), Vec<usize>> = BTreeMap::new();
    for (grain, radius) in drawn.packing.radii.iter().enumerate() {
        // Positive numbers are in the order of their bits.
        groups.entry(((*radius as f32).to_bits(), colours[grain])).or_default().push(grain);
    }
    let list = |(id, ((_, colour), grains)): (usize, ((u32, Colour), Vec<usize>))| {
        let diameter = 2.0 * drawn.packing.radii[grains[0]];
        let alone = grains.len() == 1;
        let kind = if alone { Marker::SPHERE } else { Marker::SPHERE_LIST };
        let mut spheres = marker(header, "grains", id, kind, colour);
        spheres.scale = Vector3 { x: diameter, y: diameter, z: diameter };
        if alone {
            spheres.pose.position = point(&drawn.centre(grains[0]));
        } else {
            spheres.points = grains.iter().map(|g| point(&drawn.centre(*g))).collect();
        }
        spheres
    };
    groups.into_iter().enumerate().map(list).collect()
}

/// Lines between the centres of grains in contact, wider and lighter for larger forces. Three times the mean force and all
/// forces above have the last class. A contact through a face of the cell is two lines, from each centre to the face where the
/// grains touch, so that both grains show it.
fn chains(drawn: &Drawn<'_>, header: &Header) -> Vec<Marker> {
    let full = drawn.force_of_full_colour();
    let mut classes: [Vec<Point>; CLASSES] = Default::default();
    for contact in &drawn.contacts {
        let share = if full > 0.0 { contact.force / full } else { 0.0 };
        let class = ((share * CLASSES as f64) as usize).min(CLASSES - 1);
        classes[class].extend(ends(drawn, contact).iter().map(point));
    }
    let line = |(class, ends): (usize, Vec<Point>)| {
        let share = (class as f64 + 0.5) / CLASSES as f64;
        lines(header, "contacts", class, ramp(share), WIDEST * share * drawn.mean_radius(), ends)
    };
    classes.into_iter().enumerate().filter(|(_, ends)| !ends.is_empty()).map(line).collect()
}

/// The ends of the lines of a contact, m.
fn ends(drawn: &Drawn<'_>, contact: &DrawnContact) -> Vec<Vec3> {
    let (i, j) = (contact.i as usize, contact.j as usize);
    let (first, second) = (drawn.centre(i), drawn.centre(j));
    let shift = drawn.packing.cell.matrix() * Vec3::from(contact.image.map(f64::from));
    let branch = second + shift - first;
    if contact.image == [0; 3] {
        return vec![first, second];
    }
    let radii = &drawn.packing.radii;
    let touch = first + branch * (radii[i] / (radii[i] + radii[j]));
    vec![first, touch, second, touch - shift]
}

/// A marker of a namespace, in one colour. Its pose is the origin.
fn marker(header: &Header, ns: &str, id: usize, kind: i32, colour: Colour) -> Marker {
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
fn lines(header: &Header, ns: &str, id: usize, colour: Colour, width: f64, ends: Vec<Point>) -> Marker {
    let mut lines = marker(header, ns, id, Marker::LINE_LIST, colour);
    lines.scale = Vector3 { x: width, y: 0.0, z: 0.0 };
    lines.points = ends;
    lines
}

/// A place in m.
fn point(place: &Vec3) -> Point {
    Point { x: place.x, y: place.y, z: place.z }
}
