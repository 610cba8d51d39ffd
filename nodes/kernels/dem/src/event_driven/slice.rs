//! The events of one interval, in a fixed cell with growing grains.
//!
//! Each grain has an anchor, where it was when its list of near grains was made, and may move freely within a margin of
//! it. Its next event is a collision, or reaching that margin, where anchor and list are made anew (near-neighbour lists:
//! Donev, Torquato & Stillinger, J. Comput. Phys. 202, 737 (2005)). As in Lubachevsky, J. Comput. Phys. 94, 255 (1991),
//! a grain whose partner found an earlier collision keeps the time of the lost one, and looks again then.

use super::ROUNDING;
use super::grid::{Grid, Image, NONE, Near, cell_vectors};
use super::pair::{Approach, Grain, collide, dot};
use super::queue::Queue;
use crate::error::DemError;
use grainlab_core::Vec3;

/// A grain's next collision.
#[derive(Clone, Copy, Debug)]
struct Meeting {
    /// `NONE`: the collision was lost to another, or there is none before the end.
    partner: u32,
    /// Cell vectors from the partner, unwrapped since the beginning, to the image of it that is met.
    image: [i32; 3],
}

const NOBODY: Meeting = Meeting { partner: NONE, image: [0; 3] };

/// Near grains looked at together.
const GROUP: usize = 16;

/// A grain that comes closer.
#[derive(Clone, Copy, Debug, Default)]
struct Closing {
    near: Near,
    approach: Approach,
}

/// The interval under way.
pub(super) struct Slice {
    edges: [f64; 3],
    /// Shift of each of the 27 images, m.
    shifts: [[f64; 3]; 27],
    /// Relative growth of all lengths of grains per unit of time, 1/s.
    growth: f64,
    end: f64,
    /// How far a grain may be from its anchor, m.
    margin: f64,
    grains: Vec<Grain>,
    anchors: Vec<[f64; 3]>,
    /// Grains that each may meet before one of the two reaches its margin; each pair is listed with both.
    near: Vec<Vec<Near>>,
    /// Candidates, and the list before.
    spare: [Vec<Near>; 2],
    /// Images, as bits, in which grains were near; all zero between two uses.
    marks: Vec<u32>,
    meetings: Vec<Meeting>,
    /// When.
    next: Vec<f64>,
    /// Those of a group that come closer; only while it is looked at.
    closing: [Closing; GROUP],
    /// When each grain reaches its margin.
    leaving: Vec<f64>,
    /// Cell vectors by which each grain was folded since the beginning.
    crossed: Vec<[i32; 3]>,
    grid: Grid,
    queue: Queue,
    /// Which grain of the caller each one is, and the cell vectors by which it was folded at the beginning.
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
    /// Folds, sorts by grid cell, lists what is near and finds every grain's first event. `margin` (m) is positive, and
    /// the largest distance of contact and twice the margin fit into every edge.
    pub(super) fn new(
        edges: Vec3,
        radii: &[f64],
        positions: &[Vec3],
        velocities: &[Vec3],
        growth: f64,
        end: f64,
        margin: f64,
    ) -> Result<Self, DemError> {
        let n = radii.len();
        let largest = radii.iter().copied().fold(0.0, f64::max) * (1.0 + growth * end).max(1.0);
        let mut grid = Grid::new(edges, 2.0 * (largest + margin) * (1.0 + ROUNDING), n);
        let fold = |x: &Vec3| -> ([f64; 3], [f64; 3]) {
            let turns: [f64; 3] = std::array::from_fn(|k| (x[k] / edges[k]).floor());
            (std::array::from_fn(|k| x[k] - turns[k] * edges[k]), turns)
        };
        let folded: Vec<_> = positions.iter().map(fold).collect();
        // Grains that are near lie near in memory.
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
        let mut slice = Self {
            edges,
            shifts: std::array::from_fn(|i| {
                let vectors = cell_vectors(i as Image);
                std::array::from_fn(|k| f64::from(vectors[k]) * edges[k])
            }),
            growth,
            end,
            margin,
            anchors: grains.iter().map(|g| g.x).collect(),
            near: vec![Vec::with_capacity(24); n],
            spare: [Vec::new(), Vec::new()],
            marks: vec![0; n],
            meetings: vec![NOBODY; n],
            next: vec![f64::INFINITY; n],
            closing: [Closing::default(); GROUP],
            leaving: Vec::with_capacity(n),
            crossed: vec![[0; 3]; n],
            grid,
            queue: Queue::new(std::iter::empty()),
            origin: order.iter().map(|i| (*i, folded[*i as usize].1)).collect(),
            grains,
        };
        for i in 0..n {
            slice.list(i);
            slice.refuse_overlaps(i)?;
            slice.leaving.push(slice.exit(i));
        }
        slice.queue = Queue::new(slice.leaving.iter().copied());
        for i in 0..n {
            // A grain that an earlier one found keeps that unless it finds better.
            slice.seek(i, 0.0);
            slice.queue.set(i, slice.event(i));
        }
        Ok(slice)
    }

