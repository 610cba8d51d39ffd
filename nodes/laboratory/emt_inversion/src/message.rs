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
    /// One estimate per model, in the order of [`Settings::models`], or none for data that say why they have nothing to invert; header,
    /// name and step are those of the data.
    pub message: msg::Microstructure,
    /// Why the data were refused; every estimate is then unknown, with this reason.
    pub refused: Option<BoundaryError>,
}

/// Returns the microstructure inferred from the report of a packing; without estimates if the packing has no stiffness. The result
/// depends only on the two arguments.
pub fn microstructure_of_report(report: &msg::PackingReport, settings: &Settings) -> Answer {
    let datum =
        Datum { header: &report.header, name: "", step: report.source_step, topic: &topics::PACKING_REPORT };
    let observed = match PackingReport::try_from(report) {
        Ok(read) => of_report(&read, settings).map(Ok),
        Err(_) if report.stiffness.is_empty() => None,
        Err(refused) => Some(Err(refused)),
    };
    observed.map_or_else(|| datum.nothing(), |observed| datum.answer(observed, settings))
}

/// Returns the microstructure inferred from one set of moduli.
pub fn microstructure_of_moduli(moduli: &msg::Moduli, settings: &Settings) -> Answer {
    let (header, name, step) = (&moduli.header, &moduli.name, moduli.source_step);
    let observed = ModuliReading::try_from(moduli).map(|reading| of_moduli(&reading, settings));
    Datum { header, name, step, topic: &topics::MODULI }.answer(observed, settings)
}

/// Returns the microstructure inferred from one set of wave speeds; without estimates if the set has notes in place of speeds.
pub fn microstructure_of_speeds(speeds: &msg::WaveSpeeds, settings: &Settings) -> Answer {
    let (header, name, step) = (&speeds.header, &speeds.name, speeds.source_step);
    let datum = Datum { header, name, step, topic: &topics::WAVE_SPEEDS };
    match WaveSpeedsReading::try_from(speeds) {
        Ok(reading) if reading.is_declined() => datum.nothing(),
        reading => datum.answer(reading.map(|reading| of_speeds(&reading, settings)), settings),
    }
}

/// What an answer copies from its data.
struct Datum<'a> {
    header: &'a Header,
    name: &'a str,
    step: u64,
    topic: &'a Topic,
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

impl Datum<'_> {
    fn message(&self, estimates: Vec<msg::Estimate>) -> msg::Microstructure {
        msg::Microstructure {
            header: self.header.clone(),
            name: self.name.to_owned(),
            source_step: self.step,
            // The name in the contract, not the resolved one: the bytes must not depend on a namespace or a remap.
            source: self.topic.name.to_owned(),
            estimates,
        }
    }

    /// The answer to data without a value to invert.
    fn nothing(&self) -> Answer {
        Answer { message: self.message(Vec::new()), refused: None }
    }

    fn answer(
        &self,
        observed: Result<Result<Observed, Unobservable>, BoundaryError>,
        settings: &Settings,
    ) -> Answer {
        let (observed, refused) = match observed {
            Ok(observed) => (observed, None),
            Err(error) => (Err(Unobservable::Refused(error.clone())), Some(error)),
        };
        let is_free = observed.as_ref().map_or(is_of_waves(self.topic), |o| has_free_contacts(o, self.topic));
        let applies = |model: &&'static dyn Model| {
            !settings.chooses || is_free || *model != grainlab_emt::free_contact()
        };
        let estimates = settings.models.iter().copied().filter(applies).map(|model| {
            let own = || model.default_calibration();
            let calibration = settings.calibration.as_ref().unwrap_or_else(own);
            let without = |gamma: StrainRatio, reason: Note| Estimate {
                gamma: model
                    .uses_gamma()
                    .then(|| GammaUsed { value: gamma.value, source: gamma.source.name() }),
                ..Estimate::unknown(model.name(), calibration.name(), vec![reason])
            };
            let observed = match &observed {
                Ok(observed) => observed,
                Err(nothing) => {
                    return estimate_message(&without(
                        StrainRatio::ZERO,
                        Note::no_answer(nothing.to_string()),
                    ));
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
        Answer { message: self.message(estimates.collect()), refused }
    }
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
