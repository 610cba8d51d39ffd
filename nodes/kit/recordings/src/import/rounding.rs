//! Rounding of printed positions, and what it does to overlaps.

use std::fmt;

use grainlab_core::{Contact, Packing};

use super::text::digits;

/// Numbers of significant digits of rounded positions. Programs print at least six; fewer were typed by hand, and count as exact.
/// More leave an error that no overlap feels.
const ROUNDED: std::ops::RangeInclusive<u32> = 5..=12;

/// Share of the mean overlap from which the rounding of positions is noticeable.
const NOTICEABLE: f64 = 1e-3;

/// Largest error of an overlap over the rounding of a coordinate: both centres are off along each axis, 2 √3, and the radii a little.
const OVERLAP: f64 = 4.0;

/// The coordinates of a file as printed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Printed {
    /// Most significant digits of any coordinate.
    digits: u32,
    /// Largest magnitude of a coordinate, in its unit.
    largest: f64,
    /// Length of one printed unit, m: more than 1 m only for coordinates in shares of an edge.
    unit: f64,
}

/// How far positions may be off because of their few printed digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounding {
    /// Significant digits of the largest coordinate.
    pub digits: u32,
    /// Largest error of a coordinate, m.
    pub position: f64,
}

/// A rounding, with the mean overlap that it blurs, m.
pub(super) struct Blurred(pub(super) Rounding, pub(super) f64);

impl Default for Printed {
    fn default() -> Self {
        Self { digits: 0, largest: 0.0, unit: 1.0 }
    }
}

impl Printed {
    /// Notes a position as printed, in units of this length, m.
    pub(super) fn note(&mut self, words: [&str; 3], unit: f64) {
        self.unit = unit;
        for word in words {
            self.digits = self.digits.max(digits(word));
            self.largest = self.largest.max(word.trim().parse::<f64>().map_or(0.0, f64::abs));
        }
    }

    /// Returns the rounding of the positions; `None` where they have all their digits, or were not printed.
    pub(super) fn rounding(&self) -> Option<Rounding> {
        let Self { digits, largest, unit } = *self;
        (ROUNDED.contains(&digits) && largest > 0.0).then(|| {
            let place = largest.log10().floor() as i32 + 1 - digits as i32;
            Rounding { digits, position: 0.5 * 10f64.powi(place) * unit }
        })
    }
}

impl Rounding {
    /// Returns the largest error of an overlap, m.
    pub fn of_overlap(&self) -> f64 {
        OVERLAP * self.position
    }

    /// Returns the largest mean difference of normal forces that the rounding causes by the contact law, over their mean.
    pub(super) fn of_forces(&self, packing: &Packing) -> f64 {
        let force = |more: f64| -> f64 {
            let of = |c: &Contact| {
                let overlap = c.overlap.max(0.0) + more;
                packing.law.normal_force(&packing.material, packing.effective_radius(c), overlap)
            };
            packing.contacts.iter().map(of).sum()
        };
        force(self.of_overlap()) / force(0.0) - 1.0
    }

    /// Returns the rounding with the mean overlap of `packing`, where it changes overlaps noticeably.
    pub(super) fn noticeable(self, packing: &Packing) -> Option<Blurred> {
        let overlaps = packing.contacts.iter().map(|c| c.overlap);
        let mean = overlaps.sum::<f64>() / packing.contacts.len() as f64;
        (self.position > NOTICEABLE * mean).then_some(Blurred(self, mean))
    }
}

impl fmt::Display for Rounding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "positions have {} digits, so they are rounded by up to {:.1e} m",
            self.digits, self.position
        )
    }
}

impl fmt::Display for Blurred {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(rounding, mean) = self;
        write!(f, "{rounding}, {:.1} % of the mean overlap", 100.0 * rounding.position / mean)
    }
}

pub(super) const ALL_DIGITS: &str = "write them with 17 digits (LAMMPS: dump_modify ID format float %.17g)";

#[cfg(test)]
mod tests {
    use super::*;

    fn rounding(words: [&str; 3], unit: f64) -> Option<Rounding> {
        let mut printed = Printed::default();
        printed.note(words, unit);
        printed.rounding()
    }

    #[test]
    fn coordinates_are_rounded_at_the_last_digit_of_the_largest() {
        let metres = rounding(["0.00123457", "-9.87654e-05", "0"], 1.0).unwrap();
        assert!(metres.digits == 6 && (metres.position / 5e-9 - 1.0).abs() < 1e-9, "{metres:?}");
        // In shares of an edge of 2 mm.
        let shares = rounding(["0.123457", "0.987654", "0.5"], 2e-3).unwrap();
        assert!((shares.position / 1e-9 - 1.0).abs() < 1e-9, "{shares:?}");
        assert_eq!(rounding(["0.25", "0.5", "1"], 1.0), None, "typed by hand");
        assert_eq!(rounding(["0.0012345678901234567", "0", "0"], 1.0), None, "all digits");
    }
}
