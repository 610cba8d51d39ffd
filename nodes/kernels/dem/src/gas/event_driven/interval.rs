//! The events of one interval, in a fixed cell with growing grains.
//!
//! Each grain has an anchor, its position when its list of neighbours was made, and may move freely within a margin around
//! it. Its next event is a collision, or reaching that margin, where anchor and list are renewed (near-neighbour lists: Donev,
//! Torquato & Stillinger, J. Comput. Phys. 202, 737 (2005)). As in Lubachevsky, J. Comput. Phys. 94, 255 (1991), a grain whose
//! partner found an earlier collision keeps the time of the cancelled one, and searches again then.

use super::pair::{Grain, OVERLAP_TOLERANCE, PairMotion, collide, dot};
use super::queue::Queue;
use crate::gas::error::GasError;
use crate::gas::grid::{Grid, Image, NO_GRAIN, Neighbour, cell_vectors};
use grainlab_core::Vec3;

#[derive(Clone, Copy, Debug)]
struct NextCollision {
    /// `NO_GRAIN` if the collision was cancelled, or if the grain collides with no other before the end.
    partner: u32,
    /// Cell vectors from the partner, unwrapped since the start, to the image that is hit.
    image: [i32; 3],
}

const NO_COLLISION: NextCollision = NextCollision { partner: NO_GRAIN, image: [0; 3] };

/// Neighbours examined together.
const GROUP: usize = 16;

#[derive(Clone, Copy, Debug, Default)]
struct ClosingPair {
    neighbour: Neighbour,
    motion: PairMotion,
}

pub(super) struct Interval {
    edges: [f64; 3],
    /// Offset of each of the 27 images, m.
    image_offsets: [[f64; 3]; 27],
    /// Relative growth of all lengths of grains per unit of time, 1/s.
    growth: f64,
    end: f64,
    /// Largest distance of a grain from its anchor, m.
    margin: f64,
    grains: Vec<Grain>,
    anchors: Vec<[f64; 3]>,
    /// Grains that each may hit before one of the two reaches its margin; each pair is listed with both grains.
    neighbours: Vec<Vec<Neighbour>>,
    /// Buffers: candidates, and the previous list.
    buffers: [Vec<Neighbour>; 2],
    /// Buffer: images, as bits, in which grains were neighbours; all zero between two uses.
    image_bits: Vec<u32>,
    collisions: Vec<NextCollision>,
    collision_times: Vec<f64>,
    /// Buffer: neighbours of a group that come closer.
    closing: [ClosingPair; GROUP],
    /// Times when each grain reaches its margin.
    margin_times: Vec<f64>,
    /// Cell vectors by which each grain was folded since the start.
    cells_crossed: Vec<[i32; 3]>,
    grid: Grid,
    queue: Queue,
    /// The caller's index of each grain, and the cell vectors by which it was folded at the start.
    origin: Vec<(u32, [f64; 3])>,
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EventCounts {
    pub(super) collisions: u64,
    /// Sum of impulse times distance, over density and 4π/3.
    pub(super) impulse_length: f64,
}

/// Events between two looks at whether to stop: below a millisecond.
const LOOK: u64 = 256;

/// Why the end was not reached.
#[derive(Clone, Copy, Debug)]
pub(super) enum Cut {
    /// There were more events than allowed, before this time.
    Limit { reached: f64 },
    /// The caller stopped it.
    Stopped,
}

impl Interval {
    /// Folds the grains, sorts them by grid cell, lists neighbours and finds the first event of every grain. `margin` (m) must
    /// be positive, and the largest contact distance plus twice the margin must fit into every edge.
    pub(super) fn new(
        edges: Vec3,
        radii: &[f64],
        positions: &[Vec3],
        velocities: &[Vec3],
        (growth, end): (f64, f64),
        margin: f64,
        stopped: &dyn Fn() -> bool,
    ) -> Result<Self, GasError> {
        let n = radii.len();
        let largest = radii.iter().copied().fold(0.0, f64::max) * (1.0 + growth * end).max(1.0);
        let mut grid = Grid::new(edges, 2.0 * (largest + margin) * (1.0 + OVERLAP_TOLERANCE), n);
        let fold = |x: &Vec3| -> ([f64; 3], [f64; 3]) {
            let turns: [f64; 3] = std::array::from_fn(|k| (x[k] / edges[k]).floor());
            (std::array::from_fn(|k| x[k] - turns[k] * edges[k]), turns)
        };
        let folded: Vec<_> = positions.iter().map(fold).collect();
        // Neighbours in space are neighbours in memory.
        let mut order: Vec<u32> = (0..n as u32).collect();
        order.sort_by_cached_key(|i| grid.cell(&folded[*i as usize].0));
        let grain = |i: &u32| Grain {
            x: folded[*i as usize].0,
            time: 0.0,
            v: velocities[*i as usize].into(),
            radius: radii[*i as usize],
        };
        let grains: Vec<Grain> = order.iter().map(grain).collect();
        grains.iter().enumerate().for_each(|(i, g)| grid.place(i, &g.x));
        let edges: [f64; 3] = edges.into();
        let mut interval = Self {
            edges,
            image_offsets: std::array::from_fn(|i| {
                let vectors = cell_vectors(i as Image);
                std::array::from_fn(|k| f64::from(vectors[k]) * edges[k])
            }),
            growth,
            end,
            margin,
            anchors: grains.iter().map(|g| g.x).collect(),
            neighbours: vec![Vec::with_capacity(24); n],
            buffers: [Vec::new(), Vec::new()],
            image_bits: vec![0; n],
            collisions: vec![NO_COLLISION; n],
            collision_times: vec![f64::INFINITY; n],
            closing: [ClosingPair::default(); GROUP],
            margin_times: Vec::with_capacity(n),
            cells_crossed: vec![[0; 3]; n],
            grid,
            queue: Queue::new(std::iter::empty()),
            origin: order.iter().map(|i| (*i, folded[*i as usize].1)).collect(),
            grains,
        };
        let go_on = |i: usize| {
            if (i as u64).is_multiple_of(LOOK) && stopped() { Err(GasError::Stopped) } else { Ok(()) }
        };
        for i in 0..n {
            go_on(i)?;
            interval.find_neighbours(i);
            interval.check_overlaps(i)?;
            interval.margin_times.push(interval.margin_time(i));
        }
        interval.queue = Queue::new(interval.margin_times.iter().copied());
        for i in 0..n {
            go_on(i)?;
            // A collision that an earlier grain found is kept unless there is an earlier one.
            interval.find_collision(i, 0.0);
            interval.queue.set(i, interval.event_time(i));
        }
        Ok(interval)
    }

