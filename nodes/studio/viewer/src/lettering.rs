//! Texts in a picture.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Height of a line, pixels.
pub(crate) const LINE: usize = 20;

/// Width of a letter, pixels.
pub(crate) fn width_of(text: &str) -> usize {
    text.chars().count() * get_raster_width(FontWeight::Regular, RasterHeight::Size16)
}

/// Calls `ink` with each pixel of a text and its share of ink; the upper left corner is at `at`.
pub(crate) fn write(text: &str, at: [usize; 2], mut ink: impl FnMut([usize; 2], f64)) {
    let mut left = at[0];
    for letter in text.chars() {
        if let Some(raster) = get_raster(letter, FontWeight::Regular, RasterHeight::Size16) {
            for (row, values) in raster.raster().iter().enumerate() {
                for (column, value) in values.iter().enumerate().filter(|(_, v)| **v > 0) {
                    ink([left + column, at[1] + row], f64::from(*value) / 255.0);
                }
            }
        }
        left += width_of("x");
    }
}
