//! How far the grains of a packing overlap, and up to which overlap a contact law holds.

use crate::contact::SpringLaw;
use crate::notes::Note;
use crate::packing::{Contact, Packing};

/// Overlap over the smaller diameter beyond which no contact law holds. A run ends where two grains overlap by more, and a
/// packing with such a contact has no moduli.
pub const OVERLAP_LIMIT: f64 = 0.1;

/// Overlap over the smaller diameter beyond which Hertz's law is doubtful. It needs contact areas far smaller than the grains
/// (Johnson, Contact Mechanics, 1985, section 4.2); here the contact radius is 0.22 of the radius of equal grains.
const HERTZ_LIMIT: f64 = 0.05;

/// Share of the contacts beyond [`OVERLAP_LIMIT`] from which all radii are wrong, rather than some places.
const MOST: f64 = 0.5;

/// Probability below which it is no chance that all contacts beyond [`OVERLAP_LIMIT`] are with images.
const CHANCE: f64 = 0.01;

/// The overlaps of a packing, as shares of the smaller diameter of each two grains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlaps {
    /// The largest one.
    pub largest: f64,
    /// Ids of the two grains of the largest one.
    pub grains: [u32; 2],
    /// Number of contacts.
    pub contacts: usize,
    /// Number of contacts beyond [`OVERLAP_LIMIT`].
    pub beyond: usize,
    /// Why they are beyond it, where the packing shows that.
    cause: Cause,
}

/// Likely causes of overlaps beyond any contact law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cause {
    /// Only contacts with images of grains are too deep.
    Cell,
    /// Most contacts are too deep.
    Radii,
    Unknown,
}

impl Cause {
    const fn text(self) -> &'static str {
        match self {
            Self::Cell => {
                "all of these are with periodic images of grains, so that the cell is probably not the one of the positions: it is \
                 transposed, lacks its tilts, or has other edges"
            }
            Self::Radii => {
                "the radii are probably not those of the positions: they are diameters, or positions and cell have another unit"
            }
            Self::Unknown => {
                "the cell may be transposed or lack its tilts, the radii may be diameters or have another unit, or it is a state \
                 before the grains were pushed apart"
            }
        }
    }
}

impl Packing {
    /// Returns the overlap of a contact over the smaller diameter of its two grains.
    pub fn overlap_ratio(&self, c: &Contact) -> f64 {
        c.overlap / (2.0 * self.radii[c.i as usize].min(self.radii[c.j as usize]))
    }

    /// Returns the overlaps of the contacts; `None` without contacts.
    pub fn overlaps(&self) -> Option<Overlaps> {
        let deepest =
            self.contacts.iter().max_by(|a, b| self.overlap_ratio(a).total_cmp(&self.overlap_ratio(b)))?;
        let is_beyond = |c: &&Contact| self.overlap_ratio(c) > OVERLAP_LIMIT;
        let (contacts, beyond) = (self.contacts.len(), self.contacts.iter().filter(is_beyond).count());
        let mut found = Overlaps {
            largest: self.overlap_ratio(deepest),
            grains: [deepest.i, deepest.j].map(|g| self.ids[g as usize]),
            contacts,
            beyond,
            cause: Cause::Unknown,
        };
        if beyond > 0 {
            // A wrong cell changes no distance of the positions as they are, whatever it makes of their images.
            let crosses = |c: &&Contact| c.image != [0; 3];
            let across = self.contacts.iter().filter(crosses).count();
            let beyond_across = self.contacts.iter().filter(is_beyond).filter(crosses).count();
            let chance = (across as f64 / contacts as f64).powi(i32::try_from(beyond).unwrap_or(i32::MAX));
            found.cause = if beyond_across == beyond && chance < CHANCE {
                Cause::Cell
            } else if beyond as f64 > MOST * contacts as f64 {
                Cause::Radii
            } else {
                Cause::Unknown
            };
        }
        Some(found)
    }

    /// Returns the note on overlaps beyond [`OVERLAP_LIMIT`], with their likely cause; `None` for smaller ones.
    pub fn overlap_fault(&self) -> Option<Note> {
        self.overlaps()?.fault()
    }

