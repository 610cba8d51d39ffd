//! The time step, from the stiffness of the contacts present.

use crate::domain::state::State;
use crate::pairs::contacts::Contacts;
use crate::pairs::types::Pair;
use grainlab_core::contact::{ContactSprings, LawVisitor, RollingResistance};
use grainlab_core::effective_radius;
use grainlab_engine::{EngineSettings, Features};

/// m R²/I of a sphere.
const INERTIA_RATIO: f64 = 2.5;

/// Longest stable time step of the present contacts, s. Infinite where nothing touches.
///
/// With velocities half a step behind, grains of stiffness K and damping C (per mass) are stable while
/// 4 − h² K − 2 h C ≥ 0: a mode x moves as one degree of freedom with stiffness x·Kx and damping x·Cx. The relative
/// displacement at a contact is B u = B_i u_i + B_j u_j. Its square |B u|² is at most (1 + θ) |B_i u_i|² + (1 + 1/θ) |B_j u_j|²,
/// for any θ > 0. This leaves one block of 6 × 6 per grain, translations and rotations:
///
/// 4 − Σ_c (1 + s_j/s_i) B_iᵀ (h² k_c + 2 h c_c) B_i/m_i ≥ 0.
///
/// θ = s_j/s_i, with s_i the sum of h² k_c + 2 h c_c over the contacts of a grain (per mass) at an h near the result: a grain
/// gains from its softer and heavier neighbours, as in Merris, Linear Algebra Appl. 285, 33 (1998) for graphs.
///
/// A rolling spring adds the relative displacement R* (ω_j − ω_i) × n to B u, with its own stiffness and dashpot.
///
/// A rigorous bound for contacts that stick, for any damping and sizes. It is 0.75 to 0.95 of the true limit in packings of
/// equal grains, and 0.66 to 0.93 for sizes from 1 to 5; lower with more damping. (`tests/hard/time_step.rs` checks 0.7 and 0.6.)
pub(crate) fn stable(state: &State, contacts: &Contacts, settings: &EngineSettings) -> f64 {
    let springs = state.law.visit(&state.material, CollectSprings { state, contacts, settings });
    // With θ = 1 and the trace for the largest eigenvalue: about half of the result.
    let plain = springs.loads();
    let near = plain.iter().map(|load| 2.0 * load.step()).fold(f64::INFINITY, f64::min);
    if near.is_infinite() {
        return near;
    }
    let weights: Vec<f64> = plain.iter().map(|load| load.at(near)).collect();
    let blocks = springs.blocks(&weights);
    let steps: Vec<f64> = blocks.iter().map(|block| springs.load(block).step()).collect();
    let worst = (0..steps.len()).min_by(|a, b| steps[*a].total_cmp(&steps[*b]));
    // A grain's block is examined only where the trace does not suffice.
    worst.into_iter().chain(0..steps.len()).fold(f64::INFINITY, |bound, i| {
        if steps[i] < bound { springs.longest(&blocks[i], steps[i], bound) } else { bound }
    })
}

/// Sums over the springs and dashpots of a grain, per mass: no eigenvalue of its block is larger.
#[derive(Clone, Copy, Default)]
struct Load {
    /// Stiffness per mass, 1/s².
    stiffness: f64,
    /// Damping per mass, 1/s.
    damping: f64,
}

impl Load {
    fn at(&self, h: f64) -> f64 {
        h * h * self.stiffness + 2.0 * h * self.damping
    }

    /// h at which the load is 4, s.
    fn step(&self) -> f64 {
        4.0 / (self.damping + (self.damping * self.damping + 4.0 * self.stiffness).sqrt())
    }
}

/// Σ w (1, n, n ⊗ n) over the contacts of a grain. n points outward; n ⊗ n is in the order xx, yx, yy, zx, zy, zz.
type DirectionSums = [f64; 10];

/// The springs and dashpots of a grain, per mass.
#[derive(Clone, Copy, Default)]
struct GrainBlock {
    /// With w = k_n, and with that of the normal dashpot.
    contact: [DirectionSums; 2],
    /// With w = (R*/R)² k of the rolling springs, and of the rolling dashpots.
    rolling: [DirectionSums; 2],
}

/// The contacts present as springs and dashpots.
struct Springs<'a> {
    state: &'a State,
    contacts: &'a Contacts,
    /// Each contact with its k_n (N/m) and the coefficient of its normal dashpot (N s/m).
    list: Vec<(Pair, f64, f64)>,
    /// k_t/k_n, and its square root c_t/c_n.
    ratios: [f64; 2],
    /// Stiffness (N/m) and coefficient of the dashpot (N s/m) of rolling; zero where nothing resists it.
    rolling: [f64; 2],
}

struct CollectSprings<'a> {
    state: &'a State,
    contacts: &'a Contacts,
    settings: &'a EngineSettings,
}

impl<'a> LawVisitor for CollectSprings<'a> {
    type Output = Springs<'a>;

