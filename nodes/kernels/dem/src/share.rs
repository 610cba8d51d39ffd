//! The pairs that one thread works on, eight to a block.

use crate::images::{Images, NOWHERE};
use crate::lanes::{BLOCK, CHUNK};
use crate::own::Own;
use crate::pass::Chunk;
use crate::state::State;
use crate::sums::{Layout, PartSums, Put, Sums};
use grainlab_core::Vec3;
use grainlab_core::material::effective_radius;

/// Eight pairs.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Block {
    /// √(R* δ) at the last evaluation, m; 0 where the pair does not touch.
    pub(crate) root: [f64; BLOCK],
    /// Elastic tangential force on `i`, N.
    pub(crate) history: [[f64; BLOCK]; 3],
    pub(crate) i: [u32; BLOCK],
    pub(crate) j: [u32; BLOCK],
    pub(crate) image: [u32; BLOCK],
    /// Row for what acts on `j`. That for `i` is its place in the chunk.
    pub(crate) to: [u32; BLOCK],
}

/// What a contact law needs to know of the sizes of eight pairs; kept only where sizes differ.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Sizes {
    pub(crate) radius_i: [f64; BLOCK],
    pub(crate) radius_j: [f64; BLOCK],
    pub(crate) r_eff: [f64; BLOCK],
    pub(crate) m_eff: [f64; BLOCK],
}

/// A pair whose second grain is an image.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Slot among those of its chunk.
    pub(crate) slot: u32,
    /// Row in [`Images`].
    pub(crate) image: u32,
}

/// One pair.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    pub(crate) i: u32,
    pub(crate) j: u32,
    /// Row in [`Images`].
    pub(crate) image: u32,
    /// √(R* δ), m; 0 where it does not touch.
    pub(crate) root: f64,
    pub(crate) history: Vec3,
}

impl Pair {
    pub(crate) fn touches(&self) -> bool {
        self.root > 0.0
    }
}

impl Block {
    /// The pair in a lane; `None` where it only fills up the block.
    #[inline(always)]
    pub(crate) fn pair(&self, lane: usize) -> Option<Pair> {
        let h = &self.history;
        (self.image[lane] != NOWHERE).then(|| Pair {
            i: self.i[lane],
            j: self.j[lane],
            image: self.image[lane],
            root: self.root[lane],
            history: Vec3::new(h[0][lane], h[1][lane], h[2][lane]),
        })
    }
}

/// Pairs sorted by (i, j, image), in blocks that begin anew with each chunk of grains.
///
/// A share has some parts of grains for its own, and all pairs that act on them: those whose first grain is its own, and
/// those by which grains of earlier shares act on its own, which the earlier share has as well. So it sums and moves its
/// grains without waiting for others. What both have is the same bit for bit.
#[derive(Clone, Debug)]
pub(crate) struct Share {
    /// The grains that are its own.
    own: Own,
    pub(crate) blocks: Vec<Block>,
    sizes: Vec<Sizes>,
    /// First block of each chunk up to the last of its own, and the end.
    chunks: Vec<u32>,
    /// Pairs across the faces of the cell, in the order of the sum.
    crossing: Vec<Crossing>,
    /// First of `crossing` of each chunk, and the end.
    crossings: Vec<u32>,
    /// Grains of other shares in its pairs, each at least once.
    abroad: Vec<u32>,
    sums: Sums,
}

/// Some chunks, passed one after the other.
pub(crate) struct Part<'a> {
    blocks: &'a mut [Block],
    /// Of all parts.
    sizes: &'a [Sizes],
    crossing: &'a [Crossing],
    /// First block and first crossing of each of its chunks, and the end.
    bounds: &'a [u32],
    faces: &'a [u32],
    pub(crate) sums: PartSums<'a>,
}

impl Part<'_> {
    /// How many chunks.
    pub(crate) fn chunks(&self) -> usize {
        self.bounds.len() - 1
    }

    /// Chunk `c` of the part, to pass.
    pub(crate) fn chunk(&mut self, c: usize) -> Chunk<'_> {
        let blocks = self.bounds[c] as usize..self.bounds[c + 1] as usize;
        let first = self.bounds[0] as usize;
        Chunk {
            sizes: if self.sizes.is_empty() { &[] } else { &self.sizes[blocks.clone()] },
            blocks: &mut self.blocks[blocks.start - first..blocks.end - first],
            crossing: &self.crossing[self.faces[c] as usize..self.faces[c + 1] as usize],
            sums: self.sums.rows(),
        }
    }
}

impl Share {
    /// The grains that are its own.
    pub(crate) fn own(&self) -> &Own {
        &self.own
    }

    /// Grains of other shares in its pairs, each at least once.
    pub(crate) fn abroad(&self) -> &[u32] {
        &self.abroad
    }

    /// The blocks of pairs whose first grain is its own, and their sizes, chunk by chunk.
    pub(crate) fn own_chunks(&self) -> impl Iterator<Item = (&[Block], &[Sizes])> {
        self.chunks[self.own.chunks().start..].windows(2).map(|c| {
            let range = c[0] as usize..c[1] as usize;
            let sizes = if self.sizes.is_empty() { &[] } else { &self.sizes[range.clone()] };
            (&self.blocks[range], sizes)
        })
    }

