//! What can be set.

use crate::calibration::CalibrationChoice;
use crate::models::Models;
use crate::settings_error::SettingsError;
use grainlab_core::Vec3;
use grainlab_emt::StrainRatioSource;
use grainlab_node_kit::{ParameterSpec, Parameters, Range};

/// The parameters of the node.
pub fn parameters() -> Vec<ParameterSpec> {
    let error = "relative one-sigma error of each modulus where the data bring none, 1; 0 leaves the uncertainty of the \
                 estimates unknown";
    vec![
        ParameterSpec::new("models", "all", "which models to ask: all, or names with commas between them"),
        ParameterSpec::new(
            "calibration",
            "default",
            "constants of the models: default (to each its own), or one for all of them: paper, grainlab, grainlab-z, or \
             a FILE.toml",
        ),
        ParameterSpec::new(
            "axis",
            "stated",
            "axis of symmetry: stated (the one that the moduli are about; of wave speeds e3), e3, found (the one that the data \
             name; of wave speeds that name none, the one that they tell), or a direction x,y,z of any length; moduli about \
             another axis than e3 are taken about that one alone, those about e3 are turned where the full stiffness is known",
        ),
        ParameterSpec::new(
            "gamma_over_delta",
            "total",
            "which measured strain ratio feeds the models; where it is not known, contact, else zero",
        )
        .within(Range::Choice(&["total", "elastic", "contact", "zero"])),
        ParameterSpec::new("modulus_error", Settings::default().modulus_error, error)
            .within(Range::Double { min: 0.0, max: 1.0 }),
    ]
}

/// The parameters, typed.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Which models are asked.
    pub models: Models,
    /// What constants they get.
    pub calibration: CalibrationChoice,
    /// The axis that moduli are taken about.
    pub axis: Axis,
    /// Which of the measured strain ratios γ/Δ feeds the models. The paper takes the total one, which is mostly plastic
    /// history; the one fitted to the contacts is what its Eq. 10 stands for.
    pub gamma: StrainRatioSource,
    /// Relative one-sigma error, independent for each modulus measured, taken where the data bring no error. 0 leaves the
    /// uncertainty of the estimates unknown.
    pub modulus_error: f64,
}

/// An axis of symmetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Axis {
    /// The one that the moduli are about; of wave speeds e3.
    Stated,
    /// That of the scene.
    E3,
    /// The one that comes with the data; of wave speeds that come with none, the one that they tell.
    Found,
    /// A unit vector in the frame of the cell.
    Given(Vec3),
}

/// One percent: what a good resonant or ultrasonic measurement of a modulus reaches, so that the one-sigma of an estimate
/// reads "if these moduli had come from an instrument".
impl Default for Settings {
    fn default() -> Self {
        Self {
            models: Models::all(),
            calibration: CalibrationChoice::Default,
            axis: Axis::Stated,
            gamma: StrainRatioSource::Total,
            modulus_error: 0.01,
        }
    }
}

impl Settings {
    /// The parameters, typed. `read` gives the text of a file, or why there is none: a `calibration` that ends in `.toml` is
    /// one.
    pub fn new(
        parameters: &Parameters,
        read: impl FnOnce(&str) -> Result<String, String>,
    ) -> Result<Self, SettingsError> {
        let text = |name| parameters.get::<String>(name);
        let mut calibration = text("calibration");
        if calibration.ends_with(".toml") {
            let read = read(&calibration);
            calibration =
                read.map_err(|reason| SettingsError::CalibrationFile { path: calibration, reason })?;
        }
        Ok(Self {
            models: Models::named(&text("models"))?,
            calibration: CalibrationChoice::named(&calibration)?,
            axis: axis(&text("axis"))?,
            gamma: match text("gamma_over_delta").as_str() {
                "elastic" => StrainRatioSource::Elastic,
                "contact" => StrainRatioSource::Contact,
                "zero" => StrainRatioSource::Zero,
                _ => StrainRatioSource::Total,
            },
            modulus_error: parameters.get("modulus_error"),
        })
    }
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
    // Scaled first: the square of a large component is no number any more.
    let unit = valid.map(|v| (v / v.amax()).normalize());
    unit.map(Axis::Given).ok_or_else(|| SettingsError::Axis(text.to_owned()))
}