    /// Runs to the end, or through `limit` events.
    pub(super) fn run(&mut self, limit: u64) -> Result<Tally, TooMany> {
        let (mut tally, mut events) = (Tally::default(), 0);
        while let Some((time, i)) = self.queue.first() {
            if time >= self.end {
                break;
            }
            events += 1;
            if events > limit {
                return Err(TooMany { reached: time });
            }
            let i = i as usize;
            let meeting = self.meetings[i];
            if self.leaving[i] <= self.next[i] {
                self.leave(i, time);
            } else if meeting.partner == NONE {
                self.next[i] = f64::INFINITY;
                self.seek(i, time);
                self.queue.set(i, self.event(i));
            } else {
                tally.impulse_length += self.collide(i, meeting, time);
                tally.collisions += 1;
            }
        }
        Ok(tally)
    }

    /// m v², over density and 4π/3.
    pub(super) fn twice_energy(&self) -> f64 {
        self.grains.iter().map(|g| g.mass() * dot(&g.v, &g.v)).sum()
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
        self.next[i].min(self.leaving[i])
    }

    /// Distance of contact at `time`, and its rate.
    #[inline(always)]
    fn contact(&self, i: usize, j: usize, time: f64) -> (f64, f64) {
        let sum = self.grains[i].radius + self.grains[j].radius;
        (sum * (1.0 + self.growth * time), sum * self.growth)
    }

    /// The grains anchored so near to the anchor of `i` that they may touch it before either leaves its margin.
    fn list(&mut self, i: usize) {
        let candidates = &mut self.spare[0];
        let (anchor, radius) = (self.anchors[i], self.grains[i].radius);
        let scale = (1.0 + self.growth * self.end).max(1.0);
        self.grid.around(&anchor, candidates);
        let mut count = 0;
        for k in 0..candidates.len() {
            let near = candidates[k];
            let j = near.grain as usize;
            let (to, shift) = (&self.anchors[j], &self.shifts[near.image as usize]);
            let d: [f64; 3] = std::array::from_fn(|k| to[k] - anchor[k] + shift[k]);
            let contact = (radius + self.grains[j].radius) * scale;
            let reach = (contact + 2.0 * self.margin) * (1.0 + ROUNDING);
            candidates[count] = near;
            count += usize::from((dot(&d, &d) < reach * reach) & (j != i));
        }
        self.near[i].clear();
        self.near[i].extend_from_slice(&candidates[..count]);
    }

    /// When a grain reaches its margin, from where it is.
    #[inline]
    fn exit(&self, i: usize) -> f64 {
        let (g, a) = (&self.grains[i], &self.anchors[i]);
        let y: [f64; 3] = std::array::from_fn(|k| g.x[k] - a[k]);
        let (vv, yv) = (dot(&g.v, &g.v), dot(&y, &g.v));
        if vv == 0.0 {
            return f64::INFINITY;
        }
        let room = (self.margin * self.margin - dot(&y, &y)).max(0.0);
        g.time + ((yv * yv + vv * room).sqrt() - yv) / vv
    }

    /// Anchors a grain where it is, and lists it anew with all that are near.
    fn leave(&mut self, i: usize, now: f64) {
        let g = &mut self.grains[i];
        g.x = g.at(now);
        g.time = now;
        for k in 0..3 {
            // Seldom, and `floor` is a call where the processor may be any.
            if !(0.0..self.edges[k]).contains(&g.x[k]) {
                let turns = (g.x[k] / self.edges[k]).floor();
                g.x[k] -= turns * self.edges[k];
                self.crossed[i][k] += turns as i32;
            }
        }
        self.anchors[i] = g.x;
        self.grid.place(i, &self.anchors[i]);
        self.relist(i);
        self.leaving[i] = self.exit(i);
        self.seek(i, now);
        self.queue.set(i, self.event(i));
    }

