//! Pairs that touch or soon may, eight to a block, with the history of their contacts.

use crate::lanes::{BLOCK, CHUNK, Quad, V3};
use crate::pass::Chunk;
use crate::state::{State, row, vector};
use crate::sums::{Earlier, Layout, PART, PartSums, Sums};
use grains::material::effective_radius;
use grains::{Cell, Contact, Packing, Vec3};
use std::collections::HashMap;

/// The distinct periodic images in use, with their shifts in the present cell.
#[derive(Clone, Debug)]
pub(crate) struct Images {
    number: Vec<[i8; 3]>,
    shift: Vec<Quad>,
    find: HashMap<[i8; 3], u32>,
}

/// Image of the pairs that only fill up a block: so far away that they never touch.
const NOWHERE: u32 = 0;

impl Images {
    pub(crate) fn new(state: &State) -> Self {
        let far = 1e6 * state.largest_radius;
        Self { number: vec![[i8::MIN; 3]], shift: vec![[far, far, far, 0.0]], find: HashMap::new() }
    }

    /// Row of `image` in the table.
    pub(crate) fn index(&mut self, image: [i8; 3], cell: &Cell) -> u32 {
        *self.find.entry(image).or_insert_with(|| {
            self.number.push(image);
            self.shift.push(row(&cell.shift(image)));
            self.number.len() as u32 - 1
        })
    }

    /// Brings the shifts up to date with the cell.
    pub(crate) fn follow(&mut self, cell: &Cell) {
        for (shift, image) in self.shift.iter_mut().zip(&self.number).skip(1) {
            *shift = row(&cell.shift(*image));
        }
    }

    pub(crate) fn number(&self, index: u32) -> [i8; 3] {
        self.number[index as usize]
    }

    /// Shifts, m, one row an image.
    pub(crate) fn shifts(&self) -> &[Quad] {
        &self.shift
    }
}

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
    /// Row, among those that the chunk adds to, for what acts on `j`. That for `i` is its place in the chunk.
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

/// Pairs sorted by (i, j, image), in blocks that begin anew with each chunk of grains.
///
/// Pairs that do not touch contribute exact zeros to sums in this order, so no result depends on which are listed.
#[derive(Clone, Debug)]
pub(crate) struct Contacts {
    pub(crate) images: Images,
    pub(crate) blocks: Vec<Block>,
    pub(crate) sizes: Vec<Sizes>,
    /// First block of each chunk, and the end.
    pub(crate) chunks: Vec<u32>,
    /// Pairs across the faces of the cell, in the order of the sum.
    pub(crate) crossing: Vec<Crossing>,
    /// First of `crossing` of each chunk, and the end.
    pub(crate) crossings: Vec<u32>,
    pub(crate) sums: Sums,
}

/// A pair whose second grain is an image.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Slot among those of its chunk.
    pub(crate) slot: u32,
    /// Row in [`Images`].
    pub(crate) image: u32,
}

/// Some chunks: what a thread works on at a time.
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

impl Contacts {
    /// No pairs.
    pub(crate) fn none(state: &State) -> Self {
        Builder::new(state, Images::new(state), 0).finish(state)
    }

    /// The contacts of a packing, as a list of their own.
    pub(crate) fn from_packing(packing: &Packing, state: &State) -> Self {
        let images = Images::new(state);
        let mut list = Builder::new(state, images, packing.contacts.len());
        for c in &packing.contacts {
            let (r_i, r_j) = (state.radius[c.i as usize], state.radius[c.j as usize]);
            let root = (effective_radius(r_i, r_j) * c.overlap).sqrt();
            let image = list.contacts.images.index(c.image, &state.cell);
            list.push(state, Pair { i: c.i, j: c.j, image, root, history: c.tangential_force });
        }
        list.finish(state)
    }

    /// Pair in a slot; `None` where the slot only fills up a block.
    #[inline(always)]
    pub(crate) fn pair(&self, slot: usize) -> Option<Pair> {
        let (block, lane) = (&self.blocks[slot / BLOCK], slot % BLOCK);
        let h = &block.history;
        (block.image[lane] != NOWHERE).then(|| Pair {
            i: block.i[lane],
            j: block.j[lane],
            image: block.image[lane],
            root: block.root[lane],
            history: Vec3::new(h[0][lane], h[1][lane], h[2][lane]),
        })
    }

    pub(crate) fn slots(&self) -> usize {
        self.blocks.len() * BLOCK
    }

    /// Pairs that touch, in the order of the sum.
    pub(crate) fn touching(&self) -> impl Iterator<Item = Pair> {
        (0..self.slots()).filter_map(|s| self.pair(s)).filter(Pair::touches)
    }

    /// Branch vector of a pair, from `i` to the image of `j`, m.
    pub(crate) fn branch(&self, p: &Pair, state: &State) -> Vec3 {
        vector(&state.position[p.j as usize]) - vector(&state.position[p.i as usize])
            + vector(&self.images.shift[p.image as usize])
    }

