//! Finding neighbouring pairs in a periodic cell of any shape.
//!
//! There are two lists. The neighbours are all pairs within the Verlet skin, found with bins. The pairs of the force kernel
//! are those neighbours that may touch soon: the neighbours are pruned to them, often and cheaply, so that the kernel sees
//! little more than the contacts.

use super::contacts::Contacts;
use super::grid::Grid;
use super::images::Images;
use super::subdomain_pairs::PairsBuilder;
use super::types::{History, Pair, PairBlock, RollingBlock};
use crate::domain::decomposition::Subdomain;
use crate::domain::state::{State, vector};
use crate::simd::simd_f64::BLOCK_SIZE;
use grainlab_core::Cell;
use grainlab_engine::{Compute, EngineError};
use std::ops::Range;

/// All pairs closer than R_i + R_j + skin when they were found, sorted by (i, j, image). Self-images are included; each pair
/// appears once, with i < j, or i = j and a positive image.
#[derive(Clone, Debug, Default)]
pub(crate) struct Neighbours {
    /// First pair of each grain, and the end.
    start: Vec<u32>,
    j: Vec<u32>,
    /// Row in the table of images.
    image: Vec<u32>,
}

impl Neighbours {
    pub(crate) fn find(state: &State, skin: f64) -> Result<(Self, Images), EngineError> {
        let mut grid = Grid::new(state, 2.0 * state.largest_radius + skin)?;
        let mut rows = ImageRows::new(state);
        let mut list = Self { start: Vec::with_capacity(state.len() + 1), ..Self::default() };
        list.start.push(0);
        let mut near: Vec<(u32, [i8; 3])> = Vec::new();
        for i in 0..state.len() {
            near.clear();
            grid.neighbours(state, i, skin, &mut near)?;
            grid.remove(i);
            near.sort_unstable();
            for &(j, image) in &near {
                list.j.push(j);
                list.image.push(rows.index(image, &state.cell));
            }
            list.start.push(list.j.len() as u32);
        }
        Ok((list, rows.images))
    }

    /// The pairs now closer than R_i + R_j + `skin`, with the history of `old`, in one subdomain per thread if there are grains
    /// enough. `images` is the table that this list refers to.
    pub(crate) fn prune(
        &self,
        state: &State,
        images: Images,
        old: &Contacts,
        skin: f64,
        compute: &Compute,
    ) -> Contacts {
        let split = Subdomain::split(state.len(), compute.threads());
        let expected = old.slots() / split.len();
        let subdomains = compute.map_subdomains(split.enumerate(), |(k, subdomain)| {
            let mut pairs = PairsBuilder::new(state, subdomain.clone(), expected);
            let history = HistoryCursor::new(old, k, &subdomain);
            self.prune_subdomain(state, &images, history, skin, subdomain.grains(), &mut pairs);
            pairs.finish()
        });
        Contacts { images, subdomains }
    }

    /// Adds to `pairs` those that act on the grains `owned`.
    fn prune_subdomain(
        &self,
        state: &State,
        images: &Images,
        mut old: HistoryCursor<'_>,
        skin: f64,
        owned: Range<usize>,
        pairs: &mut PairsBuilder,
    ) {
        let longest = self.start.windows(2).map(|w| w[1] - w[0]).max().unwrap_or(0);
        let mut near = vec![0; longest as usize];
        let offsets = images.offsets();
        for i in 0..owned.end {
            let mut range = self.start[i] as usize..self.start[i + 1] as usize;
            if i < owned.start {
                // Sorted by j.
                let second = &self.j[range.clone()];
                let [from, to] =
                    [owned.start, owned.end].map(|g| second.partition_point(|j| (*j as usize) < g));
                range = range.start + from..range.start + to;
            }
            let (here, radius) = (vector(&state.position[i]), state.radius[i]);
            // Near pairs cannot be predicted: count them without a branch.
            let mut count = 0;
            for (q, (j, image)) in range.clone().zip(self.j[range.clone()].iter().zip(&self.image[range])) {
                let branch = vector(&state.position[*j as usize]) - here + vector(&offsets[*image as usize]);
                let reach = radius + state.radius[*j as usize] + skin;
                near[count] = q;
                count += usize::from(branch.norm_squared() < reach * reach);
            }
            for &q in &near[..count] {
                let (j, image) = (self.j[q], self.image[q]);
                let history = old.take(i as u32, j, images.number(image));
                pairs.push(state, images, Pair { i: i as u32, j, image, history });
            }
        }
    }
}

/// Reads the history of touching pairs, in order.
struct HistoryCursor<'a> {
    images: &'a Images,
    /// The blocks with pairs that may be asked for, in order, with their rolling forces.
    blocks: Vec<(&'a [PairBlock], &'a [RollingBlock])>,
    /// The next pair may be in this run of blocks, at this slot.
    run: usize,
    slot: usize,
}

impl<'a> HistoryCursor<'a> {
    fn new(old: &'a Contacts, k: usize, subdomain: &Subdomain) -> Self {
        let blocks = match old.subdomains.get(k) {
            Some(pairs) if pairs.subdomain == *subdomain => vec![(&pairs.blocks[..], &pairs.rolling[..])],
            _ => old.subdomains.iter().map(|s| (s.owned_blocks(), s.owned_rolling())).collect(),
        };
        Self { images: &old.images, blocks, run: 0, slot: 0 }
    }

    /// History of a pair, zero where it did not touch. Pairs must be asked for in order.
    #[inline]
    fn take(&mut self, i: u32, j: u32, image: [i8; 3]) -> History {
        while let Some((blocks, rolling)) = self.blocks.get(self.run) {
            let Some(block) = blocks.get(self.slot / BLOCK_SIZE) else {
                (self.run, self.slot) = (self.run + 1, 0);
                continue;
            };
            let lane = self.slot % BLOCK_SIZE;
            if block.contact_radius[lane] > 0.0 {
                let number = || self.images.number(block.image[lane]);
                let order = (block.i[lane], block.j[lane]).cmp(&(i, j)).then_with(|| number().cmp(&image));
                if order.is_gt() {
                    break;
                }
                if order.is_eq() {
                    let rolling = rolling.get(self.slot / BLOCK_SIZE);
                    self.slot += 1;
                    return block.history(rolling, lane);
                }
            }
            self.slot += 1;
        }
        History::default()
    }
}

/// A table of images with direct access to the near ones.
struct ImageRows {
    images: Images,
    /// Rows of images up to [`NEAR`] cells away; 0 for images that have no row yet.
    near: [u32; (2 * NEAR as usize + 1).pow(3)],
}

/// Images up to so many cells away along each axis are looked up directly.
const NEAR: i8 = 2;

impl ImageRows {
    fn new(state: &State) -> Self {
        Self { images: Images::new(state), near: [0; _] }
    }

    #[inline]
    fn index(&mut self, image: [i8; 3], cell: &Cell) -> u32 {
        if image.iter().any(|k| k.abs() > NEAR) {
            return self.images.index(image, cell);
        }
        let at = image.iter().fold(0, |at, k| (2 * NEAR as usize + 1) * at + (k + NEAR) as usize);
        if self.near[at] == 0 {
            self.near[at] = self.images.index(image, cell);
        }
        self.near[at]
    }
}
