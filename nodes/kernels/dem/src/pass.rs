//! One pass over the pairs of a chunk of grains: forces and torques, contact by contact, summed on the grains.

use crate::contacts::{Block, Sizes};
use crate::lanes::{BLOCK, Lanes, Quad, V3, Wrench};
use crate::law::{Law, Touch};
use crate::simd::Kernel;
use grains::Mat3;

/// A contact overlapping by more than this share of the smaller diameter is outside Hertz's law.
pub(crate) const OVERLAP_LIMIT: f64 = 0.1;

/// Blocks between asking for the grains of one and working on it.
const AHEAD: usize = 6;

/// What all chunks read.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    pub(crate) position: &'a [Quad],
    pub(crate) velocity: &'a [Quad],
    pub(crate) spin: &'a [Quad],
    /// Shift of each periodic image.
    pub(crate) shift: &'a [Quad],
    pub(crate) rate: Mat3,
    pub(crate) law: Law,
    pub(crate) dt: f64,
    /// Radius, R*, effective mass of every pair, where grains are of one size.
    pub(crate) equal: (f64, f64, f64),
}

/// One chunk.
pub(crate) struct Chunk<'a> {
    /// Its first grain.
    pub(crate) first: u32,
    pub(crate) blocks: &'a mut [Block],
    /// Empty where grains are of one size.
    pub(crate) sizes: &'a [Sizes],
    /// Force and torque found for each of its grains, and for the second grain of each pair with another chunk.
    pub(crate) sums: &'a mut [Wrench],
}

/// Adds the eight rows of a block to the sums, in the order of pairs. Loops of fixed length: what a branch predictor
/// would have to guess costs more than what it might spare.
///
/// Where sizes differ, the spares of a row are the levers of its second (force) and first (torque) grain.
#[inline(always)]
fn sum<const FRICTION: bool, const SIZES: bool>(
    rows: &[Wrench; BLOCK],
    block: &Block,
    first: u32,
    sums: &mut [Wrench],
) {
    for (lane, row) in rows.iter().enumerate() {
        let on_j = &mut sums[block.to[lane] as usize];
        for c in 0..4 {
            on_j[c] += row[c];
        }
        if FRICTION {
            for c in 4..8 {
                on_j[c] += if SIZES { row[c] * row[3] } else { row[c] };
            }
        }
        let on_i = &mut sums[(block.i[lane] - first) as usize];
        for c in 0..4 {
            on_i[c] -= row[c];
        }
        if FRICTION {
            for c in 4..8 {
                on_i[c] += if SIZES { row[c] * row[7] } else { row[c] };
            }
        }
    }
}

/// What one pass saw.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Seen {
    /// Σ f ⊗ l of the elastic forces, symmetrised, Voigt order, J; two spares. Zero unless it was asked for.
    pub(crate) virial: [f64; 8],
    /// Some contact overlaps beyond [`OVERLAP_LIMIT`].
    pub(crate) deep: bool,
}

impl Seen {
    /// This, then what the next chunk saw.
    pub(crate) fn then(&mut self, next: &Self) {
        self.virial.iter_mut().zip(next.virial).for_each(|(a, b)| *a += b);
        self.deep |= next.deep;
    }
}

/// Contacts without friction: no spins, no tangential springs.
pub(crate) struct Frictionless<'a, const SIZES: bool, const LOOK: bool> {
    pub(crate) view: View<'a>,
    pub(crate) chunk: Chunk<'a>,
}

/// Contacts with friction; see [`Law::frictional`] for the switches.
pub(crate) struct Frictional<
    'a,
    const ADVANCE: bool,
    const SLIDING: bool,
    const RESCALED: bool,
    const SIZES: bool,
    const LOOK: bool,
> {
    pub(crate) view: View<'a>,
    pub(crate) chunk: Chunk<'a>,
}

/// Some lanes of a block, looked at: where the pairs are and whether they touch.
pub(crate) struct Geometry<L: Lanes> {
    pub(crate) i: L::Index,
    pub(crate) j: L::Index,
    pub(crate) radius: [L; 2],
    pub(crate) r_eff: L,
    pub(crate) m_eff: L,
    pub(crate) branch: V3<L>,
    pub(crate) normal: V3<L>,
    pub(crate) distance: L,
    pub(crate) inverse_distance: L,
    /// Never negative.
    pub(crate) overlap: L,
    pub(crate) touching: L::Mask,
}

