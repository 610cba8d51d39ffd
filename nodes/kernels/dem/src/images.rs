//! The periodic images that contacts reach to.

use crate::lanes::Quad;
use crate::state::{State, row};
use grainlab_core::Cell;
use std::collections::HashMap;

/// The distinct periodic images in use, with their shifts in the present cell.
#[derive(Clone, Debug)]
pub(crate) struct Images {
    number: Vec<[i8; 3]>,
    shift: Vec<Quad>,
    find: HashMap<[i8; 3], u32>,
}

/// Image of the pairs that only fill up a block: so far away that they never touch.
pub(crate) const NOWHERE: u32 = 0;

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
