//! Sparse Cholesky factorisation for these systems: a second way to every stiffness, to check the first
//! one. They share only the operator and the definition of residuals.
//!
//! At 2,000 grains a factorisation costs as much as about 1,000 iterations of [`super::solve()`] with
//! tangential springs and 500 without, where rotations drop out. It grows slightly faster than N², the
//! iterations for one tolerance as N^1.4 (`grainlab bench stiffness`). It is slower by a factor of ten or
//! more for stiff networks, and more so for larger ones. It is faster near isostaticity, where iterations are
//! many: with a friction of 1 and z = 4.1 both are equal; without friction it is several times as fast at z =
//! 6.02, and more than ten times at z = 6.00.
//!
//! K is singular. K + s diag(K) is factorised, with s far above rounding, so that no pivot vanishes, and far
//! below the stiffness of almost every mode, so that one solve reduces most of the residual to a fraction s.
//! Conjugate gradients with this factor as preconditioner reduce the rest: near a mechanism a few modes are
//! as soft as s, and each costs one or two rounds. Every round computes the residual with K itself.

use super::solve::{Refinement, Solution, add};
use super::spring_network::{GrainDofs, SpringNetwork};
use crate::error::MicroError;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};

/// Fraction of the diagonal that is added to it.
const SHARE: f64 = 1e-11;

/// Directions with a stiffness below this fraction of the largest one of their grain are left out.
const LOOSE: f64 = 1e-12;

/// Maximum number of rounds: a network with so many modes as soft as s has no stiffness.
const ROUNDS: u32 = 100;

/// Solves K x = `load` like [`super::solve()`], with a factorisation instead of iterations. Each round of
/// refinement counts as one iteration.
///
/// # Errors
/// As [`super::solve()`].
pub fn solve<const L: usize>(
    network: &SpringNetwork,
    load: &[GrainDofs<L>],
    scale: &[f64; L],
    tolerance: f64,
    max_iterations: u32,
) -> Result<Solution<L>, MicroError> {
    let mut refinement = Refinement::new(network, load, scale, tolerance, max_iterations.min(ROUNDS))?;
    if let Some(factor) = Factor::new(network) {
        let mut step = vec![[[0.0; L]; 6]; load.len()];
        let mut image = step.clone();
        // xᵀ K x of the last step; none before the first.
        let mut energy = [0.0; L];
        while refinement.goes_on() {
            let left = refinement.left();
            let mut found = factor.solve(&left);
            // Conjugate to the last step.
            let shared = ratios(&products(&found, &image), &energy);
            add(&shared.map(|share| -share), &step, &mut found);
            step = found;
            energy = network.apply(&step, &mut image);
            refinement.advance(network, &step, &ratios(&products(&step, &left), &energy));
        }
    }
    refinement.solution()
}

/// xᵀ y of each column.
fn products<const L: usize>(x: &[GrainDofs<L>], y: &[GrainDofs<L>]) -> [f64; L] {
    let mut sums = [0.0; L];
    for (x, y) in x.iter().zip(y) {
        for k in 0..6 {
            for l in 0..L {
                sums[l] += x[k][l] * y[k][l];
            }
        }
    }
    sums
}

/// Zero if the divisor is zero.
fn ratios<const L: usize>(above: &[f64; L], below: &[f64; L]) -> [f64; L] {
    std::array::from_fn(|l| if below[l] > 0.0 { above[l] / below[l] } else { 0.0 })
}

struct Factor {
    factor: Llt<usize, f64>,
    /// Grain and row of each direction that is kept.
    directions: Vec<(usize, usize)>,
}

impl Factor {
    /// `None` if a pivot is not positive, which happens only if a stiffness is not a finite number.
    fn new(network: &SpringNetwork) -> Option<Self> {
        let blocks = network.diagonal_blocks();
        let mut directions = Vec::new();
        let mut numbers = vec![[None; 6]; blocks.len()];
        for (grain, block) in blocks.iter().enumerate() {
            let largest = (0..6).fold(0.0, |most: f64, k| most.max(block[k][k]));
            for row in (0..6).filter(|row| block[*row][*row] > LOOSE * largest) {
                numbers[grain][row] = Some(directions.len());
                directions.push((grain, row));
            }
        }
        let mut entries = Vec::with_capacity(21 * blocks.len() + 36 * network.contacts());
        // Into the lower triangle.
        let mut enter = |a: (usize, usize), b: (usize, usize), val: f64| {
            if let (Some(a), Some(b)) = (numbers[a.0][a.1], numbers[b.0][b.1]) {
                entries.push(Triplet { row: a.max(b), col: a.min(b), val });
            }
        };
        for (grain, block) in blocks.iter().enumerate() {
            for (row, entries) in block.iter().enumerate() {
                enter((grain, row), (grain, row), (1.0 + SHARE) * entries[row]);
                for (column, entry) in entries[..row].iter().enumerate() {
                    enter((grain, row), (grain, column), *entry);
                }
            }
        }
        for s in network.springs.iter().filter(|s| s.i != s.j) {
            for (row, entries) in s.coupling().iter().enumerate() {
                for (column, entry) in entries.iter().enumerate() {
                    enter((s.i as usize, row), (s.j as usize, column), *entry);
                }
            }
        }
        let size = directions.len();
        let matrix = SparseColMat::try_new_from_triplets(size, size, &entries).ok()?;
        Some(Self { factor: matrix.sp_cholesky(Side::Lower).ok()?, directions })
    }

    /// The motion that balances `load`, apart from the directions left out and the term added to the
    /// diagonal.
    fn solve<const L: usize>(&self, load: &[GrainDofs<L>]) -> Vec<GrainDofs<L>> {
        let mut columns = Mat::zeros(self.directions.len(), L);
        for (number, (grain, row)) in self.directions.iter().enumerate() {
            (0..L).for_each(|l| columns[(number, l)] = load[*grain][*row][l]);
        }
        self.factor.solve_in_place(&mut columns);
        let mut motion = vec![[[0.0; L]; 6]; load.len()];
        for (number, (grain, row)) in self.directions.iter().enumerate() {
            (0..L).for_each(|l| motion[*grain][*row][l] = columns[(number, l)]);
        }
        motion
    }
}
