//! One pass over the pairs of a chunk of grains: forces and torques, contact by contact, summed on the grains.
//!
//! In three stages, a few blocks at a time: where the pairs are, what the contact law says, whom it acts on. Each waits
//! long for roots and sums, and only in a short loop does a processor see far enough ahead to have the next block's under
//! way.

use crate::contacts::{Block, Crossing, Sizes};
use crate::geometry::{Geometry, Grains, View};
use crate::lanes::{BLOCK, Lanes, Octad, Rows, V3};
use crate::law::Touch;
use crate::simd::Kernel;
use crate::stress::{self, Seen};

/// Blocks that go through the stages together.
const BATCH: usize = 8;

/// One chunk.
pub(crate) struct Chunk<'a> {
    /// Its first grain.
    pub(crate) first: u32,
    pub(crate) blocks: &'a mut [Block],
    /// Empty where grains are of one size.
    pub(crate) sizes: &'a [Sizes],
    /// Pairs across the faces of the cell.
    pub(crate) crossing: &'a [Crossing],
    /// Rows to add to: those of its grains, then others.
    pub(crate) sums: &'a mut [Octad],
    /// Whether these are zero.
    pub(crate) clean: bool,
}

/// Contacts without friction: no spins, no tangential springs.
pub(crate) struct Frictionless<'a, const SIZES: bool> {
    pub(crate) view: View<'a>,
    pub(crate) chunk: Chunk<'a>,
    /// Whether to see the stress across the faces of the cell.
    pub(crate) look: bool,
}

/// Contacts with friction; see [`crate::Law::frictional`] for the switches.
pub(crate) struct Frictional<
    'a,
    const ADVANCE: bool,
    const SLIDING: bool,
    const RESCALED: bool,
    const SIZES: bool,
> {
    pub(crate) view: View<'a>,
    pub(crate) chunk: Chunk<'a>,
    pub(crate) look: bool,
}

type Scalars = [f64; BLOCK];
type Vectors = [Scalars; 3];

/// Where the pairs of a block are.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Near {
    normal: Vectors,
    overlap: Scalars,
    inverse_distance: Scalars,
}

/// Some blocks under way.
#[repr(C, align(64))]
struct Batch {
    near: [Near; BATCH],
    /// On the second grain of each pair, N.
    force: [Vectors; BATCH],
    /// On both grains, N m; where sizes differ to be multiplied by the levers of the second and the first grain.
    moment: [Vectors; BATCH],
    levers: [[Scalars; 2]; BATCH],
    /// Lanes with a contact among them: block, first lane.
    live: [(u8, u8); BATCH * BLOCK],
}

/// How a phase's contacts resist.
trait Resist {
    /// Whether they turn grains.
    const TURN: bool;
    const SIZES: bool;

    /// What the contact law says about some lanes of a block.
    fn resist<L: Lanes>(
        view: &View<'_>,
        block: &mut Block,
        sizes: Option<&Sizes>,
        batch: &mut Batch,
        b: usize,
        lane: usize,
    );
}

/// All pairs of a chunk.
#[inline(always)]
fn pass<R: Resist, L: Lanes>(view: &View<'_>, chunk: Chunk<'_>, look: bool) -> Seen {
    if !chunk.clean {
        chunk.sums.fill(Octad::default());
    }
    let none = [0.0; BLOCK];
    let near = Near { normal: [none; 3], overlap: none, inverse_distance: none };
    let mut batch = Batch {
        near: [near; BATCH],
        force: [[none; 3]; BATCH],
        moment: [[none; 3]; BATCH],
        levers: [[none; 2]; BATCH],
        live: [(0, 0); BATCH * BLOCK],
    };
    let mut seen = Seen::default();
    let (mut start, mut crossed) = (0, 0);
    while start < chunk.blocks.len() {
        let end = (start + BATCH).min(chunk.blocks.len());
        if R::TURN {
            ask_for::<L>(view, &chunk.blocks[end..]);
        }
        let blocks = &mut chunk.blocks[start..end];
        let sizes = if R::SIZES { &chunk.sizes[start..end] } else { &[] };
        let count = if R::SIZES {
            locate::<L, true>(view, blocks, sizes, &mut batch)
        } else {
            locate::<L, false>(view, blocks, sizes, &mut batch)
        };
        for k in 0..count {
            let (b, lane) = (batch.live[k].0 as usize, batch.live[k].1 as usize);
            R::resist::<L>(view, &mut blocks[b], sizes.get(b), &mut batch, b, lane);
        }
        act::<R, L>(blocks, chunk.first, &batch, count, chunk.sums);
        if look {
            let from = crossed;
            while crossed < chunk.crossing.len() && (chunk.crossing[crossed].slot as usize) < end * BLOCK {
                crossed += 1;
            }
            let crossing = &chunk.crossing[from..crossed];
            stress::cross(&mut seen, crossing, start * BLOCK, view.shift, &batch.force);
        }
        start = end;
    }
    seen
}

