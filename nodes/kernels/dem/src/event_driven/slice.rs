//! The events of one interval, in a fixed cell with growing grains.
//!
//! Each grain knows its next collision and when it leaves its grid cell; the earlier of the two is its event. As in
//! Lubachevsky, J. Comput. Phys. 94, 255 (1991), a grain whose partner found an earlier collision keeps the time of the
//! lost one, and looks again then.

use super::ROUNDING;
use super::grid::{Grid, NONE};
use super::pair::{Gap, Grain, collide};
use super::queue::Queue;
use crate::error::DemError;
use grains::Vec3;

/// A grain's next collision.
#[derive(Clone, Copy, Debug)]
struct Meeting {
    time: f64,
    /// `NONE`: the collision was lost to another, or there is none before the end.
    partner: u32,
    /// Cell vectors from the partner, as it was at the beginning (unwrapped), to the image that is met.
    image: [i32; 3],
}

const NEVER: Meeting = Meeting { time: f64::INFINITY, partner: NONE, image: [0; 3] };

/// The interval under way.
pub(super) struct Slice {
    edges: [f64; 3],
    /// Relative growth of all lengths of grains per unit of time, 1/s.
    growth: f64,
    end: f64,
    grains: Vec<Grain>,
    /// Cell vectors crossed since the beginning.
    crossed: Vec<[i32; 3]>,
    meetings: Vec<Meeting>,
    leaving: Vec<(f64, u8, bool)>,
    grid: Grid,
    queue: Queue,
    /// Which grain of the caller each one is, and the cell vectors by which it was folded.
    origin: Vec<(u32, [f64; 3])>,
}

/// What happened.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    pub(super) collisions: u64,
    /// Sum of impulse times distance, over density and 4π/3.
    pub(super) impulse_length: f64,
}

/// More events than allowed.
#[derive(Clone, Copy, Debug)]
pub(super) struct TooMany {
    /// Time reached.
    pub(super) reached: f64,
}

impl Slice {
    /// Folds, sorts by grid cell, and finds every grain's first event.
    pub(super) fn new(
        edges: Vec3,
        radii: &[f64],
        positions: &[Vec3],
        velocities: &[Vec3],
        growth: f64,
        end: f64,
    ) -> Result<Self, DemError> {
        let n = radii.len();
        let largest = radii.iter().copied().fold(0.0, f64::max) * (1.0 + growth * end).max(1.0);
        // Rounding lets a grain stand a little outside the cell it is listed in.
        let mut grid = Grid::new(edges, 2.0 * largest * (1.0 + ROUNDING), n);
        let folded: Vec<([f64; 3], [f64; 3])> = positions
            .iter()
            .map(|x| {
                let turns: [f64; 3] = std::array::from_fn(|k| (x[k] / edges[k]).floor());
                (std::array::from_fn(|k| x[k] - turns[k] * edges[k]), turns)
            })
            .collect();
        // Grains that are near lie near in memory.
        let mut order: Vec<u32> = (0..n as u32).collect();
        order.sort_by_cached_key(|i| grid.flat(grid.cell_of(&folded[*i as usize].0)));
        let grain = |i: &u32| Grain {
            x: folded[*i as usize].0,
            time: 0.0,
            v: velocities[*i as usize].into(),
            radius: radii[*i as usize],
        };
        let grains: Vec<Grain> = order.iter().map(grain).collect();
        for (i, g) in grains.iter().enumerate() {
            grid.insert(i, grid.cell_of(&g.x));
        }
        let leaving: Vec<_> = (0..n).map(|i| exit(&grid, i, &grains[i])).collect();
        let queue = Queue::new(leaving.iter().map(|l| l.0));
        let mut slice = Self {
            edges: edges.into(),
            growth,
            end,
            crossed: vec![[0; 3]; n],
            meetings: vec![NEVER; n],
            leaving,
            grid,
            queue,
            origin: order.iter().map(|i| (*i, folded[*i as usize].1)).collect(),
            grains,
        };
        slice.refuse_overlaps()?;
        for i in 0..n {
            // A grain that an earlier one found keeps that unless it finds better.
            slice.seek(i, 0.0, None);
            slice.queue.set(i, slice.event(i));
        }
        Ok(slice)
    }

