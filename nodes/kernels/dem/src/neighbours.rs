//! Finding neighbouring pairs in a periodic cell of any shape.
//!
//! Two lists: all pairs within the Verlet skin, found with bins, and of those the pairs near enough to touch soon, which
//! the contact pass works on. The second is drawn from the first, often and cheaply, so that what the contact pass sees
//! is little more than the contacts.

use crate::compute::Compute;
use crate::contacts::Contacts;
use crate::error::DemError;
use crate::images::Images;
use crate::lanes::{BLOCK, Quad};
use crate::own::Own;
use crate::share::{Block, Builder, Pair, Share};
use crate::state::{State, vector};
use grainlab_core::{Cell, Vec3};
use std::ops::Range;

/// Largest image number that a contact may carry.
const MAX_IMAGE: i32 = 100;

/// All pairs closer than R_i + R_j + skin at one time, sorted by (i, j, image). Self-images are included; each pair
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
    /// The list, and the table of images that it refers to.
    pub(crate) fn find(state: &State, skin: f64) -> Result<(Self, Images), DemError> {
        let mut grid = Grid::new(state, 2.0 * state.largest_radius + skin)?;
        let mut rows = Rows::new(state);
        let mut list = Self { start: Vec::with_capacity(state.grains() + 1), ..Self::default() };
        list.start.push(0);
        let mut near: Vec<(u32, [i8; 3])> = Vec::new();
        for i in 0..state.grains() {
            near.clear();
            grid.around(state, i, skin, &mut near)?;
            grid.leave_out(i);
            near.sort_unstable();
            for &(j, image) in &near {
                list.j.push(j);
                list.image.push(rows.of(image, &state.cell));
            }
            list.start.push(list.j.len() as u32);
        }
        Ok((list, rows.images))
    }

    /// The pairs now closer than R_i + R_j + `skin`, the history of `old` carried over, in a share for each thread that can
    /// have one. `images` is the table that this list refers to.
    pub(crate) fn draw(
        &self,
        state: &State,
        images: Images,
        old: &Contacts,
        skin: f64,
        compute: &Compute,
    ) -> Contacts {
        let owners = Own::shares(state.grains(), compute.threads());
        let expected = old.slots() / owners.len();
        let shares = compute.share(owners.enumerate(), |(k, own)| {
            let mut share = Builder::new(state, own.clone(), expected);
            self.share(state, &images, Kept::of(old, k, &own), skin, own.grains(), &mut share);
            share.finish()
        });
        Contacts { images, shares }
    }

    /// Those of them that act on the grains `own`.
    fn share(
        &self,
        state: &State,
        images: &Images,
        mut kept: Kept<'_>,
        skin: f64,
        own: Range<usize>,
        share: &mut Builder,
    ) {
        let longest = self.start.windows(2).map(|w| w[1] - w[0]).max().unwrap_or(0);
        let mut near = vec![0; longest as usize];
        let shifts = images.shifts();
        for i in 0..own.end {
            let mut range = self.start[i] as usize..self.start[i + 1] as usize;
            if i < own.start {
                // Sorted by j.
                let ours = &self.j[range.clone()];
                let [from, to] = [own.start, own.end].map(|g| ours.partition_point(|j| (*j as usize) < g));
                range = range.start + from..range.start + to;
            }
            let (here, radius) = (vector(&state.position[i]), state.radius[i]);
            // Which of them are near is anyone's guess: counted, not branched upon.
            let mut count = 0;
            for (q, (j, image)) in range.clone().zip(self.j[range.clone()].iter().zip(&self.image[range])) {
                let branch = vector(&state.position[*j as usize]) - here + vector(&shifts[*image as usize]);
                let reach = radius + state.radius[*j as usize] + skin;
                near[count] = q;
                count += usize::from(branch.norm_squared() < reach * reach);
            }
            for &q in &near[..count] {
                let (j, image) = (self.j[q], self.image[q]);
                let (root, history) = kept.take(i as u32, j, images.number(image));
                share.push(state, images, Pair { i: i as u32, j, image, root, history });
            }
        }
    }
}