impl<L: Lanes> Geometry<L> {
    /// `None` where no lane touches.
    #[inline(always)]
    pub(crate) fn of<const SIZES: bool>(
        view: &View<'_>,
        block: &Block,
        sizes: Option<&Sizes>,
        lane: usize,
    ) -> Option<Self> {
        let grains = view.position.len();
        let i = L::index(&block.i, lane, grains);
        let j = L::index(&block.j, lane, grains);
        let image = L::index(&block.image, lane, view.shift.len());
        let (radius, r_eff, m_eff) = match sizes {
            Some(s) if SIZES => (
                [L::load(&s.radius_i, lane), L::load(&s.radius_j, lane)],
                L::load(&s.r_eff, lane),
                L::load(&s.m_eff, lane),
            ),
            _ => {
                let (radius, r_eff, m_eff) = view.equal;
                ([L::splat(radius); 2], L::splat(r_eff), L::splat(m_eff))
            }
        };
        let apart = V3::gather(view.position, j) - V3::gather(view.position, i);
        let branch = apart + V3::gather(view.shift, image);
        let reach = radius[0] + radius[1];
        let square = branch.dot(branch);
        if !L::any((reach * reach).gt(square)) {
            return None;
        }
        let distance = square.sqrt();
        let inverse_distance = L::splat(1.0) / distance;
        let overlap = (reach - distance).max(L::splat(0.0));
        let touching = overlap.gt(L::splat(0.0));
        let normal = branch.scale(inverse_distance);
        Some(Self {
            i,
            j,
            radius,
            r_eff,
            m_eff,
            branch,
            normal,
            distance,
            inverse_distance,
            overlap,
            touching,
        })
    }

    #[inline(always)]
    pub(crate) fn deep(&self) -> bool {
        // The smaller of two is the larger of their negatives.
        let smaller = -(-self.radius[0]).max(-self.radius[1]);
        L::any(self.overlap.gt(smaller * L::splat(2.0 * OVERLAP_LIMIT)))
    }

    #[inline(always)]
    fn touch(&self, view: &View<'_>, root: L, previous_root: L) -> Touch<L> {
        let rate = |r: usize| {
            let of = |c: usize| L::splat(view.rate[(r, c)]);
            V3::new(of(0), of(1), of(2)).dot(self.branch)
        };
        let affine = V3::new(rate(0), rate(1), rate(2));
        let zero = V3::new(L::splat(0.0), L::splat(0.0), L::splat(0.0));
        Touch {
            normal: self.normal,
            inverse_distance: self.inverse_distance,
            overlap: self.overlap,
            root,
            previous_root,
            m_eff: self.m_eff,
            relative: V3::gather(view.velocity, self.j) - V3::gather(view.velocity, self.i) + affine,
            rolling: zero,
            spin: zero,
        }
    }

    #[inline(always)]
    fn look(&self, force: V3<L>, virial: &mut [f64; 8]) {
        let (f, l) = (force, self.branch);
        let half = L::splat(0.5);
        let zero = L::splat(0.0);
        let kept = |v: L| L::select(self.touching, v, zero);
        let terms = [
            kept(f.x * l.x),
            kept(f.y * l.y),
            kept(f.z * l.z),
            kept(half * (f.y * l.z + f.z * l.y)),
            kept(half * (f.x * l.z + f.z * l.x)),
            kept(half * (f.x * l.y + f.y * l.x)),
            zero,
            zero,
        ];
        L::fold(terms, virial);
    }
}

