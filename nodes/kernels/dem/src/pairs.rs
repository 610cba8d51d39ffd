//! Neighbouring pairs with their contact history.

use crate::state::{Soa, State};
use grains::{Contact, Packing, Vec3};

/// Pairs within the Verlet radius, sorted by (i, j, image), each with the history of its contact.
///
/// Pairs that do not touch contribute nothing to any sum, so results do not depend on which of them are listed.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pairs {
    pub(crate) i: Vec<u32>,
    pub(crate) j: Vec<u32>,
    /// Index into `images`.
    pub(crate) image: Vec<u32>,
    /// The distinct periodic images in use.
    pub(crate) images: Vec<[i8; 3]>,
    /// Shift of each of `images` in the present cell, m.
    pub(crate) shifts: Vec<Vec3>,
    /// Full overlap at the last evaluation, m; 0 where the pair does not touch.
    pub(crate) overlap: Vec<f64>,
    /// Elastic tangential force on `i`, N.
    pub(crate) tangential: Soa,
}

impl Pairs {
    pub(crate) fn len(&self) -> usize {
        self.i.len()
    }

    #[inline(always)]
    pub(crate) fn key(&self, p: usize) -> (u32, u32, [i8; 3]) {
        (self.i[p], self.j[p], self.images[self.image[p] as usize])
    }

    pub(crate) fn push(&mut self, i: u32, j: u32, image: [i8; 3], overlap: f64, tangential: Vec3) {
        let slot = match self.images.iter().position(|k| *k == image) {
            Some(slot) => slot,
            None => {
                self.images.push(image);
                self.images.len() - 1
            }
        };
        self.i.push(i);
        self.j.push(j);
        self.image.push(slot as u32);
        self.overlap.push(overlap);
        self.tangential.push(tangential);
    }

    /// Brings the shifts up to date with the cell.
    pub(crate) fn follow(&mut self, state: &State) {
        self.shifts.clear();
        self.shifts.extend(self.images.iter().map(|k| state.cell.shift(*k)));
    }

    /// Branch vector of pair `p`, from `i` to the image of `j`, m.
    #[inline(always)]
    pub(crate) fn branch(&self, p: usize, position: &Soa) -> Vec3 {
        position.get(self.j[p] as usize) - position.get(self.i[p] as usize)
            + self.shifts[self.image[p] as usize]
    }

    /// The contacts of a packing, as a list of their own.
    pub(crate) fn from_packing(packing: &Packing) -> Self {
        let mut pairs = Self::default();
        for c in &packing.contacts {
            pairs.push(c.i, c.j, c.image, c.overlap, c.tangential_force);
        }
        pairs
    }

    /// The touching pairs as contacts, in the order of the sum.
    pub(crate) fn contacts(&self, state: &State) -> Vec<Contact> {
        let touching = (0..self.len()).filter(|p| self.overlap[*p] > 0.0);
        touching
            .map(|p| {
                let (i, j, image) = self.key(p);
                let branch = self.branch(p, &state.position);
                let r_eff =
                    grains::material::effective_radius(state.radius[i as usize], state.radius[j as usize]);
                Contact {
                    i,
                    j,
                    image,
                    overlap: self.overlap[p],
                    normal: branch / branch.norm(),
                    normal_force: state.material.normal_force(r_eff, self.overlap[p]),
                    tangential_force: self.tangential.get(p),
                }
            })
            .collect()
    }
}
