//! The parameters of the node.

use grainlab_core::Vec3;
use grainlab_emt::{Calibration, Model, Probe, StrainRatioSource};
use grainlab_node_kit::{ParameterSpec, Parameters, Range, parameters};

/// The parameters of the node.
pub fn parameters() -> Vec<ParameterSpec> {
    let error = "relative one-sigma error of each modulus if the data have none, 1; 0 leaves the uncertainty of the \
                 estimates unknown";
    parameters! {
        "models" "all", Range::Any,
            "models to apply: all, or comma-separated names; free-contact is applied if it is named, and of all to wave speeds \
             without a contact law and to contacts that are not Hertz-Mindlin contacts";
        "calibration" "default", Range::Any,
            "constants of the models: default (that of each model), or one for all models: paper, grainlab, or a FILE.toml";
        "axis" "stated", Range::Any,
            "axis of symmetry: stated (that of the moduli; for wave speeds e3), e3, found (that of the data; inferred from wave \
             speeds without a stated axis), or a direction x,y,z of any length; moduli about an axis other than e3 are used only \
             about that one, those about e3 are transformed if the full stiffness is known";
        "gamma_over_delta" "total", Range::Choice(&["total", "elastic", "contact", "zero"]),
            "measured strain ratio that the models use; if it is not known, contact, else zero";
        "probe" "unknown", Range::Choice(&["sticking", "unknown"]),
            "whether contacts slid while the Moduli received were measured: sticking if none did; unknown widens z, k and eps of \
             relaxed and free-contact. In packings and in wave speeds no contact slides";
        "modulus_error" Settings::default().modulus_error, Range::Double { min: 0.0, max: 1.0 }, error;
    }
}

/// A parameter of the right type with an invalid value, and why it is. The process then ends with
/// [`grainlab_node_kit::Exit::Usage`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("parameter \"{0}\": {1}")]
pub struct SettingsError(pub &'static str, pub String);

/// The values of the parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Models to apply, each once: [`grainlab_emt::free_contact`], then the others in the order of [`grainlab_emt::models`].
    pub models: Vec<&'static dyn Model>,
    /// True if `free-contact` is left to contacts that are not known, or of another law.
    pub chooses: bool,
    /// Constants of all models; `None`: those of each, [`Model::default_calibration`].
    pub calibration: Option<Calibration>,
    /// Axis of the moduli.
    pub axis: Axis,
    /// The measured strain ratio γ/Δ that the models use. The paper uses the total one, which is mostly
    /// plastic history; Eq. 10 of the paper refers to the one fitted to the contacts.
    pub gamma: StrainRatioSource,
    /// Whether contacts slid while the moduli of an instrument were measured.
    pub probe: Probe,
    /// Relative one-sigma error, independent for each measured modulus, if the data have no error. With 0 the
    /// uncertainty of the estimates is unknown.
    pub modulus_error: f64,
}

/// An axis of symmetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Axis {
    /// The axis of the moduli; for wave speeds e3.
    Stated,
    /// The axis of the scene.
    E3,
    /// The axis stated with the data; without one, the axis inferred from the wave speeds.
    Found,
    /// A unit vector in the frame of the cell.
    Given(Vec3),
}

/// One percent: the accuracy of a good resonant or ultrasonic measurement of a modulus, so that the
/// uncertainty of an estimate is that for a laboratory measurement.
impl Default for Settings {
    fn default() -> Self {
        Self {
            models: every_model(),
            chooses: true,
            calibration: None,
            axis: Axis::Stated,
            gamma: StrainRatioSource::Total,
            probe: Probe::Unknown,
            modulus_error: 0.01,
        }
    }
}

impl Settings {
    /// The values of the parameters. `read` returns the text of a file, or the reason of a failure; a
    /// `calibration` that ends in `.toml` is a file.
    pub fn new(
        parameters: &Parameters,
        read: impl FnOnce(&str) -> Result<String, String>,
    ) -> Result<Self, SettingsError> {
        let text = |name| parameters.get::<String>(name);
        let mut calibration = text("calibration");
        if calibration.ends_with(".toml") {
            let read = read(&calibration);
            calibration =
                read.map_err(|reason| SettingsError("calibration", format!("{calibration:?}: {reason}")))?;
        }
        Ok(Self {
            models: models(&text("models"))?,
            chooses: text("models").trim() == "all",
            calibration: constants(&calibration)?,
            axis: axis(&text("axis"))?,
            gamma: match text("gamma_over_delta").as_str() {
                "elastic" => StrainRatioSource::Elastic,
                "contact" => StrainRatioSource::Contact,
                "zero" => StrainRatioSource::Zero,
                _ => StrainRatioSource::Total,
            },
            probe: if text("probe") == Probe::Sticking.name() { Probe::Sticking } else { Probe::Unknown },
            modulus_error: parameters.get("modulus_error"),
        })
    }
}

/// The model of unknown contacts, and all others.
fn every_model() -> Vec<&'static dyn Model> {
    [grainlab_emt::free_contact()].into_iter().chain(grainlab_emt::models().iter().copied()).collect()
}

/// `all`, or comma-separated names in any order.
fn models(text: &str) -> Result<Vec<&'static dyn Model>, SettingsError> {
    let mut all = every_model();
    if text.trim() == "all" {
        return Ok(all);
    }
    let names: Vec<&str> = text.split(',').map(str::trim).collect();
    if let Some(stranger) = names.iter().find(|n| grainlab_emt::model(n).is_none()) {
        let known = all.iter().map(|m| m.name()).collect::<Vec<_>>().join(", ");
        return Err(SettingsError("models", format!("no model {stranger:?}; there are: {known}")));
    }
    all.retain(|m| names.contains(&m.name()));
    Ok(all)
}

/// `default`, the name of a built-in calibration, or the text of one (TOML).
fn constants(text: &str) -> Result<Option<Calibration>, SettingsError> {
    let name = text.trim();
    if name == "default" {
        return Ok(None);
    }
    if let Some(found) = Calibration::builtin(name) {
        return Ok(Some(found.clone()));
    }
    if !name.contains('=') {
        let known = ["default"].into_iter().chain(Calibration::BUILTIN).collect::<Vec<_>>().join(", ");
        let reason = format!("no calibration {name:?}; there are: {known}, or a FILE.toml");
        return Err(SettingsError("calibration", reason));
    }
    Calibration::parse(text).map(Some).map_err(|e| SettingsError("calibration", e.to_string()))
}

fn axis(text: &str) -> Result<Axis, SettingsError> {
    match text.trim() {
        "stated" => return Ok(Axis::Stated),
        "e3" => return Ok(Axis::E3),
        "found" => return Ok(Axis::Found),
        _ => {}
    }
    let numbers: Option<Vec<f64>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    let direction = numbers.and_then(|n| <[f64; 3]>::try_from(n).ok()).map(Vec3::from);
    let valid = direction.filter(|v| v.iter().all(|n| n.is_finite()) && v.amax() > 0.0);
    // Scaled first: the square of a large component overflows.
    let unit = valid.map(|v| (v / v.amax()).normalize());
    let choices = "stated, e3, found, or three numbers x,y,z that are finite and not all zero";
    unit.map(Axis::Given).ok_or_else(|| SettingsError("axis", format!("{text:?} is not an axis: {choices}")))
}