/// Has the second grains of the next batch brought near.
#[inline(always)]
fn ask_for<L: Lanes>(view: &View<'_>, blocks: &[Block]) {
    for block in &blocks[..blocks.len().min(BATCH)] {
        L::prefetch(view.position, &block.j);
        L::prefetch(view.twist, &block.j);
    }
}

/// First stage: where the pairs are. Returns how many lots of lanes have contacts; the others forget their history.
#[inline(always)]
fn locate<L: Lanes, const SIZES: bool>(
    view: &View<'_>,
    blocks: &mut [Block],
    sizes: &[Sizes],
    batch: &mut Batch,
) -> usize {
    let mut count = 0;
    for (b, block) in blocks.iter_mut().enumerate() {
        let mut lane = 0;
        while lane < BLOCK {
            let near = &mut batch.near[b];
            match Geometry::<L>::of::<SIZES>(view, block, sizes.get(b), lane) {
                Some(g) => {
                    g.normal.store(&mut near.normal, lane);
                    g.overlap.store(&mut near.overlap, lane);
                    g.inverse_distance.store(&mut near.inverse_distance, lane);
                    batch.live[count] = (b as u8, lane as u8);
                    count += 1;
                }
                None => {
                    let zero = V3::<L>::splat(0.0);
                    zero.x.store(&mut block.root, lane);
                    zero.store(&mut block.history, lane);
                    zero.store(&mut batch.force[b], lane);
                }
            }
            lane += L::WIDTH;
        }
    }
    count
}

/// Last stage: forces and moments on grains.
#[inline(always)]
fn act<R: Resist, L: Lanes>(blocks: &[Block], first: u32, batch: &Batch, count: usize, sums: &mut [Octad]) {
    let rows = sums.len();
    let zero = L::splat(0.0);
    for k in 0..count {
        let (b, lane) = (batch.live[k].0 as usize, batch.live[k].1 as usize);
        let block = &blocks[b];
        let to = Rows::<L>::new(&block.to, lane, rows);
        let from = Rows::<L>::new(&block.from, lane, rows);
        let f = V3::<L>::load(&batch.force[b], lane);
        let m = if R::TURN { V3::<L>::load(&batch.moment[b], lane) } else { V3::splat(0.0) };
        let mut levers = [zero; 2];
        if R::SIZES && R::TURN {
            levers = [L::load(&batch.levers[b][0], lane), L::load(&batch.levers[b][1], lane)];
        }
        let components = [f.x, f.y, f.z, levers[0], m.x, m.y, m.z, levers[1]];
        match (R::TURN, R::SIZES) {
            (false, _) => L::scatter::<false, false>(components, from, to, sums),
            (true, false) => L::scatter::<true, false>(components, from, to, sums),
            (true, true) => L::scatter::<true, true>(components, from, to, sums),
        }
    }
}

/// Radii, R* and effective mass of some lanes of a block.
#[inline(always)]
fn sizes_of<L: Lanes, const SIZES: bool>(
    view: &View<'_>,
    sizes: Option<&Sizes>,
    lane: usize,
) -> ([L; 2], L, L) {
    match sizes {
        Some(s) if SIZES => {
            let radius = [L::load(&s.radius_i, lane), L::load(&s.radius_j, lane)];
            (radius, L::load(&s.r_eff, lane), L::load(&s.m_eff, lane))
        }
        _ => {
            let e = &view.equal;
            ([L::splat(e.radius); 2], L::splat(e.r_eff), L::splat(e.m_eff))
        }
    }
}

/// Velocity relative to each other of points that follow the affine motion, m/s.
#[inline(always)]
fn affine<L: Lanes>(view: &View<'_>, l: V3<L>) -> V3<L> {
    let [x, y, z] = &view.rate;
    V3::row(x).scale(l.x).plus(V3::row(y), l.y).plus(V3::row(z), l.z)
}

