//! Colours of a picture with their meaning.

use crate::canvas::Canvas;
use crate::lettering::Lettering;
use crate::palette::{CARRIER, Colour, MOST_CONTACTS, Quantity, RATTLER, by_coordination, ramp};
use crate::view::View;

/// Title, and colours by name.
pub(crate) struct Legend(&'static str, Vec<(Colour, String)>);

/// Height in lines.
pub(crate) const ROWS: usize = 2;

impl Legend {
    pub(crate) fn new(view: &View, quantity: Quantity) -> Self {
        let rattler = (RATTLER, "rattler".to_owned());
        match quantity {
            Quantity::Force => {
                let full = view.force_of_full_colour();
                let entry = |n: u32| (ramp(f64::from(n) / 3.0), newtons(f64::from(n) / 3.0 * full, full));
                let mut entries: Vec<_> = (0..=3).map(entry).collect();
                entries[3].1.insert_str(0, ">=");
                Self("mean normal force of the contacts of a grain", entries)
            }
            Quantity::Rattlers => Self("", vec![(CARRIER, "carries force".to_owned()), rattler]),
            Quantity::Coordination => {
                let most = view.coordination.iter().copied().max().unwrap_or(0) as usize;
                let (table, last) = (by_coordination(), most.min(MOST_CONTACTS));
                let name = |n: usize| if n < most && n == last { format!(">={n}") } else { n.to_string() };
                let entries = (2..=last).map(|n| (table[n], name(n))).chain([rattler]);
                Self("contacts per grain (those with rattlers not counted)", entries.collect())
            }
        }
    }

    /// Width in pixels.
    pub(crate) fn width(&self, letters: Lettering) -> usize {
        let entry = |(_, text): &(Colour, String)| letters.width_of(text) + 3 * letters.line() / 2;
        letters.width_of(self.0).max(self.1.iter().map(entry).sum())
    }

    /// Draws it with its upper left corner.
    pub(crate) fn draw(&self, canvas: &mut Canvas, [left, top]: [usize; 2]) {
        let (letters, line) = (canvas.letters, canvas.letters.line());
        canvas.write(self.0, [left, top]);
        let mut at = left;
        for (colour, text) in &self.1 {
            canvas.fill([at, top + line + line / 6], [line / 2, line / 2], *colour);
            canvas.write(text, [at + 3 * line / 4, top + line]);
            at += letters.width_of(text) + 3 * line / 2;
        }
    }
}

/// A force in the unit and with the decimal places that give the largest one three digits.
pub(crate) fn newtons(force: f64, largest: f64) -> String {
    if force == 0.0 {
        return "0".to_owned();
    }
    let units = [(1.0, "N"), (1e-3, "mN"), (1e-6, "µN"), (1e-9, "nN")];
    let (size, name) = units.into_iter().find(|(size, _)| largest >= *size).unwrap_or(units[3]);
    let digits = (2.0 - (largest / size).log10().floor()).clamp(0.0, 2.0) as usize;
    format!("{:.digits$} {name}", force / size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_forces_of_a_legend_have_one_unit_and_three_digits() {
        let of = |full: f64| [1.0, 2.0, 3.0].map(|n| newtons(n / 3.0 * full, full));
        assert_eq!(of(2.046e-3), ["0.68 mN", "1.36 mN", "2.05 mN"]);
        assert_eq!(of(6.0e-4), ["200 µN", "400 µN", "600 µN"]);
        assert_eq!((of(31.5)[2].as_str(), newtons(0.0, 1.0).as_str()), ("31.5 N", "0"));
    }
}
