//! Random placement of grains, with thermal velocities.

use super::grid::{Grid, Neighbour};
use crate::gas::error::GasError;
use grainlab_core::{Cell, Vec3};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Randomly placed grains without overlap, in a cubic cell.
#[derive(Clone, Debug)]
pub struct Gas {
    /// The periodic cell.
    pub cell: Cell,
    /// Centres of the grains, m.
    pub positions: Vec<Vec3>,
    /// Velocities with zero sum, m/s.
    pub velocities: Vec<Vec3>,
}

/// Attempts to place one grain before an error. At a solid fraction of 0.35 some tens of thousands may be needed.
const ATTEMPTS: u32 = 200_000;

/// Places spheres of these radii (m) one after the other at random without overlap (random sequential addition), which is
/// possible up to a solid fraction of about 0.38 where they are of one size, and gives them random velocities of root mean
/// square `speed` (m/s), of equal mean energy and without momentum. Large spheres should come first.
pub fn random_placement(radii: &[f64], solid_fraction: f64, speed: f64, seed: u64) -> Result<Gas, GasError> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let grains = u32::try_from(radii.len()).unwrap_or(u32::MAX);
    let edge = (solid_volume(radii) / solid_fraction).cbrt();
    let degenerate = GasError::Placement { placed: 0, grains, solid_fraction };
    let cell = Cell::cube(edge).ok_or(degenerate)?;
    let positions = place(radii, edge, &mut random).map_err(|placed| GasError::Placement {
        placed,
        grains,
        solid_fraction,
    })?;
    Ok(Gas { cell, positions, velocities: thermal(radii, speed, &mut random) })
}

fn are_equal(radii: &[f64]) -> bool {
    radii.windows(2).all(|pair| pair[0] == pair[1])
}

/// Volume of the spheres, m³.
fn solid_volume(radii: &[f64]) -> f64 {
    let sphere = |r: f64| std::f64::consts::PI / 6.0 * (2.0 * r).powi(3);
    match radii.first() {
        Some(r) if are_equal(radii) => radii.len() as f64 * std::f64::consts::PI / 6.0 * (2.0 * r).powi(3),
        _ => radii.iter().map(|r| sphere(*r)).sum(),
    }
}

/// Centres without overlap in a cube of this edge (m); the number placed if there is no room for the next one.
fn place(radii: &[f64], edge: f64, random: &mut Pcg64Mcg) -> Result<Vec<Vec3>, u32> {
    let widest = 2.0 * radii.iter().copied().fold(0.0, f64::max);
    let mut grid = Grid::new(Vec3::repeat(edge), widest, radii.len());
    let (mut placed, mut near) = (Vec::<Vec3>::with_capacity(radii.len()), Vec::new());
    let fold = |d: f64| d - edge * (d / edge).round();
    for (count, radius) in radii.iter().enumerate() {
        let is_free = |x: &Vec3| {
            grid.around(&(*x).into(), &mut near);
            let overlaps = |other: &Neighbour| {
                let contact = radius + radii[other.grain as usize];
                (placed[other.grain as usize] - x).map(fold).norm_squared() < contact * contact
            };
            2.0 * radius <= edge && !near.iter().any(overlaps)
        };
        let mut attempts = (0..ATTEMPTS).map(|_| Vec3::from_fn(|_, _| uniform(random) * edge));
        let x = attempts.find(is_free).ok_or(count as u32)?;
        grid.place(count, &x.into());
        placed.push(x);
    }
    Ok(placed)
}

/// Velocities of root mean square `speed` without momentum, of equal mean energy for spheres of unequal mass.
///
/// Each component is a sum of twelve uniform numbers, which is nearly normal. It needs no logarithm, which differs between
/// platforms, so the same seed gives the same bits everywhere. Collisions make the distribution normal.
fn thermal(radii: &[f64], speed: f64, random: &mut Pcg64Mcg) -> Vec<Vec3> {
    let grains = radii.len() as f64;
    let mut v: Vec<Vec3> = radii
        .iter()
        .map(|_| Vec3::from_fn(|_, _| (0..12).map(|_| uniform(random)).sum::<f64>() - 6.0))
        .collect();
    let drift = if are_equal(radii) {
        v.iter().sum::<Vec3>() / grains
    } else {
        v.iter_mut().zip(radii).for_each(|(v, r)| *v /= (r / radii[0]).powi(3).sqrt());
        let momentum: Vec3 = v.iter().zip(radii).map(|(v, r)| v * r.powi(3)).sum();
        momentum / radii.iter().map(|r| r.powi(3)).sum::<f64>()
    };
    v.iter_mut().for_each(|v| *v -= drift);
    let square = v.iter().map(Vec3::norm_squared).sum::<f64>() / grains;
    if square > 0.0 {
        let factor = speed / square.sqrt();
        v.iter_mut().for_each(|v| *v *= factor);
    }
    v
}

/// Uniform in [0, 1), 53 bits.
fn uniform(random: &mut Pcg64Mcg) -> f64 {
    (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}