    /// Runs to the end, through `limit` events, or until it is stopped.
    pub(super) fn run(&mut self, limit: u64, stopped: &dyn Fn() -> bool) -> Result<EventCounts, Cut> {
        let (mut counts, mut events) = (EventCounts::default(), 0);
        while let Some((time, i)) = self.queue.first() {
            if time >= self.end {
                break;
            }
            events += 1;
            if events > limit {
                return Err(Cut::Limit { reached: time });
            }
            if events.is_multiple_of(LOOK) && stopped() {
                return Err(Cut::Stopped);
            }
            let i = i as usize;
            let collision = self.collisions[i];
            if self.margin_times[i] <= self.collision_times[i] {
                self.renew_anchor(i, time);
            } else if collision.partner == NO_GRAIN {
                self.collision_times[i] = f64::INFINITY;
                self.find_collision(i, time);
                self.queue.set(i, self.event_time(i));
            } else {
                counts.impulse_length += self.collide(i, collision, time);
                counts.collisions += 1;
            }
        }
        Ok(counts)
    }

    /// m v², over density and 4π/3.
    pub(super) fn twice_energy(&self) -> f64 {
        self.grains.iter().map(|g| g.mass() * dot(&g.v, &g.v)).sum()
    }

    /// Writes positions and velocities at the end, with all lengths scaled by `stretch`.
    pub(super) fn finish(&self, stretch: f64, positions: &mut [Vec3], velocities: &mut [Vec3]) {
        for (i, (caller, turns)) in self.origin.iter().enumerate() {
            let x = self.grains[i].at(self.end);
            let cells_crossed = self.cells_crossed[i];
            let unwrapped = |k: usize| x[k] + (turns[k] + f64::from(cells_crossed[k])) * self.edges[k];
            positions[*caller as usize] = Vec3::from_fn(|k, _| unwrapped(k) * stretch);
            velocities[*caller as usize] = self.grains[i].v.into();
        }
    }

