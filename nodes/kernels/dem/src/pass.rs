//! One pass over the pairs of a chunk of grains: forces and torques, contact by contact, summed on the grains.
//!
//! In three stages: where the pairs are, what the contact law says, whom it acts on. Each waits long for the roots,
//! quotients and sums of the one before. So the stages of three blocks that follow each other run side by side, and a
//! processor always has something else to do.

use crate::geometry::{Geometry, Grains, View};
use crate::lanes::{BLOCK, Lanes, Octad, Rows, V3};
use crate::law::Touch;
use crate::share::{Block, Crossing, Sizes};
use crate::simd::Kernel;
use crate::stress::{self, Seen};

/// Grains beyond which the rows of second grains are asked for ahead of time: fewer stay near by themselves.
const MANY: usize = 8000;

/// Blocks ahead that they are asked for.
const AHEAD: usize = 6;

/// One chunk.
pub(crate) struct Chunk<'a> {
    pub(crate) blocks: &'a mut [Block],
    /// Empty where grains are of one size.
    pub(crate) sizes: &'a [Sizes],
    /// Pairs across the faces of the cell.
    pub(crate) crossing: &'a [Crossing],
    /// Rows to add to: those of its grains first.
    pub(crate) sums: &'a mut [Octad],
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

/// A block under way.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Way {
    normal: Vectors,
    overlap: Scalars,
    inverse_distance: Scalars,
    /// On the second grain of each pair, N.
    force: Vectors,
    /// On both grains, N m; where sizes differ to be multiplied by the levers of the second and the first grain.
    moment: Vectors,
    levers: [Scalars; 2],
}

impl Way {
    const NEW: Self = {
        let none = [0.0; BLOCK];
        Self {
            normal: [none; 3],
            overlap: none,
            inverse_distance: none,
            force: [none; 3],
            moment: [none; 3],
            levers: [none; 2],
        }
    };
}

/// How a phase's contacts resist.
trait Resist {
    /// Whether they turn grains.
    const TURN: bool;
    const SIZES: bool;

    /// Second stage: what the contact law says about some lanes of a block.
    fn resist<L: Lanes>(
        view: &View<'_>,
        block: &mut Block,
        sizes: Option<&Sizes>,
        way: &mut Way,
        lane: usize,
    );
}

/// All pairs of a chunk.
#[inline(always)]
fn pass<R: Resist, L: Lanes>(view: &View<'_>, chunk: Chunk<'_>, look: bool) -> Seen {
    let Chunk { blocks, sizes, mut crossing, sums } = chunk;
    let mut seen = Seen::default();
    let ask = view.position.len() > MANY;
    let lots = BLOCK / L::WIDTH;
    let end = blocks.len() * lots;
    // Two blocks are under way at a time; lots of lanes go through the stages one after the other.
    let mut ways = [Way::NEW; 2];
    let (mut acted, mut located) = (false, end > 0 && locate::<R, L>(view, blocks, sizes, &mut ways, 0));
    for u in 0..=end {
        let (resisted, before) = (located, acted);
        let (b, lane) = (u / lots, u % lots * L::WIDTH);
        if resisted {
            R::resist::<L>(view, &mut blocks[b], sizes.get(b), &mut ways[b % 2], lane);
        } else if look {
            V3::<L>::splat(0.0).store(&mut ways[b % 2].force, lane);
        }
        located = u + 1 < end && locate::<R, L>(view, blocks, sizes, &mut ways, u + 1);
        if before {
            let (b, lane) = ((u - 1) / lots, (u - 1) % lots * L::WIDTH);
            act::<R, L>(view.position.len(), &blocks[b], &ways[b % 2], lane, sums);
        }
        acted = resisted;
        if u > 0 && u % lots == 0 {
            let b = u / lots - 1;
            if look {
                crossing = stress::cross(&mut seen, crossing, b, view.shift, &ways[b % 2].force);
            }
            if ask && let Some(ahead) = blocks.get(b + AHEAD) {
                L::prefetch(view.position, &ahead.j);
                L::prefetch(view.twist, &ahead.j);
                L::prefetch(sums, &ahead.to);
            }
        }
    }
    seen
}

