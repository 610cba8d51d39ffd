//! Acoustic modes at one wave vector.
//!
//! Inverse iteration on K x = ω² M x, from plane waves: each round solves K y = M x by conjugate gradients
//! and takes the best combinations of x and y (Rayleigh–Ritz). The acoustic modes of a long wave are the
//! softest modes. A round therefore reduces the components along other modes by (ω/ω')², where ω' is the
//! softest of them; the error of ω² is the square of that.

use crate::dispersion::bloch::Bloch;
use crate::dispersion::error::SolveError;
use crate::dispersion::solve::InverseIteration;
use crate::dispersion::subspace::{C, Subspace};
use crate::dispersion::waves::{Amplitude, Block, Row, WAVES};
use grainlab_core::instruction_sets::{Work, with_avx2};
use grainlab_core::{Mat3, Vec3};
use nalgebra::{DMatrix, Matrix3, SymmetricEigen};

/// Maximum number of rounds of inverse iteration.
const ROUNDS: u32 = 30;

/// Residual of a solve over the square root of the tolerance of ω², whose error is of second order in the residual.
const RESIDUAL: f64 = 1.0;

#[derive(Debug)]
pub(crate) struct Modes {
    /// Σ ω² p p* over the modes with their polarizations p, 1/s²: the acoustic tensor over the density, times q². Zero
    /// for polarizations that were not given.
    pub(crate) acoustic_tensor: Mat3,
    /// Largest relative change of ω² in the last round.
    pub(crate) change: f64,
    /// The modes, and softer ones that had to be separated.
    pub(crate) found: Vec<Block>,
}

/// The modes nearest to plane waves with one to three perpendicular `polarizations`, to the relative error `tolerance`
/// of ω².
/// `near`: modes found at a neighbouring wave vector, where floppy modes have other phases.
pub(crate) fn modes(
    bloch: &Bloch<'_>,
    polarizations: &[Vec3],
    near: &[Block],
    tolerance: f64,
    max_iterations: u32,
) -> Result<Modes, SolveError> {
    let plane = plane_waves(bloch, polarizations);
    let count = polarizations.len();
    let mut mass_times = vec![Amplitude::STILL; plane.len()];
    bloch.apply_mass(&plane, &mut mass_times);
    let mut subspace = Subspace::new(count);
    subspace.add(bloch, plane.clone());
    for mut block in near.iter().cloned() {
        bloch.project_out_floppy_modes(&mut block);
        subspace.add(bloch, block);
    }
    let mut ritz = subspace.best(&mass_times).ok_or(SolveError::Floppy)?;
    let mut budget = max_iterations;
    let mut change = f64::INFINITY;
    for _ in 0..ROUNDS {
        let residual = RESIDUAL * tolerance.sqrt();
        let solve = InverseIteration {
            bloch,
            x: &ritz.waves,
            squares: &ritz.squares,
            tolerance: residual,
            budget: &mut budget,
        };
        let solved = with_avx2(solve).unwrap_or_else(InverseIteration::run)?;
        let before = ritz.squares;
        let mut subspace = Subspace::new(count);
        // The change in this round, not its result, which is nearly parallel to the previous one.
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
        ritz = subspace.best(&mass_times).ok_or(SolveError::Floppy)?;
        let moved = |k: usize| (ritz.squares[k] - before[k]).abs() / ritz.squares[k];
        change = (0..count).map(moved).fold(0.0, f64::max);
        if change <= tolerance {
            let acoustic_tensor = acoustic_tensor(&ritz.squares, &ritz.overlaps, polarizations);
            let found = std::iter::once(ritz.waves).chain(ritz.softer).collect();
            return Ok(Modes { acoustic_tensor, change, found });
        }
    }
    Err(SolveError::Unsettled { change, rounds: ROUNDS })
}

/// Uniform motions of all grains of the backbone, without floppy modes.
fn plane_waves(bloch: &Bloch<'_>, polarizations: &[Vec3]) -> Block {
    let mut plane = vec![Amplitude::STILL; bloch.backbone.mass.len()];
    for (amplitude, mass) in plane.iter_mut().zip(&bloch.backbone.mass) {
        if *mass > 0.0 {
            for k in 0..3 {
                amplitude.re[k] =
                    Row::of([0, 1, 2].map(|wave| polarizations.get(wave).map_or(0.0, |m| m[k])));
            }
        }
    }
    bloch.project_out_floppy_modes(&mut plane);
    plane
}

/// Real part of Σ ω² p p*, with the polarizations p of the modes orthogonalised in the least-squares sense (Löwdin).
fn acoustic_tensor(squares: &[f64; WAVES], overlaps: &Matrix3<C>, polarizations: &[Vec3]) -> Mat3 {
    let count = polarizations.len();
    let w = overlaps.view((0, 0), (count, count)).into_owned();
    // W (W*W)^-½: the nearest orthogonal polarizations.
    let eigen = SymmetricEigen::new(w.adjoint() * &w);
    let root = DMatrix::from_diagonal(&eigen.eigenvalues.map(|v| C::from(1.0 / v.sqrt())));
    let vectors = DMatrix::from_fn(count, count, |i, j| eigen.eigenvectors[(i, j)]);
    let w = DMatrix::from_fn(count, count, |i, j| w[(i, j)]);
    let motions = w * &vectors * root * vectors.adjoint();
    let mut sum = Mat3::zeros();
    for a in 0..count {
        for b in 0..count {
            let term = |k: usize| squares[k] * (motions[(a, k)] * motions[(b, k)].conj()).re;
            let share: f64 = (0..count).map(term).sum();
            sum += polarizations[a] * polarizations[b].transpose() * share;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backbone::Backbone;

    const ALL: [Vec3; 3] = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];

    /// A lattice with two neighbours that have two contacts each, and floppy modes in common.
    fn loose() -> Backbone {
        let mut packing = crate::dispersion::lattice_sample::lattice();
        packing.contacts.retain(|c| c.i > 1 || [[0, 1], [0, 9], [1, 4]].contains(&[c.i, c.j]));
        let backbone = Backbone::new(&packing).unwrap();
        assert!(backbone.clusters.iter().any(|c| c.grains.len() == 2 && c.motions.iter().any(|m| m.is_free)));
        backbone
    }

    fn at(backbone: &Backbone, wavenumber: f64) -> Bloch<'_> {
        Bloch::new(backbone, &(Vec3::new(1.0, 2.0, 3.0).normalize() * wavenumber))
    }

    #[test]
    fn modes_near_those_of_another_wave_vector_are_found_where_neighbours_share_floppy_modes() {
        let backbone = loose();
        let of = |wavenumber: f64, near: &[Block]| {
            modes(&at(&backbone, wavenumber), &ALL, near, 1e-8, 10_000).unwrap()
        };
        let [alone, near] = [&[][..], &of(300.0, &[]).found].map(|near| of(600.0, near).acoustic_tensor);
        assert!((near - alone).amax() < 1e-6 * alone.amax(), "{near} {alone}");
    }

    #[test]
    fn a_load_on_a_motion_without_stiffness_is_named_and_no_lack_of_iterations() {
        let backbone = loose();
        let bloch = at(&backbone, 600.0);
        let mut x = plane_waves(&bloch, &ALL);
        x[0].re[3] = Row::of([1.0; WAVES]);
        let solve = InverseIteration {
            bloch: &bloch,
            x: &x,
            squares: &[1e10; WAVES],
            tolerance: 1e-3,
            budget: &mut 10_000,
        };
        assert_eq!(solve.run().err(), Some(SolveError::Floppy));
    }
}
