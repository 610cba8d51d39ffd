//! Normal forces of a packing compared with the forces of its contact law at the same overlaps.

use crate::packing::{Contact, Packing};

/// Difference of normal forces from the contact law, relative and on average, above which they are of another law, of another
/// material, of rounded positions, or of a packing in motion.
pub const OTHER_LAW: f64 = 0.01;

/// Relative spread of the forces about k_n times the overlap, up to which they belong to linear springs. Forces that grow as
/// overlap^1.5, as Hertz's do, spread by half of [`DIFFERENT_OVERLAPS`] and more.
const LINEAR: f64 = 0.01;

/// Standard deviation of the overlaps over their mean, from which they differ enough to tell linear springs from others.
const DIFFERENT_OVERLAPS: f64 = 0.1;

/// Number of contacts from which forces tell a law, or that their sign is reversed.
const FEWEST: usize = 10;

/// Share of the normal forces, by magnitude, that pull in a packing whose forces have the wrong sign. A law that only presses
/// gives none; a dashpot pulls in some contacts of a packing in motion.
const REVERSED: f64 = 0.9;

/// Normal forces compared with a contact law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawComparison {
    /// Sum of the magnitudes of the normal forces over the sum of the forces of the law.
    pub ratio: f64,
    /// Stiffness k_n, N/m, if the magnitudes are k_n times the overlap to 1 % in contacts whose overlaps differ; else `None`.
    pub linear_stiffness: Option<f64>,
    /// Number of contacts that pull, if at least nine tenths of the forces do, as where all have the wrong sign; else `None`.
    pub reversed: Option<usize>,
}

impl Packing {
    /// Compares the normal forces with the contact law; `None` with fewer than 10 contacts, and if a force is not finite.
    pub fn compare_with_law(&self) -> Option<LawComparison> {
        let contacts = &self.contacts;
        let count = contacts.len() as f64;
        let sum = |of: &dyn Fn(&Contact) -> f64| contacts.iter().map(of).sum::<f64>();
        let size = |c: &Contact| c.normal_force.abs();
        let forces = sum(&size);
        let ratio = forces / sum(&|c| self.law_force(c));
        if contacts.len() < FEWEST || !ratio.is_finite() {
            return None;
        }
        let mean = sum(&|c| c.overlap) / count;
        let spread = (sum(&|c| (c.overlap - mean).powi(2)) / count).sqrt() / mean;
        let stiffness = sum(&|c| size(c) * c.overlap) / sum(&|c| c.overlap * c.overlap);
        let off = (sum(&|c| (size(c) - stiffness * c.overlap).powi(2)) / sum(&|c| size(c) * size(c))).sqrt();
        let is_linear = spread >= DIFFERENT_OVERLAPS && off <= LINEAR;
        let pulling = || contacts.iter().filter(|c| c.normal_force < 0.0);
        let is_reversed = forces > 0.0 && pulling().map(size).sum::<f64>() >= REVERSED * forces;
        Some(LawComparison {
            ratio,
            linear_stiffness: is_linear.then_some(stiffness),
            reversed: is_reversed.then(|| pulling().count()),
        })
    }

    /// Returns the mean difference of the normal forces from the contact law at the same overlaps, over the mean force of the law; 0
    /// without contacts. Forces of another law or material, and of a packing in motion, differ.
    pub fn law_difference(&self) -> f64 {
        let difference: f64 = self.contacts.iter().map(|c| (c.normal_force - self.law_force(c)).abs()).sum();
        if difference == 0.0 {
            0.0
        } else {
            difference / self.contacts.iter().map(|c| self.law_force(c)).sum::<f64>()
        }
    }

    /// Elastic normal force, N, of the contact law at the overlap of a contact.
    pub(crate) fn law_force(&self, c: &Contact) -> f64 {
        self.law.normal_force(&self.material, self.effective_radius(c), c.overlap.max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{ContactLaw, Linear, SpringLaw};
    use crate::{Cell, Vec3};

    /// Twelve pairs of grains with overlaps of 1 to 12 µm, and the forces of `law`.
    fn pairs(law: ContactLaw) -> Packing {
        let overlap = |n: usize| 1e-6 * (n + 1) as f64;
        let first = |n: usize| Vec3::new(0.0, 0.0, 0.01 * n as f64);
        let positions = (0..12).flat_map(|n| [first(n), first(n) + Vec3::x() * (2e-3 - overlap(n))]);
        let mut p = Packing::at_rest(Cell::cube(0.12).unwrap(), vec![1e-3; 24], positions.collect());
        let one = |n: usize| {
            let force = law.normal_force(&p.material, 5e-4, overlap(n));
            Contact::pressed([2 * n as u32, 2 * n as u32 + 1], [0; 3], Vec3::x(), overlap(n), force)
        };
        p.contacts = (0..12).map(one).collect();
        p
    }

    fn linear(normal_stiffness: f64) -> ContactLaw {
        ContactLaw::of(SpringLaw::Linear(Linear { normal_stiffness, stiffness_ratio: 0.5 }))
    }

    #[test]
    fn forces_of_the_law_itself_have_a_ratio_of_one_and_are_linear_only_if_the_law_is() {
        for law in [ContactLaw::default(), linear(7e6)] {
            let found = Packing { law, ..pairs(law) }.compare_with_law().unwrap();
            assert!((found.ratio - 1.0).abs() < 1e-12, "{law}: {found:?}");
            assert_eq!(found.linear_stiffness.is_some(), law != ContactLaw::default(), "{law}");
            assert_eq!(found.reversed, None, "{law}");
        }
    }

    #[test]
    fn linear_forces_are_told_from_hertzian_ones_with_their_stiffness() {
        let found = pairs(linear(7e6)).compare_with_law().unwrap();
        assert!((found.linear_stiffness.unwrap() / 7e6 - 1.0).abs() < 1e-12, "{found:?}");
        // Contacts with one overlap, as in a lattice, tell no law.
        let mut lattice = pairs(linear(7e6));
        lattice.contacts.iter_mut().for_each(|c| (c.overlap, c.normal_force) = (1e-6, 7.0));
        assert_eq!(lattice.compare_with_law().unwrap().linear_stiffness, None);
    }

    #[test]
    fn forces_that_all_pull_are_reversed_and_some_that_pull_are_not() {
        let mut p = pairs(ContactLaw::default());
        p.contacts.iter_mut().for_each(|c| c.normal_force = -c.normal_force);
        assert_eq!(p.compare_with_law().unwrap().reversed, Some(12));
        p.contacts[11].normal_force *= -1.0;
        assert_eq!(p.compare_with_law().unwrap().reversed, None);
        p.contacts.truncate(9);
        assert_eq!(p.compare_with_law(), None);
    }
}
