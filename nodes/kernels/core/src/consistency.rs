//! Contacts of a packing compared with its positions and radii.

use crate::packing::{Contact, Packing, PackingError};

/// Overlap and normal may differ from those of the positions by this share, and by rounding.
const SHARE: f64 = 1e-9;

/// Rounding of a distance, in units in the last place of the coordinates.
const ROUNDING: f64 = 64.0;

/// No contact presses or pulls more than this many times as hard as its law at its overlap, nor at the mean overlap: far more than
/// viscous forces make of it. At small overlaps, the forces of other laws and of dashpots exceed Hertz's by any factor.
const HARDEST: f64 = 100.0;

impl Packing {
    /// The packing itself if its numbers belong together, else the first fault found: ids that are all different, a solid
    /// fraction of at most 1, overlaps and normals that follow from positions and radii to 1e-9 and rounding, no contact twice (a
    /// grain touches an own image on both sides at once, which is one contact), normal forces of at most a hundred times the forces
    /// of the contact law. The packing is taken to be a [validated](Packing::validated) one. Linear in grains and contacts, but for the
    /// sorting of ids that are out of order.
    ///
    /// Not checked is whether all contacts are listed, nor whether forces balance: a packing in motion is one, too.
    pub fn consistent(self) -> Result<Self, PackingError> {
        self.check_consistency().map(|()| self)
    }

    /// Checks that the numbers belong together, as [`consistent`](Self::consistent) says: the first fault found.
    pub fn check_consistency(&self) -> Result<(), PackingError> {
        self.check_ids()?;
        let solid_fraction = self.solid_fraction();
        if solid_fraction > 1.0 {
            let requirement = "at most 1: the spheres do not fit into their cell";
            return Err(PackingError::Range {
                field: "solid_fraction",
                index: 0,
                value: solid_fraction,
                requirement,
            });
        }
        let cell = self.cell.matrix().amax();
        let usual =
            self.contacts.iter().map(|c| self.law_force(c)).sum::<f64>() / self.contacts.len().max(1) as f64;
        for (index, c) in self.contacts.iter().enumerate() {
            self.check_contact(c, cell, usual)?;
            // Both names of the contact with an own image are next to each other in the list of that grain.
            let opposite = c.image.map(|k| k.saturating_neg());
            if c.i == c.j && opposite < c.image {
                let own = self.contacts[..index].iter().rev().take_while(|b| b.i == c.i);
                if own.into_iter().any(|b| b.j == c.j && b.image == opposite) {
                    return Err(PackingError::ContactOrder { contact: index });
                }
            }
        }
        Ok(())
    }

    fn check_ids(&self) -> Result<(), PackingError> {
        if self.ids.windows(2).all(|w| w[0] < w[1]) {
            return Ok(());
        }
        let mut order: Vec<u32> = (0..self.ids.len() as u32).collect();
        order.sort_by_key(|k| (self.ids[*k as usize], *k));
        match order.windows(2).find(|w| self.ids[w[0] as usize] == self.ids[w[1] as usize]) {
            Some(w) => {
                Err(PackingError::DuplicateId { id: self.ids[w[0] as usize], first: w[0], second: w[1] })
            }
            None => Ok(()),
        }
    }

