//! From one message of data to one `Microstructure`.

use crate::estimate::{estimate_message, unknown};
use crate::moduli::{of_moduli, of_report};
use crate::observed::{Observed, Unobservable};
use crate::settings::Settings;
use crate::speeds::of_speeds;
use grainlab_core::contact::SpringLaw;
use grainlab_core::results::PackingReport;
use grainlab_emt::{Model, StrainRatio};
use grainlab_msgs::boundary::{BoundaryError, ModuliReading, WaveSpeedsReading};
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{Topic, msg, topics};

/// The answer to one set of data.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// One estimate per model, in the order of [`Settings::models`]; header, name and step are those of the data.
    pub message: msg::Microstructure,
    /// Why the data were refused; every estimate is then unknown, with this reason.
    pub refused: Option<BoundaryError>,
}

/// The microstructure inferred from the report of a packing; `None` without a stiffness, from which nothing is inferred. The result
/// depends only on the two arguments.
pub fn microstructure_of_report(report: &msg::PackingReport, settings: &Settings) -> Option<Answer> {
    let observed = match PackingReport::try_from(report) {
        Ok(report) => Ok(of_report(&report, settings)?),
        Err(_) if report.stiffness.is_empty() => return None,
        Err(refused) => Err(refused),
    };
    Some(answer(&report.header, "", report.source_step, &topics::PACKING_REPORT, observed, settings))
}

/// The microstructure inferred from one set of moduli.
pub fn microstructure_of_moduli(moduli: &msg::Moduli, settings: &Settings) -> Answer {
    let observed = ModuliReading::try_from(moduli).map(|reading| of_moduli(&reading, settings));
    answer(&moduli.header, &moduli.name, moduli.source_step, &topics::MODULI, observed, settings)
}

/// The microstructure inferred from one set of wave speeds.
pub fn microstructure_of_speeds(speeds: &msg::WaveSpeeds, settings: &Settings) -> Answer {
    let observed = WaveSpeedsReading::try_from(speeds).map(|reading| of_speeds(&reading, settings));
    answer(&speeds.header, &speeds.name, speeds.source_step, &topics::WAVE_SPEEDS, observed, settings)
}

fn is_of_waves(source: &Topic) -> bool {
    source.name == topics::WAVE_SPEEDS.name
}

/// True for wave speeds of contacts that nothing is known of, and for contacts of another law than Hertz–Mindlin.
fn has_free_contacts(observed: &Observed, source: &Topic) -> bool {
    match observed.observation.conditions.contact_law {
        None => is_of_waves(source),
        Some(law) => law.springs != SpringLaw::HertzMindlin,
    }
}

fn answer(
    header: &Header,
    name: &str,
    source_step: u64,
    source: &Topic,
    observed: Result<Result<Observed, Unobservable>, BoundaryError>,
    settings: &Settings,
) -> Answer {
    let (observed, refused) = match observed {
        Ok(observed) => (observed, None),
        Err(error) => (Err(Unobservable::Refused(error.clone())), Some(error)),
    };
    let is_free = observed.as_ref().map_or(is_of_waves(source), |o| has_free_contacts(o, source));
    let applies =
        |model: &&'static dyn Model| !settings.chooses || is_free || *model != grainlab_emt::free_contact();
    let estimates = settings.models.iter().copied().filter(applies).map(|model| {
        let own = || model.default_calibration();
        let calibration = settings.calibration.as_ref().unwrap_or_else(own);
        let without = |gamma: StrainRatio, reasons: Vec<String>| {
            unknown(model.name(), calibration.name(), model.uses_gamma().then_some(gamma), reasons)
        };
        let observed = match &observed {
            Ok(observed) => observed,
            Err(nothing) => return without(StrainRatio::ZERO, vec![nothing.to_string()]),
        };
        match model.infer(&observed.observation, calibration) {
            Ok(estimate) => {
                let mut message = estimate_message(&estimate, observed);
                let is_of_others = is_free && *model != *grainlab_emt::free_contact();
                if is_of_others && message.status == msg::Estimate::STATUS_OK {
                    // Hertz–Mindlin contacts are an assumption here.
                    message.status = msg::Estimate::STATUS_EXTRAPOLATED;
                }
                message
            }
            Err(error) => {
                let reasons = std::iter::once(error.to_string()).chain(observed.notes.iter().cloned());
                without(observed.observation.conditions.gamma, reasons.collect())
            }
        }
    });
    let message = msg::Microstructure {
        header: header.clone(),
        name: name.to_owned(),
        source_step,
        // The name in the contract, not the resolved one: the bytes must not depend on a namespace or a
        // remap.
        source: source.name.to_owned(),
        estimates: estimates.collect(),
    };
    Answer { message, refused }
}
