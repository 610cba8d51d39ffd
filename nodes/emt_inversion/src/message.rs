//! From one message of data to one `Microstructure`.

use crate::calibration::calibration_for;
use crate::estimate::{estimate_message, failure, unobserved};
use crate::observation::{Unobservable, of_moduli};
use crate::settings::Settings;
use emt::Observation;
use grainlab_msgs::boundary::{BoundaryError, ModuliReading};
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{Topic, msg, topics};

/// What the models infer from one set of moduli: one estimate a model, in the order of [`emt::models`]. Header and step are
/// copied; nothing but the two arguments enters. Moduli that cannot be ones are refused.
pub fn microstructure_message(
    moduli: &msg::Moduli,
    settings: &Settings,
) -> Result<msg::Microstructure, BoundaryError> {
    let reading = ModuliReading::try_from(moduli)?;
    let observation = of_moduli(&reading, settings);
    Ok(microstructure(&moduli.header, moduli.source_step, &topics::MODULI, &observation, settings))
}

fn microstructure(
    header: &Header,
    source_step: u64,
    source: &Topic,
    observation: &Result<Observation, Unobservable>,
    settings: &Settings,
) -> msg::Microstructure {
    let estimates = settings.models.iter().map(|model| {
        let calibration = calibration_for(model, settings);
        let observation = match observation {
            Ok(observation) => observation,
            Err(nothing) => return unobserved(model, calibration.name(), nothing.to_string()),
        };
        match model.infer(observation, calibration) {
            Ok(estimate) => estimate_message(&estimate),
            Err(error) => failure(model, calibration.name(), observation.conditions.gamma, &error),
        }
    });
    msg::Microstructure {
        header: header.clone(),
        source_step,
        // The contract's name and not the resolved one: the bytes must not depend on a namespace.
        source: source.name.to_owned(),
        estimates: estimates.collect(),
    }
}
