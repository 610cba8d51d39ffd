//! Finding neighbouring pairs in a periodic cell of any shape.
//!
//! Two lists: all pairs within the Verlet skin, found with bins, and of those the pairs near enough to touch soon, which
//! the contact pass works on. The second is drawn from the first, often and cheaply, so that what the contact pass sees
//! is little more than the contacts.

use crate::contacts::{Builder, Contacts, Images, Pair};
use crate::error::DemError;
use crate::state::{State, vector};
use grains::Vec3;

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
        let grid = Grid::new(state, 2.0 * state.largest_radius + skin)?;
        let mut images = Images::new(state);
        let mut list = Self { start: vec![0], ..Self::default() };
        let mut near: Vec<(u32, [i8; 3])> = Vec::new();
        for i in 0..state.grains() {
            near.clear();
            grid.around(state, i, skin, &mut near)?;
            near.sort_unstable();
            for &(j, image) in &near {
                list.j.push(j);
                list.image.push(images.index(image, &state.cell));
            }
            list.start.push(list.j.len() as u32);
        }
        Ok((list, images))
    }

    /// The pairs now closer than R_i + R_j + `skin`, the history of `old` carried over. `images` is the table that this
    /// list refers to.
    pub(crate) fn draw(&self, state: &State, images: Images, old: &Contacts, skin: f64) -> Contacts {
        let mut list = Builder::new(state, images, old.slots());
        let mut kept = (0..old.slots()).filter_map(|s| old.pair(s)).filter(Pair::touches).peekable();
        for i in 0..state.grains() {
            let (here, radius) = (vector(&state.position[i]), state.radius[i]);
            for q in self.start[i] as usize..self.start[i + 1] as usize {
                let j = self.j[q] as usize;
                let branch = vector(&state.position[j]) - here
                    + vector(&list.contacts.images.shifts()[self.image[q] as usize]);
                let reach = radius + state.radius[j] + skin;
                if branch.norm_squared() >= reach * reach {
                    continue;
                }
                let key = (i as u32, self.j[q], list.contacts.images.number(self.image[q]));
                let of = |p: &Pair| (p.i, p.j, old.images.number(p.image));
                while kept.next_if(|p| of(p) < key).is_some() {}
                let (root, history) =
                    kept.next_if(|p| of(p) == key).map_or((0.0, Vec3::zeros()), |p| (p.root, p.history));
                list.push(state, Pair { i: key.0, j: key.1, image: self.image[q], root, history });
            }
        }
        list.finish(state)
    }
}

/// Grains sorted into bins at least `reach` wide, or spanning the whole cell where it is narrower.
struct Grid {
    bins: [i32; 3],
    /// Bins to look at on either side.
    span: [i32; 3],
    /// Bin of each grain, and the whole cells it has travelled.
    home: Vec<([i32; 3], [i32; 3])>,
    start: Vec<u32>,
    members: Vec<u32>,
}

impl Grid {
    fn new(state: &State, reach: f64) -> Result<Self, DemError> {
        let n = state.grains();
        // More bins than grains along an axis only cost memory.
        let most = (n as f64).cbrt().ceil() as i32 + 1;
        let bins: [i32; 3] = std::array::from_fn(|k| ((state.cell.width(k) / reach) as i32).clamp(1, most));
        let span: [i32; 3] =
            std::array::from_fn(|k| (reach / (state.cell.width(k) / f64::from(bins[k]))).ceil() as i32);
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
        let index = |b: [i32; 3]| ((b[0] * bins[1] + b[1]) * bins[2] + b[2]) as usize;
        let mut start = vec![0u32; (bins[0] * bins[1] * bins[2]) as usize + 1];
        for (b, _) in &home {
            start[index(*b) + 1] += 1;
        }
        for b in 1..start.len() {
            start[b] += start[b - 1];
        }
        let mut fill = start.clone();
        let mut members = vec![0u32; n];
        for (i, (b, _)) in home.iter().enumerate() {
            members[fill[index(*b)] as usize] = i as u32;
            fill[index(*b)] += 1;
        }
        Ok(Self { bins, span, home, start, members })
    }

    /// Neighbours of grain `i` that pair with it (j > i, or its own image), unsorted.
    fn around(
        &self,
        state: &State,
        i: usize,
        skin: f64,
        out: &mut Vec<(u32, [i8; 3])>,
    ) -> Result<(), DemError> {
        let (bin, travelled) = self.home[i];
        let here = vector(&state.position[i]);
        for a in -self.span[0]..=self.span[0] {
            for b in -self.span[1]..=self.span[1] {
                for c in -self.span[2]..=self.span[2] {
                    let target = [bin[0] + a, bin[1] + b, bin[2] + c];
                    let lap: [i32; 3] = std::array::from_fn(|k| target[k].div_euclid(self.bins[k]));
                    let b: [i32; 3] = std::array::from_fn(|k| target[k].rem_euclid(self.bins[k]));
                    let index = ((b[0] * self.bins[1] + b[1]) * self.bins[2] + b[2]) as usize;
                    for &j in &self.members[self.start[index] as usize..self.start[index + 1] as usize] {
                        if (j as usize) < i {
                            continue;
                        }
                        let theirs = self.home[j as usize].1;
                        let wide: [i32; 3] = std::array::from_fn(|k| lap[k] - theirs[k] + travelled[k]);
                        if wide.iter().any(|w| w.abs() > MAX_IMAGE) {
                            return Err(DemError::Image { grain: state.ids[i] });
                        }
                        let image = wide.map(|w| w as i8);
                        // A grain meets its own image twice; keep the positive one.
                        if j as usize == i && image <= [0, 0, 0] {
                            continue;
                        }
                        let d = vector(&state.position[j as usize]) - here + state.cell.shift(image);
                        let reach = state.radius[i] + state.radius[j as usize] + skin;
                        if d.norm_squared() < reach * reach {
                            out.push((j, image));
                        }
                    }
                }
            }
        }
        Ok(())
    }
}
