//! Pixels with texts, lines and rectangles over them.

use crate::lettering::Lettering;
use crate::palette::Colour;

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

#[derive(Clone, Debug)]
pub(crate) struct Canvas {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) letters: Lettering,
    pub(crate) ink: Colour,
    /// Red, green, blue and opacity.
    pub(crate) pixels: Vec<u8>,
}

impl Canvas {
    pub(crate) fn new(
        [width, height]: [usize; 2],
        ground: Ground,
        letters: Lettering,
        pixels: Vec<u8>,
    ) -> Self {
        let mut canvas = Self { width, height, letters, ink: ground.ink(), pixels };
        if let Some(paper) = ground.paper() {
            canvas.lay_on(paper.map(f64::from));
        }
        canvas
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
        if x < self.width && y < self.height {
            let pixel = &mut self.pixels[4 * (y * self.width + x)..][..4];
            let before = [pixel[0], pixel[1], pixel[2]].map(f64::from);
            let (colour, opacity) = over(before, f64::from(pixel[3]) / 255.0, ink.map(f64::from), share);
            let [r, g, b] = colour.map(|v| v.round() as u8);
            pixel.copy_from_slice(&[r, g, b, (255.0 * opacity).round() as u8]);
        }
    }

    /// A text with its upper left corner.
    pub(crate) fn write(&mut self, text: &str, at: [usize; 2]) {
        let ink = self.ink;
        self.letters.write(text, at, |at, share| self.blend(at, ink, share));
    }

    pub(crate) fn line(&mut self, ends: [[f64; 2]; 2], width: f64) {
        let range = |k: usize| {
            let [low, high] = [ends[0][k].min(ends[1][k]), ends[0][k].max(ends[1][k])];
            (low - width - 1.0).max(0.0) as usize..(high + width + 2.0).max(0.0) as usize
        };
        for y in range(1) {
            for x in range(0) {
                let (distance, _) = beside([x as f64 + 0.5, y as f64 + 0.5], ends);
                self.blend([x, y], self.ink, stroke(distance, width));
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

/// A colour with this share of ink over it, and its opacity.
pub(crate) fn over(colour: [f64; 3], opacity: f64, ink: [f64; 3], share: f64) -> ([f64; 3], f64) {
    let all = share + opacity * (1.0 - share);
    let part = if all > 0.0 { share / all } else { 0.0 };
    (std::array::from_fn(|c| colour[c] + part * (ink[c] - colour[c])), all)
}

/// Distance from a line between two places, and the share of the line up to there.
pub(crate) fn beside(p: [f64; 2], [from, to]: [[f64; 2]; 2]) -> (f64, f64) {
    let [a, b] = [[to[0] - from[0], to[1] - from[1]], [p[0] - from[0], p[1] - from[1]]];
    let t = ((a[0] * b[0] + a[1] * b[1]) / (a[0] * a[0] + a[1] * a[1]).max(1e-12)).clamp(0.0, 1.0);
    let d = [b[0] - t * a[0], b[1] - t * a[1]];
    ((d[0] * d[0] + d[1] * d[1]).sqrt(), t)
}

/// Share of a pixel at this distance that a line of this width covers.
pub(crate) fn stroke(distance: f64, width: f64) -> f64 {
    (0.5 * width + 0.5 - distance).clamp(0.0, 1.0)
}