    /// `usual` is the mean normal force, N, of the contact law.
    fn check_contact(&self, c: &Contact, cell: f64, usual: f64) -> Result<(), PackingError> {
        let (i, j) = (c.i as usize, c.j as usize);
        let branch = self.branch(c);
        let distance = branch.norm();
        let ids = [c.i, c.j].map(|g| self.ids[g as usize]);
        let fault = |quantity, given, found| {
            let [i, j] = ids;
            Err(PackingError::Contradiction { i, j, quantity, given, found })
        };
        let steps = c.image.iter().map(|k| f64::from(k.unsigned_abs())).fold(1.0, f64::max);
        let largest = self.positions[i].amax() + self.positions[j].amax() + steps * cell;
        let rounding = ROUNDING * f64::EPSILON * largest;
        let overlap = self.radii[i] + self.radii[j] - distance;
        // Written so that NaN, of infinite distances, is a fault.
        let overlaps = (c.overlap - overlap).abs() <= SHARE * c.overlap + rounding;
        if !overlaps {
            return fault("overlap (m)", c.overlap, overlap);
        }
        let chord = (c.normal * distance - branch).norm();
        if chord.is_nan() || chord > SHARE * distance + rounding {
            if (c.normal * distance + branch).norm() <= SHARE * distance + rounding {
                let is_reversed = |c: &&Contact| c.normal.dot(&self.branch(c)) < 0.0;
                let (reversed, contacts) =
                    (self.contacts.iter().filter(is_reversed).count(), self.contacts.len());
                let [i, j] = ids;
                return Err(PackingError::ReversedNormal { i, j, reversed, contacts });
            }
            return fault("angle of the normal (rad)", 2.0 * (0.5 * chord / distance).min(1.0).asin(), 0.0);
        }
        let law_force = self.law_force(c);
        if c.normal_force.abs() > HARDEST * law_force.max(usual) {
            let ([i, j], force, law) = (ids, c.normal_force, self.law.name());
            return Err(PackingError::Force { i, j, force, law, law_force });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, Mat3, Material, Vec3};

    /// Two grains that touch across a face of a sheared cell; the second one also touches its own image.
    fn pair() -> Packing {
        let (a, b) = (Vec3::new(0.02, 0.3, 0.4), Vec3::new(0.92, 0.31, 0.42));
        let cell = Cell::new(Mat3::new(1.0, 0.2, 0.0, 0.0, 0.118, -0.1, 0.0, 0.0, 1.0)).unwrap();
        let branch = b - a + cell.shift([-1, 0, 0]);
        let overlap = 0.11 - branch.norm();
        let force = Material::GLASS.normal_force(0.03, overlap);
        Packing {
            ids: vec![7, 3],
            contacts: vec![Contact::pressed([0, 1], [-1, 0, 0], branch.normalize(), overlap, force)],
            friction: 0.1,
            ..Packing::at_rest(cell, vec![0.05, 0.06], vec![a, b])
        }
    }

    fn fault(change: impl FnOnce(&mut Packing)) -> String {
        let mut p = pair().validated().unwrap();
        change(&mut p);
        p.validated().unwrap().consistent().unwrap_err().to_string()
    }

    #[test]
    fn a_packing_whose_numbers_belong_together_passes() {
        assert_eq!(pair().consistent(), Ok(pair()));
        let gas = Packing { contacts: Vec::new(), ..pair() };
        assert_eq!(gas.clone().consistent(), Ok(gas));
    }

    #[test]
    fn what_does_not_belong_together_is_named() {
        assert!(fault(|p| p.ids[1] = 7).contains("same id 7"));
        assert!(
            fault(|p| p.contacts[0].overlap *= 1.0 + 1e-7)
                .contains("overlap (m) of the contact of grains 7 and 3")
        );
        assert!(fault(|p| p.positions[1].x -= 1e-7).contains("overlap"));
        assert!(fault(|p| p.radii[0] *= 1e-3).contains("overlap"));
        assert!(fault(|p| p.contacts[0].image = [0, 0, 0]).contains("overlap"));
        let turned = fault(|p| p.contacts[0].normal = p.contacts[0].normal.cross(&Vec3::x()).normalize());
        assert!(turned.contains("angle of the normal (rad)") && turned.contains("is 1.57"), "{turned}");
        let reversed = fault(|p| p.contacts[0].normal = -p.contacts[0].normal);
        assert!(
            reversed.starts_with(
                "the normals of 1 of 1 contacts point the wrong way, the first of grains 7 and 3"
            ),
            "{reversed}"
        );
        let force = fault(|p| p.contacts[0].normal_force *= 1e3);
        assert!(force.contains("is 1049 times that of hertz_mindlin contacts at its overlap"), "{force}");
        assert!(fault(|p| p.radii = vec![0.4, 0.4]).contains("solid_fraction"));
    }

    /// Cells are narrow in shear, and grains wander.
    #[test]
    fn images_and_grains_far_from_the_cell_are_within_rounding() {
        let mut p = pair();
        let shift = [3i8, -50, 2];
        p.positions[0] += p.cell.shift(shift);
        p.contacts[0].image = [2, -50, 2];
        assert!(p.consistent().is_ok());
    }

    #[test]
    fn a_contact_with_an_own_image_has_one_name() {
        let mut p = pair();
        p.cell = Cell::cube(0.1).unwrap();
        p.radii = vec![0.051];
        (p.ids, p.positions) = (vec![1], vec![Vec3::zeros()]);
        (p.velocities, p.spins) = (vec![Vec3::zeros()], vec![Vec3::zeros()]);
        let own = |k: i8| Contact::pressed([0, 0], [0, 0, k], Vec3::z() * f64::from(k), 0.102 - 0.1, 1.0);
        p.contacts = vec![own(1)];
        assert!(p.clone().validated().unwrap().consistent().is_ok());
        p.contacts = vec![own(-1), own(1)];
        let twice = p.validated().unwrap().consistent();
        assert_eq!(twice, Err(PackingError::ContactOrder { contact: 1 }));
    }
}
