//! The pairs that one thread works on.

use super::images::Images;
use super::types::{PADDING, Pair, PairBlock, PairChunk, PairSizes, PeriodicPair, RollingBlock};
use crate::domain::accumulator::{AccumulatorBuilder, ForceAccumulator, PartAccumulator, StoredForces};
use crate::domain::decomposition::Subdomain;
use crate::domain::state::State;
use crate::simd::simd_f64::{BLOCK_SIZE, CHUNK_SIZE};
use grainlab_core::effective_radius;

/// Pairs sorted by (i, j, image), in blocks; each chunk of grains begins a new block.
///
/// A subdomain has all pairs that act on its grains: those whose first grain it owns, and those whose first grain an earlier
/// subdomain owns. The earlier subdomain has the latter too. So each subdomain sums forces and moves its grains without
/// waiting for others. What two subdomains evaluate has the same bits in both.
#[derive(Clone, Debug)]
pub(crate) struct SubdomainPairs {
    pub(crate) subdomain: Subdomain,
    pub(crate) blocks: Vec<PairBlock>,
    /// Beside each block; empty where contacts do not resist rolling.
    pub(crate) rolling: Vec<RollingBlock>,
    sizes: Vec<PairSizes>,
    /// First block of each chunk up to the last owned one, and the end.
    chunk_start: Vec<u32>,
    /// Pairs across the faces of the cell, in the order of the sum.
    periodic: Vec<PeriodicPair>,
    /// First of `periodic` for each chunk, and the end.
    periodic_start: Vec<u32>,
    /// Grains of other subdomains in its pairs; they may repeat.
    pub(crate) ghosts: Vec<u32>,
    accumulator: ForceAccumulator,
}

pub(crate) struct PartPairs<'a> {
    blocks: &'a mut [PairBlock],
    rolling: &'a mut [RollingBlock],
    /// Sizes in all parts.
    sizes: &'a [PairSizes],
    /// Pairs across the faces in all parts.
    periodic: &'a [PeriodicPair],
    /// First block and first periodic pair of each chunk of the part, and the end.
    chunk_start: &'a [u32],
    periodic_start: &'a [u32],
    pub(crate) accumulator: PartAccumulator<'a>,
}

impl PartPairs<'_> {
    pub(crate) fn chunks(&self) -> usize {
        self.chunk_start.len() - 1
    }

    pub(crate) fn chunk(&mut self, c: usize) -> PairChunk<'_> {
        let blocks = self.chunk_start[c] as usize..self.chunk_start[c + 1] as usize;
        let first = self.chunk_start[0] as usize;
        let own = blocks.start - first..blocks.end - first;
        PairChunk {
            sizes: if self.sizes.is_empty() { &[] } else { &self.sizes[blocks] },
            rolling: if self.rolling.is_empty() { &mut [] } else { &mut self.rolling[own.clone()] },
            blocks: &mut self.blocks[own],
            periodic: &self.periodic[self.periodic_start[c] as usize..self.periodic_start[c + 1] as usize],
            sums: self.accumulator.rows,
        }
    }
}

impl SubdomainPairs {
    /// The blocks of pairs whose first grain is owned, with their sizes, chunk by chunk.
    pub(crate) fn owned_chunks(&self) -> impl Iterator<Item = (&[PairBlock], &[PairSizes])> {
        self.chunk_start[self.subdomain.chunks().start..].windows(2).map(|c| {
            let range = c[0] as usize..c[1] as usize;
            let sizes = if self.sizes.is_empty() { &[] } else { &self.sizes[range.clone()] };
            (&self.blocks[range], sizes)
        })
    }

    /// The blocks of pairs whose first grain is owned.
    pub(crate) fn owned_blocks(&self) -> &[PairBlock] {
        &self.blocks[self.first_owned()..]
    }

    /// The rolling forces of those blocks; empty where contacts do not resist rolling.
    pub(crate) fn owned_rolling(&self) -> &[RollingBlock] {
        self.rolling.get(self.first_owned()..).unwrap_or(&[])
    }

    /// The pair in each place of those blocks; `None` where it only pads a block.
    pub(crate) fn owned_pairs(&self) -> impl Iterator<Item = Option<Pair>> {
        let rolling = self.owned_rolling();
        let blocks = self.owned_blocks().iter().enumerate();
        blocks.flat_map(move |(b, block)| (0..BLOCK_SIZE).map(move |lane| block.pair(rolling.get(b), lane)))
    }

    fn first_owned(&self) -> usize {
        self.chunk_start[self.subdomain.chunks().start] as usize
    }

    pub(crate) fn clear_history(&mut self) {
        self.blocks.iter_mut().for_each(|block| block.history = [[0.0; BLOCK_SIZE]; 3]);
        self.rolling.fill(RollingBlock::default());
    }

    /// Earlier parts must be complete.
    pub(crate) fn part_mut(&mut self, part: usize) -> PartPairs<'_> {
        let chunks = self.subdomain.chunks_of(part);
        let chunks = chunks.start..chunks.end + 1;
        let (chunk_start, periodic_start) = (&self.chunk_start[chunks.clone()], &self.periodic_start[chunks]);
        let blocks = chunk_start[0] as usize..chunk_start[chunk_start.len() - 1] as usize;
        PartPairs {
            rolling: if self.rolling.is_empty() { &mut [] } else { &mut self.rolling[blocks.clone()] },
            blocks: &mut self.blocks[blocks],
            sizes: &self.sizes,
            periodic: &self.periodic,
            chunk_start,
            periodic_start,
            accumulator: self.accumulator.part_mut(part),
        }
    }

    pub(crate) fn stored_forces(&self) -> impl Iterator<Item = StoredForces<'_>> {
        self.accumulator.chunks()
    }
}

