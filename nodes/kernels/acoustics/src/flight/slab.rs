//! Slabs of grains across a path: sources and receivers.

use crate::repeat::Repeated;
use grainlab_core::Vec3;
use std::f64::consts::FRAC_PI_2;

/// Grains of a slab with smooth weights: cos² across it, so that it does not jump when a grain is moved in or out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Slab {
    /// Grain, and its share of 1: mass times weight.
    shares: Vec<(usize, f64)>,
    /// Weight of each, 1 in the middle.
    weights: Vec<f64>,
    /// Mean place of the shares from the middle, m.
    pub(crate) offset: f64,
}

impl Slab {
    /// The grains around the place `middle` of the path that are `present`, rattlers left out; `thickness` is the full width at
    /// half of the greatest weight, m. `None` if there is no such grain.
    pub(crate) fn new(repeated: &Repeated, present: &[bool], middle: f64, thickness: f64) -> Option<Self> {
        let path = repeated.path;
        let packing = &repeated.packing;
        let (mut shares, mut weights, mut total, mut offset) = (Vec::new(), Vec::new(), 0.0, 0.0);
        for (grain, along) in repeated.along.iter().enumerate() {
            // The shorter way around.
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
    pub(crate) fn velocity(&self, velocities: &[Vec3], motion: &Vec3) -> f64 {
        self.shares.iter().map(|(grain, share)| share * velocities[*grain].dot(motion)).sum()
    }

    /// A change of velocity for each grain: `by` in the middle.
    pub(crate) fn kicks<'a>(&'a self, by: Vec3) -> impl Iterator<Item = (usize, Vec3)> + 'a {
        self.shares.iter().zip(&self.weights).map(move |((grain, _), weight)| (*grain, by * *weight))
    }
}