    #[inline(always)]
    fn event_time(&self, i: usize) -> f64 {
        self.collision_times[i].min(self.margin_times[i])
    }

    /// Contact distance at `time`, and its rate.
    #[inline(always)]
    fn contact(&self, i: usize, j: usize, time: f64) -> (f64, f64) {
        let sum = self.grains[i].radius + self.grains[j].radius;
        (sum * (1.0 + self.growth * time), sum * self.growth)
    }

    /// Lists the grains with anchors so near to that of `i` that they may touch it before either leaves its margin.
    fn find_neighbours(&mut self, i: usize) {
        let candidates = &mut self.buffers[0];
        let (anchor, radius) = (self.anchors[i], self.grains[i].radius);
        let scale = (1.0 + self.growth * self.end).max(1.0);
        self.grid.around(&anchor, candidates);
        let mut count = 0;
        for k in 0..candidates.len() {
            let neighbour = candidates[k];
            let j = neighbour.grain as usize;
            let (to, offset) = (&self.anchors[j], &self.image_offsets[neighbour.image as usize]);
            let d: [f64; 3] = std::array::from_fn(|k| to[k] - anchor[k] + offset[k]);
            let contact = (radius + self.grains[j].radius) * scale;
            let reach = (contact + 2.0 * self.margin) * (1.0 + OVERLAP_TOLERANCE);
            candidates[count] = neighbour;
            count += usize::from((dot(&d, &d) < reach * reach) & (j != i));
        }
        self.neighbours[i].clear();
        self.neighbours[i].extend_from_slice(&candidates[..count]);
    }

    /// When a grain reaches its margin from its present position.
    #[inline]
    fn margin_time(&self, i: usize) -> f64 {
        let (g, a) = (&self.grains[i], &self.anchors[i]);
        let y: [f64; 3] = std::array::from_fn(|k| g.x[k] - a[k]);
        let (vv, yv) = (dot(&g.v, &g.v), dot(&y, &g.v));
        if vv == 0.0 {
            return f64::INFINITY;
        }
        let room = (self.margin * self.margin - dot(&y, &y)).max(0.0);
        g.time + ((yv * yv + vv * room).sqrt() - yv) / vv
    }

    /// Moves the anchor of a grain to its position, and renews its list of neighbours.
    fn renew_anchor(&mut self, i: usize, now: f64) {
        let g = &mut self.grains[i];
        g.x = g.at(now);
        g.time = now;
        for k in 0..3 {
            // This is rare, and `floor` is a library call without SSE4.1.
            if !(0.0..self.edges[k]).contains(&g.x[k]) {
                let turns = (g.x[k] / self.edges[k]).floor();
                g.x[k] -= turns * self.edges[k];
                self.cells_crossed[i][k] += turns as i32;
            }
        }
        self.anchors[i] = g.x;
        self.grid.place(i, &self.anchors[i]);
        self.update_neighbours(i);
        self.margin_times[i] = self.margin_time(i);
        self.find_collision(i, now);
        self.queue.set(i, self.event_time(i));
    }

    /// Renews the list of `i`, and updates those of the grains that became its neighbours or ceased to be.
    fn update_neighbours(&mut self, i: usize) {
        let previous = std::mem::replace(&mut self.neighbours[i], std::mem::take(&mut self.buffers[1]));
        self.find_neighbours(i);
        for old in &previous {
            self.image_bits[old.grain as usize] |= 1 << old.image;
        }
        for k in 0..self.neighbours[i].len() {
            let new = self.neighbours[i][k];
            let (bits, bit) = (&mut self.image_bits[new.grain as usize], 1 << new.image);
            if *bits & bit == 0 {
                self.neighbours[new.grain as usize]
                    .push(Neighbour { grain: i as u32, image: 26 - new.image });
            }
            *bits &= !bit;
        }
        for old in &previous {
            let (bits, bit) = (&mut self.image_bits[old.grain as usize], 1 << old.image);
            if *bits & bit != 0 {
                *bits &= !bit;
                let mirror = Neighbour { grain: i as u32, image: 26 - old.image };
                let others = &mut self.neighbours[old.grain as usize];
                if let Some(at) = others.iter().position(|n| *n == mirror) {
                    others.swap_remove(at);
                }
            }
        }
        self.buffers[1] = previous;
    }

