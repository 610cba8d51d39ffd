//! Spheres and lines in parallel projection, with sixteen samples a pixel. The same input gives the same pixels on every
//! machine: only additions, multiplications, divisions and square roots.

use crate::canvas::{beside, over, stroke};
use crate::light::{Ball, Light, of_stick};
use crate::palette::Colour;
use crate::section::Stick;
use grainlab_core::Vec3;
use rayon::prelude::*;

/// Samples of a pixel along each side; each has a row and a column of its own.
const SIDE: usize = 4;
const SAMPLES: usize = SIDE * SIDE;

/// Rows of pixels that are drawn at a time: their samples fit into the cache of a processor.
const ROWS: usize = 8;

/// Towards the viewer, as in the page: from the right, the front and above.
const VIEWER: [f64; 3] = [2.55, -2.15, 1.45];

/// Owner of a sample without a sphere.
const NOTHING: u32 = u32::MAX;

/// Colour of lines, seen on a light and on a dark ground.
const OUTLINE: [f64; 3] = [122.0, 122.0, 134.0];

/// Opacity of a line within a sphere: an edge of the cell remains one line where grains lie on it.
const WITHIN: f64 = 0.3;

/// A sphere in metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sphere {
    pub(crate) centre: Vec3,
    pub(crate) radius: f64,
    pub(crate) colour: Colour,
}

/// Right, up and towards the viewer.
pub(crate) fn frame() -> [Vec3; 3] {
    let toward = Vec3::from(VIEWER).normalize();
    let right = Vec3::z().cross(&toward).normalize();
    [right, toward.cross(&right), toward]
}

/// A piece of a force chain in the frame of the picture, pixels.
struct Rod {
    ends: [[f64; 3]; 2],
    radius: f64,
    colour: Colour,
}

/// A scene in the frame of the picture.
pub(crate) struct Scene {
    rods: Vec<Rod>,
    /// Factors of right and down, and the constant, of the depth of a cut: nothing is nearer.
    cut: Option<[f64; 3]>,
    /// Pixels of the origin in the frame of the picture.
    origin: [f64; 2],
    /// From the nearest to the farthest.
    balls: Vec<Ball>,
    /// Ends of each edge, and whether nothing but a sphere on it can hide it.
    edges: Vec<([[f64; 3]; 2], bool)>,
    width: usize,
    /// Pixels of a metre.
    pub(crate) scale: f64,
}

impl Scene {
    /// Spheres and the twelve edges between the corners of a cell, numbered by the bits of their vectors, in the middle of the
    /// part of a picture at `area`: left, top, right, bottom.
    pub(crate) fn placed(spheres: &[Sphere], corners: [Vec3; 8], width: usize, area: [f64; 4]) -> Self {
        let [right, up, toward] = frame();
        let turned = |x: &Vec3| [x.dot(&right), -x.dot(&up), x.dot(&toward)];
        let ends = |k: usize| {
            let of_spheres =
                spheres.iter().map(|s| (turned(&s.centre)[k], s.radius)).flat_map(|(x, r)| [x - r, x + r]);
            let all = of_spheres.chain(corners.iter().map(|c| turned(c)[k]));
            all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
        };
        let (across, along) = (ends(0), ends(1));
        let room = [area[2] - area[0], area[3] - area[1]].map(|room| room.max(1.0));
        let extent = [across[1] - across[0], along[1] - along[0]].map(|e| e.max(f64::MIN_POSITIVE));
        let scale = (room[0] / extent[0]).min(room[1] / extent[1]);
        let middle = [across, along].map(|[low, high]| 0.5 * (low + high));
        let place = |x: &Vec3| {
            let p = turned(x);
            let at = |k: usize| 0.5 * (area[k] + area[k + 2]) + (p[k] - middle[k]) * scale;
            [at(0), at(1), p[2] * scale]
        };
        let ball = |s: &Sphere| Ball { centre: place(&s.centre), radius: s.radius * scale, colour: s.colour };
        let mut balls: Vec<Ball> = spheres.iter().map(ball).collect();
        balls.sort_by(|a, b| (b.centre[2] + b.radius).total_cmp(&(a.centre[2] + a.radius)));
        let corners = corners.map(|c| place(&c));
        let last = (0..8).min_by(|a, b| corners[*a][2].total_cmp(&corners[*b][2])).unwrap_or(0);
        let from = |n: usize| [1, 2, 4].into_iter().filter(move |k| n & k == 0).map(move |k| [n, n | k]);
        let edges = (0..8).flat_map(from).map(|ends| (ends.map(|n| corners[n]), !ends.contains(&last)));
        let (rods, cut, edges) = (Vec::new(), None, edges.collect());
        let origin = [place(&Vec3::zeros())[0], place(&Vec3::zeros())[1]];
        Self { rods, cut, origin, balls, edges, width, scale }
    }