    /// Runs to the end, or through `limit` collisions.
    pub(super) fn run(&mut self, limit: u64) -> Result<Tally, TooMany> {
        let mut tally = Tally::default();
        while let Some((time, i)) = self.queue.first() {
            if time >= self.end {
                break;
            }
            let i = i as usize;
            let meeting = self.meetings[i];
            if self.leaving[i].0 <= meeting.time {
                self.leave(i, time);
            } else if meeting.partner == NONE {
                self.meetings[i] = NEVER;
                self.seek(i, time, None);
                self.queue.set(i, self.event(i));
            } else {
                tally.impulse_length += self.collide(i, meeting);
                tally.collisions += 1;
                if tally.collisions > limit {
                    return Err(TooMany { reached: time });
                }
            }
        }
        Ok(tally)
    }

    /// m v², over density and 4π/3.
    pub(super) fn twice_energy(&self, i: usize) -> f64 {
        let g = &self.grains[i];
        g.mass() * super::pair::dot(&g.v, &g.v)
    }

    /// Hands back where everything is at the end, all lengths scaled by `stretch`.
    pub(super) fn finish(&self, stretch: f64, positions: &mut [Vec3], velocities: &mut [Vec3]) {
        for (i, (caller, turns)) in self.origin.iter().enumerate() {
            let x = self.grains[i].at(self.end);
            let crossed = self.crossed[i];
            let unwrapped = |k: usize| x[k] + (turns[k] + f64::from(crossed[k])) * self.edges[k];
            positions[*caller as usize] = Vec3::from_fn(|k, _| unwrapped(k) * stretch);
            velocities[*caller as usize] = self.grains[i].v.into();
        }
    }

    /// Time of a grain's next event.
    #[inline(always)]
    fn event(&self, i: usize) -> f64 {
        self.meetings[i].time.min(self.leaving[i].0)
    }

    /// Distance of contact at `time`, and its rate.
    #[inline(always)]
    fn contact(&self, i: usize, j: usize, time: f64) -> (f64, f64) {
        let sum = self.grains[i].radius + self.grains[j].radius;
        (sum * (1.0 + self.growth * time), sum * self.growth)
    }

    fn leave(&mut self, i: usize, now: f64) {
        let (_, axis, forward) = self.leaving[i];
        let axis = axis as usize;
        let shift = self.grid.cross(i, axis, forward);
        if shift != 0 {
            self.grains[i].x[axis] -= f64::from(shift) * self.edges[axis];
            self.crossed[i][axis] += i32::from(shift);
        }
        self.leaving[i] = exit(&self.grid, i, &self.grains[i]);
        self.seek(i, now, Some((axis, forward)));
        self.queue.set(i, self.event(i));
    }

    fn collide(&mut self, i: usize, meeting: Meeting) -> f64 {
        let (j, now) = (meeting.partner as usize, meeting.time);
        let (sigma, growth) = self.contact(i, j, now);
        let (mut a, mut b) = (self.grains[i], self.grains[j]);
        (a.x, b.x) = (a.at(now), b.at(now));
        (a.time, b.time) = (now, now);
        let image = |k: usize| f64::from(meeting.image[k] - self.crossed[i][k] + self.crossed[j][k]);
        let d = std::array::from_fn(|k| b.x[k] - a.x[k] + image(k) * self.edges[k]);
        let carried = collide(&mut a, &mut b, &d, sigma, growth);
        for (g, grain) in [(i, a), (j, b)] {
            self.grains[g] = grain;
            self.leaving[g] = exit(&self.grid, g, &grain);
            self.meetings[g] = NEVER;
        }
        self.seek(i, now, None);
        self.seek(j, now, None);
        self.queue.set(i, self.event(i));
        self.queue.set(j, self.event(j));
        carried
    }