/// The touching pairs of a list, taken in order.
struct Kept<'a> {
    images: &'a Images,
    /// Those that may be asked for, in order.
    blocks: Vec<&'a [Block]>,
    /// Where the next may be: in which of them, and where in it.
    run: usize,
    slot: usize,
}

impl<'a> Kept<'a> {
    /// Of the pairs that act on the grains `own`, those of share `k` from now on.
    fn of(old: &'a Contacts, k: usize, own: &Own) -> Self {
        let blocks = match old.shares.get(k) {
            Some(share) if share.own() == own => vec![&share.blocks[..]],
            _ => old.shares.iter().map(Share::own_blocks).collect(),
        };
        Self { images: &old.images, blocks, run: 0, slot: 0 }
    }

    /// √(R* δ) and history of a pair, zero where it did not touch. Pairs must be asked for in order.
    #[inline]
    fn take(&mut self, i: u32, j: u32, image: [i8; 3]) -> (f64, Vec3) {
        while let Some(blocks) = self.blocks.get(self.run) {
            let Some(block) = blocks.get(self.slot / BLOCK) else {
                (self.run, self.slot) = (self.run + 1, 0);
                continue;
            };
            let lane = self.slot % BLOCK;
            if block.root[lane] > 0.0 {
                let number = || self.images.number(block.image[lane]);
                let order = (block.i[lane], block.j[lane]).cmp(&(i, j)).then_with(|| number().cmp(&image));
                if order.is_gt() {
                    break;
                }
                if order.is_eq() {
                    self.slot += 1;
                    let h = &block.history;
                    return (block.root[lane], Vec3::new(h[0][lane], h[1][lane], h[2][lane]));
                }
            }
            self.slot += 1;
        }
        (0.0, Vec3::zeros())
    }
}

/// A table of images, the nearest of them found without a search.
struct Rows {
    images: Images,
    /// Rows of images up to [`NEAR`] cells away, 0 where unknown.
    near: [u32; (2 * NEAR as usize + 1).pow(3)],
}

/// Cells along each axis within which images are looked up directly.
const NEAR: i8 = 2;

impl Rows {
    fn new(state: &State) -> Self {
        Self { images: Images::new(state), near: [0; _] }
    }