    /// The blocks of pairs whose first grain is its own.
    pub(crate) fn own_blocks(&self) -> &[Block] {
        &self.blocks[self.chunks[self.own.chunks().start] as usize..]
    }

    /// One part to pass; earlier ones must have been.
    pub(crate) fn part_mut(&mut self, p: usize) -> Part<'_> {
        let chunks = self.own.chunks_of(p);
        let chunks = chunks.start..chunks.end + 1;
        let (bounds, faces) = (&self.chunks[chunks.clone()], &self.crossings[chunks]);
        let own = bounds[0] as usize..bounds[bounds.len() - 1] as usize;
        let sums = self.sums.part_mut(p);
        let (sizes, crossing) = (&self.sizes[..], &self.crossing[..]);
        Part { blocks: &mut self.blocks[own], sizes, crossing, bounds, faces, sums }
    }

    /// What acts on each chunk of its own, where it was put down.
    pub(crate) fn acts(&self) -> impl Iterator<Item = Put<'_>> {
        self.sums.chunks()
    }
}

/// Fills a [`Share`] pair by pair, in order.
pub(crate) struct Builder {
    share: Share,
    layout: Layout,
    /// Pairs in the last block.
    filled: usize,
    equal_sized: bool,
}

impl Builder {
    /// For the grains `own`, with about as many pairs as expected.
    pub(crate) fn new(state: &State, own: Own, expected: usize) -> Self {
        let blocks = expected / BLOCK + own.chunks().len() + 2;
        let share = Share {
            own: own.clone(),
            blocks: Vec::with_capacity(blocks),
            sizes: Vec::new(),
            chunks: vec![0],
            crossing: Vec::new(),
            crossings: vec![0],
            abroad: Vec::new(),
            sums: Sums::default(),
        };
        let layout = Layout::new(own, state.grains());
        Self { share, layout, filled: BLOCK, equal_sized: state.equal_sized() }
    }

    /// Adds a pair; pairs must come sorted by (i, j, image).
    pub(crate) fn push(&mut self, state: &State, images: &Images, pair: Pair) {
        let (i, j) = (pair.i as usize, pair.j as usize);
        while self.share.chunks.len() <= i / CHUNK {
            self.end_chunk();
        }
        if self.filled == BLOCK {
            self.begin_block(state, pair.i);
        }
        let (lane, share) = (self.filled, &mut self.share);
        self.filled += 1;
        let to = self.layout.row(i / CHUNK, j);
        let own = self.layout.grains();
        for grain in [pair.i, pair.j] {
            // A grain's pairs follow each other.
            if !own.contains(&(grain as usize)) && share.abroad.last() != Some(&grain) {
                share.abroad.push(grain);
            }
        }
        if images.number(pair.image) != [0; 3] {
            let before = share.chunks.last().map_or(0, |b| *b as usize);
            let slot = ((share.blocks.len() - 1 - before) * BLOCK + lane) as u32;
            share.crossing.push(Crossing { slot, image: pair.image });
        }
        if let Some(block) = share.blocks.last_mut() {
            block.root[lane] = pair.root;
            for k in 0..3 {
                block.history[k][lane] = pair.history[k];
            }
            (block.i[lane], block.j[lane]) = (pair.i, pair.j);
            (block.image[lane], block.to[lane]) = (pair.image, to);
        }
        if let Some(sizes) = share.sizes.last_mut() {
            let (r_i, r_j) = (state.radius[i], state.radius[j]);
            (sizes.radius_i[lane], sizes.radius_j[lane]) = (r_i, r_j);
            sizes.r_eff[lane] = effective_radius(r_i, r_j);
            sizes.m_eff[lane] = 1.0 / (state.inverse_mass[i] + state.inverse_mass[j]);
        }
    }

    /// A block of pairs of `grain` with itself, nowhere.
    fn begin_block(&mut self, state: &State, grain: u32) {
        let i = grain as usize;
        self.share.blocks.push(Block {
            root: [0.0; BLOCK],
            history: [[0.0; BLOCK]; 3],
            i: [grain; BLOCK],
            j: [grain; BLOCK],
            image: [NOWHERE; BLOCK],
            to: [(i % CHUNK) as u32; BLOCK],
        });
        if !self.equal_sized {
            let r = state.radius[i];
            self.share.sizes.push(Sizes {
                radius_i: [r; BLOCK],
                radius_j: [r; BLOCK],
                r_eff: [effective_radius(r, r); BLOCK],
                m_eff: [0.5 / state.inverse_mass[i]; BLOCK],
            });
        }
        self.filled = 0;
    }

    /// What follows belongs to the next chunk.
    fn end_chunk(&mut self) {
        let share = &mut self.share;
        share.chunks.push(share.blocks.len() as u32);
        share.crossings.push(share.crossing.len() as u32);
        self.filled = BLOCK;
    }

    /// The share, with what its chunks have to add from others.
    pub(crate) fn finish(mut self) -> Share {
        while self.share.chunks.len() <= self.share.own.chunks().end {
            self.end_chunk();
        }
        let mut share = self.share;
        share.sums = self.layout.finish();
        share
    }
}
