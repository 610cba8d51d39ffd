//! Colours of a picture with their meaning.

use crate::palette::{CARRIER, Colour, MOST_CONTACTS, Quantity, RATTLER, by_coordination, ramp};
use crate::picture::Picture;
use crate::view::View;

/// The colours in a picture.
pub(crate) enum Legend {
    /// Title, and colours by name.
    Swatches(&'static str, Vec<(Colour, String)>),
    /// Title, and the force of the last colour.
    Ramp(&'static str, String),
}

impl Legend {
    /// That of a quantity.
    pub(crate) fn new(view: &View, quantity: Quantity) -> Self {
        let rattler = (RATTLER, "rattler".to_owned());
        match quantity {
            Quantity::Force => Self::Ramp(
                "mean normal force of the contacts of a grain",
                newtons(view.force_of_full_colour()),
            ),
            Quantity::Rattlers => Self::Swatches("", vec![(CARRIER, "carries force".to_owned()), rattler]),
            Quantity::Coordination => {
                let most = view.coordination.iter().copied().max().unwrap_or(0) as usize;
                let (table, last) = (by_coordination(), most.min(MOST_CONTACTS));
                let name = |n: usize| if n < most && n == last { format!(">={n}") } else { n.to_string() };
                let entries = (2..=last).map(|n| (table[n], name(n))).chain([rattler]);
                Self::Swatches("contacts of a grain, without rattlers", entries.collect())
            }
        }
    }

    /// Height in lines.
    pub(crate) fn rows(&self) -> usize {
        match self {
            Self::Swatches(..) => 2,
            Self::Ramp(..) => 3,
        }
    }

    /// Draws it with its upper left corner.
    pub(crate) fn draw(&self, picture: &mut Picture, [left, top]: [usize; 2]) {
        let letters = picture.letters();
        let line = letters.line();
        match self {
            Self::Swatches(title, entries) => {
                picture.write(title, [left, top]);
                let (mut at, side) = (left, line / 2);
                for (colour, text) in entries {
                    picture.fill([at, top + line + line / 6], [side, side], *colour);
                    picture.write(text, [at + 3 * line / 4, top + line]);
                    at += letters.width_of(text) + 3 * line / 2;
                }
            }
            Self::Ramp(title, full) => {
                picture.write(title, [left, top]);
                let width = (picture.width() / 4).max(letters.width_of(full) + 2 * line);
                for x in 0..width {
                    let colour = ramp(x as f64 / (width - 1) as f64);
                    picture.fill([left + x, top + line + line / 4], [1, line / 2], colour);
                }
                picture.write("0", [left, top + 2 * line]);
                picture.write(full, [left + width - letters.width_of(full), top + 2 * line]);
            }
        }
    }
}

/// A force with its unit.
fn newtons(force: f64) -> String {
    let units = [(1.0, "N"), (1e-3, "mN"), (1e-6, "µN"), (1e-9, "nN")];
    let (size, name) = units.into_iter().find(|(size, _)| force >= *size).unwrap_or(units[3]);
    format!(">={:.3} {name}", force / size)
}