/// Fills [`SubdomainPairs`] pair by pair, in order.
pub(crate) struct PairsBuilder {
    pairs: SubdomainPairs,
    accumulator: AccumulatorBuilder,
    /// Pairs in the last block.
    filled: usize,
    is_monodisperse: bool,
    resists_rolling: bool,
}

impl PairsBuilder {
    pub(crate) fn new(state: &State, subdomain: Subdomain, expected: usize) -> Self {
        let blocks = expected / BLOCK_SIZE + subdomain.chunks().len() + 2;
        let pairs = SubdomainPairs {
            subdomain: subdomain.clone(),
            blocks: Vec::with_capacity(blocks),
            rolling: Vec::new(),
            sizes: Vec::new(),
            chunk_start: vec![0],
            periodic: Vec::new(),
            periodic_start: vec![0],
            ghosts: Vec::new(),
            accumulator: ForceAccumulator::default(),
        };
        let accumulator = AccumulatorBuilder::new(subdomain, state.len());
        Self {
            pairs,
            accumulator,
            filled: BLOCK_SIZE,
            is_monodisperse: state.is_monodisperse(),
            resists_rolling: state.law.rolling.is_some(),
        }
    }

    /// Pairs must come sorted by (i, j, image).
    pub(crate) fn push(&mut self, state: &State, images: &Images, pair: Pair) {
        let (i, j) = (pair.i as usize, pair.j as usize);
        while self.pairs.chunk_start.len() <= i / CHUNK_SIZE {
            self.end_chunk();
        }
        if self.filled == BLOCK_SIZE {
            self.begin_block(state, pair.i);
        }
        let (lane, pairs) = (self.filled, &mut self.pairs);
        self.filled += 1;
        let accumulator_row = self.accumulator.row(i / CHUNK_SIZE, j);
        let owned = self.accumulator.grains.clone();
        for grain in [pair.i, pair.j] {
            // The pairs of a grain are consecutive, so this leaves out most repetitions.
            if !owned.contains(&(grain as usize)) && pairs.ghosts.last() != Some(&grain) {
                pairs.ghosts.push(grain);
            }
        }
        if images.number(pair.image) != [0; 3] {
            let before = pairs.chunk_start.last().map_or(0, |b| *b as usize);
            let slot = ((pairs.blocks.len() - 1 - before) * BLOCK_SIZE + lane) as u32;
            pairs.periodic.push(PeriodicPair { slot, image: pair.image });
        }
        if let Some(block) = pairs.blocks.last_mut() {
            block.contact_radius[lane] = pair.history.contact_radius;
            for k in 0..3 {
                block.history[k][lane] = pair.history.tangential[k];
            }
            (block.i[lane], block.j[lane]) = (pair.i, pair.j);
            (block.image[lane], block.accumulator_row[lane]) = (pair.image, accumulator_row);
        }
        if let Some(rolling) = pairs.rolling.last_mut() {
            for k in 0..3 {
                rolling.history[k][lane] = pair.history.rolling[k];
            }
        }
        if let Some(sizes) = pairs.sizes.last_mut() {
            let (r_i, r_j) = (state.radius[i], state.radius[j]);
            (sizes.radius_i[lane], sizes.radius_j[lane]) = (r_i, r_j);
            sizes.r_eff[lane] = effective_radius(r_i, r_j);
            sizes.m_eff[lane] = 1.0 / (state.inverse_mass[i] + state.inverse_mass[j]);
        }
    }

    /// Begins a block, padded with pairs of `grain` and itself.
    fn begin_block(&mut self, state: &State, grain: u32) {
        let i = grain as usize;
        self.pairs.blocks.push(PairBlock {
            contact_radius: [0.0; BLOCK_SIZE],
            history: [[0.0; BLOCK_SIZE]; 3],
            i: [grain; BLOCK_SIZE],
            j: [grain; BLOCK_SIZE],
            image: [PADDING; BLOCK_SIZE],
            accumulator_row: [(i % CHUNK_SIZE) as u32; BLOCK_SIZE],
        });
        if self.resists_rolling {
            self.pairs.rolling.push(RollingBlock::default());
        }
        if !self.is_monodisperse {
            let r = state.radius[i];
            self.pairs.sizes.push(PairSizes {
                radius_i: [r; BLOCK_SIZE],
                radius_j: [r; BLOCK_SIZE],
                r_eff: [effective_radius(r, r); BLOCK_SIZE],
                m_eff: [0.5 / state.inverse_mass[i]; BLOCK_SIZE],
            });
        }
        self.filled = 0;
    }

    fn end_chunk(&mut self) {
        let pairs = &mut self.pairs;
        pairs.chunk_start.push(pairs.blocks.len() as u32);
        pairs.periodic_start.push(pairs.periodic.len() as u32);
        self.filled = BLOCK_SIZE;
    }

    pub(crate) fn finish(mut self) -> SubdomainPairs {
        while self.pairs.chunk_start.len() <= self.pairs.subdomain.chunks().end {
            self.end_chunk();
        }
        SubdomainPairs { accumulator: self.accumulator.finish(), ..self.pairs }
    }
}
