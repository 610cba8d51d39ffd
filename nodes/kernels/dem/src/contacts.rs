//! Pairs that touch or soon may, eight to a block, with the history of their contacts.

use crate::lanes::{BLOCK, Quad, Wrench};
use crate::pass::Chunk;
use crate::state::{State, row, vector};
use grains::material::effective_radius;
use grains::{Cell, Contact, Packing, Vec3};
use std::collections::HashMap;

/// Grains in a chunk: the unit of work of a thread, and of every sum over contacts.
pub(crate) const CHUNK: usize = 256;

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
    /// Row, within those of the chunk, that sums what acts on `j`.
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
    /// First row of [`Contacts::sums`] of each chunk, and the end.
    pub(crate) rows: Vec<u32>,
    /// Forces and torques that each chunk found, N and N m: a row for each of its grains, then one for each pair whose
    /// second grain is of another chunk.
    pub(crate) sums: Vec<Wrench>,
    /// What each chunk has to add from others: (row of `sums`, grain within the chunk), ascending in rows.
    pub(crate) far: Vec<(u32, u32)>,
    /// First of `far` of each chunk, and the end.
    pub(crate) far_start: Vec<u32>,
}

/// One pair.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    pub(crate) i: u32,
    pub(crate) j: u32,
    /// Row in [`Images`].
    pub(crate) image: u32,
    pub(crate) root: f64,
    pub(crate) history: Vec3,
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
        (0..self.slots()).filter_map(|s| self.pair(s)).filter(|p| p.root > 0.0)
    }

    /// Branch vector of a pair, from `i` to the image of `j`, m.
    pub(crate) fn branch(&self, p: &Pair, state: &State) -> Vec3 {
        vector(&state.position[p.j as usize]) - vector(&state.position[p.i as usize])
            + vector(&self.images.shift[p.image as usize])
    }

    /// One chunk to pass, and the images.
    pub(crate) fn chunk_mut(&mut self, c: usize) -> (&Images, Chunk<'_>) {
        let blocks = self.chunks[c] as usize..self.chunks[c + 1] as usize;
        let chunk = Chunk {
            first: (c * CHUNK) as u32,
            sizes: if self.sizes.is_empty() { &[] } else { &self.sizes[blocks.clone()] },
            blocks: &mut self.blocks[blocks],
            sums: &mut self.sums[self.rows[c] as usize..self.rows[c + 1] as usize],
        };
        (&self.images, chunk)
    }

    /// All chunks to pass, and the images.
    pub(crate) fn chunks_mut(&mut self) -> (&Images, impl Iterator<Item = Chunk<'_>>) {
        let (images, sizes) = (&self.images, &self.sizes[..]);
        let (mut blocks, mut sums) = (&mut self.blocks[..], &mut self.sums[..]);
        let bounds = self.chunks.windows(2).zip(self.rows.windows(2)).enumerate();
        let chunks = bounds.map(move |(c, (range, rows))| Chunk {
            first: (c * CHUNK) as u32,
            sizes: if sizes.is_empty() { &[] } else { &sizes[range[0] as usize..range[1] as usize] },
            blocks: split(&mut blocks, (range[1] - range[0]) as usize),
            sums: split(&mut sums, (rows[1] - rows[0]) as usize),
        });
        (images, chunks)
    }

    /// Forces and torques that chunk `c` found for its `grains` grains, and those that it has to add from others.
    pub(crate) fn found(&self, c: usize, grains: usize) -> (&[Wrench], &[(u32, u32)]) {
        let row = self.rows[c] as usize;
        let far = self.far_start[c] as usize..self.far_start[c + 1] as usize;
        (&self.sums[row..row + grains], &self.far[far])
    }

    /// The touching pairs as contacts, in the order of the sum.
    pub(crate) fn contacts(&self, state: &State) -> Vec<Contact> {
        let contact = |p: Pair| {
            let branch = self.branch(&p, state);
            let (r_i, r_j) = (state.radius[p.i as usize], state.radius[p.j as usize]);
            let r_eff = effective_radius(r_i, r_j);
            let distance = (branch.x * branch.x + branch.y * branch.y + branch.z * branch.z).sqrt();
            let overlap = r_i + r_j - distance;
            Contact {
                i: p.i,
                j: p.j,
                image: self.images.number(p.image),
                overlap,
                normal: branch / distance,
                normal_force: state.material.normal_force(r_eff, overlap),
                tangential_force: p.history,
            }
        };
        self.touching().map(contact).collect()
    }

    /// Forgets tangential forces.
    pub(crate) fn forget(&mut self) {
        for block in &mut self.blocks {
            block.history = [[0.0; BLOCK]; 3];
        }
    }
}

/// Takes the first `count` of a slice away from it.
fn split<'a, T>(rest: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (first, after) = std::mem::take(rest).split_at_mut(count);
    *rest = after;
    first
}

/// Fills [`Contacts`] pair by pair, in order.
pub(crate) struct Builder {
    pub(crate) contacts: Contacts,
    /// Pairs in the last block.
    filled: usize,
    /// (chunk, row, grain) of what one chunk finds for another.
    far: Vec<(u32, u32, u32)>,
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
            rows: vec![0],
            sums: Vec::new(),
            far: Vec::new(),
            far_start: Vec::new(),
        };
        let mut list = Self { contacts, filled: BLOCK, far: Vec::new(), equal_sized: state.equal_sized() };
        list.contacts.sums.resize(CHUNK.min(state.grains()), [0.0; 8]);
        list
    }

    /// Adds a pair; pairs must come sorted by (i, j, image).
    pub(crate) fn push(&mut self, state: &State, pair: Pair) {
        let (i, j) = (pair.i as usize, pair.j as usize);
        while self.contacts.chunks.len() <= i / CHUNK {
            self.end_chunk(state.grains());
        }
        if self.filled == BLOCK {
            self.begin_block(state, pair.i);
        }
        let (lane, c) = (self.filled, &mut self.contacts);
        self.filled += 1;
        let first = i / CHUNK * CHUNK;
        let to = if j / CHUNK == i / CHUNK {
            (j - first) as u32
        } else {
            let row = c.sums.len() as u32;
            self.far.push(((j / CHUNK) as u32, row, (j % CHUNK) as u32));
            c.sums.push([0.0; 8]);
            row - c.rows[i / CHUNK]
        };
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
    fn end_chunk(&mut self, grains: usize) {
        let c = &mut self.contacts;
        let next = c.chunks.len() * CHUNK;
        c.chunks.push(c.blocks.len() as u32);
        c.rows.push(c.sums.len() as u32);
        c.sums.resize(c.sums.len() + CHUNK.min(grains.saturating_sub(next)), [0.0; 8]);
        self.filled = BLOCK;
    }

    /// The list, with what chunks have to add from others.
    pub(crate) fn finish(mut self, state: &State) -> Contacts {
        let chunks = state.grains().div_ceil(CHUNK);
        while self.contacts.chunks.len() <= chunks {
            self.end_chunk(state.grains());
        }
        self.far.sort_unstable();
        let mut c = self.contacts;
        let before = |chunk: u32| self.far.partition_point(|f| f.0 < chunk) as u32;
        c.far_start = (0..=chunks as u32).map(before).collect();
        c.far = self.far.iter().map(|f| (f.1, f.2)).collect();
        c
    }
}
