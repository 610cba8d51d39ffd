//! Several right-hand sides of one network at once: conjugate gradients in single precision, refined in double.
//!
//! The operator is singular (uniform translation, rattlers, floppy grains), but loads from contact forces lie
//! in its range, where conjugate gradients converge to a solution. All solutions give the same forces.
//!
//! Each round solves for the residual of the last one, computed in double precision with the operator itself,
//! so that neither the precision of a round nor its recurrences limit the result. Single precision halves the
//! memory traffic and doubles the work per instruction; double precision follows where it no longer helps.
//! If a round is slow, the softest motions of a few grains are left out of the iterations, and balanced exactly before and
//! after each round ([`super::soft_motions`]). If they are so soft that rounding makes the rest indefinite, the iterations take them
//! back, in double precision.
//! All operations run in a fixed order on one thread: the same input gives the same bits.

use super::conjugate_gradient::{Descent, Goal};
use super::gauss_seidel::Sweeps;
use super::lanes::{Real, WIDTH};
use super::preconditioner::Block;
use super::soft_motions::{Entries, SoftMotion, soft_motions};
use super::spring_network::{GrainDofs, SpringNetwork};
use crate::error::MicroError;
use nalgebra::Matrix6;
use std::cell::OnceCell;

/// A round reduces the residual by this much at most in single precision (10⁻⁷ relative rounding)…
const SINGLE: f64 = 3e-6;

/// …and in double.
const DOUBLE: f64 = 1e-13;

/// A round that leaves more than this fraction of a residual did not help.
const HELPED: f64 = 0.1;

/// Iterations of one round after which the soft motions of the network are found and solved for directly. Networks far from
/// isostaticity need some thirty.
const WITHOUT_SOFT: u32 = 100;

/// Maximum number of iterations of one round in single precision. A network that needs more is so close to a
/// mechanism that rounding errors dominate.
const SINGLE_ROUND: u32 = 500;

/// Growth of a squared residual in double precision that no network causes whose stiffness double precision resolves.
const GROWTH: f64 = 1e12;

/// Negative eigenvalues of a block up to this fraction of its largest one are rounding.
const ROUNDING: f64 = 1e-12;

/// Solution of a solve.
#[derive(Clone, Debug)]
pub struct Solution<const L: usize> {
    /// One motion per grain.
    pub motion: Vec<GrainDofs<L>>,
    /// Norm of the residual of each load, recomputed from the motion, over its scale; maximum over the
    /// columns.
    pub residual: f64,
    /// Number of iterations done.
    pub iterations: u32,
}

/// Solves K x = `load` (one entry per grain, N) for `L` columns at once, at most eight, until the norm of each residual
/// is at most `tolerance` times its entry in `scale` (N). Columns with a scale of zero are left at zero.
///
/// # Errors
/// Another number of loads than of grains, and a solve that does not converge.
pub fn solve<const L: usize>(
    network: &SpringNetwork,
    load: &[GrainDofs<L>],
    scale: &[f64; L],
    tolerance: f64,
    max_iterations: u32,
) -> Result<Solution<L>, MicroError> {
    Solver::new(network).solve(load, scale, tolerance, max_iterations)
}

/// Solves with one network, whose soft motions are found once.
pub(super) struct Solver<'a> {
    network: &'a SpringNetwork,
    /// Found by the first solve that needs them.
    soft: OnceCell<Vec<SoftMotion>>,
}

impl<'a> Solver<'a> {
    pub(super) fn new(network: &'a SpringNetwork) -> Self {
        Self { network, soft: OnceCell::new() }
    }

    /// See [`solve()`] for arguments and errors.
    pub(super) fn solve<const L: usize>(
        &self,
        load: &[GrainDofs<L>],
        scale: &[f64; L],
        tolerance: f64,
        max_iterations: u32,
    ) -> Result<Solution<L>, MicroError> {
        let solution = self.closest(load, scale, tolerance, max_iterations)?;
        let Solution { residual, iterations, .. } = solution;
        if residual <= tolerance {
            Ok(solution)
        } else {
            Err(MicroError::NotConverged { residual, tolerance, iterations, sufficient: None })
        }
    }

    /// Returns the closest solution found, whatever its residual is; arguments and other errors as of [`solve()`].
    pub(super) fn closest<const L: usize>(
        &self,
        load: &[GrainDofs<L>],
        scale: &[f64; L],
        tolerance: f64,
        max_iterations: u32,
    ) -> Result<Solution<L>, MicroError> {
        const { assert!(L <= WIDTH) }
        let mut refinement = Refinement::new(self.network, load, scale, tolerance, max_iterations)?;
        if self.network.prestressed() {
            refinement.solve::<true>(self)?;
        } else {
            refinement.solve::<false>(self)?;
        }
        let Refinement { motion, residual, iterations, .. } = refinement;
        Ok(Solution { motion, residual, iterations })
    }
}

