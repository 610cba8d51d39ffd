//! One view of a packing as pixels, without a display.

use crate::canvas::{Canvas, Ground};
use crate::legend::{Legend, ROWS, newtons};
use crate::lettering::Lettering;
use crate::marks::{scale_bar, triad};
use crate::palette::{Quantity, colours};
use crate::raster::{Scene, Sphere, frame};
use crate::section::{SMALL, Slice, chains};
use crate::view::View;
use grainlab_core::Vec3;

const CAPTION: &str = "Periodic cell: each grain is drawn once, whole, where its centre is.";

/// Largest side of a picture, pixels.
const LARGEST: usize = 8192;

/// Fewest lines of a picture with texts.
const LINES: usize = 12;

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

/// Parts of the packing in a picture, by default whole grains.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parts {
    /// A cut along a face of the cell.
    pub slice: Option<Slice>,
    /// True for the contacts as force chains, with the grains small.
    pub chains: bool,
}

/// Pixels of a picture.
#[derive(Clone, Debug)]
pub struct Picture(Canvas);

impl Picture {
    /// The packing in parallel projection, with a legend, a scale bar and the directions of the axes.
    pub fn new(view: &View, quantity: Quantity, size: Size, ground: Ground) -> Self {
        Self::of(view, quantity, size, ground, &Parts::default())
    }

    /// As [`new`](Self::new), with these parts.
    pub fn of(view: &View, quantity: Quantity, size: Size, ground: Ground, parts: &Parts) -> Self {
        let letters = Lettering::of(size.height.min(size.width));
        let (line, legend) = (letters.line(), Legend::new(view, quantity));
        let mut above = Vec::new();
        if ground != Ground::Clear {
            above.extend([view.label.clone(), view.part.clone().unwrap_or_else(|| CAPTION.to_owned())]);
            above.extend(parts.slice.map(|slice| format!("{slice}")));
            let full = view.force_of_full_colour();
            let full = newtons(full, full);
            above.extend(
                parts
                    .chains
                    .then(|| format!("force chains: thickness and hue by normal force, up to {full}")),
            );
        }
        let margin = 3 * line / 4;
        let fits = |text: &String| letters.width_of(text) + 2 * margin <= size.width;
        above.retain(fits);
        if legend.width(letters) + 2 * margin > size.width || size.height < LINES * line {
            // A thumbnail has no room for texts.
            let all = [0.0, 0.0, size.width as f64, size.height as f64];
            let scene = scene(view, quantity, parts, size.width, all).draw(size.height);
            return Self(Canvas::new([size.width, size.height], ground, letters, scene));
        }
        let below = size.height.saturating_sub(margin + ROWS * line);
        let room = [
            margin,
            margin + above.len() * line + line / 4,
            size.width - margin,
            below - line.min(below) / 4,
        ];
        let scene = scene(view, quantity, parts, size.width, room.map(|v| v as f64));
        let sides = [size.width, size.height];
        let mut canvas = Canvas::new(sides, ground, letters, scene.draw(size.height));
        for (n, text) in above.into_iter().enumerate() {
            canvas.write(&text, [margin, margin + n * line]);
        }
        legend.draw(&mut canvas, [margin, below]);
        let corner = [size.width - margin, size.height - margin].map(|v| v as f64);
        scale_bar(&mut canvas, scene.scale, corner);
        triad(&mut canvas, [corner[0], corner[1] - 1.8 * line as f64]);
        Self(canvas)
    }

    /// The file.
    ///
    /// # Errors
    /// If the encoder fails.
    pub fn png(&self) -> Result<Vec<u8>, PictureError> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.0.width as u32, self.0.height as u32);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.0.pixels)?;
        writer.finish()?;
        Ok(file)
    }

    /// The colour of a pixel: red, green, blue and opacity.
    pub fn pixel(&self, x: usize, y: usize) -> Option<[u8; 4]> {
        let at = 4 * (y * self.0.width + x);
        (x < self.0.width).then(|| self.0.pixels.get(at..at + 4)?.try_into().ok())?
    }
}

fn scene(view: &View, quantity: Quantity, parts: &Parts, width: usize, room: [f64; 4]) -> Scene {
    let cell = view.matrix();
    let colours = colours(view, quantity);
    let size = if parts.chains { SMALL } else { 1.0 };
    let sphere =
        |n: usize| Sphere { centre: cell * view.places[n], radius: size * view.radii[n], colour: colours[n] };
    let spheres: Vec<Sphere> = (0..view.grains()).map(sphere).collect();
    let corner = |n: usize| cell * Vec3::new((n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2 & 1) as f64);
    let sticks = if parts.chains { chains(view) } else { Vec::new() };
    let plane = parts.slice.map(|slice| slice.plane(view, &frame()[2]));
    Scene::placed(&spheres, std::array::from_fn(corner), width, room).with(&sticks, plane)
}
