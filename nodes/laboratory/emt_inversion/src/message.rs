//! From one message of data to one `Microstructure`.

use crate::moduli::{of_moduli, of_report};
use crate::observed::{Observed, Unobservable};
use crate::settings::Settings;
use crate::speeds::of_speeds;
use grainlab_core::contact::SpringLaw;
use grainlab_core::notes::{Code, Note, Status};
use grainlab_core::results::{Estimate, GammaUsed, PackingReport};
use grainlab_emt::{Inversion, Model, StrainRatio};
use grainlab_msgs::boundary::{BoundaryError, ModuliReading, WaveSpeedsReading, estimate_message};
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
        let without = |gamma: StrainRatio, reason: Note| Estimate {
            gamma: model.uses_gamma().then(|| GammaUsed { value: gamma.value, source: gamma.source.name() }),
            ..Estimate::unknown(model.name(), calibration.name(), vec![reason])
        };
        let observed = match &observed {
            Ok(observed) => observed,
            Err(nothing) => {
                return estimate_message(&without(StrainRatio::ZERO, Note::no_answer(nothing.to_string())));
            }
        };
        let mut estimate = match model.infer(&observed.observation, calibration) {
            Ok(inversion) => of_data_and_model(&inversion, observed),
            Err(error) => without(observed.observation.conditions.gamma, Note::from(&error)),
        };
        estimate.add_notes(&observed.notes);
        if is_free && *model != *grainlab_emt::free_contact() {
            // Hertz–Mindlin contacts are an assumption that the data do not test.
            estimate.raise(Code::ContactLawAssumed, Status::Extrapolated);
        }
        estimate_message(&estimate)
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

/// Returns the estimate of a model. The misfit of the data about the moduli and that of the moduli about the structure add up.
fn of_data_and_model(inversion: &Inversion, observed: &Observed) -> Estimate {
    let misfits = [observed.misfit, inversion.misfit].into_iter().flatten();
    let misfits: Vec<_> = misfits.filter(|misfit| misfit.degrees_of_freedom > 0).collect();
    Estimate {
        chi_square: Some(misfits.iter().fold(0.0, |sum, misfit| sum + misfit.chi_square)),
        degrees_of_freedom: Some(misfits.iter().map(|misfit| misfit.degrees_of_freedom).sum()),
        ..inversion.estimate()
    }
}