    /// All parts to pass at once, and the images.
    pub(crate) fn parts_mut(&mut self) -> (&Images, impl Iterator<Item = Part<'_>>) {
        let (sizes, crossing) = (&self.sizes[..], &self.crossing[..]);
        let (bounds, faces) = (&self.chunks[..], &self.crossings[..]);
        let mut blocks = &mut self.blocks[..];
        let parts = self.sums.parts_mut().enumerate().map(move |(p, sums)| {
            let chunks = p * PART..((p + 1) * PART).min(bounds.len() - 1) + 1;
            let (bounds, faces) = (&bounds[chunks.clone()], &faces[chunks]);
            let count = (bounds[bounds.len() - 1] - bounds[0]) as usize;
            let (own, after) = std::mem::take(&mut blocks).split_at_mut(count);
            blocks = after;
            Part { blocks: own, sizes, crossing, bounds, faces, sums }
        });
        (&self.images, parts)
    }

    /// One part to pass, what earlier ones did, and the images.
    pub(crate) fn part_mut(&mut self, p: usize) -> (&Images, Part<'_>, Earlier<'_>) {
        let chunks = p * PART..((p + 1) * PART).min(self.chunks.len() - 1) + 1;
        let (bounds, faces) = (&self.chunks[chunks.clone()], &self.crossings[chunks]);
        let own = bounds[0] as usize..bounds[bounds.len() - 1] as usize;
        let (sums, earlier) = self.sums.part_mut(p);
        let (sizes, crossing) = (&self.sizes[..], &self.crossing[..]);
        let part = Part { blocks: &mut self.blocks[own], sizes, crossing, bounds, faces, sums };
        (&self.images, part, earlier)
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
        for block in &mut self.blocks {
            block.history = [[0.0; BLOCK]; 3];
        }
    }
}

/// |l|, rounded as in the contact pass.
fn distance(branch: &Vec3) -> f64 {
    let branch = V3::new(branch.x, branch.y, branch.z);
    branch.dot(branch).sqrt()
}

/// Fills [`Contacts`] pair by pair, in order.
pub(crate) struct Builder {
    pub(crate) contacts: Contacts,
    layout: Layout,
    /// Pairs in the last block.
    filled: usize,
    equal_sized: bool,
}

impl Builder {
    pub(crate) fn new(state: &State, images: Images, expected: usize) -> Self {
        let blocks = expected / BLOCK + state.grains() / CHUNK + 2;
        let contacts = Contacts {
            images,
            blocks: Vec::with_capacity(blocks),
            sizes: Vec::new(),
            chunks: vec![0],
            crossing: Vec::new(),
            crossings: vec![0],
            sums: Sums::default(),
        };
        let layout = Layout::new(state.grains());
        Self { contacts, layout, filled: BLOCK, equal_sized: state.equal_sized() }
    }

    /// Adds a pair; pairs must come sorted by (i, j, image).
    pub(crate) fn push(&mut self, state: &State, pair: Pair) {
        let (i, j) = (pair.i as usize, pair.j as usize);
        while self.contacts.chunks.len() <= i / CHUNK {
            self.end_chunk();
        }
        if self.filled == BLOCK {
            self.begin_block(state, pair.i);
        }
        let (lane, c) = (self.filled, &mut self.contacts);
        self.filled += 1;
        let to = self.layout.row(i / CHUNK, j);
        if c.images.number(pair.image) != [0; 3] {
            let before = c.chunks.last().map_or(0, |b| *b as usize);
            let slot = ((c.blocks.len() - 1 - before) * BLOCK + lane) as u32;
            c.crossing.push(Crossing { slot, image: pair.image });
        }
        if let Some(block) = c.blocks.last_mut() {
            block.root[lane] = pair.root;
            for k in 0..3 {
                block.history[k][lane] = pair.history[k];
            }
            (block.i[lane], block.j[lane]) = (pair.i, pair.j);
            (block.image[lane], block.to[lane]) = (pair.image, to);
        }
        if let Some(sizes) = c.sizes.last_mut() {
            let (r_i, r_j) = (state.radius[i], state.radius[j]);
            (sizes.radius_i[lane], sizes.radius_j[lane]) = (r_i, r_j);
            sizes.r_eff[lane] = effective_radius(r_i, r_j);
            sizes.m_eff[lane] = 1.0 / (state.inverse_mass[i] + state.inverse_mass[j]);
        }
    }

    /// A block of pairs of `grain` with itself, nowhere.
    fn begin_block(&mut self, state: &State, grain: u32) {
        let i = grain as usize;
        self.contacts.blocks.push(Block {
            root: [0.0; BLOCK],
            history: [[0.0; BLOCK]; 3],
            i: [grain; BLOCK],
            j: [grain; BLOCK],
            image: [NOWHERE; BLOCK],
            to: [(i % CHUNK) as u32; BLOCK],
        });
        if !self.equal_sized {
            let r = state.radius[i];
            self.contacts.sizes.push(Sizes {
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
        let c = &mut self.contacts;
        c.chunks.push(c.blocks.len() as u32);
        c.crossings.push(c.crossing.len() as u32);
        self.filled = BLOCK;
    }

    /// The list, with what chunks have to add from others.
    pub(crate) fn finish(mut self, state: &State) -> Contacts {
        let chunks = state.grains().div_ceil(CHUNK);
        while self.contacts.chunks.len() <= chunks {
            self.end_chunk();
        }
        let mut c = self.contacts;
        c.sums = self.layout.finish();
        c
    }
}
