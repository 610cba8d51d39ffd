//! The moduli from wave speeds, with a given or an inferred axis.

use crate::christoffel::{self, AxisError, ChristoffelError, SpeedFit};
use crate::conditions::{Conditions, Measured};
use crate::moduli::Modulus;
use grainlab_core::{Vec3, WaveSpeed};

/// The moduli from wave speeds, and their axis.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveModuli {
    /// The given axis, else the one inferred from the speeds, else e3; unit.
    pub axis: Vec3,
    /// Why none was named and the speeds show none, so that it is e3.
    pub no_axis: Option<AxisError>,
    /// The moduli about it, or the reason why no medium has these speeds.
    pub fitted: Result<SpeedFit, ChristoffelError>,
}

impl WaveModuli {
    /// From the waves in a sample of this density, kg/m³, in the state `conditions`; `named` is the axis of
    /// symmetry, and `grains` the number of grains of the sample, if known.
    pub fn of_speeds(
        speeds: &[WaveSpeed],
        density: Measured,
        named: Option<Vec3>,
        conditions: Conditions,
        grains: Option<f64>,
    ) -> Self {
        let inferred = || christoffel::find_axis(speeds).map(|found| found.axis);
        let found = named.map_or_else(inferred, Ok);
        let axis = *found.as_ref().unwrap_or(&Vec3::z());
        let fitted = christoffel::moduli_of_sample(speeds, density, Some(axis), conditions, grains);
        Self { axis, no_axis: found.err(), fitted }
    }

    /// One of the moduli, Pa; `None` where the speeds do not determine it.
    pub fn modulus(&self, modulus: Modulus) -> Option<f64> {
        self.fitted.as_ref().ok()?.observation.moduli.get(modulus)
    }

    /// Standard deviation of a modulus, Pa; `None` also where the errors of the speeds are not known.
    pub fn stddev(&self, modulus: Modulus) -> Option<f64> {
        let observation = &self.fitted.as_ref().ok()?.observation;
        let (covariance, at) = (observation.covariance?, modulus as usize);
        observation.moduli.get(modulus).map(|_| covariance[(at, at)].max(0.0).sqrt())
    }
}
