//! Stress, tangent stiffness and balance of the present contacts.

use crate::compute::Compute;
use crate::contacts::Contacts;
use crate::error::DemError;
use crate::geometry::{Geometry, View};
use crate::lanes::{BLOCK, Lanes, V3};
use crate::share::{Block, Pair, Share, Sizes};
use crate::simd::Kernel;
use crate::state::State;
use grainlab_core::Mat3;
use grainlab_core::material::effective_radius;
use grainlab_core::stress::Stress;

/// What one look at the contacts gives. Nothing in the state changes by looking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapshot {
    /// Love–Weber stress of the elastic contact forces.
    pub stress: Stress,
    /// Affine tangent stiffness of the present contacts, Pa: C_iiii for xx, yy, zz and C_ijij for yz, xz, xy.
    pub tangent: [f64; 6],
    /// Solid fraction.
    pub solid_fraction: f64,
    /// Contacts.
    pub contacts: u32,
    /// k = 2 contacts/grains.
    pub coordination: f64,
    /// Mean net force of non-rattlers over mean contact force; 1 where nothing is in contact.
    pub unbalanced: f64,
}

/// A contact overlapping by more than this share of the smaller diameter is outside Hertz's law.
const OVERLAP_LIMIT: f64 = 0.1;

pub(crate) fn snapshot(
    state: &State,
    contacts: &Contacts,
    view: View<'_>,
    compute: &Compute,
) -> Result<Snapshot, DemError> {
    let friction = view.law.friction > 0.0;
    let mut rows = vec![[[0.0; BLOCK]; 3]; contacts.blocks().count()];
    let mut total = Sums::default();
    let mut rest = rows.as_mut_slice();
    let chunks = contacts.shares.iter().flat_map(Share::own_chunks).map(|(blocks, sizes)| {
        let (force, after) = std::mem::take(&mut rest).split_at_mut(blocks.len());
        rest = after;
        Look { view, blocks, sizes, force }
    });
    compute.each(
        chunks,
        |look| {
            if look.sizes.is_empty() {
                compute.simd().run(LookAt::<false> { look, friction })
            } else {
                compute.simd().run(LookAt::<true> { look, friction })
            }
        },
        |sums| total.then(&sums),
    );
    if total.deep {
        return Err(deepest(state, contacts));
    }
    let volume = state.cell.volume();
    let [xx, yy, zz, yz, xz, xy, zy, zx, yx, ..] = total.of;
    let virial = Mat3::new(xx, xy, xz, yx, yy, yz, zx, zy, zz);
    let bearing = Bearing::of(contacts, &rows, state.grains(), if friction { 2 } else { 4 });
    let mean_force = total.of[9] / f64::from(bearing.contacts);
    let solid: f64 = state.radius.iter().map(|r| r * r * r).sum();
    Ok(Snapshot {
        stress: Stress::from_virial(&virial, volume),
        tangent: std::array::from_fn(|k| total.of[10 + k] / volume),
        solid_fraction: 4.0 / 3.0 * std::f64::consts::PI * solid / volume,
        contacts: bearing.contacts,
        coordination: 2.0 * f64::from(bearing.contacts) / state.grains() as f64,
        unbalanced: bearing.mean_net_force().map_or(1.0, |f| f / mean_force),
    })
}

/// The deepest contact of the last evaluation, relative to the smaller of its grains.
pub(crate) fn deepest(state: &State, contacts: &Contacts) -> DemError {
    let radii = |p: &Pair| (state.radius[p.i as usize], state.radius[p.j as usize]);
    let overlap = |p: &Pair| p.root * p.root / effective_radius(radii(p).0, radii(p).1);
    let depth = |p: &Pair| overlap(p) / radii(p).0.min(radii(p).1);
    let worst = contacts.touching().max_by(|a, b| depth(a).total_cmp(&depth(b)));
    let (first, second, overlap) =
        worst.map_or((0, 0, f64::NAN), |p| (state.ids[p.i as usize], state.ids[p.j as usize], overlap(&p)));
    DemError::Overlap { step: state.step, first, second, overlap }
}

/// One chunk to look at.
struct Look<'a> {
    view: View<'a>,
    blocks: &'a [Block],
    sizes: &'a [Sizes],
    /// Elastic force on the second grain of each slot, N.
    force: &'a mut [[[f64; BLOCK]; 3]],
}

struct LookAt<'a, const SIZES: bool> {
    look: Look<'a>,
    friction: bool,
}

/// Sums over contacts: Σ f ⊗ l (xx, yy, zz, yz, xz, xy, zy, zx, yx; J), Σ |f| (N), and the energy of each unit strain
/// component (J).
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    of: [f64; 16],
    deep: bool,
}

impl Sums {
    fn then(&mut self, next: &Self) {
        self.of.iter_mut().zip(next.of).for_each(|(a, b)| *a += b);
        self.deep |= next.deep;
    }
}