    /// Lists `i` anew, with itself and with all that it came near to or went away from.
    fn relist(&mut self, i: usize) {
        let old = std::mem::replace(&mut self.near[i], std::mem::take(&mut self.spare[1]));
        self.list(i);
        for near in &old {
            self.marks[near.grain as usize] |= 1 << near.image;
        }
        for k in 0..self.near[i].len() {
            let near = self.near[i][k];
            let (marks, bit) = (&mut self.marks[near.grain as usize], 1 << near.image);
            if *marks & bit == 0 {
                self.near[near.grain as usize].push(Near { grain: i as u32, image: 26 - near.image });
            }
            *marks &= !bit;
        }
        for near in &old {
            let (marks, bit) = (&mut self.marks[near.grain as usize], 1 << near.image);
            if *marks & bit != 0 {
                *marks &= !bit;
                let mine = Near { grain: i as u32, image: 26 - near.image };
                let theirs = &mut self.near[near.grain as usize];
                if let Some(at) = theirs.iter().position(|n| *n == mine) {
                    theirs.swap_remove(at);
                }
            }
        }
        self.spare[1] = old;
    }

    fn collide(&mut self, i: usize, meeting: Meeting, now: f64) -> f64 {
        let j = meeting.partner as usize;
        let (sigma, growth) = self.contact(i, j, now);
        let (mut a, mut b) = (self.grains[i], self.grains[j]);
        (a.x, b.x) = (a.at(now), b.at(now));
        (a.time, b.time) = (now, now);
        let image = |k: usize| f64::from(meeting.image[k] - self.crossed[i][k] + self.crossed[j][k]);
        let d = std::array::from_fn(|k| b.x[k] - a.x[k] + image(k) * self.edges[k]);
        let carried = collide(&mut a, &mut b, &d, sigma, growth);
        for (g, grain) in [(i, a), (j, b)] {
            self.grains[g] = grain;
            self.leaving[g] = self.exit(g);
            (self.meetings[g], self.next[g]) = (NOBODY, f64::INFINITY);
        }
        self.seek(i, now);
        self.seek(j, now);
        self.queue.set(i, self.event(i));
        self.queue.set(j, self.event(j));
        carried
    }

    /// Looks for a collision of `i` before the one it has.
    fn seek(&mut self, i: usize, now: f64) {
        let g = self.grains[i];
        let x = g.at(now);
        let scale = 1.0 + self.growth * now;
        let mut best = self.next[i].min(self.end);
        let mut found = None;
        for group in self.near[i].chunks(GROUP) {
            // Half of all pairs close, no telling which: counted, not branched upon.
            let (mut count, limit) = (0, best);
            for near in group {
                let other = &self.grains[near.grain as usize];
                let (p, s) = (other.at(now), &self.shifts[near.image as usize]);
                let d = [p[0] - x[0] + s[0], p[1] - x[1] + s[1], p[2] - x[2] + s[2]];
                let v = [other.v[0] - g.v[0], other.v[1] - g.v[1], other.v[2] - g.v[2]];
                let sum = g.radius + other.radius;
                let approach = Approach::of(&d, &v, sum * scale, sum * self.growth);
                self.closing[count] = Closing { near: *near, approach };
                // What the other grain meets before is its next collision, after which it looks again.
                let before = limit.min(self.next[near.grain as usize]);
                count += usize::from(approach.may_meet(before - now));
            }
            for c in &self.closing[..count] {
                let wait = c.approach.meeting();
                if wait < best - now && now + wait < self.next[c.near.grain as usize] {
                    (best, found) = (now + wait, Some(c.near));
                }
            }
        }
        let Some(near) = found else { return };
        let (j, vectors) = (near.grain as usize, cell_vectors(near.image));
        let image = std::array::from_fn(|k| vectors[k] + self.crossed[i][k] - self.crossed[j][k]);
        self.abandon(i, j);
        self.abandon(j, i);
        self.meetings[i] = Meeting { partner: near.grain, image };
        self.meetings[j] = Meeting { partner: i as u32, image: image.map(|k| -k) };
        (self.next[i], self.next[j]) = (best, best);
        self.queue.set(j, self.event(j));
    }

    /// `i` has found better than its partner, which looks again when they would have met.
    fn abandon(&mut self, i: usize, better: usize) {
        let partner = self.meetings[i].partner;
        if partner != NONE && partner as usize != better {
            self.meetings[partner as usize].partner = NONE;
        }
    }

    fn refuse_overlaps(&self, i: usize) -> Result<(), DemError> {
        for near in &self.near[i] {
            let j = near.grain as usize;
            let (a, b, shift) = (&self.anchors[i], &self.anchors[j], &self.shifts[near.image as usize]);
            let distance = Vec3::from_fn(|k, _| b[k] - a[k] + shift[k]).norm();
            let overlap = self.contact(i, j, 0.0).0 - distance;
            if overlap > ROUNDING * distance {
                let [first, second] = [i, j].map(|g| self.origin[g].0);
                return Err(DemError::HardSpheres(format!(
                    "grains {first} and {second} overlap by {overlap:e} m; hard spheres must not"
                )));
            }
        }
        Ok(())
    }
}
