//! Acoustic modes at one wave vector.
//!
//! Inverse iteration on K x = ω² M x, from plane waves: each round solves K y = M x by conjugate gradients and takes the best
//! combinations of x and y (Rayleigh–Ritz). The acoustic modes of a long wave are the softest there are, so a round leaves
//! some (ω/ω')² of what is not theirs, ω' the softest other mode, and errors of ω² are squares of that.

use crate::dispersion::bloch::Bloch;
use crate::dispersion::row::{Amplitude, Block, Row, WAVES};
use crate::dispersion::solve::Solve;
use crate::dispersion::subspace::{Complex3, Subspace};
use grainlab_core::{Mat3, Vec3};

/// Rounds of inverse iteration at most.
const ROUNDS: u32 = 30;

/// A solve ends when its residual is this share of the square root of the tolerance of ω², whose error is of second order.
const RESIDUAL: f64 = 1.0;

/// The acoustic modes at one wave vector.
#[derive(Debug)]
pub(crate) struct Modes {
    /// Σ ω² p p* over the modes with their motions p, 1/s²: what resists a motion, over the mass that moves. Zero for
    /// motions that were not sent.
    pub(crate) resistance: Mat3,
    /// Relative change of ω² in the last round, the worst of the modes.
    pub(crate) change: f64,
    /// The modes themselves, and softer ones that had to be kept apart.
    pub(crate) found: Vec<Block>,
}

/// Why there are none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stopped {
    /// A motion that meets no resistance, and is not of a few grains alone.
    NoResistance,
    /// The iterations did not suffice.
    NotConverged { residual: f64, iterations: u32 },
    /// The rounds did not.
    Unsettled { change: f64 },
}

impl std::fmt::Display for Stopped {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoResistance => write!(f, "it meets no resistance"),
            Self::NotConverged { residual, iterations } => {
                write!(
                    f,
                    "relative residual {residual:e} after {iterations} iterations; raise max_iterations or tolerance, or use \
                     longer waves"
                )
            }
            Self::Unsettled { change } => {
                write!(
                    f,
                    "the square of the frequency still changed by {change:e} of itself after {ROUNDS} rounds, among softer \
                     motions of single grains; use longer waves"
                )
            }
        }
    }
}

/// The modes that are nearest to plane waves with the perpendicular `motions`, one to three, to the relative error
/// `tolerance` of ω². `near`: what was found at a wave vector near by.
pub(crate) fn modes(
    bloch: &Bloch<'_>,
    motions: &[Vec3],
    near: &[Block],
    tolerance: f64,
    max_iterations: u32,
) -> Result<Modes, Stopped> {
    let plane = plane_waves(bloch, motions);
    let count = motions.len();
    let mut weighed = vec![Amplitude::STILL; plane.len()];
    bloch.weigh(&plane, &mut weighed);
    let mut subspace = Subspace::new(count);
    subspace.add(bloch, plane.clone());
    near.iter().for_each(|block| subspace.add(bloch, block.clone()));
    let mut ritz = subspace.best(&weighed).ok_or(Stopped::NoResistance)?;
    let mut budget = max_iterations;
    let mut change = f64::INFINITY;
    for _ in 0..ROUNDS {
        let residual = RESIDUAL * tolerance.sqrt();
        let solve =
            Solve { bloch, x: &ritz.waves, squares: &ritz.squares, tolerance: residual, budget: &mut budget };
        let solved = pulp::Arch::new().dispatch(solve)?;
        let before = ritz.squares;
        let mut subspace = Subspace::new(count);
        // What the round changed, rather than its result, which is nearly what was there.
        let mut step = solved;
        let squares = Row::of(ritz.squares);
        for (step, wave) in step.iter_mut().zip(&ritz.waves) {
            for k in 0..6 {
                step.re[k] = squares * step.re[k] - wave.re[k];
                step.im[k] = squares * step.im[k] - wave.im[k];
            }
        }
        subspace.add(bloch, ritz.waves);
        subspace.add(bloch, step);
        ritz.softer.into_iter().for_each(|block| subspace.add(bloch, block));
        ritz = subspace.best(&weighed).ok_or(Stopped::NoResistance)?;
        let moved = |k: usize| (ritz.squares[k] - before[k]).abs() / ritz.squares[k];
        change = (0..count).map(moved).fold(0.0, f64::max);
        if change <= tolerance {
            let resistance = resistance(&ritz.squares, &ritz.overlaps, motions);
            let found = std::iter::once(ritz.waves).chain(ritz.softer).collect();
            return Ok(Modes { resistance, change, found });
        }
    }
    Err(Stopped::Unsettled { change })
}

/// Uniform motions of all grains that take part, without what meets no resistance.
fn plane_waves(bloch: &Bloch<'_>, motions: &[Vec3]) -> Block {
    let mut plane = vec![Amplitude::STILL; bloch.carrier.mass.len()];
    for (amplitude, mass) in plane.iter_mut().zip(&bloch.carrier.mass) {
        if *mass > 0.0 {
            for k in 0..3 {
                amplitude.re[k] = Row::of([0, 1, 2].map(|wave| motions.get(wave).map_or(0.0, |m| m[k])));
            }
        }
    }
    bloch.purge(&mut plane);
    plane
}

/// Σ ω² p p*, real part, with the modes' motions p made perpendicular in the least-squares sense (Löwdin).
fn resistance(squares: &[f64; WAVES], overlaps: &Complex3, motions: &[Vec3]) -> Mat3 {
    let count = motions.len();
    let small = overlaps.resistance(squares, count);
    let mut sum = Mat3::zeros();
    for a in 0..count {
        for b in 0..count {
            sum += motions[a] * motions[b].transpose() * small[(a, b)];
        }
    }
    sum
}
