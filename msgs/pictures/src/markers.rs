//! `visualization_msgs/MarkerArray`: grains, contacts and cell.

use crate::chains::chains;
use crate::drawn::Drawn;
use crate::marker::{lines, marker, point};
use crate::spheres::spheres;
use grainlab_core::{Cell, Vec3};
use grainlab_msgs::boundary::packing_header;
use grainlab_msgs::geometry_msgs::Point;
use grainlab_msgs::visualization_msgs::{Marker, MarkerArray};

/// Colour of the edges of the cell: seen on a light and on a dark background.
const EDGES: [u8; 3] = [128, 128, 128];

/// Width of the edges of the cell, mean radii.
const EDGE_WIDTH: f64 = 0.08;

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
