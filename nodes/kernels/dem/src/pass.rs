//! One pass over the pairs of a chunk of grains: forces and torques, contact by contact, summed on the grains.

use crate::contacts::{Block, Sizes};
use crate::lanes::{BLOCK, Lanes, Quad, V3, Wrench};
use crate::law::{Law, Touch};
use crate::simd::Kernel;

/// Blocks between asking for the grains of one and working on it.
const AHEAD: usize = 4;

/// What all chunks read.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    pub(crate) position: &'a [Quad],
    pub(crate) velocity: &'a [Quad],
    pub(crate) spin: &'a [Quad],
    /// Shift of each periodic image.
    pub(crate) shift: &'a [Quad],
    /// Columns of the strain rate, 1/s.
    pub(crate) rate: [[f64; 3]; 3],
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
fn sum<L: Lanes, const SIZES: bool>(
    rows: &mut [Wrench; BLOCK],
    block: &Block,
    first: u32,
    sums: &mut [Wrench],
) {
    for (lane, row) in rows.iter_mut().enumerate() {
        let [lever_j, lever_i] = [row[3], row[7]];
        let moment = [row[4], row[5], row[6]];
        if SIZES {
            row[4..7].copy_from_slice(&[moment[0] * lever_j, moment[1] * lever_j, moment[2] * lever_j]);
        }
        L::add_row(row, &mut sums[block.to[lane] as usize]);
        if SIZES {
            row[4..7].copy_from_slice(&[moment[0] * lever_i, moment[1] * lever_i, moment[2] * lever_i]);
        }
        L::add_reaction(row, &mut sums[(block.i[lane] - first) as usize]);
    }
}

/// What one pass saw.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Seen {
    /// Σ f ⊗ l of the elastic forces, symmetrised, Voigt order, J; two spares. Zero unless it was asked for.
    pub(crate) virial: [f64; 8],
}

impl Seen {
    /// This, then what the next chunk saw.
    pub(crate) fn then(&mut self, next: &Self) {
        self.virial.iter_mut().zip(next.virial).for_each(|(a, b)| *a += b);
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
    pub(crate) m_eff: L,
    pub(crate) branch: V3<L>,
    pub(crate) normal: V3<L>,
    pub(crate) distance: L,
    pub(crate) inverse_distance: L,
    /// Never negative.
    pub(crate) overlap: L,
    /// √(R* δ).
    pub(crate) root: L,
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
        // Not 1/distance: root and division need not wait for each other.
        let inverse_distance = distance * (L::splat(1.0) / square);
        let overlap = (reach - distance).max(L::splat(0.0));
        let touching = overlap.gt(L::splat(0.0));
        let root = (r_eff * overlap).sqrt();
        Some(Self {
            i,
            j,
            radius,
            m_eff,
            branch,
            normal: branch.scale(inverse_distance),
            distance,
            inverse_distance,
            overlap,
            root,
            touching,
        })
    }

    #[inline(always)]
    fn touch(&self, view: &View<'_>) -> Touch<L> {
        let [x, y, z] = &view.rate;
        let l = self.branch;
        let affine = V3::row(x).scale(l.x).plus(V3::row(y), l.y).plus(V3::row(z), l.z);
        Touch {
            normal: self.normal,
            inverse_distance: self.inverse_distance,
            overlap: self.overlap,
            root: self.root,
            unloading: L::splat(1.0),
            m_eff: self.m_eff,
            relative: V3::gather(view.velocity, self.j) - V3::gather(view.velocity, self.i) + affine,
            rolling: V3::splat(0.0),
            spin: V3::splat(0.0),
        }
    }

    /// Adds f ⊗ l, symmetrised, where pairs touch. With l = |l| n, which keeps less at hand than l itself.
    #[inline(always)]
    fn look(&self, force: V3<L>, virial: &mut [f64; 8]) {
        let (zero, half) = (L::splat(0.0), L::splat(0.5));
        let (f, n) = (force.scale(L::select(self.touching, self.distance, zero)), self.normal);
        let h = f.scale(half);
        let terms = [
            f.x * n.x,
            f.y * n.y,
            f.z * n.z,
            h.y.mul_add(n.z, h.z * n.y),
            h.x.mul_add(n.z, h.z * n.x),
            h.x.mul_add(n.y, h.y * n.x),
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
                        let (elastic, normal) = view.law.frictionless(&g.touch(&view));
                        g.root.store(&mut block.root, lane);
                        let force = g.normal.scale(normal);
                        let force = V3::select(g.touching, force, V3::splat(0.0));
                        L::store_rows([force.x, force.y, force.z, zero], &mut rows, lane, 0);
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
            sum::<L, false>(&mut rows, block, chunk.first, chunk.sums);
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
        let (one, none) = (L::splat(1.0), V3::splat(0.0));
        for b in 0..chunk.blocks.len() {
            if let Some(ahead) = chunk.blocks.get(b + AHEAD) {
                L::prefetch(view.position, &ahead.j);
                L::prefetch(view.velocity, &ahead.j);
                L::prefetch(view.spin, &ahead.j);
            }
            let block = &mut chunk.blocks[b];
            let mut lane = 0;
            while lane < BLOCK {
                match Geometry::<L>::of::<SIZES>(&view, block, chunk.sizes.get(b), lane) {
                    Some(g) => {
                        let mut touch = g.touch(&view);
                        let was = L::load(&block.root, lane);
                        touch.unloading = L::select(was.gt(g.root), g.root / was, one);
                        let half = L::splat(0.5);
                        let lever = [
                            half.mul_sub_from(g.overlap, g.radius[0]),
                            half.mul_sub_from(g.overlap, g.radius[1]),
                        ];
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
                        g.root.store(&mut block.root, lane);
                        if ADVANCE {
                            V3::select(g.touching, f.history, none).store(&mut block.history, lane);
                        }
                        let force = (V3::splat(0.0) - f.tangential).plus(g.normal, f.normal);
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
                        if LOOK {
                            g.look((V3::splat(0.0) - f.history).plus(g.normal, f.elastic), &mut seen.virial);
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
            sum::<L, SIZES>(&mut rows, block, chunk.first, chunk.sums);
        }
        seen
    }
}
