//! Contacts as lines, so that chains of large forces are seen.

use crate::colours::ramp;
use crate::drawn::{Drawn, DrawnContact};
use crate::marker::{lines, point};
use grainlab_core::Vec3;
use grainlab_msgs::geometry_msgs::Point;
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::visualization_msgs::Marker;

/// Widths and colours of lines: a list of lines has one of each.
const CLASSES: usize = 12;

/// Width of the widest line, mean radii.
const WIDEST: f64 = 0.5;

/// Lines between the centres of grains in contact, wider and lighter for larger forces. Three times the mean force and all
/// forces above have the last class. A contact through a face of the cell is two lines, from each centre to the face where the
/// grains touch, so that both grains show it.
pub(crate) fn chains(drawn: &Drawn<'_>, header: &Header) -> Vec<Marker> {
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