/// Loads less the forces that answer a motion, where there is a scale.
pub(crate) fn left<const L: usize>(
    load: &[GrainDofs<L>],
    image: &[GrainDofs<L>],
    scale: &[f64; L],
) -> Vec<GrainDofs<L>> {
    let left = |load: f64, image: f64, l: usize| if scale[l] > 0.0 { load - image } else { 0.0 };
    let row = |load: &[f64; L], image: &[f64; L]| std::array::from_fn(|l| left(load[l], image[l], l));
    load.iter().zip(image).map(|(load, image)| std::array::from_fn(|k| row(&load[k], &image[k]))).collect()
}

/// Solution and residual so far, in double precision.
struct Refinement<'a, const L: usize> {
    load: &'a [GrainDofs<L>],
    scale: &'a [f64; L],
    soft: &'a [SoftMotion],
    tolerance: f64,
    max_iterations: u32,
    motion: Vec<GrainDofs<L>>,
    /// Product K x.
    image: Vec<GrainDofs<L>>,
    /// Squared norms of load − K x.
    squares: [f64; L],
    /// Maximum over the columns.
    residual: f64,
    iterations: u32,
}

impl<'a, const L: usize> Refinement<'a, L> {
    fn new(
        network: &SpringNetwork,
        load: &'a [GrainDofs<L>],
        scale: &'a [f64; L],
        tolerance: f64,
        max_iterations: u32,
    ) -> Result<Self, MicroError> {
        if load.len() != network.grains() {
            return Err(MicroError::Loads { grains: network.grains(), loads: load.len() });
        }
        let zero = vec![[[0.0; L]; 6]; load.len()];
        let (squares, residual) = ([0.0; L], f64::INFINITY);
        let mut new = Self {
            load,
            scale,
            soft: &[],
            tolerance,
            max_iterations,
            motion: zero.clone(),
            image: zero,
            squares,
            residual,
            iterations: 0,
        };
        new.look();
        Ok(new)
    }

    /// Computes the residual.
    fn look(&mut self) {
        self.squares = [0.0; L];
        for (load, image) in self.load.iter().zip(&self.image) {
            for k in 0..6 {
                for l in 0..L {
                    self.squares[l] += (load[k][l] - image[k][l]).powi(2);
                }
            }
        }
        let ratio = |l: usize| if self.scale[l] > 0.0 { self.squares[l].sqrt() / self.scale[l] } else { 0.0 };
        // Not f64::max, which would hide a NaN.
        self.residual =
            (0..L).map(ratio).fold(0.0, |worst: f64, r| if worst.is_nan() || r <= worst { worst } else { r });
    }

    /// In single precision, then in double if that does not suffice. `G`: with the prestress term.
    fn solve<const G: bool>(&mut self, solver: &'a Solver<'_>) -> Result<(), MicroError> {
        let network = solver.network;
        if G && network.diagonal_blocks().iter().any(gives_way) {
            return Err(MicroError::Unstable { residual: self.residual });
        }
        let single = Sweeps::<f32, G>::new(network);
        if solver.soft.get().is_none()
            && self.rounds(network, &mut Descent::new(&single), SINGLE, WITHOUT_SOFT)
        {
            return Ok(());
        }
        self.soft = solver.soft.get_or_init(|| soft_motions(network));
        let before_soft = self.motion.clone();
        let single = single.without(self.soft);
        if !self.rounds(network, &mut Descent::new(&single), SINGLE, SINGLE_ROUND) {
            let double = Sweeps::<f64, G>::new(network).without(self.soft);
            let mut descent = Descent::new(&double);
            self.rounds(network, &mut descent, DOUBLE, u32::MAX);
            if descent.lost_after.is_some() {
                // Motions so soft that rounding gives them work in common are better left to the iterations.
                (self.soft, self.motion) = (&[], before_soft);
                self.renew(network);
                let whole = Sweeps::<f64, G>::new(network);
                self.rounds(network, &mut Descent::new(&whole), DOUBLE, u32::MAX);
            }
            let solved = self.residual <= self.tolerance;
            if descent.unstable && !solved {
                return Err(MicroError::Unstable { residual: self.residual });
            }
        }
        Ok(())
    }

    /// Recomputes the residual from the motion.
    fn renew(&mut self, network: &SpringNetwork) {
        network.apply(&self.motion, &mut self.image);
        self.look();
    }

    fn goes_on(&self) -> bool {
        self.residual > self.tolerance && self.iterations < self.max_iterations
    }

    /// Rounds of conjugate gradients, as long as they help. Each reduces the residual by at most `reach` in
    /// at most `most` iterations. Returns true if the solve is finished.
    fn rounds<T: Real, const G: bool>(
        &mut self,
        network: &SpringNetwork,
        descent: &mut Descent<T, G>,
        reach: f64,
        most: u32,
    ) -> bool {
        while self.goes_on() {
            let (before, kept) = (self.residual, self.motion.clone());
            let done = self.round(descent, reach, most);
            self.renew(network);
            // A NaN does not help either.
            let worse = self.residual.is_nan() || self.residual > before;
            if worse {
                self.motion = kept;
                self.renew(network);
            }
            let slow = done == most || self.residual > HELPED * before;
            if worse || (slow && self.residual > self.tolerance) {
                return false;
            }
        }
        true
    }

