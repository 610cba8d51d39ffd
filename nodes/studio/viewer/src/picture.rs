//! One view of a packing as pixels, without a display.

use crate::lettering::{self, LINE, width_of};
use crate::palette::{CARRIER, Colour, MOST_CONTACTS, Quantity, RATTLER, by_coordination, colours, ramp};
use crate::raster::{Sphere, draw};
use crate::view::View;
use grainlab_core::Vec3;

/// Paper and ink of a picture with a legend.
const PAPER: Colour = [255, 255, 255];
const INK: Colour = [40, 40, 46];

/// Room around the legend, pixels.
const MARGIN: usize = 18;

/// Width of the ramp of colours, pixels.
const BAR: usize = 220;

/// Largest side of a picture, pixels.
const LARGEST: usize = 8192;

/// Width and height, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
}

impl std::str::FromStr for Size {
    type Err = PictureError;

    fn from_str(text: &str) -> Result<Self, PictureError> {
        let parts = text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
        let sides = parts.filter(|(w, h)| [w, h].iter().all(|side| (16..=LARGEST).contains(*side)));
        let (width, height) = sides.ok_or_else(|| PictureError::Size(text.to_owned()))?;
        Ok(Self { width, height })
    }
}

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The size is not one.
    #[error("{0:?} is not a size: WIDTHxHEIGHT in pixels, each from 16 to {LARGEST}, as in 1600x1200")]
    Size(String),
    /// The encoder failed.
    #[error("PNG: {0}")]
    Png(#[from] png::EncodingError),
}

/// Pixels of a picture.
#[derive(Clone, Debug)]
pub struct Picture {
    size: Size,
    /// Red, green, blue and opacity.
    pixels: Vec<u8>,
}

impl Picture {
    /// The packing without a legend, on a transparent ground.
    pub fn plain(view: &View, quantity: Quantity, size: Size) -> Self {
        Self { size, pixels: packing(view, quantity, size, 0.94) }
    }

    /// The packing on white, with a legend and the name of the state.
    pub fn with_legend(view: &View, quantity: Quantity, size: Size) -> Self {
        let mut picture = Self { size, pixels: packing(view, quantity, size, 0.84) };
        for pixel in picture.pixels.chunks_exact_mut(4) {
            let share = f64::from(pixel[3]) / 255.0;
            let over = |c: usize| f64::from(pixel[c]) * share + f64::from(PAPER[c]) * (1.0 - share);
            let [r, g, b] = [over(0), over(1), over(2)].map(|v| v.round() as u8);
            pixel.copy_from_slice(&[r, g, b, 255]);
        }
        picture.write(&view.label, [MARGIN, MARGIN]);
        picture.write(view.part.as_deref().unwrap_or_default(), [MARGIN, MARGIN + LINE]);
        picture.legend(view, quantity);
        picture
    }

    /// The file.
    ///
    /// # Errors
    /// If the encoder fails.
    pub fn png(&self) -> Result<Vec<u8>, PictureError> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.size.width as u32, self.size.height as u32);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.pixels)?;
        writer.finish()?;
        Ok(file)
    }

    /// The colour of a pixel: red, green, blue and opacity.
    pub fn pixel(&self, x: usize, y: usize) -> Option<[u8; 4]> {
        let at = 4 * (y * self.size.width + x);
        (x < self.size.width).then(|| self.pixels.get(at..at + 4)?.try_into().ok())?
    }

    fn legend(&mut self, view: &View, quantity: Quantity) {
        let bottom = self.size.height.saturating_sub(MARGIN + LINE);
        match quantity {
            Quantity::Force => {
                self.write(
                    "mean normal force of the contacts of a grain",
                    [MARGIN, bottom.saturating_sub(2 * LINE + 4)],
                );
                for x in 0..BAR {
                    self.fill([MARGIN + x, bottom - LINE + 2], [1, 10], ramp(x as f64 / (BAR - 1) as f64));
                }
                let full = newtons(view.force_of_full_colour());
                self.write("0", [MARGIN, bottom]);
                self.write(&full, [(MARGIN + BAR).saturating_sub(width_of(&full)), bottom]);
            }
            Quantity::Rattlers => {
                self.swatches(bottom, "", &[(CARRIER, "carries force".into()), (RATTLER, "rattler".into())])
            }
            Quantity::Coordination => {
                let most = view.coordination.iter().copied().max().unwrap_or(0) as usize;
                let table = by_coordination();
                let name =
                    |n: usize| if n == MOST_CONTACTS && most > n { format!(">={n}") } else { n.to_string() };
                let mut entries: Vec<_> =
                    (2..=most.min(MOST_CONTACTS)).map(|n| (table[n], name(n))).collect();
                entries.push((RATTLER, "rattler".into()));
                self.swatches(bottom, "contacts of a grain, without rattlers", &entries);
            }
        }
    }

    fn swatches(&mut self, bottom: usize, title: &str, entries: &[(Colour, String)]) {
        self.write(title, [MARGIN, bottom.saturating_sub(LINE + 2)]);
        let mut left = MARGIN;
        for (colour, text) in entries {
            self.fill([left, bottom + 3], [11, 11], *colour);
            self.write(text, [left + 16, bottom]);
            left += 16 + width_of(text) + 14;
        }
    }

    fn write(&mut self, text: &str, at: [usize; 2]) {
        lettering::write(text, at, |[x, y], share| {
            if x < self.size.width && y < self.size.height {
                let pixel = &mut self.pixels[4 * (y * self.size.width + x)..][..3];
                for (value, ink) in pixel.iter_mut().zip(INK) {
                    *value = (f64::from(*value) * (1.0 - share) + f64::from(ink) * share).round() as u8;
                }
            }
        });
    }

    fn fill(&mut self, [left, top]: [usize; 2], [width, height]: [usize; 2], colour: Colour) {
        for y in top..(top + height).min(self.size.height) {
            for x in left..(left + width).min(self.size.width) {
                self.pixels[4 * (y * self.size.width + x)..][..3].copy_from_slice(&colour);
            }
        }
    }
}

/// A force with its unit.
fn newtons(force: f64) -> String {
    let units = [(1.0, "N"), (1e-3, "mN"), (1e-6, "uN"), (1e-9, "nN")];
    let (size, name) = units.into_iter().find(|(size, _)| force >= *size).unwrap_or(units[3]);
    format!(">={:.3} {name}", force / size)
}

/// Spheres at their places and the edges of the cell.
fn packing(view: &View, quantity: Quantity, size: Size, fill: f64) -> Vec<u8> {
    let cell = view.matrix();
    let colours = colours(view, quantity);
    let sphere =
        |n: usize| Sphere { centre: cell * view.places[n], radius: view.radii[n], colour: colours[n] };
    let spheres: Vec<Sphere> = (0..view.grains()).map(sphere).collect();
    let corner = |n: usize| cell * Vec3::new((n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2 & 1) as f64);
    let edges =
        (0..8).flat_map(|n| [1, 2, 4].into_iter().filter(move |k| n & k == 0).map(move |k| [n, n | k]));
    let edges: Vec<[Vec3; 2]> = edges.map(|ends| ends.map(corner)).collect();
    draw(&spheres, &edges, [size.width, size.height], fill)
}