    /// Returns the note on overlaps at which the contact law is doubtful, or holds no more; `None` for smaller ones.
    pub(crate) fn overlap_note(&self) -> Option<Note> {
        let found = self.overlaps()?;
        found.fault().or_else(|| {
            let is_hertz = !matches!(self.law.springs, SpringLaw::Linear(_));
            let [i, j] = found.grains.map(f64::from);
            (is_hertz && found.largest > HERTZ_LIMIT)
                .then(|| Note::overlaps_deep(found.largest, HERTZ_LIMIT, i, j))
        })
    }
}

impl Overlaps {
    /// Returns true if a contact is beyond [`OVERLAP_LIMIT`].
    pub fn are_too_deep(&self) -> bool {
        self.beyond > 0
    }

    fn fault(&self) -> Option<Note> {
        let ([i, j], [beyond, contacts]) =
            (self.grains.map(f64::from), [self.beyond, self.contacts].map(|n| n as f64));
        (beyond > 0.0).then(|| {
            Note::overlaps_too_deep(self.cause.text(), beyond, contacts, i, j, OVERLAP_LIMIT, self.largest)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, Mat3, Vec3, contact_search};

    /// A simple cubic lattice of 4³ grains that touch with this overlap (diameters), in a cell of these edge vectors (diameters).
    fn lattice(overlap: f64, cell: Mat3) -> Packing {
        let site =
            |n: usize| Vec3::new((n / 16) as f64, (n / 4 % 4) as f64, (n % 4) as f64) * (1.0 - overlap);
        let mut p = Packing::at_rest(
            Cell::new(cell * (1.0 - overlap)).unwrap(),
            vec![0.5; 64],
            (0..64).map(site).collect(),
        );
        p.contacts = contact_search::of_packing(&p).unwrap();
        p
    }

    fn cube() -> Mat3 {
        Mat3::identity() * 4.0
    }

    #[test]
    fn overlaps_of_five_per_cent_are_doubtful_by_hertz_and_not_by_linear_springs() {
        for (overlap, is_doubtful) in [(0.049, false), (0.051, true), (0.099, true)] {
            let mut p = lattice(overlap, cube());
            assert!((p.overlaps().unwrap().largest - overlap).abs() < 1e-12);
            assert_eq!(
                p.overlap_note().is_some_and(|w| w.to_string().contains("Hertz's law")),
                is_doubtful,
                "{overlap}"
            );
            p.law.springs = SpringLaw::EXAMPLES[1];
            assert_eq!(p.overlap_note(), None);
        }
        assert_eq!(Packing { contacts: Vec::new(), ..lattice(0.1, cube()) }.overlaps(), None);
    }

    #[test]
    fn overlaps_beyond_the_limit_are_a_fault_by_any_law_with_its_likely_cause() {
        for springs in SpringLaw::EXAMPLES {
            let mut p = lattice(0.11, cube());
            p.law.springs = springs;
            let text = p.overlap_note().unwrap().to_string();
            assert!(
                text.starts_with("192 of 192 contacts overlap") && text.contains("they are diameters"),
                "{text}"
            );
        }
        // Grains of the first layer lie between two grains of the last one, unless the cell has lost its tilt.
        let height = 3.0 + 0.75f64.sqrt();
        let tilted = |tilt: f64| {
            lattice(0.01, Mat3::new(4.0, 0.0, tilt, 0.0, 4.0, 0.0, 0.0, 0.0, height)).overlap_note()
        };
        assert_eq!(tilted(0.5), None);
        let text = tilted(0.0).unwrap();
        let text = text.to_string();
        assert!(text.contains("lacks its tilts") && text.starts_with("16 of 192"), "{text}");
        let mut one = lattice(0.01, cube());
        one.contacts[0].overlap = 0.2;
        let text = one.overlap_note().unwrap().to_string();
        assert!(text.contains("1 of 192 contacts overlaps") && text.contains("grains 0 and"), "{text}");
        assert!(text.contains("pushed apart"), "{text}");
    }
}