    /// Looks for a collision of `i` that comes before the one it has, among the grains around, or only among those in
    /// the cells that it now sees for the first time, having moved along an axis.
    fn seek(&mut self, i: usize, now: f64, moved: Option<(usize, bool)>) {
        let g = self.grains[i];
        let x = g.at(now);
        let scale = 1.0 + self.growth * now;
        let (mut best, mut shift) = (self.meetings[i], [0i8; 3]);
        best.time = best.time.min(self.end);
        let mut found = NONE;
        let span = |k: usize| match moved {
            Some((axis, true)) if axis == k => 2..3,
            Some((axis, false)) if axis == k => 0..1,
            _ => 0..3,
        };
        let [xs, ys, zs] = [0, 1, 2].map(|k| &self.grid.around(i, k)[span(k)]);
        for a in xs {
            let x0 = x[0] - f64::from(a.shift) * self.edges[0];
            for b in ys {
                let x1 = x[1] - f64::from(b.shift) * self.edges[1];
                for c in zs {
                    let x2 = x[2] - f64::from(c.shift) * self.edges[2];
                    let mut j = self.grid.first(self.grid.flat([a.index, b.index, c.index]));
                    while j != NONE {
                        let other = &self.grains[j as usize];
                        let p = other.at(now);
                        let d = [p[0] - x0, p[1] - x1, p[2] - x2];
                        let v = [other.v[0] - g.v[0], other.v[1] - g.v[1], other.v[2] - g.v[2]];
                        let sum = g.radius + other.radius;
                        let gap = Gap::new(&d, &v, sum * scale, sum * self.growth);
                        // Whatever the other grain meets before is its next collision.
                        if let Some(wait) = gap.meeting(best.time - now)
                            && now + wait < self.meetings[j as usize].time
                            && j as usize != i
                        {
                            best.time = now + wait;
                            found = j;
                            shift = [a.shift, b.shift, c.shift];
                        }
                        j = self.grid.next(j);
                    }
                }
            }
        }
        if found == NONE {
            return;
        }
        let j = found as usize;
        let image = std::array::from_fn(|k| i32::from(shift[k]) + self.crossed[i][k] - self.crossed[j][k]);
        self.abandon(i, j);
        self.abandon(j, i);
        self.meetings[i] = Meeting { time: best.time, partner: found, image };
        self.meetings[j] = Meeting { time: best.time, partner: i as u32, image: image.map(|k| -k) };
        self.queue.set(j, self.event(j));
    }

    /// `i` has found better than its partner, which looks again when they would have met.
    fn abandon(&mut self, i: usize, better: usize) {
        let partner = self.meetings[i].partner;
        if partner != NONE && partner as usize != better {
            self.meetings[partner as usize].partner = NONE;
        }
    }

    fn refuse_overlaps(&self) -> Result<(), DemError> {
        for i in 0..self.grains.len() {
            for a in self.grid.around(i, 0) {
                for b in self.grid.around(i, 1) {
                    for c in self.grid.around(i, 2) {
                        let mut j = self.grid.first(self.grid.flat([a.index, b.index, c.index]));
                        while j != NONE {
                            let (near, at) = (self.grains[j as usize].x, [a.shift, b.shift, c.shift]);
                            let d = Vec3::from_fn(|k, _| {
                                near[k] - self.grains[i].x[k] + f64::from(at[k]) * self.edges[k]
                            });
                            let (sigma, distance) = (self.contact(i, j as usize, 0.0).0, d.norm());
                            if (j as usize) < i && distance < sigma * (1.0 - ROUNDING) {
                                let [first, second] = [j as usize, i].map(|g| self.origin[g].0);
                                let overlap = sigma - distance;
                                return Err(DemError::HardSpheres(format!(
                                    "grains {first} and {second} overlap by {overlap:e} m; hard spheres must not"
                                )));
                            }
                            j = self.grid.next(j);
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

fn exit(grid: &Grid, i: usize, g: &Grain) -> (f64, u8, bool) {
    let (time, axis, forward) = grid.leaving(i, g);
    (time, axis as u8, forward)
}
