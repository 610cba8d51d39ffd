//! Texts in a picture.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Lettering {
    /// Height of a letter, pixels.
    height: usize,
}

impl Lettering {
    /// The size for a picture whose shorter side has this number of pixels.
    pub(crate) fn of(side: usize) -> Self {
        Self { height: (side / 50).max(15) }
    }

    /// Height of a line, pixels.
    pub(crate) fn line(self) -> usize {
        self.height * 4 / 3
    }

    /// Width of a text, pixels.
    pub(crate) fn width_of(self, text: &str) -> usize {
        let wide = get_raster_width(FontWeight::Regular, RasterHeight::Size32);
        text.chars().count() * (wide * self.height).div_ceil(32)
    }

    /// Calls `ink` with each pixel of a text and its share of ink; the upper left corner is at `at`.
    pub(crate) fn write(self, text: &str, [left, top]: [usize; 2], mut ink: impl FnMut([usize; 2], f64)) {
        let wide = self.width_of("x");
        for (n, letter) in text.chars().enumerate() {
            let Some(raster) = get_raster(letter, FontWeight::Regular, RasterHeight::Size32) else {
                continue;
            };
            for (x, y) in (0..self.height).flat_map(|y| (0..wide).map(move |x| (x, y))) {
                let mean = mean(raster.raster(), [x, y], 32.0 / self.height as f64);
                if mean > 0.0 {
                    ink([left + n * wide + x, top + y], mean);
                }
            }
        }
    }
}

/// Mean of the values of a large letter in a pixel of a letter smaller by `scale`, from 0 to 1.
fn mean(rows: &[&[u8]], pixel: [usize; 2], scale: f64) -> f64 {
    let [across, down] = pixel.map(|v| [v as f64 * scale, (v + 1) as f64 * scale]);
    let part = |n: usize, [from, to]: [f64; 2]| ((n + 1) as f64).min(to) - (n as f64).max(from);
    let range = |[from, to]: [f64; 2], end: usize| from as usize..(to.ceil() as usize).min(end);
    let mut sum = 0.0;
    for y in range(down, rows.len()) {
        for x in range(across, rows[y].len()) {
            sum += part(y, down) * part(x, across) * f64::from(rows[y][x]);
        }
    }
    sum / (255.0 * scale * scale)
}
