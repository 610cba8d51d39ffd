//! Parts of a packing that are not whole grains: a cut along a face of the cell, and force chains.

use crate::palette::{Colour, ramp};
use crate::view::View;
use grainlab_core::Vec3;

/// Radius of the grains beside force chains, of their own.
pub(crate) const SMALL: f64 = 0.3;

/// A cut along a face of the cell: what is nearer to the viewer is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// The axis that is cut: 0 to 2.
    axis: usize,
    /// Position along the cell vector, 0 to 1.
    position: f64,
}

impl std::str::FromStr for Slice {
    type Err = SliceError;

    fn from_str(text: &str) -> Result<Self, SliceError> {
        let invalid = || SliceError(text.to_owned());
        let (name, position) = text.split_once('=').unwrap_or((text, "0.5"));
        let axis = ["x", "y", "z"].iter().position(|known| *known == name).ok_or_else(invalid)?;
        let position = position.parse().ok().filter(|p| (0.0..=1.0).contains(p)).ok_or_else(invalid)?;
        Ok(Self { axis, position })
    }
}

/// A text that is no cut.
#[derive(Debug, thiserror::Error)]
#[error("{0:?} is not a cut: x, y or z, and its position along the cell from 0 to 1, as in z or x=0.25")]
pub struct SliceError(String);

impl std::fmt::Display for Slice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "cut at {} = {} of the cell", ["x", "y", "z"][self.axis], self.position)
    }
}

impl Slice {
    /// Normal towards the viewer, and its product with the places of the cut, m.
    pub(crate) fn plane(&self, view: &View, toward: &Vec3) -> (Vec3, f64) {
        let column = |k: usize| view.matrix().column((self.axis + k) % 3).into_owned();
        let normal = column(1).cross(&column(2)).normalize();
        let normal = if normal.dot(toward) < 0.0 { -normal } else { normal };
        (normal, self.position * normal.dot(&column(0)))
    }
}

/// A piece of a force chain, m.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stick {
    pub(crate) ends: [Vec3; 2],
    pub(crate) radius: f64,
    pub(crate) colour: Colour,
}

/// The contacts as pieces, with thickness and colour by their normal force. One across a face of the cell is two halves.
pub(crate) fn chains(view: &View) -> Vec<Stick> {
    let (top, radius) = (view.force_of_full_colour(), view.largest_radius());
    let mut sticks = Vec::new();
    for contact in &view.contacts {
        let [a, b] = [contact.i, contact.j].map(|n| view.matrix() * view.places[n as usize]);
        let branch = b + view.matrix() * Vec3::from(contact.image.map(f64::from)) - a;
        let share = if top > 0.0 { contact.force / top } else { 0.0 };
        let (radius, colour) = (radius * (0.03 + 0.42 * share.min(1.6)), ramp(share));
        let is_whole = contact.image == [0; 3];
        let ends = if is_whole { vec![[a, b]] } else { vec![[a, a + 0.5 * branch], [b, b - 0.5 * branch]] };
        sticks.extend(ends.into_iter().map(|ends| Stick { ends, radius, colour }));
    }
    sticks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_is_an_axis_and_a_position_in_the_cell() {
        assert_eq!("z".parse::<Slice>().unwrap(), Slice { axis: 2, position: 0.5 });
        assert_eq!("x=0.25".parse::<Slice>().unwrap(), Slice { axis: 0, position: 0.25 });
        for wrong in ["", "w", "x=", "x=1.5", "y=-0.1", "x=nan", "0.5"] {
            let error = wrong.parse::<Slice>().unwrap_err().to_string();
            assert!(error.contains("x=0.25"), "{wrong}: {error}");
        }
    }
}