    /// Residuals of norm 1 in the order of the sweeps: the start of a descent.
    fn fill<T: Real, const G: bool>(
        &self,
        descent: &mut Descent<T, G>,
        squares: &[f64; WIDTH],
        norms: &[f64; WIDTH],
    ) {
        for (at, grain) in descent.sweeps.order.iter().enumerate() {
            let (load, image) = (&self.load[*grain as usize], &self.image[*grain as usize]);
            for k in 0..6 {
                for l in 0..L {
                    let left = (load[k][l] - image[k][l]) / norms[l];
                    descent.rest[at][k][l] = if squares[l] > 0.0 { T::of(left) } else { T::ZERO };
                }
            }
        }
    }

    /// One round, with the number of its iterations.
    fn round<T: Real, const G: bool>(&mut self, descent: &mut Descent<T, G>, reach: f64, most: u32) -> u32 {
        let sweeps = descent.sweeps;
        if !self.soft.is_empty() {
            self.balance_soft();
        }
        // Rounding leaves a larger residual than the recurrence gives, hence half the tolerance as a margin.
        // The remaining rounds share the remaining reduction evenly.
        let whole = 0.5 * self.tolerance / self.residual;
        let rounds = (whole.ln() / reach.ln()).ceil().max(1.0);
        let reduction = whole.powf(1.0 / rounds);
        // Loads of norm 1: single precision has a narrow range.
        let (mut squares, mut targets, mut norms) = ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
        for l in 0..L {
            norms[l] = self.squares[l].sqrt();
            if self.scale[l] > 0.0 && norms[l] > 0.0 {
                squares[l] = 1.0;
                targets[l] = (reduction * self.residual * self.scale[l] / norms[l]).powi(2);
            }
        }
        self.fill(descent, &squares, &norms);
        let limit = most.min(self.max_iterations.saturating_sub(self.iterations));
        // In single precision a round that loses its way is discarded.
        let growth = (reach == DOUBLE && !G).then_some(GROWTH);
        let mut iterations = descent.run(&Goal { squares, targets, limit, growth });
        if let Some(limit) = descent.lost_after.filter(|_| self.soft.is_empty()) {
            // Rounding has put a motion without resistance into a column: back to where that began.
            self.fill(descent, &squares, &norms);
            iterations += descent.run(&Goal { squares, targets, limit, growth: None });
        }
        self.iterations += iterations;
        let before: Vec<[f64; L]> = self.soft.iter().map(|s| shares(&s.force, &self.motion)).collect();
        for (at, grain) in sweeps.order.iter().enumerate() {
            let found = &descent.motion[at];
            for (row, found) in self.motion[*grain as usize].iter_mut().zip(found) {
                for l in 0..L {
                    row[l] += found[l].wide() * (norms[l] / sweeps.unit);
                }
            }
        }
        // The soft motions follow what was added: x − w wᵀ K x.
        for (soft, before) in self.soft.iter().zip(before) {
            let after = shares(&soft.force, &self.motion);
            add(&mut self.motion, &soft.motion, &std::array::from_fn(|l| before[l] - after[l]));
        }
        iterations
    }

    /// Moves the soft motions w so that their forces are balanced: x + w wᵀ (load − K x).
    fn balance_soft(&mut self) {
        for soft in self.soft {
            let loads = shares(&soft.motion, self.load);
            let images = shares(&soft.motion, &self.image);
            let more = std::array::from_fn(|l| if self.scale[l] > 0.0 { loads[l] - images[l] } else { 0.0 });
            add(&mut self.motion, &soft.motion, &more);
            add(&mut self.image, &soft.force, &more);
        }
        self.look();
    }
}

/// Products of `entries` with each column of `x`.
fn shares<const L: usize>(entries: &Entries, x: &[GrainDofs<L>]) -> [f64; L] {
    let mut shares = [0.0; L];
    for (grain, entry) in entries {
        for (k, row) in x[*grain as usize].iter().enumerate() {
            (0..L).for_each(|l| shares[l] += entry[k] * row[l]);
        }
    }
    shares
}

/// Adds `entries` times `factors` to the columns of `x`.
fn add<const L: usize>(x: &mut [GrainDofs<L>], entries: &Entries, factors: &[f64; L]) {
    for (grain, entry) in entries {
        for (k, row) in x[*grain as usize].iter_mut().enumerate() {
            (0..L).for_each(|l| row[l] += entry[k] * factors[l]);
        }
    }
}

/// True if a grain with this block, moved alone, has a negative stiffness.
fn gives_way(block: &Block) -> bool {
    let eigenvalues = Matrix6::from_fn(|i, j| block[i][j]).symmetric_eigenvalues();
    eigenvalues.min() < -ROUNDING * eigenvalues.max()
}
