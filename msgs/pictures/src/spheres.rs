//! Grains as spheres.

use crate::colours::{Colour, of_grains};
use crate::drawn::Drawn;
use crate::marker::{marker, point};
use grainlab_msgs::geometry_msgs::Vector3;
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::visualization_msgs::Marker;
use std::collections::BTreeMap;

/// The grains, coloured by coordination, rattlers grey.
///
/// All spheres of a list have one diameter and, without a colour for each, one colour: grains of equal size and colour are one
/// list, and a grain that has no equal is a sphere of its own. Sizes are compared as `float32`, as viewers draw.
pub(crate) fn spheres(drawn: &Drawn<'_>, header: &Header) -> Vec<Marker> {
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