impl<const SIZES: bool> Kernel for LookAt<'_, SIZES> {
    type Output = Sums;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Sums {
        let Look { view, blocks, sizes, force } = self.look;
        let (mut first, mut second) = ([0.0; 8], [0.0; 8]);
        let mut deep = false;
        let zero = L::splat(0.0);
        for (b, block) in blocks.iter().enumerate() {
            let mut lane = 0;
            while lane < BLOCK {
                if let Some(g) = Geometry::<L>::of::<SIZES>(&view, block, sizes.get(b), lane) {
                    // The smaller of two is the larger of their negatives.
                    let smaller = zero - (zero - g.radius[0]).max(zero - g.radius[1]);
                    deep |= L::any(g.overlap.gt(smaller * L::splat(2.0 * OVERLAP_LIMIT)));
                    let r_eff = match sizes.get(b) {
                        Some(s) if SIZES => L::load(&s.r_eff, lane),
                        _ => L::splat(view.equal.r_eff),
                    };
                    let root = (r_eff * g.overlap).sqrt();
                    let k_n = L::splat(view.law.normal) * root;
                    let elastic = L::splat(2.0 / 3.0) * k_n * g.overlap;
                    let f = g.normal.scale(elastic) - V3::load(&block.history, lane);
                    let f = V3::select(g.touching, f, V3::splat(0.0));
                    f.store(&mut force[b], lane);
                    let l = g.branch;
                    let size = f.dot(f).sqrt();
                    let square = L::select(g.touching, g.distance * g.distance, zero);
                    let normal = k_n * square;
                    let across =
                        if self.friction { L::splat(view.law.tangential) * root * square } else { zero };
                    let t = strained(g.normal, normal, across, g.touching);
                    L::fold(
                        [
                            f.x * l.x,
                            f.y * l.y,
                            f.z * l.z,
                            f.y * l.z,
                            f.x * l.z,
                            f.x * l.y,
                            f.z * l.y,
                            f.z * l.x,
                        ],
                        &mut first,
                    );
                    L::fold([f.y * l.x, size, t[0], t[1], t[2], t[3], t[4], t[5]], &mut second);
                }
                lane += L::WIDTH;
            }
        }
        let mut of = [0.0; 16];
        of[..8].copy_from_slice(&first);
        of[8..].copy_from_slice(&second);
        Sums { of, deep }
    }
}

/// Energy of a contact under each unit strain component: normal part by k_n l², tangential part by k_t l².
#[inline(always)]
fn strained<L: Lanes>(n: V3<L>, normal: L, across: L, touching: L::Mask) -> [L; 6] {
    let q = [n.x * n.x, n.y * n.y, n.z * n.z];
    let zero = L::splat(0.0);
    let mut energy = [zero; 6];
    for k in 0..3 {
        let (a, b) = (q[(k + 1) % 3], q[(k + 2) % 3]);
        let along = normal * q[k] * q[k] + across * (q[k] - q[k] * q[k]);
        let shear = normal * a * b + across * (L::splat(0.25) * (a + b) - a * b);
        energy[k] = L::select(touching, along, zero);
        energy[3 + k] = L::select(touching, shear, zero);
    }
    energy
}

/// Grains that are no rattlers, and what is in contact.
struct Bearing {
    alive: Vec<bool>,
    contacts: u32,
    /// Net force on each grain, N.
    net: Vec<[f64; 3]>,
}

impl Bearing {
    /// Recursively at least `least` contacts a grain; `force` (N) is that on the second grain of each slot.
    fn of(contacts: &Contacts, force: &[[[f64; BLOCK]; 3]], grains: usize, least: u32) -> Self {
        let mut net = vec![[0.0; 3]; grains];
        let mut count = vec![0u32; grains];
        let mut pairs = vec![[0u32; 2]; contacts.slots()];
        let mut touching = 0;
        for (block, force) in contacts.blocks().zip(force) {
            for lane in 0..BLOCK {
                // A slot that only fills up the block has no force and does not touch.
                let (i, j) = (block.i[lane] as usize, block.j[lane] as usize);
                for (k, f) in force.iter().enumerate() {
                    net[i][k] -= f[lane];
                    net[j][k] += f[lane];
                }
                let touches = block.root[lane] > 0.0;
                count[i] += u32::from(touches);
                count[j] += u32::from(touches);
                pairs[touching] = [block.i[lane], block.j[lane]];
                touching += usize::from(touches);
            }
        }
        pairs.truncate(touching);
        let mut alive = vec![true; grains];
        while fall(&mut alive, &count, least) {
            // The contacts of those that fell hold nothing.
            pairs.retain(|pair| {
                let [i, j] = pair.map(|grain| grain as usize);
                let holds = alive[i] && alive[j];
                if !holds {
                    count[i] -= 1;
                    count[j] -= 1;
                }
                holds
            });
        }
        Self { alive, contacts: touching as u32, net }
    }

    /// Mean of the net force, N; `None` without such grains.
    fn mean_net_force(&self) -> Option<f64> {
        let bearing = self.alive.iter().filter(|a| **a).count();
        let size = |n: &[f64; 3]| (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        let sum: f64 =
            self.net.iter().zip(&self.alive).filter(|(_, alive)| **alive).map(|(n, _)| size(n)).sum();
        (bearing > 0).then(|| sum / bearing as f64)
    }
}

/// Lets all grains fall that have less than `least` contacts; whether any did.
fn fall(alive: &mut [bool], count: &[u32], least: u32) -> bool {
    let mut fell = false;
    for (alive, count) in alive.iter_mut().zip(count) {
        fell |= *alive && *count < least;
        *alive &= *count >= least;
    }
    fell
}