impl<const SIZES: bool, const LOOK: bool> Kernel for Frictionless<'_, SIZES, LOOK> {
    type Output = Seen;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Seen {
        let Self { view, chunk } = self;
        chunk.sums.fill([0.0; 8]);
        let mut rows = [[0.0; 8]; BLOCK];
        let mut seen = Seen::default();
        let zero = L::splat(0.0);
        for (b, block) in chunk.blocks.iter_mut().enumerate() {
            let mut lane = 0;
            while lane < BLOCK {
                match Geometry::<L>::of::<SIZES>(&view, block, chunk.sizes.get(b), lane) {
                    Some(g) => {
                        let root = (g.r_eff * g.overlap).sqrt();
                        let (elastic, normal) = view.law.frictionless(&g.touch(&view, root, zero));
                        L::select(g.touching, root, zero).store(&mut block.root, lane);
                        let force = g.normal.scale(normal);
                        let force = V3::select(g.touching, force, V3::new(zero, zero, zero));
                        L::store_rows([force.x, force.y, force.z, zero], &mut rows, lane, 0);
                        seen.deep |= g.deep();
                        if LOOK {
                            g.look(g.normal.scale(elastic), &mut seen.virial);
                        }
                    }
                    None => {
                        zero.store(&mut block.root, lane);
                        L::store_rows([zero; 4], &mut rows, lane, 0);
                    }
                }
                lane += L::WIDTH;
            }
            sum::<false, SIZES>(&rows, block, chunk.first, chunk.sums);
        }
        seen
    }
}

impl<const ADVANCE: bool, const SLIDING: bool, const RESCALED: bool, const SIZES: bool, const LOOK: bool>
    Kernel for Frictional<'_, ADVANCE, SLIDING, RESCALED, SIZES, LOOK>
{
    type Output = Seen;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Seen {
        let Self { view, chunk } = self;
        chunk.sums.fill([0.0; 8]);
        let mut rows = [[0.0; 8]; BLOCK];
        let mut seen = Seen::default();
        let zero = L::splat(0.0);
        let none = V3::new(zero, zero, zero);
        for b in 0..chunk.blocks.len() {
            if let Some(ahead) = chunk.blocks.get(b + AHEAD) {
                L::prefetch(view.position, &ahead.j, 0);
                L::prefetch(view.velocity, &ahead.j, 0);
                L::prefetch(view.spin, &ahead.j, 0);
            }
            let block = &mut chunk.blocks[b];
            let mut lane = 0;
            while lane < BLOCK {
                match Geometry::<L>::of::<SIZES>(&view, block, chunk.sizes.get(b), lane) {
                    Some(g) => {
                        let root = (g.r_eff * g.overlap).sqrt();
                        let mut touch = g.touch(&view, root, L::load(&block.root, lane));
                        let half = L::splat(0.5);
                        let lever = g.radius.map(|r| r - half * g.overlap);
                        let (spin_i, spin_j) = (V3::gather(view.spin, g.i), V3::gather(view.spin, g.j));
                        let spin = spin_i + spin_j;
                        touch.rolling = if SIZES {
                            spin_i.scale(lever[0]) + spin_j.scale(lever[1])
                        } else {
                            spin.scale(lever[0])
                        };
                        touch.spin = spin.scale(half);
                        let history = V3::load(&block.history, lane);
                        let f =
                            view.law.frictional::<L, ADVANCE, SLIDING, RESCALED>(&touch, history, view.dt);
                        L::select(g.touching, root, zero).store(&mut block.root, lane);
                        if ADVANCE {
                            V3::select(g.touching, f.history, none).store(&mut block.history, lane);
                        }
                        let force = g.normal.scale(f.normal) - f.tangential;
                        let force = V3::select(g.touching, force, none);
                        let moment = g.normal.cross(f.tangential);
                        let moment = V3::select(g.touching, moment, none);
                        // One size, one lever: taken into the moment here. Else each grain applies its own.
                        let (moment, spare) = if SIZES {
                            (moment, [lever[1], lever[0]])
                        } else {
                            (moment.scale(lever[0]), [zero; 2])
                        };
                        L::store_rows([force.x, force.y, force.z, spare[0]], &mut rows, lane, 0);
                        L::store_rows([moment.x, moment.y, moment.z, spare[1]], &mut rows, lane, 4);
                        seen.deep |= g.deep();
                        if LOOK {
                            g.look(g.normal.scale(f.elastic) - f.history, &mut seen.virial);
                        }
                    }
                    None => {
                        zero.store(&mut block.root, lane);
                        none.store(&mut block.history, lane);
                        L::store_rows([zero; 4], &mut rows, lane, 0);
                        L::store_rows([zero; 4], &mut rows, lane, 4);
                    }
                }
                lane += L::WIDTH;
            }
            sum::<true, SIZES>(&rows, block, chunk.first, chunk.sums);
        }
        seen
    }
}
