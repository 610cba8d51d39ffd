//! Light on spheres: that of a sky of which the neighbours hide a part, and a lamp with soft shadows. Both are sums over the
//! neighbours instead of rays, so that there is no noise.

use crate::palette::Colour;

/// Towards the lamp, in the frame of the picture: from the upper left. Its length is 1 within rounding.
const LAMP: [f64; 3] = [-0.40169, -0.62485, 0.66948];

/// Distance up to which a sphere hides the sky, its radii.
const REACH: f64 = 4.0;

/// Most cells of a grid along a side.
const CELLS: f64 = 128.0;

/// A sphere in the frame of the picture, pixels: right, down and towards the viewer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    pub(crate) centre: [f64; 3],
    pub(crate) radius: f64,
    pub(crate) colour: Colour,
}

/// Spheres of one range of sizes, in cells at least as long as their reach.
struct Grid {
    low: [f64; 3],
    cell: f64,
    cells: [usize; 3],
    /// First sphere of each cell, and the number of spheres.
    first: Vec<u32>,
    /// Centre, radius and number of each sphere, by cells.
    balls: Vec<([f64; 3], f64, u32)>,
}

pub(crate) struct Light(Vec<Grid>);

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Light {
    /// A grid for each range of sizes up to a factor of two.
    pub(crate) fn new(balls: &[Ball]) -> Self {
        let mut left: Vec<_> = balls.iter().zip(0..).map(|(b, n)| (b.centre, b.radius, n)).collect();
        let mut grids = Vec::new();
        while !left.is_empty() {
            let largest = left.iter().map(|b| b.1).fold(0.0, f64::max);
            let (large, small) = left.into_iter().partition(|b| b.1 >= 0.5 * largest);
            grids.push(Grid::new(large, REACH * largest));
            left = small;
        }
        Self(grids)
    }

    /// Factor of the colour and glint that is added to it, at a place of the picture on a sphere of this number.
    pub(crate) fn shade(&self, ball: &Ball, number: u32, [x, y]: [f64; 2]) -> [f64; 2] {
        let [nx, ny] = [(x - ball.centre[0]) / ball.radius, (y - ball.centre[1]) / ball.radius];
        let outside = (nx * nx + ny * ny).sqrt().max(1.0);
        let [nx, ny] = [nx / outside, ny / outside];
        let n = [nx, ny, (1.0 - nx * nx - ny * ny).max(0.0).sqrt()];
        let place = std::array::from_fn(|k| ball.centre[k] + ball.radius * n[k]);
        let (mut open, mut lit) = (1.0, 1.0);
        for (centre, radius, _) in self.0.iter().flat_map(|grid| grid.near(place)).filter(|b| b.2 != number) {
            let to: [f64; 3] = std::array::from_fn(|k| centre[k] - place[k]);
            let (square, reach) = (dot(to, to), REACH * radius);
            if square >= reach * reach {
                continue;
            }
            let fade = 1.0 - square / (reach * reach);
            // Share of the sky, weighted by its height, that a sphere covers; nearly so where the horizon cuts it.
            let share = 0.5 * radius * (dot(n, to) + radius) / square;
            let share = share.clamp(0.0, 1.0);
            open *= 1.0 - fade * share * share.sqrt();
            let along = dot(to, LAMP);
            if along > 0.0 {
                let past = (square - along * along).max(0.0).sqrt() - radius;
                let half = (0.5 + 0.5 * past / (0.5 * along + 0.1 * radius)).clamp(0.0, 1.0);
                lit *= 1.0 - fade * (1.0 - half * half * (3.0 - 2.0 * half));
            }
        }
        let key = dot(n, LAMP).max(0.0);
        let half = [LAMP[0], LAMP[1], LAMP[2] + 1.0];
        let glint = (dot(n, half) / dot(half, half).sqrt()).max(0.0);
        let rim = 0.8 + 0.2 * (n[2] / 0.5).min(1.0);
        let glint = (0..5).fold(glint, |g, _| g * g);
        [
            rim * (0.18 + 0.56 * open + 0.4 * key * (0.45 + 0.55 * lit) * (0.4 + 0.6 * open)),
            22.0 * glint * lit,
        ]
    }
}

/// Factor of the colour of a piece of a force chain, at this part of its radius across it: right and down.
pub(crate) fn of_stick([x, y]: [f64; 2]) -> f64 {
    let normal = [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()];
    0.62 + 0.42 * dot(normal, LAMP).max(0.0)
}

impl Grid {
    fn new(balls: Vec<([f64; 3], f64, u32)>, reach: f64) -> Self {
        let ends = |k: usize| {
            let places = balls.iter().map(|b| b.0[k]);
            places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
        };
        let ends = [0, 1, 2].map(ends);
        let extent = ends.map(|[low, high]| high - low);
        let cell = extent.iter().fold(reach, |cell, e| cell.max(e / CELLS)).max(f64::MIN_POSITIVE);
        let mut grid = Self {
            low: ends.map(|[low, _]| low),
            cell,
            cells: extent.map(|e| (e / cell) as usize + 1),
            first: Vec::new(),
            balls,
        };
        let mut numbered: Vec<_> = std::mem::take(&mut grid.balls)
            .into_iter()
            .map(|b| (grid.number([0, 1, 2].map(|k| ((b.0[k] - grid.low[k]) / cell) as usize)), b))
            .collect();
        numbered.sort_by_key(|(cell, _)| *cell);
        let first = |cell: usize| numbered.partition_point(|(of, _)| *of < cell) as u32;
        grid.first = (0..=grid.cells.iter().product()).map(first).collect();
        grid.balls = numbered.into_iter().map(|(_, b)| b).collect();
        grid
    }

    fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.cells[1] + y) * self.cells[0] + x
    }

    fn near(&self, place: [f64; 3]) -> impl Iterator<Item = &([f64; 3], f64, u32)> {
        let around = [0, 1, 2].map(|k| {
            let at = ((place[k] - self.low[k]) / self.cell).floor();
            let end = self.cells[k] as f64;
            [(at - 1.0).clamp(0.0, end) as usize, (at + 2.0).clamp(0.0, end) as usize]
        });
        let [xs, ys, zs] = around;
        let rows = (zs[0]..zs[1]).flat_map(move |z| (ys[0]..ys[1]).map(move |y| [y, z]));
        rows.flat_map(move |[y, z]| {
            let [from, to] = xs.map(|x| self.first[self.number([0, y, z]) + x] as usize);
            &self.balls[from..to]
        })
    }
}