impl<const SIZES: bool> Resist for Frictionless<'_, SIZES> {
    const TURN: bool = false;
    const SIZES: bool = SIZES;

    #[inline(always)]
    fn resist<L: Lanes>(
        view: &View<'_>,
        block: &mut Block,
        sizes: Option<&Sizes>,
        batch: &mut Batch,
        b: usize,
        lane: usize,
    ) {
        let near = &batch.near[b];
        let (radius, r_eff, m_eff) = sizes_of::<L, SIZES>(view, sizes, lane);
        let grains = Grains::<L>::of(view, &block.i, &block.j, lane);
        let (normal, overlap) = (V3::<L>::load(&near.normal, lane), L::load(&near.overlap, lane));
        let root = (r_eff * overlap).sqrt();
        let distance = radius[0] + radius[1] - overlap;
        let [velocity, _] = L::relative(view.twist, grains.j, grains.i);
        let relative = velocity + affine(view, normal.scale(distance));
        let force = view.law.frictionless(overlap, root, m_eff, relative.dot(normal));
        root.store(&mut block.root, lane);
        let touching = overlap.gt(L::splat(0.0));
        V3::select(touching, normal.scale(force), V3::splat(0.0)).store(&mut batch.force[b], lane);
    }
}

impl<const SIZES: bool> Kernel for Frictionless<'_, SIZES> {
    type Output = Seen;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Seen {
        pass::<Self, L>(&self.view, self.chunk, self.look)
    }
}

impl<const ADVANCE: bool, const SLIDING: bool, const RESCALED: bool, const SIZES: bool> Resist
    for Frictional<'_, ADVANCE, SLIDING, RESCALED, SIZES>
{
    const TURN: bool = true;
    const SIZES: bool = SIZES;

    #[inline(always)]
    fn resist<L: Lanes>(
        view: &View<'_>,
        block: &mut Block,
        sizes: Option<&Sizes>,
        batch: &mut Batch,
        b: usize,
        lane: usize,
    ) {
        let near = &batch.near[b];
        let (half, none) = (L::splat(0.5), V3::splat(0.0));
        let (radius, r_eff, m_eff) = sizes_of::<L, SIZES>(view, sizes, lane);
        let (normal, overlap) = (V3::<L>::load(&near.normal, lane), L::load(&near.overlap, lane));
        let (root, was) = ((r_eff * overlap).sqrt(), L::load(&block.root, lane));
        let lever = [half.mul_sub_from(overlap, radius[0]), half.mul_sub_from(overlap, radius[1])];
        let grains = Grains::<L>::of(view, &block.i, &block.j, lane);
        let [velocity, spin] = L::relative(view.twist, grains.j, grains.i);
        let rolling = if SIZES {
            let spins = [L::spins(view.twist, grains.i), L::spins(view.twist, grains.j)];
            spins[0].scale(lever[0]) + spins[1].scale(lever[1])
        } else {
            spin.scale(lever[0])
        };
        let distance = radius[0] + radius[1] - overlap;
        let touch = Touch {
            normal,
            inverse_distance: L::load(&near.inverse_distance, lane),
            overlap,
            root,
            unloading: L::select(was.gt(root), root / was, L::splat(1.0)),
            m_eff,
            relative: velocity + affine(view, normal.scale(distance)),
            rolling,
            spin,
        };
        let history = V3::load(&block.history, lane);
        let forces = view.law.frictional::<L, ADVANCE, SLIDING, RESCALED>(&touch, history, view.dt);
        let touching = overlap.gt(L::splat(0.0));
        root.store(&mut block.root, lane);
        if ADVANCE {
            V3::select(touching, forces.history, none).store(&mut block.history, lane);
        }
        let force = forces.tangential.from_scaled(normal, forces.normal);
        V3::select(touching, force, none).store(&mut batch.force[b], lane);
        let moment = V3::select(touching, normal.cross(forces.tangential), none);
        // One size, one lever: taken into the moment here. Else each grain applies its own.
        if SIZES {
            moment.store(&mut batch.moment[b], lane);
            lever[1].store(&mut batch.levers[b][0], lane);
            lever[0].store(&mut batch.levers[b][1], lane);
        } else {
            moment.scale(lever[0]).store(&mut batch.moment[b], lane);
        }
    }
}

impl<const ADVANCE: bool, const SLIDING: bool, const RESCALED: bool, const SIZES: bool> Kernel
    for Frictional<'_, ADVANCE, SLIDING, RESCALED, SIZES>
{
    type Output = Seen;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Seen {
        pass::<Self, L>(&self.view, self.chunk, self.look)
    }
}
