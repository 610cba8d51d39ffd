//! Pairs that touch or soon may, with the history of their contacts.

use crate::images::Images;
use crate::lanes::{BLOCK, V3};
use crate::own::Own;
use crate::share::{Block, Builder, Pair, Share};
use crate::state::{State, vector};
use grainlab_core::material::effective_radius;
use grainlab_core::{Contact, Packing, Vec3};

/// All pairs, shared out.
///
/// Pairs that do not touch contribute exact zeros to sums, so no result depends on which are listed; nor does any depend
/// on how many shares there are.
#[derive(Clone, Debug)]
pub(crate) struct Contacts {
    pub(crate) images: Images,
    /// In the order of their grains.
    pub(crate) shares: Vec<Share>,
}

/// A touching pair as it is kept: grains, image, √(R* δ) (m) and tangential force (N).
pub(crate) type Kept = (u32, u32, [i8; 3], f64, Vec3);

impl Contacts {
    /// No pairs.
    pub(crate) fn none(state: &State) -> Self {
        Self::of(state, std::iter::empty(), 0)
    }

    /// These pairs, which must come sorted, in one share.
    pub(crate) fn of(state: &State, kept: impl Iterator<Item = Kept>, expected: usize) -> Self {
        let mut images = Images::new(state);
        let mut share = Builder::new(state, Own::all(state.grains()), expected);
        for (i, j, image, root, history) in kept {
            let image = images.index(image, &state.cell);
            share.push(state, &images, Pair { i, j, image, root, history });
        }
        Self { images, shares: vec![share.finish()] }
    }

    /// The contacts of a packing.
    pub(crate) fn from_packing(packing: &Packing, state: &State) -> Self {
        let kept = packing.contacts.iter().map(|c| {
            let (r_i, r_j) = (state.radius[c.i as usize], state.radius[c.j as usize]);
            (c.i, c.j, c.image, (effective_radius(r_i, r_j) * c.overlap).sqrt(), c.tangential_force)
        });
        Self::of(state, kept, packing.contacts.len())
    }

    /// All blocks, in the order of the sum.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.shares.iter().flat_map(Share::own_blocks)
    }

    /// Places for pairs.
    pub(crate) fn slots(&self) -> usize {
        self.shares.iter().map(|s| s.own_blocks().len()).sum::<usize>() * BLOCK
    }

    /// Pairs that touch, in the order of the sum.
    pub(crate) fn touching(&self) -> impl Iterator<Item = Pair> {
        let pairs = self.blocks().flat_map(|b| (0..BLOCK).filter_map(|lane| b.pair(lane)));
        pairs.filter(Pair::touches)
    }

    /// The same, to be kept.
    pub(crate) fn kept(&self) -> impl Iterator<Item = Kept> {
        self.touching().map(|p| (p.i, p.j, self.images.number(p.image), p.root, p.history))
    }

    /// Branch vector of a pair, from `i` to the image of `j`, m.
    pub(crate) fn branch(&self, p: &Pair, state: &State) -> Vec3 {
        vector(&state.position[p.j as usize]) - vector(&state.position[p.i as usize])
            + vector(&self.images.shifts()[p.image as usize])
    }

    /// The touching pairs as contacts, in the order of the sum.
    pub(crate) fn contacts(&self, state: &State) -> Vec<Contact> {
        let contact = |p: Pair| {
            let branch = self.branch(&p, state);
            let (r_i, r_j) = (state.radius[p.i as usize], state.radius[p.j as usize]);
            let r_eff = effective_radius(r_i, r_j);
            let distance = distance(&branch);
            let overlap = r_i + r_j - distance;
            // A run that failed may have moved on without its contacts.
            (overlap > 0.0).then(|| Contact {
                i: p.i,
                j: p.j,
                image: self.images.number(p.image),
                overlap,
                normal: branch / distance,
                normal_force: state.material.normal_force(r_eff, overlap),
                tangential_force: p.history,
            })
        };
        self.touching().filter_map(contact).collect()
    }

    /// Forgets tangential forces.
    pub(crate) fn forget(&mut self) {
        for block in self.shares.iter_mut().flat_map(|s| &mut s.blocks) {
            block.history = [[0.0; BLOCK]; 3];
        }
    }
}

/// |l|, rounded as in the contact pass.
fn distance(branch: &Vec3) -> f64 {
    let branch = V3::new(branch.x, branch.y, branch.z);
    branch.dot(branch).sqrt()
}
