//! Bins of grains, to find neighbours in a periodic cell of any shape.

use crate::domain::state::{State, vector};
use crate::simd::simd_f64::F64x4;
use grainlab_core::sorted_into_bins;
use grainlab_engine::EngineError;

/// Largest image number that a contact may carry.
const MAX_IMAGE: i32 = 100;

/// Grains sorted into bins at least `reach` wide, or spanning the whole cell where it is narrower.
pub(super) struct Grid {
    bins: [i32; 3],
    /// Bins to search on either side.
    span: [i32; 3],
    /// For each axis the bin and its periodic image, from `span` bins before the cell to `span` bins after it.
    places: [Vec<(i32, i32)>; 3],
    /// Bin of each grain, and the whole cells by which the grain has left the cell.
    bin_of: Vec<([i32; 3], [i32; 3])>,
    /// First member of each bin that has not been removed.
    first: Vec<u32>,
    /// End of the members of each bin.
    end: Vec<u32>,
    /// Grains, bin after bin, in ascending order in each.
    members: Vec<u32>,
    /// Centres of the members, folded into the cell, and radii, m.
    spheres: Vec<F64x4>,
}

impl Grid {
    pub(super) fn new(state: &State, reach: f64) -> Result<Self, EngineError> {
        let n = state.len();
        // More bins than grains along an axis only cost memory.
        let limit = (n as f64).cbrt().ceil() as i32 + 1;
        let bins: [i32; 3] = std::array::from_fn(|k| ((state.cell.width(k) / reach) as i32).clamp(1, limit));
        let span: [i32; 3] =
            std::array::from_fn(|k| (reach / (state.cell.width(k) / f64::from(bins[k]))).ceil() as i32);
        let place = |k: usize, at: i32| (at.rem_euclid(bins[k]), at.div_euclid(bins[k]));
        let places = std::array::from_fn(|k| (-span[k]..bins[k] + span[k]).map(|at| place(k, at)).collect());
        let mut bin_of = Vec::with_capacity(n);
        for i in 0..n {
            let s = state.cell.fractional(&vector(&state.position[i]));
            if !s.iter().all(|v| v.abs() < f64::from(MAX_IMAGE)) {
                return Err(EngineError::Image { grain: state.ids[i] });
            }
            let cells: [i32; 3] = std::array::from_fn(|k| s[k].floor() as i32);
            let bin: [i32; 3] = std::array::from_fn(|k| {
                let inside = s[k] - f64::from(cells[k]);
                ((inside * f64::from(bins[k])) as i32).min(bins[k] - 1)
            });
            bin_of.push((bin, cells));
        }
        let mut grid =
            Self { bins, span, places, bin_of, first: vec![], end: vec![], members: vec![], spheres: vec![] };
        grid.sort(state);
        Ok(grid)
    }

    fn sort(&mut self, state: &State) {
        let bins = self.bins.iter().product::<i32>() as usize;
        let (first, members) = sorted_into_bins(bins, self.bin_of.iter().map(|(bin, _)| self.index(*bin)));
        let sphere = |&i: &u32| {
            let i = i as usize;
            let x = vector(&state.position[i]) - state.cell.shift(self.bin_of[i].1.map(|c| c as i8));
            [x.x, x.y, x.z, state.radius[i]]
        };
        self.spheres = members.iter().map(sphere).collect();
        (self.end, self.first, self.members) = (first[1..].to_vec(), first, members);
    }

    fn index(&self, bin: [i32; 3]) -> usize {
        ((bin[0] * self.bins[1] + bin[1]) * self.bins[2] + bin[2]) as usize
    }

    /// Bins around one along axis `k`.
    fn along(&self, k: usize, bin: i32) -> &[(i32, i32)] {
        &self.places[k][bin as usize..=(bin + 2 * self.span[k]) as usize]
    }

    /// Removes a grain from its bin. Grains must be removed in ascending order.
    pub(super) fn remove(&mut self, i: usize) {
        let bin = self.index(self.bin_of[i].0);
        self.first[bin] += 1;
    }

    /// Neighbours of grain `i` that form a pair with it (j > i, or its own image), unsorted. All grains before it must have
    /// been removed.
    pub(super) fn neighbours(
        &self,
        state: &State,
        i: usize,
        skin: f64,
        out: &mut Vec<(u32, [i8; 3])>,
    ) -> Result<(), EngineError> {
        let (bin, cells) = self.bin_of[i];
        let too_far = EngineError::Image { grain: state.ids[i] };
        let here = vector(&state.position[i]) - state.cell.shift(cells.map(|c| c as i8));
        let edges = state.cell.matrix();
        for &(a, image_a) in self.along(0, bin[0]) {
            let from_a = here - edges.column(0) * f64::from(image_a);
            for &(b, image_b) in self.along(1, bin[1]) {
                let from_b = from_a - edges.column(1) * f64::from(image_b);
                for &(c, image_c) in self.along(2, bin[2]) {
                    let bin_image = [image_a, image_b, image_c];
                    let index = self.index([a, b, c]);
                    let range = self.first[index] as usize..self.end[index] as usize;
                    if range.is_empty() {
                        continue;
                    }
                    if bin_image.iter().any(|w| w.abs() > MAX_IMAGE) {
                        return Err(too_far);
                    }
                    let from = from_b - edges.column(2) * f64::from(image_c);
                    let own_reach = state.radius[i] + skin;
                    for (&j, sphere) in self.members[range.clone()].iter().zip(&self.spheres[range]) {
                        let reach = own_reach + sphere[3];
                        if (vector(sphere) - from).norm_squared() >= reach * reach {
                            continue;
                        }
                        let other_cells = self.bin_of[j as usize].1;
                        let wide: [i32; 3] =
                            std::array::from_fn(|k| bin_image[k] - other_cells[k] + cells[k]);
                        if wide.iter().any(|w| w.abs() > MAX_IMAGE) {
                            return Err(too_far);
                        }
                        let image = wide.map(|w| w as i8);
                        // A grain finds its own image twice: keep the positive one.
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