    fn visit<S: ContactSprings>(self, springs: S) -> Springs<'a> {
        let Self { state, contacts, settings } = self;
        let twice = 2.0 * settings.damping;
        let mut list = Vec::with_capacity(contacts.slots());
        list.extend(contacts.touching().map(|p| {
            let (contact_radius, m) = (p.history.contact_radius, &state.inverse_mass);
            let k = springs.normal_stiffness(contact_radius, p.overlap(&state.radius, contact_radius));
            let dashpot = twice * (k / (m[p.i as usize] + m[p.j as usize])).sqrt();
            (p, k, dashpot)
        }));
        let frictional = settings.features() != Features::Frictionless;
        let ratio = if frictional { springs.stiffness_ratio() } else { 0.0 };
        let resistance = if frictional { springs.rolling() } else { RollingResistance::NONE };
        let rolling = [resistance.stiffness, resistance.damping];
        Springs { state, contacts, list, ratios: [ratio, ratio.sqrt()], rolling }
    }
}

impl Springs<'_> {
    fn load(&self, block: &GrainBlock) -> Load {
        // The largest eigenvalue of one contact is that along it, or that across it, which also rotates the grain.
        let [stiffest, thickest] = self.ratios.map(|ratio| ((1.0 + INERTIA_RATIO) * ratio).max(1.0));
        let [k, c] = block.rolling.map(|sums| INERTIA_RATIO * sums[0]);
        Load { stiffness: stiffest * block.contact[0][0] + k, damping: thickest * block.contact[1][0] + c }
    }

    /// (R*/R)² for both grains of a pair.
    fn rolling_levers(&self, p: &Pair) -> [f64; 2] {
        let radius = [p.i, p.j].map(|grain| self.state.radius[grain as usize]);
        let r_eff = effective_radius(radius[0], radius[1]);
        radius.map(|r| (r_eff / r) * (r_eff / r))
    }

    /// The load of each grain with θ = 1.
    fn loads(&self) -> Vec<Load> {
        let mut sums = vec![[0.0; 2]; self.state.len()];
        let mut rolling = vec![0.0; self.state.len()];
        for (p, k, c) in &self.list {
            for (grain, lever) in [p.i as usize, p.j as usize].into_iter().zip(self.rolling_levers(p)) {
                sums[grain][0] += k;
                sums[grain][1] += c;
                rolling[grain] += lever;
            }
        }
        let [stiffest, thickest] = self.ratios.map(|ratio| 2.0 * ((1.0 + INERTIA_RATIO) * ratio).max(1.0));
        let [k, c] = self.rolling.map(|w| 2.0 * INERTIA_RATIO * w);
        let load = |((sum, rolling), m): ((&[f64; 2], &f64), &f64)| Load {
            stiffness: (stiffest * sum[0] + k * rolling) * m,
            damping: (thickest * sum[1] + c * rolling) * m,
        };
        sums.iter().zip(&rolling).zip(&self.state.inverse_mass).map(load).collect()
    }

    /// The block of each grain, θ = s_j/s_i.
    fn blocks(&self, s: &[f64]) -> Vec<GrainBlock> {
        let state = self.state;
        let mut blocks = vec![GrainBlock::default(); state.len()];
        for (p, k, c) in &self.list {
            let (i, j) = (p.i as usize, p.j as usize);
            let branch = self.contacts.branch(p, state);
            let distance = branch.norm();
            let n = branch / distance;
            let half = 0.5 * (state.radius[i] + state.radius[j] - distance);
            let both = s[i] + s[j];
            for ((grain, n), rolling) in [(i, n), (j, -n)].into_iter().zip(self.rolling_levers(p)) {
                let weight = both / s[grain] * state.inverse_mass[grain];
                // The lever is R − δ/2. With l = 1 − δ/2R convexity has (t + l r)² ≤ (t + r)² + (1 − l) t².
                let whole = 1.0 + half / state.radius[grain];
                let row =
                    [whole, n.x, n.y, n.z, n.x * n.x, n.y * n.x, n.y * n.y, n.z * n.x, n.z * n.y, n.z * n.z];
                let add = |sum: &mut DirectionSums, w: f64| {
                    sum.iter_mut().zip(row).for_each(|(sum, x)| *sum += w * x);
                };
                let block = &mut blocks[grain];
                for (sum, w) in block.contact.iter_mut().zip([*k, *c]) {
                    add(sum, weight * w);
                }
                if self.rolling[0] > 0.0 {
                    for (sum, w) in block.rolling.iter_mut().zip(self.rolling) {
                        add(sum, weight * rolling * w);
                    }
                }
            }
        }
        blocks
    }

    /// Longest h up to `limit` at which a block is stable, s. It must be stable at `safe`.
    fn longest(&self, block: &GrainBlock, safe: f64, limit: f64) -> f64 {
        if limit.is_finite() && self.is_stable(block, limit) {
            return limit;
        }
        let (mut low, mut high) = (safe, limit.min(2.0 * safe));
        while self.is_stable(block, high) {
            (low, high) = (high, 2.0 * high);
        }
        // To 1e-6.
        for _ in 0..20 {
            let h = 0.5 * (low + high);
            if self.is_stable(block, h) { low = h } else { high = h }
        }
        low
    }

    /// True if 4 − h² K − 2 h C is positive definite. Rotations are scaled so that their inertia is the mass.
    fn is_stable(&self, block: &GrainBlock, h: f64) -> bool {
        // Sums with the tangential coefficients, the excess of the normal ones, and all that resists rotation.
        let (mut across, mut excess, mut turning) = ([0.0; 10], [0.0; 10], [0.0; 10]);
        for (which, power) in [h * h, 2.0 * h].into_iter().enumerate() {
            let (sums, ratio) = (&block.contact[which], self.ratios[which]);
            for k in 0..10 {
                across[k] += power * ratio * sums[k];
                excess[k] += power * (1.0 - ratio) * sums[k];
                turning[k] += power * (ratio * sums[k] + block.rolling[which][k]);
            }
        }
        let mut m = [[0.0; 6]; 6];
        let mut k = 4;
        for row in 0..3 {
            for column in 0..=row {
                m[row][column] = -excess[k];
                m[row + 3][column + 3] = INERTIA_RATIO * turning[k];
                k += 1;
            }
            m[row][row] += 4.0 - across[0];
            m[row + 3][row + 3] += 4.0 - INERTIA_RATIO * turning[0];
        }
        let [_, x, y, z, ..] = across.map(|v| INERTIA_RATIO.sqrt() * v);
        m[3][..3].copy_from_slice(&[0.0, z, -y]);
        m[4][..3].copy_from_slice(&[-z, 0.0, x]);
        m[5][..3].copy_from_slice(&[y, -x, 0.0]);
        is_positive(m)
    }
}