    /// The scene with pieces of force chains, and cut by a plane: its normal, and the product with its places, m.
    pub(crate) fn with(mut self, sticks: &[Stick], plane: Option<(Vec3, f64)>) -> Self {
        let [right, up, toward] = frame();
        let ([x, y], scale) = (self.origin, self.scale);
        let place = |p: &Vec3| [x + p.dot(&right) * scale, y - p.dot(&up) * scale, p.dot(&toward) * scale];
        let rod =
            |s: &Stick| Rod { ends: s.ends.map(|p| place(&p)), radius: s.radius * scale, colour: s.colour };
        self.rods = sticks.iter().map(rod).collect();
        self.cut = plane.map(|(normal, at)| {
            let [a, b] = [-normal.dot(&right), normal.dot(&up)].map(|v| v / normal.dot(&toward));
            [a, b, at * scale / normal.dot(&toward) - a * x - b * y]
        });
        // Balls that are cut away give no shadow.
        let limit = self.cut;
        let is_left = |b: &Ball| {
            limit.is_none_or(|[p, q, r]| {
                let over = b.centre[2] - p * b.centre[0] - q * b.centre[1] - r;
                over < b.radius * (1.0 + p * p + q * q).sqrt()
            })
        };
        self.balls.retain(is_left);
        self
    }

    /// Largest depth at a place.
    fn limit(&self, [x, y]: [f64; 2]) -> f64 {
        self.cut.map_or(f64::INFINITY, |[a, b, c]| a * x + b * y + c)
    }

    /// The pixels: red, green, blue and opacity.
    pub(crate) fn draw(&self, height: usize) -> Vec<u8> {
        let light = Light::new(&self.balls);
        let mut pixels = vec![0u8; 4 * self.width * height];
        let bands = pixels.par_chunks_mut(4 * self.width * ROWS).enumerate();
        bands.for_each(|(n, pixels)| {
            let samples = self.samples(n * ROWS, pixels.len() / 4 / self.width);
            for (at, pixel) in pixels.chunks_exact_mut(4).enumerate() {
                let place = [at % self.width, n * ROWS + at / self.width].map(|v| v as f64);
                pixel.copy_from_slice(&self.pixel(&light, &samples, at, place));
            }
        });
        pixels
    }

    /// Depth (greater is nearer) and sphere at each sample of some rows, for one sample of all pixels after the other.
    fn samples(&self, top: usize, rows: usize) -> Vec<Vec<(f32, u32)>> {
        let mut samples = vec![vec![(f32::NEG_INFINITY, NOTHING); rows * self.width]; SAMPLES];
        let within = |low: f64, high: f64, end: usize| {
            low.ceil().max(0.0) as usize..((high.floor() + 1.0).max(0.0) as usize).min(end)
        };
        for (number, Ball { centre: [x, y, z], radius, .. }) in self.balls.iter().enumerate() {
            let nearest = (z + radius) as f32;
            for (of_sample, (right, down)) in samples.iter_mut().zip(offsets()) {
                let (x, y) = (x - right, y - down - top as f64);
                for row in within(y - radius, y + radius, rows) {
                    let square = radius * radius - (row as f64 - y) * (row as f64 - y);
                    let half = square.max(0.0).sqrt();
                    for column in within(x - half, x + half, self.width) {
                        let sample = &mut of_sample[row * self.width + column];
                        if sample.0 < nearest {
                            let dx = column as f64 - x;
                            let half = (square - dx * dx).max(0.0).sqrt();
                            let limit = self.limit([column as f64 + right, (top + row) as f64 + down]);
                            let depth = (z + half).min(limit) as f32;
                            if depth > sample.0 && limit > z - half {
                                *sample = (depth, number as u32);
                            }
                        }
                    }
                }
            }
        }
        for (rod, number) in self.rods.iter().zip(self.balls.len()..) {
            let ends = |k: usize| [0, 1].map(|n| rod.ends[n][k]);
            let range = |[a, b]: [f64; 2], from: f64, end| {
                within(a.min(b) - rod.radius - from - 1.0, a.max(b) + rod.radius - from, end)
            };
            for (row, column) in range(ends(1), top as f64, rows)
                .flat_map(|row| range(ends(0), 0.0, self.width).map(move |column| (row, column)))
            {
                for (of_sample, (right, down)) in samples.iter_mut().zip(offsets()) {
                    let at = [column as f64 + right, (top + row) as f64 + down];
                    let (distance, t) = beside(at, rod.ends.map(|p| [p[0], p[1]]));
                    if distance < rod.radius {
                        let middle = rod.ends[0][2] + t * (rod.ends[1][2] - rod.ends[0][2]);
                        let depth = middle + (rod.radius * rod.radius - distance * distance).sqrt();
                        let sample = &mut of_sample[row * self.width + column];
                        if depth as f32 > sample.0 && depth <= self.limit(at) {
                            *sample = (depth as f32, number as u32);
                        }
                    }
                }
            }
        }
        samples
    }

