//! The periodic images that pairs reach to.

use crate::domain::state::{State, row};
use crate::simd::simd_f64::F64x4;
use grainlab_core::Cell;
use std::collections::HashMap;

/// The periodic images in use, with their offsets in the present cell. Row 0 is that of padding: too far to touch.
#[derive(Clone, Debug)]
pub(crate) struct Images {
    number: Vec<[i8; 3]>,
    offset: Vec<F64x4>,
    index: HashMap<[i8; 3], u32>,
}

impl Images {
    pub(crate) fn new(state: &State) -> Self {
        let far = 1e6 * state.largest_radius;
        Self { number: vec![[i8::MIN; 3]], offset: vec![[far, far, far, 0.0]], index: HashMap::new() }
    }

    pub(crate) fn index(&mut self, image: [i8; 3], cell: &Cell) -> u32 {
        *self.index.entry(image).or_insert_with(|| {
            self.number.push(image);
            self.offset.push(row(&cell.shift(image)));
            self.number.len() as u32 - 1
        })
    }

    /// Updates the offsets after the cell has deformed.
    pub(crate) fn update(&mut self, cell: &Cell) {
        for (offset, image) in self.offset.iter_mut().zip(&self.number).skip(1) {
            *offset = row(&cell.shift(*image));
        }
    }

    /// Cell vectors to the image in a row.
    pub(crate) fn number(&self, index: u32) -> [i8; 3] {
        self.number[index as usize]
    }

    /// Offsets, m, one row per image.
    pub(crate) fn offsets(&self) -> &[F64x4] {
        &self.offset
    }
}
