//! Pairs that touch or soon may, with the history of their contacts.

use super::images::Images;
use super::subdomain_pairs::{PairsBuilder, SubdomainPairs};
use super::types::{History, Pair, PairBlock, SavedContact};
use crate::domain::decomposition::Subdomain;
use crate::domain::state::{State, vector};
use crate::simd::simd_f64::BLOCK_SIZE;
use grainlab_core::effective_radius;
use grainlab_core::lanes::LaneVec3;
use grainlab_core::{Contact, Packing, Vec3};

/// All pairs, divided among subdomains.
///
/// Pairs that do not touch contribute exact zeros to sums. So no result depends on which pairs are listed, nor on the number
/// of subdomains.
#[derive(Clone, Debug)]
pub(crate) struct Contacts {
    pub(crate) images: Images,
    /// In the order of their grains.
    pub(crate) subdomains: Vec<SubdomainPairs>,
}

impl Contacts {
    /// These contacts, which must come sorted, in one subdomain.
    pub(crate) fn from_saved(state: &State, saved: Vec<SavedContact>) -> Self {
        let mut images = Images::new(state);
        let mut pairs = PairsBuilder::new(state, Subdomain::whole(state.len()), saved.len());
        for SavedContact { i, j, image, history } in saved {
            let image = images.index(image, &state.cell);
            pairs.push(state, &images, Pair { i, j, image, history });
        }
        Self { images, subdomains: vec![pairs.finish()] }
    }

    pub(crate) fn from_packing(packing: &Packing, state: &State) -> Self {
        let saved = |c: &Contact| {
            let (r_i, r_j) = (state.radius[c.i as usize], state.radius[c.j as usize]);
            let history = History {
                contact_radius: (effective_radius(r_i, r_j) * c.overlap).sqrt(),
                tangential: c.tangential_force,
                rolling: c.rolling_force,
            };
            SavedContact { i: c.i, j: c.j, image: c.image, history }
        };
        Self::from_saved(state, packing.contacts.iter().map(saved).collect())
    }

    /// All blocks, in the order of the sum.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = &PairBlock> {
        self.subdomains.iter().flat_map(SubdomainPairs::owned_blocks)
    }

    /// Number of places for pairs, padding included.
    pub(crate) fn slots(&self) -> usize {
        self.subdomains.iter().map(|s| s.owned_blocks().len()).sum::<usize>() * BLOCK_SIZE
    }

    /// The pair in each place, in the order of the sum; `None` where it only pads a block.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = Option<Pair>> {
        self.subdomains.iter().flat_map(SubdomainPairs::owned_pairs)
    }

    /// Pairs that touch, in the order of the sum.
    pub(crate) fn touching(&self) -> impl Iterator<Item = Pair> {
        self.pairs().flatten().filter(Pair::touches)
    }

    /// Pairs that touch, to be saved.
    pub(crate) fn saved(&self) -> impl Iterator<Item = SavedContact> {
        self.touching().map(|p| SavedContact {
            i: p.i,
            j: p.j,
            image: self.images.number(p.image),
            history: p.history,
        })
    }

    /// Branch vector of a pair, from `i` to the image of `j`, m.
    pub(crate) fn branch(&self, p: &Pair, state: &State) -> Vec3 {
        vector(&state.position[p.j as usize]) - vector(&state.position[p.i as usize])
            + vector(&self.images.offsets()[p.image as usize])
    }

    /// The touching pairs as the contacts of a packing, in the order of the sum.
    pub(crate) fn to_contacts(&self, state: &State) -> Vec<Contact> {
        let contact = |p: Pair| {
            let branch = self.branch(&p, state);
            let (r_i, r_j) = (state.radius[p.i as usize], state.radius[p.j as usize]);
            let r_eff = effective_radius(r_i, r_j);
            let distance = distance(&branch);
            let overlap = r_i + r_j - distance;
            // In a failed run grains may have moved after the last evaluation of their contacts.
            (overlap > 0.0).then(|| Contact {
                i: p.i,
                j: p.j,
                image: self.images.number(p.image),
                overlap,
                normal: branch / distance,
                normal_force: state.law.normal_force(&state.material, r_eff, overlap),
                tangential_force: p.history.tangential,
                rolling_force: p.history.rolling,
            })
        };
        self.touching().filter_map(contact).collect()
    }

    /// Sets all tangential and rolling forces to zero.
    pub(crate) fn clear_history(&mut self) {
        self.subdomains.iter_mut().for_each(SubdomainPairs::clear_history);
    }
}

/// |l|, rounded as in the force kernel.
fn distance(branch: &Vec3) -> f64 {
    let branch = LaneVec3::new(branch.x, branch.y, branch.z);
    branch.dot(branch).sqrt()
}
