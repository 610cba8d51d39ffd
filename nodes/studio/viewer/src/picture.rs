//! One view of a packing as pixels, without a display.

use crate::legend::Legend;
use crate::lettering::Lettering;
use crate::marks::{scale_bar, triad};
use crate::palette::{Colour, Quantity, colours};
use crate::raster::{Scene, Sphere, beside, over, stroke};
use crate::view::View;
use grainlab_core::Vec3;

/// What a reader must know of a periodic packing.
const CAPTION: &str = "Periodic cell: each grain is drawn once, whole, where its centre is.";

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

/// Ground of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ground {
    /// White, with the name of the state.
    #[default]
    Light,
    /// Nearly black, with the name of the state.
    Dark,
    /// None: for a page of either theme, which has the name itself.
    Clear,
}

impl Ground {
    /// Colour of texts and lines.
    fn ink(self) -> Colour {
        match self {
            Self::Light => [40, 40, 46],
            Self::Dark => [214, 214, 222],
            Self::Clear => [126, 126, 138],
        }
    }

    fn paper(self) -> Option<Colour> {
        match self {
            Self::Light => Some([255, 255, 255]),
            Self::Dark => Some([20, 20, 23]),
            Self::Clear => None,
        }
    }
}

/// Pixels of a picture.
#[derive(Clone, Debug)]
pub struct Picture {
    size: Size,
    ground: Ground,
    letters: Lettering,
    /// Red, green, blue and opacity.
    pixels: Vec<u8>,
}

impl Picture {
    /// The packing in parallel projection, with a legend, a scale bar and the directions of the axes.
    pub fn new(view: &View, quantity: Quantity, size: Size, ground: Ground) -> Self {
        let letters = Lettering::of(size.height.min(size.width));
        let (line, legend) = (letters.line(), Legend::new(view, quantity));
        let mut above = Vec::new();
        if ground != Ground::Clear {
            above.extend([view.label.as_str(), view.part.as_deref().unwrap_or(CAPTION)]);
        }
        let margin = 3 * line / 4;
        let below = size.height.saturating_sub(margin + legend.rows() * line);
        let room = [
            margin,
            margin + above.len() * line + line / 4,
            size.width - margin,
            below - line.min(below) / 4,
        ];
        let scene = scene(view, quantity, size.width, room.map(|v| v as f64));
        let mut picture = Self { size, ground, letters, pixels: scene.draw(size.height) };
        if let Some(paper) = ground.paper() {
            picture.lay_on(paper.map(f64::from));
        }
        for (n, text) in above.into_iter().enumerate() {
            picture.write(text, [margin, margin + n * line]);
        }
        legend.draw(&mut picture, [margin, below]);
        let corner = [size.width - margin, size.height - margin].map(|v| v as f64);
        scale_bar(&mut picture, scene.scale, corner);
        triad(&mut picture, [corner[0], corner[1] - 1.8 * line as f64]);
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

    pub(crate) fn letters(&self) -> Lettering {
        self.letters
    }

    pub(crate) fn width(&self) -> usize {
        self.size.width
    }

    fn lay_on(&mut self, paper: [f64; 3]) {
        for pixel in self.pixels.chunks_exact_mut(4) {
            let share = f64::from(pixel[3]) / 255.0;
            let of = |c: usize| (f64::from(pixel[c]) * share + paper[c] * (1.0 - share)).round() as u8;
            pixel.copy_from_slice(&[of(0), of(1), of(2), 255]);
        }
    }

    /// A share of ink over a pixel, if it is in the picture.
    fn blend(&mut self, [x, y]: [usize; 2], ink: Colour, share: f64) {
        if x < self.size.width && y < self.size.height {
            let pixel = &mut self.pixels[4 * (y * self.size.width + x)..][..4];
            let before = [pixel[0], pixel[1], pixel[2]].map(f64::from);
            let (colour, opacity) = over(before, f64::from(pixel[3]) / 255.0, ink.map(f64::from), share);
            let [r, g, b] = colour.map(|v| v.round() as u8);
            pixel.copy_from_slice(&[r, g, b, (255.0 * opacity).round() as u8]);
        }
    }

    /// A text with its upper left corner.
    pub(crate) fn write(&mut self, text: &str, at: [usize; 2]) {
        let ink = self.ground.ink();
        self.letters.write(text, at, |at, share| self.blend(at, ink, share));
    }

    /// A line of ink.
    pub(crate) fn line(&mut self, ends: [[f64; 2]; 2], width: f64) {
        let range = |k: usize| {
            let [low, high] = [ends[0][k].min(ends[1][k]), ends[0][k].max(ends[1][k])];
            (low - width - 1.0).max(0.0) as usize..(high + width + 2.0).max(0.0) as usize
        };
        for y in range(1) {
            for x in range(0) {
                let (distance, _) = beside([x as f64 + 0.5, y as f64 + 0.5], ends);
                self.blend([x, y], self.ground.ink(), stroke(distance, width));
            }
        }
    }

    /// A rectangle from its upper left corner.
    pub(crate) fn fill(&mut self, [left, top]: [usize; 2], [width, height]: [usize; 2], colour: Colour) {
        for y in top..top + height {
            (left..left + width).for_each(|x| self.blend([x, y], colour, 1.0));
        }
    }
}

/// Spheres at their places and the cell.
fn scene(view: &View, quantity: Quantity, width: usize, room: [f64; 4]) -> Scene {
    let cell = view.matrix();
    let colours = colours(view, quantity);
    let sphere =
        |n: usize| Sphere { centre: cell * view.places[n], radius: view.radii[n], colour: colours[n] };
    let spheres: Vec<Sphere> = (0..view.grains()).map(sphere).collect();
    let corner = |n: usize| cell * Vec3::new((n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2 & 1) as f64);
    Scene::placed(&spheres, std::array::from_fn(corner), width, room)
}
