//! Slabs of grains across a path: sources and receivers.

use crate::supercell::Supercell;
use grainlab_core::Vec3;
use std::f64::consts::FRAC_PI_2;

/// Grains of a slab with the weights cos² across it, which are continuous when a grain enters or leaves.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Slab {
    /// Grains with mass times weight, normalised to a sum of 1.
    shares: Vec<(usize, f64)>,
    /// Weight of each, 1 in the middle.
    weights: Vec<f64>,
    /// Mean position relative to the middle, m.
    pub(crate) offset: f64,
}

impl Slab {
    /// The grains near the position `middle` of the path that are `present`, without rattlers. `thickness` is
    /// the full width at half maximum of the weights, m. `None` if there is no such grain.
    pub(crate) fn new(supercell: &Supercell, present: &[bool], middle: f64, thickness: f64) -> Option<Self> {
        let path = supercell.path;
        let packing = &supercell.packing;
        let (mut shares, mut weights, mut total, mut offset) = (Vec::new(), Vec::new(), 0.0, 0.0);
        for (grain, along) in supercell.along.iter().enumerate() {
            // The nearest periodic image.
            let from = (along - middle + 0.5 * path).rem_euclid(path) - 0.5 * path;
            if from.abs() < thickness && present[grain % present.len()] {
                let weight = (FRAC_PI_2 * from / thickness).cos().powi(2);
                let share = weight * packing.material.sphere_mass(packing.radii[grain]);
                shares.push((grain, share));
                weights.push(weight);
                total += share;
                offset += share * from;
            }
        }
        if total.is_nan() || total <= 0.0 {
            return None;
        }
        shares.iter_mut().for_each(|(_, share)| *share /= total);
        Some(Self { shares, weights, offset: offset / total })
    }

    /// Mean velocity along `motion`, weighted by mass, m/s.
    pub(crate) fn velocity(&self, velocities: &[Vec3], polarization: &Vec3) -> f64 {
        self.shares.iter().map(|(grain, share)| share * velocities[*grain].dot(polarization)).sum()
    }

    /// A change of velocity for each grain: `by` in the middle.
    pub(crate) fn kicks<'a>(&'a self, by: Vec3) -> impl Iterator<Item = (usize, Vec3)> + 'a {
        self.shares.iter().zip(&self.weights).map(move |((grain, _), weight)| (*grain, by * *weight))
    }
}
