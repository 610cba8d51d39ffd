//! Data common to all measurements on a packing, computed once.

use grainlab_core::stress::{Stress, stress};
use grainlab_core::{Packing, PackingError, Vec3, non_rattlers};

/// A packing with the data common to all measurements.
#[derive(Clone, Debug)]
pub struct PackingView<'a> {
    /// The packing seen.
    pub packing: &'a Packing,
    /// For each grain, whether it is part of the contact network ([`non_rattlers`]).
    pub non_rattlers: Vec<bool>,
    /// Branch vector of each contact, m.
    pub branches: Vec<Vec3>,
    /// Stiffnesses (k_n, k_t) of each contact, N/m.
    pub contact_stiffnesses: Vec<(f64, f64)>,
    /// Stress of the elastic contact forces.
    pub stress: Stress,
    /// ⟨F_n⟩ over contacts, N; 0 without contacts.
    pub mean_normal_force: f64,
}

impl<'a> PackingView<'a> {
    /// Computes the data of `packing`.
    ///
    /// # Errors
    /// Numbers that are no packing.
    pub fn new(packing: &'a Packing) -> Result<Self, PackingError> {
        packing.check()?;
        let contacts = &packing.contacts;
        let forces: f64 = contacts.iter().map(|c| c.normal_force).sum();
        Ok(Self {
            packing,
            non_rattlers: non_rattlers(packing),
            branches: contacts.iter().map(|c| packing.branch(c)).collect(),
            contact_stiffnesses: contacts.iter().map(|c| packing.contact_stiffness(c)).collect(),
            stress: stress(packing),
            mean_normal_force: forces / contacts.len().max(1) as f64,
        })
    }

    /// Number of non-rattlers.
    pub fn carrying(&self) -> usize {
        self.non_rattlers.iter().filter(|carries| **carries).count()
    }

    /// True if neither of two grains is a rattler.
    pub fn carries_force(&self, i: u32, j: u32) -> bool {
        self.non_rattlers[i as usize] && self.non_rattlers[j as usize]
    }
}