    #[inline]
    fn of(&mut self, image: [i8; 3], cell: &Cell) -> u32 {
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

/// Grains sorted into bins at least `reach` wide, or spanning the whole cell where it is narrower.
struct Grid {
    bins: [i32; 3],
    /// Bins to look at on either side.
    span: [i32; 3],
    /// Along each axis the bin, and the cell it is in, of each place from `span` bins before the cell on.
    places: [Vec<(i32, i32)>; 3],
    /// Bin of each grain, and the whole cells it has travelled.
    home: Vec<([i32; 3], [i32; 3])>,
    /// First member of each bin that is not left out.
    first: Vec<u32>,
    /// End of the members of each bin.
    end: Vec<u32>,
    /// Grains, bin after bin, in ascending order in each.
    members: Vec<u32>,
    /// Their centres, taken back to the cell, and radii, m.
    spheres: Vec<Quad>,
}

impl Grid {
    fn new(state: &State, reach: f64) -> Result<Self, DemError> {
        let n = state.grains();
        // More bins than grains along an axis only cost memory.
        let most = (n as f64).cbrt().ceil() as i32 + 1;
        let bins: [i32; 3] = std::array::from_fn(|k| ((state.cell.width(k) / reach) as i32).clamp(1, most));
        let span: [i32; 3] =
            std::array::from_fn(|k| (reach / (state.cell.width(k) / f64::from(bins[k]))).ceil() as i32);
        let place = |k: usize, at: i32| (at.rem_euclid(bins[k]), at.div_euclid(bins[k]));
        let places = std::array::from_fn(|k| (-span[k]..bins[k] + span[k]).map(|at| place(k, at)).collect());
        let mut home = Vec::with_capacity(n);
        for i in 0..n {
            let s = state.cell.fractional(&vector(&state.position[i]));
            if !s.iter().all(|v| v.abs() < f64::from(MAX_IMAGE)) {
                return Err(DemError::Image { grain: state.ids[i] });
            }
            let travelled: [i32; 3] = std::array::from_fn(|k| s[k].floor() as i32);
            let bin: [i32; 3] = std::array::from_fn(|k| {
                let inside = s[k] - f64::from(travelled[k]);
                ((inside * f64::from(bins[k])) as i32).min(bins[k] - 1)
            });
            home.push((bin, travelled));
        }
        let mut grid =
            Self { bins, span, places, home, first: vec![], end: vec![], members: vec![], spheres: vec![] };
        grid.sort(state);
        Ok(grid)
    }

    /// Sorts the grains into their bins.
    fn sort(&mut self, state: &State) {
        let mut first = vec![0u32; self.bins.iter().product::<i32>() as usize + 1];
        for (bin, _) in &self.home {
            first[self.index(*bin) + 1] += 1;
        }
        for b in 1..first.len() {
            first[b] += first[b - 1];
        }
        let mut end = first.clone();
        self.members = vec![0; self.home.len()];
        self.spheres = vec![[0.0; 4]; self.home.len()];
        for (i, (bin, travelled)) in self.home.iter().enumerate() {
            let next = &mut end[self.index(*bin)];
            let x = vector(&state.position[i]) - state.cell.shift(travelled.map(|t| t as i8));
            self.members[*next as usize] = i as u32;
            self.spheres[*next as usize] = [x.x, x.y, x.z, state.radius[i]];
            *next += 1;
        }
        (self.first, self.end) = (first, end);
    }

    fn index(&self, bin: [i32; 3]) -> usize {
        ((bin[0] * self.bins[1] + bin[1]) * self.bins[2] + bin[2]) as usize
    }

    /// What along axis `k` is around a bin.
    fn along(&self, k: usize, bin: i32) -> &[(i32, i32)] {
        &self.places[k][bin as usize..=(bin + 2 * self.span[k]) as usize]
    }

    /// Leaves a grain out from now on; those of lower number must have been.
    fn leave_out(&mut self, i: usize) {
        let bin = self.index(self.home[i].0);
        self.first[bin] += 1;
    }

    /// Neighbours of grain `i` that pair with it (j > i, or its own image), unsorted. All of lower number must have been
    /// left out.
    fn around(
        &self,
        state: &State,
        i: usize,
        skin: f64,
        out: &mut Vec<(u32, [i8; 3])>,
    ) -> Result<(), DemError> {
        let (bin, travelled) = self.home[i];
        let too_far = DemError::Image { grain: state.ids[i] };
        let here = vector(&state.position[i]) - state.cell.shift(travelled.map(|t| t as i8));
        let edges = state.cell.matrix();
        for &(a, lap_a) in self.along(0, bin[0]) {
            let from_a = here - edges.column(0) * f64::from(lap_a);
            for &(b, lap_b) in self.along(1, bin[1]) {
                let from_b = from_a - edges.column(1) * f64::from(lap_b);
                for &(c, lap_c) in self.along(2, bin[2]) {
                    let lap = [lap_a, lap_b, lap_c];
                    let index = self.index([a, b, c]);
                    let range = self.first[index] as usize..self.end[index] as usize;
                    if range.is_empty() {
                        continue;
                    }
                    if lap.iter().any(|w| w.abs() > MAX_IMAGE) {
                        return Err(too_far);
                    }
                    let from = from_b - edges.column(2) * f64::from(lap_c);
                    let least = state.radius[i] + skin;
                    for (&j, sphere) in self.members[range.clone()].iter().zip(&self.spheres[range]) {
                        let reach = least + sphere[3];
                        if (vector(sphere) - from).norm_squared() >= reach * reach {
                            continue;
                        }
                        let theirs = self.home[j as usize].1;
                        let wide: [i32; 3] = std::array::from_fn(|k| lap[k] - theirs[k] + travelled[k]);
                        if wide.iter().any(|w| w.abs() > MAX_IMAGE) {
                            return Err(too_far);
                        }
                        let image = wide.map(|w| w as i8);
                        // A grain meets its own image twice; keep the positive one.
                        if j as usize != i || image > [0, 0, 0] {
                            out.push((j, image));
                        }
                    }
                }
            }
        }
        Ok(())
    }
}