    fn colour(&self, light: &Light, owner: u32, at: [f64; 2]) -> [f64; 3] {
        let (colour, [factor, glint]) = match self.balls.get(owner as usize) {
            Some(ball) => {
                let [x, y] = [at[0] - ball.centre[0], at[1] - ball.centre[1]];
                let near = ball.centre[2] + (ball.radius * ball.radius - x * x - y * y).max(0.0).sqrt();
                // The face of a cut has the colour of the legend.
                let is_cut = near > self.limit(at);
                (ball.colour, if is_cut { [1.0, 0.0] } else { light.shade(ball, owner, at) })
            }
            None => {
                let rod = &self.rods[owner as usize - self.balls.len()];
                let (_, t) = beside(at, rod.ends.map(|p| [p[0], p[1]]));
                let from = |k: usize| at[k] - rod.ends[0][k] - t * (rod.ends[1][k] - rod.ends[0][k]);
                (rod.colour, [of_stick([0, 1].map(from).map(|v| v / rod.radius)), 0.0])
            }
        };
        colour.map(|c| f64::from(c) * factor + glint)
    }

    /// A pixel whose corner is at this place: each sphere is shaded in the middle of its samples.
    fn pixel(&self, light: &Light, samples: &[Vec<(f32, u32)>], at: usize, [x, y]: [f64; 2]) -> [u8; 4] {
        let mut found = [(NOTHING, [0.0; 3]); SAMPLES];
        let mut count = 0;
        for (of_sample, (right, down)) in samples.iter().zip(offsets()) {
            let owner = of_sample[at].1;
            if owner == NOTHING {
                continue;
            }
            let n = found[..count].iter().position(|(known, _)| *known == owner).unwrap_or(count);
            count = count.max(n + 1);
            let [a, b, hits] = found[n].1;
            found[n] = (owner, [a + right, b + down, hits + 1.0]);
        }
        let (mut sum, mut all) = ([0.0; 3], 0.0);
        for (owner, [right, down, hits]) in &found[..count] {
            let colour = self.colour(light, *owner, [x + right / hits, y + down / hits]);
            sum = std::array::from_fn(|c| sum[c] + hits * colour[c]);
            all += hits;
        }
        let mut colour = sum.map(|v| (v / f64::max(all, 1.0)).min(255.0));
        let mut opacity = all / SAMPLES as f64;
        for ([from, to], is_in_front) in &self.edges {
            let (distance, t) = beside([x + 0.5, y + 0.5], [from, to].map(|p| [p[0], p[1]]));
            let ink = stroke(distance, self.line());
            if ink > 0.0 {
                let depth = (from[2] + t * (to[2] - from[2])) as f32;
                let seen = samples.iter().filter(|s| s[at].0 < depth).count() as f64 / SAMPLES as f64;
                let ink = ink * (seen + if *is_in_front { WITHIN * (1.0 - seen) } else { 0.0 });
                (colour, opacity) = over(colour, opacity, OUTLINE, ink);
            }
        }
        let [r, g, b] = colour.map(|v| v.round() as u8);
        [r, g, b, (255.0 * opacity).round() as u8]
    }

    /// Width of a line, pixels.
    fn line(&self) -> f64 {
        (0.0012 * self.width as f64).max(1.2)
    }
}

fn offsets() -> impl Iterator<Item = (f64, f64)> {
    let place = |a: usize, b: usize| (a as f64 + (b as f64 + 0.5) / SIDE as f64) / SIDE as f64;
    (0..SAMPLES).map(move |s| (place(s % SIDE, s / SIDE), place(s / SIDE, s % SIDE)))
}
