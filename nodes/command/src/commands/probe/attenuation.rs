//! Flags of the attenuation, which the message `WaveSpeeds` has no place for.

use grainlab_acoustics::dispersion::AttenuationSettings;
use grainlab_console::Failure;

/// Whether attenuation is computed, and of which waves.
#[derive(Debug, clap::Args)]
#[group(skip)]
#[command(next_help_heading = "Attenuation, in the frozen contact network")]
pub(super) struct Args {
    /// Also compute 1/Q of each ray and mode against frequency: by the dashpots of the contacts and, separately, by
    /// scattering from disorder
    #[arg(long)]
    attenuation: bool,
    /// Contact damping, share of critical, 0 to 1; that of the scenes is 0.3 [default: 0.3]
    #[arg(long, value_name = "NUMBER", requires = "attenuation")]
    contact_damping: Option<f64>,
    /// Wavelengths, mean grain diameters, each above 2. Dashpots are evaluated from 30 on, scattering where the packing is
    /// large enough [default: 160,80,40,20,14,10,7]
    #[arg(long, value_name = "NUMBER,...", value_delimiter = ',', requires = "attenuation")]
    attenuation_wavelengths: Option<Vec<f64>>,
}

impl Args {
    /// The settings, if attenuation is asked for.
    pub(super) fn settings(&self) -> Result<Option<AttenuationSettings>, Failure> {
        let d = AttenuationSettings::default();
        let settings = AttenuationSettings {
            wavelengths: self.attenuation_wavelengths.clone().unwrap_or(d.wavelengths),
            damping: self.contact_damping.unwrap_or(d.damping),
        };
        settings.validated().map_err(Failure::usage)?;
        Ok(self.attenuation.then_some(settings))
    }
}