/// First stage: where the pairs in lot `u` of lanes are. Whether any touch; if none, they forget their history.
#[inline(always)]
fn locate<R: Resist, L: Lanes>(
    view: &View<'_>,
    blocks: &mut [Block],
    sizes: &[Sizes],
    ways: &mut [Way; 2],
    u: usize,
) -> bool {
    let lots = BLOCK / L::WIDTH;
    let (b, lane) = (u / lots, u % lots * L::WIDTH);
    let (block, way) = (&mut blocks[b], &mut ways[b % 2]);
    let found = if R::SIZES {
        Geometry::<L>::of::<true>(view, block, sizes.get(b), lane)
    } else {
        Geometry::<L>::of::<false>(view, block, None, lane)
    };
    match found {
        Some(g) => {
            g.normal.store(&mut way.normal, lane);
            g.overlap.store(&mut way.overlap, lane);
            g.inverse_distance.store(&mut way.inverse_distance, lane);
            true
        }
        None => {
            let zero = V3::<L>::splat(0.0);
            zero.x.store(&mut block.root, lane);
            zero.store(&mut block.history, lane);
            false
        }
    }
}

/// Last stage: forces and moments on grains.
#[inline(always)]
fn act<R: Resist, L: Lanes>(grains: usize, block: &Block, way: &Way, lane: usize, sums: &mut [Octad]) {
    let (rows, zero) = (sums.len(), L::splat(0.0));
    let to = Rows::<L>::new(&block.to, lane, rows);
    let from = Rows::<L>::new(&block.i, lane, grains);
    let f = V3::<L>::load(&way.force, lane);
    let m = if R::TURN { V3::<L>::load(&way.moment, lane) } else { V3::splat(0.0) };
    let mut levers = [zero; 2];
    if R::SIZES && R::TURN {
        levers = [L::load(&way.levers[0], lane), L::load(&way.levers[1], lane)];
    }
    let components = [f.x, f.y, f.z, levers[0], m.x, m.y, m.z, levers[1]];
    match (R::TURN, R::SIZES) {
        (false, _) => L::scatter::<false, false>(components, from, to, sums),
        (true, false) => L::scatter::<true, false>(components, from, to, sums),
        (true, true) => L::scatter::<true, true>(components, from, to, sums),
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
        way: &mut Way,
        lane: usize,
    ) {
        let (radius, r_eff, m_eff) = sizes_of::<L, SIZES>(view, sizes, lane);
        let grains = Grains::<L>::of(view, &block.i, &block.j, lane);
        let (normal, overlap) = (V3::<L>::load(&way.normal, lane), L::load(&way.overlap, lane));
        let root = (r_eff * overlap).sqrt();
        let distance = radius[0] + radius[1] - overlap;
        let [velocity, _] = L::relative(view.twist, grains.j, grains.i);
        let relative = velocity + affine(view, normal.scale(distance));
        let force = view.law.frictionless(overlap, root, m_eff, relative.dot(normal));
        root.store(&mut block.root, lane);
        let touching = overlap.gt(L::splat(0.0));
        V3::select(touching, normal.scale(force), V3::splat(0.0)).store(&mut way.force, lane);
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
        way: &mut Way,
        lane: usize,
    ) {
        let (half, none) = (L::splat(0.5), V3::splat(0.0));
        let (radius, r_eff, m_eff) = sizes_of::<L, SIZES>(view, sizes, lane);
        let (normal, overlap) = (V3::<L>::load(&way.normal, lane), L::load(&way.overlap, lane));
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
            inverse_distance: L::load(&way.inverse_distance, lane),
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
        let force = normal.scale_less(forces.normal, forces.tangential);
        V3::select(touching, force, none).store(&mut way.force, lane);
        let moment = V3::select(touching, normal.cross(forces.tangential), none);
        // One size, one lever: taken into the moment here. Else each grain applies its own.
        if SIZES {
            moment.store(&mut way.moment, lane);
            lever[1].store(&mut way.levers[0], lane);
            lever[0].store(&mut way.levers[1], lane);
        } else {
            moment.scale(lever[0]).store(&mut way.moment, lane);
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
