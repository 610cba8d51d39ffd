//! Attenuation along the rays of a measurement.

use crate::dispersion::{self, Attenuation, AttenuationSettings};
use crate::error::AcousticsError;
use crate::settings::Settings;
use crate::survey::Survey;
use grainlab_core::{Packing, Vec3};

/// Attenuation of every polarization along every ray that [`crate::measure`](fn@crate::measure) sends by dispersion with
/// these settings, in the frozen network for every method. See [`dispersion::attenuation`].
pub fn measure_attenuation(
    packing: &Packing,
    settings: &Settings,
    attenuation: &AttenuationSettings,
) -> Result<Vec<Attenuation>, AcousticsError> {
    settings.check()?;
    let survey = if settings.axis.is_some() { settings.survey } else { Survey::Hemisphere };
    let about = settings.axis.map_or_else(Vec3::z, |axis| axis.normalize());
    dispersion::attenuation(packing, &survey.rays(&about, settings.modes), attenuation)
}
