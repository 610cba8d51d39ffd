//! Gaussian noise that depends on a seed and a place alone.

use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

pub(crate) fn seed_at(seed: u64, place: &[u64]) -> u64 {
    place.iter().fold(seed, |state, index| Pcg64Mcg::seed_from_u64(state ^ index).next_u64())
}

/// Independent normal numbers.
#[derive(Clone, Debug)]
pub(crate) struct Noise(Pcg64Mcg);

impl Noise {
    /// The numbers of `seed` at a place, such as (ray, polarization, shot), independent of the order in which places
    /// are visited.
    pub(crate) fn at(seed: u64, place: &[u64]) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed_at(seed, place)))
    }

    /// A number of mean 0 and standard deviation 1.
    pub(crate) fn next(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }
}