/// True if a symmetric matrix, given by its lower triangle, is positive definite: all pivots of L D Lᵀ are positive.
fn is_positive(mut m: [[f64; 6]; 6]) -> bool {
    for pivot in 0..6 {
        let column = m.map(|row| row[pivot]);
        if column[pivot].is_nan() || column[pivot] <= 0.0 {
            return false;
        }
        let inverse = 1.0 / column[pivot];
        for row in pivot + 1..6 {
            let factor = column[row] * inverse;
            let rest = m[row].iter_mut().zip(column).take(row + 1).skip(pivot + 1);
            rest.for_each(|(x, below)| *x -= factor * below);
        }
    }
    true
}

/// Time in which a Rayleigh wave travels around half the smallest grain, s: the time step of a packing without contacts, and
/// the upper limit of all, because contacts form and stiffen between two updates.
///
/// It is no stability limit. But at a strain rate of 8 1/s, 200 such steps can close contacts by 1.3e-4 diameters, the
/// overlap at 35 kPa, where the stable step (friction, damping 0.3) is half as long. For glass it sets the step below 0.4 kPa
/// with friction and a damping of 0.3, below 0.2 MPa without friction, and below 5 MPa without either.
pub(crate) fn rayleigh(state: &State) -> f64 {
    let m = &state.material;
    let radius = state.smallest_radius;
    std::f64::consts::PI * radius * (m.density / m.shear_modulus).sqrt() / (0.1631 * m.poisson_ratio + 0.8766)
}

/// Stable time step of a collision at relative speed `speed` (m/s): that of the stiffness at its largest overlap. Two of the
/// smallest grains need the shortest step, 13 % less than the smallest with a much larger one.
pub(crate) fn collision(state: &State, speed: f64, damping: f64) -> f64 {
    let radius = state.smallest_radius;
    let (r_eff, m_eff) = (0.5 * radius, 0.5 * state.material.sphere_mass(radius));
    let stiffness = state.law.visit(&state.material, CollisionStiffness { r_eff, m_eff, speed });
    let normal = 2.0 * (m_eff / stiffness).sqrt() * ((1.0 + damping * damping).sqrt() - damping);
    // Relative rolling: 4 − h² K − 2 h C with K = R*² k (1/I + 1/I) = INERTIA_RATIO k/m, and so C.
    let mass = 2.0 * m_eff;
    let load = |r: RollingResistance| Load {
        stiffness: 0.5 * INERTIA_RATIO * r.stiffness / mass,
        damping: 0.5 * INERTIA_RATIO * r.damping / mass,
    };
    state.law.rolling.map_or(normal, |r| normal.min(load(r).step()))
}

/// Normal stiffness at the largest overlap of a collision, N/m, under any law.
struct CollisionStiffness {
    r_eff: f64,
    m_eff: f64,
    speed: f64,
}

impl LawVisitor for CollisionStiffness {
    type Output = f64;

    fn visit<S: ContactSprings>(self, springs: S) -> f64 {
        let overlap = springs.collision_overlap(self.r_eff, self.m_eff, self.speed);
        springs.normal_stiffness((self.r_eff * overlap).sqrt(), overlap)
    }
}

/// The next time step: `wanted` rounded down to a power of 2^(1/16), so that it changes seldom. It decreases at once, and
/// increases only by two such steps or more.
pub(crate) fn quantized(current: f64, wanted: f64) -> f64 {
    let step = 2f64.powf((wanted.log2() * 16.0).floor() / 16.0);
    let up = step > 1.08 * current;
    if step < current || up { step } else { current }
}