    fn collide(&mut self, i: usize, collision: NextCollision, now: f64) -> f64 {
        let j = collision.partner as usize;
        let (sigma, growth) = self.contact(i, j, now);
        let (mut a, mut b) = (self.grains[i], self.grains[j]);
        (a.x, b.x) = (a.at(now), b.at(now));
        (a.time, b.time) = (now, now);
        let image =
            |k: usize| f64::from(collision.image[k] - self.cells_crossed[i][k] + self.cells_crossed[j][k]);
        let d = std::array::from_fn(|k| b.x[k] - a.x[k] + image(k) * self.edges[k]);
        let impulse_length = collide(&mut a, &mut b, &d, sigma, growth);
        for (g, grain) in [(i, a), (j, b)] {
            self.grains[g] = grain;
            self.margin_times[g] = self.margin_time(g);
            (self.collisions[g], self.collision_times[g]) = (NO_COLLISION, f64::INFINITY);
        }
        self.find_collision(i, now);
        self.find_collision(j, now);
        self.queue.set(i, self.event_time(i));
        self.queue.set(j, self.event_time(j));
        impulse_length
    }

    /// Searches for a collision of `i` earlier than its present one.
    fn find_collision(&mut self, i: usize, now: f64) {
        let g = self.grains[i];
        let x = g.at(now);
        let scale = 1.0 + self.growth * now;
        let mut best = self.collision_times[i].min(self.end);
        let mut first = None;
        for group in self.neighbours[i].chunks(GROUP) {
            // Half of all pairs come closer, unpredictably: count without a branch.
            let (mut count, limit) = (0, best);
            for neighbour in group {
                let other = &self.grains[neighbour.grain as usize];
                let (p, s) = (other.at(now), &self.image_offsets[neighbour.image as usize]);
                let d = [p[0] - x[0] + s[0], p[1] - x[1] + s[1], p[2] - x[2] + s[2]];
                let v = [other.v[0] - g.v[0], other.v[1] - g.v[1], other.v[2] - g.v[2]];
                let sum = g.radius + other.radius;
                let motion = PairMotion::new(&d, &v, sum * scale, sum * self.growth);
                self.closing[count] = ClosingPair { neighbour: *neighbour, motion };
                // If the other grain collides before, it searches again after that.
                let before = limit.min(self.collision_times[neighbour.grain as usize]);
                count += usize::from(motion.may_collide(before - now));
            }
            for c in &self.closing[..count] {
                let wait = c.motion.time_to_contact();
                if wait < best - now && now + wait < self.collision_times[c.neighbour.grain as usize] {
                    (best, first) = (now + wait, Some(c.neighbour));
                }
            }
        }
        let Some(neighbour) = first else { return };
        let (j, vectors) = (neighbour.grain as usize, cell_vectors(neighbour.image));
        let image = std::array::from_fn(|k| vectors[k] + self.cells_crossed[i][k] - self.cells_crossed[j][k]);
        self.release_partner(i, j);
        self.release_partner(j, i);
        self.collisions[i] = NextCollision { partner: neighbour.grain, image };
        self.collisions[j] = NextCollision { partner: i as u32, image: image.map(|k| -k) };
        (self.collision_times[i], self.collision_times[j]) = (best, best);
        self.queue.set(j, self.event_time(j));
    }

    /// Cancels the collision of `i` with its partner, unless that is `new`. The partner searches again at the cancelled time.
    fn release_partner(&mut self, i: usize, new: usize) {
        let partner = self.collisions[i].partner;
        if partner != NO_GRAIN && partner as usize != new {
            self.collisions[partner as usize].partner = NO_GRAIN;
        }
    }

    fn check_overlaps(&self, i: usize) -> Result<(), GasError> {
        for neighbour in &self.neighbours[i] {
            let j = neighbour.grain as usize;
            let (a, b) = (&self.anchors[i], &self.anchors[j]);
            let offset = &self.image_offsets[neighbour.image as usize];
            let distance = Vec3::from_fn(|k, _| b[k] - a[k] + offset[k]).norm();
            let overlap = self.contact(i, j, 0.0).0 - distance;
            if overlap > OVERLAP_TOLERANCE * distance {
                let [first, second] = [i, j].map(|g| self.origin[g].0);
                return Err(GasError::HardSpheres(format!(
                    "grains {first} and {second} overlap by {overlap:e} m; hard spheres must not"
                )));
            }
        }
        Ok(())
    }
}
