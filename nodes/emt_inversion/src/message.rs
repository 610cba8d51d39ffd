//! From one message of data to one `Microstructure`.

use crate::estimate::{estimate_message, failure, unobserved};
use crate::moduli::of_moduli;
use crate::observed::{Observed, Unobservable};
use crate::settings::Settings;
use crate::speeds::of_speeds;
use grainlab_msgs::boundary::{BoundaryError, ModuliReading, WaveSpeedsReading};
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{Topic, msg, topics};

/// The microstructure inferred from one set of moduli: one estimate per model, in the order of
/// [`grainlab_emt::models`]. Header and step are copied. The result depends only on the two arguments.
/// Invalid moduli are refused.
pub fn microstructure_message(
    moduli: &msg::Moduli,
    settings: &Settings,
) -> Result<msg::Microstructure, BoundaryError> {
    let observed = of_moduli(&ModuliReading::try_from(moduli)?, settings);
    let of = About { header: &moduli.header, name: &moduli.name, source_step: moduli.source_step };
    Ok(microstructure(of, &topics::MODULI, &observed, settings))
}

/// The same for one set of wave speeds.
pub fn microstructure_of_speeds(
    speeds: &msg::WaveSpeeds,
    settings: &Settings,
) -> Result<msg::Microstructure, BoundaryError> {
    let observed = of_speeds(&WaveSpeedsReading::try_from(speeds)?, settings);
    let of = About { header: &speeds.header, name: &speeds.name, source_step: speeds.source_step };
    Ok(microstructure(of, &topics::WAVE_SPEEDS, &observed, settings))
}

/// What an answer copies from the data.
struct About<'a> {
    header: &'a Header,
    name: &'a str,
    source_step: u64,
}

fn microstructure(
    of: About<'_>,
    source: &Topic,
    observed: &Result<Observed, Unobservable>,
    settings: &Settings,
) -> msg::Microstructure {
    let estimates = settings.models.iter().map(|model| {
        let calibration = settings.calibration.calibration_for(model);
        let observed = match observed {
            Ok(observed) => observed,
            Err(nothing) => return unobserved(model, calibration.name(), nothing),
        };
        match model.infer(&observed.observation, calibration) {
            Ok(estimate) => estimate_message(&estimate, observed),
            Err(error) => failure(model, calibration.name(), observed, &error),
        }
    });
    msg::Microstructure {
        header: of.header.clone(),
        name: of.name.to_owned(),
        source_step: of.source_step,
        // The name in the contract, not the resolved one: the bytes must not depend on a namespace or a
        // remap.
        source: source.name.to_owned(),
        estimates: estimates.collect(),
    }
}
