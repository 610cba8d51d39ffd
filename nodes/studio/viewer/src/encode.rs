//! States of a packing as bytes for a page.
//!
//! Arrays follow one another in little-endian order, each at a multiple of the size of its numbers: positions in the cell
//! (three `u16` a grain, 65536 to a cell vector), radii (`u16`, 65535 for the largest), normal forces (`u16` a contact, 65535
//! for the largest), second grains (`u16` or `u32`), ids (`u32`, left out where they count up), contacts of a grain with the
//! highest bit for rattlers, contacts with this grain as first, and images ((x + 2) 25 + (y + 2) 5 + z + 2).
//! A position is so exact to 1/65536 of the cell, enough for a picture and not for a measurement.

use crate::palette::{CARRIER, Colour, RAMP, RATTLER, by_coordination};
use crate::view::View;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

/// Data for the script in addition to the bytes.
#[derive(Debug, Serialize)]
pub(crate) struct About<'a> {
    name: &'a str,
    grains: usize,
    /// Description of the part that is drawn, if that is not all.
    part: Option<&'a str>,
    /// True for second grains as `u32`.
    wide: bool,
    /// True if every state has ids.
    ids: bool,
    first_id: u32,
    /// Largest radius, m.
    largest_radius: f64,
    ramp: &'static [Colour],
    by_coordination: Vec<Colour>,
    rattler: Colour,
    carrier: Colour,
    states: Vec<AboutState<'a>>,
}

#[derive(Debug, Serialize)]
struct AboutState<'a> {
    label: &'a str,
    /// Rows of the matrix whose columns are the cell vectors, m.
    cell: Vec<f64>,
    /// Volume of the cell, m³.
    volume: f64,
    contacts: usize,
    /// Largest normal force, N.
    largest_force: f64,
    /// Force of the last colour, N.
    force_of_full_colour: f64,
}

/// True for ids that count up from the first.
fn count_up(view: &View) -> bool {
    view.ids.iter().enumerate().all(|(n, id)| *id == view.ids[0].wrapping_add(n as u32))
}

fn has_ids(views: &[&View]) -> bool {
    views.iter().any(|v| !count_up(v) || v.ids.first() != views[0].ids.first())
}

pub(crate) fn about<'a>(name: &'a str, views: &[&'a View]) -> About<'a> {
    let grains = views.first().map_or(0, |v| v.grains());
    let state = |v: &&'a View| AboutState {
        label: &v.label,
        cell: v.matrix().transpose().iter().copied().collect(),
        volume: v.cell.volume(),
        contacts: v.contacts.len(),
        largest_force: v.largest_force(),
        force_of_full_colour: v.force_of_full_colour(),
    };
    About {
        name,
        grains,
        part: views.last().and_then(|v| v.part.as_deref()),
        wide: grains > usize::from(u16::MAX),
        ids: has_ids(views),
        first_id: views.first().and_then(|v| v.ids.first()).copied().unwrap_or(0),
        largest_radius: largest_radius(views),
        ramp: &RAMP,
        by_coordination: by_coordination(),
        rattler: RATTLER,
        carrier: CARRIER,
        states: views.iter().map(state).collect(),
    }
}

fn largest_radius(views: &[&View]) -> f64 {
    views.iter().map(|v| v.largest_radius()).fold(0.0, f64::max)
}

/// The bytes of one of several states, as base64.
pub(crate) fn state(view: &View, all: &[&View]) -> String {
    let share = |value: f64, of: f64| {
        if of > 0.0 { (value / of * 65535.0).round().clamp(0.0, 65535.0) as u16 } else { 0 }
    };
    let (radius, force, n) = (largest_radius(all), view.largest_force(), view.grains());
    let mut bytes = Vec::with_capacity(size(view));
    for place in &view.places {
        place.iter().for_each(|f| bytes.extend(((f * 65536.0) as u16).to_le_bytes()));
    }
    view.radii.iter().for_each(|r| bytes.extend(share(*r, radius).to_le_bytes()));
    view.contacts.iter().for_each(|c| bytes.extend(share(c.force, force).to_le_bytes()));
    if n > usize::from(u16::MAX) {
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        view.contacts.iter().for_each(|c| bytes.extend(c.j.to_le_bytes()));
    } else {
        view.contacts.iter().for_each(|c| bytes.extend((c.j as u16).to_le_bytes()));
    }
    if has_ids(all) {
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        view.ids.iter().for_each(|id| bytes.extend(id.to_le_bytes()));
    }
    let flag = |g: usize| (view.coordination[g].min(127) as u8) | (u8::from(view.rattler[g]) << 7);
    bytes.extend((0..n).map(flag));
    let mut counts = vec![0u8; n];
    view.contacts.iter().for_each(|c| counts[c.i as usize] = counts[c.i as usize].saturating_add(1));
    bytes.extend(counts);
    bytes.extend(view.contacts.iter().map(|c| c.image.iter().fold(0, |code, k| code * 5 + (k + 2) as u8)));
    STANDARD.encode(bytes)
}

/// About the number of bytes of a state in a page.
pub(crate) fn size(view: &View) -> usize {
    (14 * view.grains() + 7 * view.contacts.len()) * 4 / 3
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::{Cell, Contact, Packing, Vec3};

    /// Two grains that touch across a face of the cell; the second is held outside of it.
    fn pair() -> Packing {
        Packing {
            ids: vec![7, 3],
            contacts: vec![Contact::pressed([0, 1], [-2, 0, 0], -Vec3::x(), 1e-9, 4.0)],
            friction: 0.3,
            ..Packing::at_rest(
                Cell::cube(8.0).unwrap(),
                vec![1.0, 0.5],
                vec![Vec3::new(0.25, 4.0, 2.0), Vec3::new(14.75, 4.0, 2.0)],
            )
        }
    }

    #[test]
    fn a_grain_outside_of_the_cell_is_drawn_inside_with_the_contact_at_the_same_image() {
        let view = View::new(&pair(), "");
        let bytes = STANDARD.decode(state(&view, &[&view])).unwrap();
        let short = |n: usize| u16::from_le_bytes([bytes[2 * n], bytes[2 * n + 1]]);
        let places: Vec<u16> = (0..6).map(short).collect();
        assert_eq!(places, [2048, 32768, 16384, 55296, 32768, 16384], "14.75 is 6.75 of 8");
        assert_eq!(
            [short(6), short(7), short(8), short(9)],
            [65535, 32768, 65535, 1],
            "radii, force, second grain"
        );
        assert_eq!(&bytes[20..28], &[7, 0, 0, 0, 3, 0, 0, 0], "ids");
        // Frictionless or not, a grain with one contact is a rattler.
        assert_eq!(&bytes[28..], &[128, 128, 1, 0, 37], "flags, counts, image (-1, 0, 0)");
    }

    #[test]
    fn ids_that_count_up_are_left_out() {
        let counting = Packing { ids: vec![4, 5], ..pair() };
        let (view, other) = (View::new(&counting, ""), View::new(&pair(), ""));
        assert_eq!(STANDARD.decode(state(&view, &[&view])).unwrap().len(), 25);
        assert!(!has_ids(&[&view]) && has_ids(&[&view, &other]));
    }
}
