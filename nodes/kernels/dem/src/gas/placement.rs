//! Random placement of grains, with thermal velocities.

use crate::error::DemError;
use grainlab_core::{Cell, Vec3};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Randomly placed grains without overlap, in a cubic cell.
#[derive(Clone, Debug)]
pub struct Gas {
    /// The cell.
    pub cell: Cell,
    /// Centres, m.
    pub positions: Vec<Vec3>,
    /// Velocities with zero sum, m/s.
    pub velocities: Vec<Vec3>,
}

/// Attempts to place one grain before an error. At a solid fraction of 0.35 some tens of thousands may be needed.
const ATTEMPTS: u32 = 200_000;

/// Places `grains` spheres of `diameter` (m) one after the other at random without overlap, which is possible up to a solid
/// fraction of about 0.38, and gives them random velocities of root mean square `speed` (m/s).
pub fn random_sequential_addition(
    grains: u32,
    diameter: f64,
    solid_fraction: f64,
    speed: f64,
    seed: u64,
) -> Result<Gas, DemError> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let volume = f64::from(grains) * std::f64::consts::PI / 6.0 * diameter.powi(3) / solid_fraction;
    let edge = volume.cbrt();
    let degenerate = DemError::Placement { placed: 0, grains, solid_fraction };
    let cell = Cell::cube(edge).ok_or(degenerate)?;
    let positions = place(grains, diameter, edge, &mut random).map_err(|placed| DemError::Placement {
        placed,
        grains,
        solid_fraction,
    })?;
    Ok(Gas { cell, positions, velocities: thermal(grains as usize, speed, &mut random) })
}

fn place(grains: u32, diameter: f64, edge: f64, random: &mut Pcg64Mcg) -> Result<Vec<Vec3>, u32> {
    // The diagonal of a bin is a diameter, so a bin holds at most one centre.
    let bins = ((edge / diameter * 3f64.sqrt()).ceil() as usize).max(1);
    let width = edge / bins as f64;
    let span = (diameter / width).ceil() as isize;
    let mut bin = vec![u32::MAX; bins.pow(3)];
    let mut placed: Vec<Vec3> = Vec::with_capacity(grains as usize);
    let fold = |d: f64| d - edge * (d / edge).round();
    for count in 0..grains {
        let mut found = false;
        for _ in 0..ATTEMPTS {
            let x = Vec3::from_fn(|_, _| uniform(random) * edge);
            let own_bin: [isize; 3] =
                std::array::from_fn(|k| ((x[k] / width) as isize).min(bins as isize - 1));
            let mut free = diameter <= edge;
            'search: for a in -span..=span {
                for b in -span..=span {
                    for c in -span..=span {
                        let at = [own_bin[0] + a, own_bin[1] + b, own_bin[2] + c]
                            .map(|t| t.rem_euclid(bins as isize) as usize);
                        let other = bin[(at[0] * bins + at[1]) * bins + at[2]];
                        if other != u32::MAX
                            && (placed[other as usize] - x).map(fold).norm_squared() < diameter * diameter
                        {
                            free = false;
                            break 'search;
                        }
                    }
                }
            }
            if free {
                let at = own_bin.map(|h| h as usize);
                bin[(at[0] * bins + at[1]) * bins + at[2]] = count;
                placed.push(x);
                found = true;
                break;
            }
        }
        if !found {
            return Err(count);
        }
    }
    Ok(placed)
}

/// Velocities of root mean square `speed` with zero sum.
///
/// Each component is a sum of twelve uniform numbers, which is nearly normal. It needs no logarithm, which differs between
/// platforms, so the same seed gives the same bits everywhere. Collisions make the distribution normal.
fn thermal(grains: usize, speed: f64, random: &mut Pcg64Mcg) -> Vec<Vec3> {
    let mut v: Vec<Vec3> = (0..grains)
        .map(|_| Vec3::from_fn(|_, _| (0..12).map(|_| uniform(random)).sum::<f64>() - 6.0))
        .collect();
    let mean = v.iter().sum::<Vec3>() / grains as f64;
    v.iter_mut().for_each(|v| *v -= mean);
    let square = v.iter().map(Vec3::norm_squared).sum::<f64>() / grains as f64;
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
