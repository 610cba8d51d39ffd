//! Each method, timed and compared with the stiffness of the frozen network.

use crate::cpu_time::timed;
use crate::numbers::{between, mean, rms};
use crate::row::{Family, Row};
use clap::ValueEnum;
use grainlab_acoustics::time_of_flight::{self, ArrivalPick};
use grainlab_acoustics::{
    AcousticsError, Measurement, MethodSettings, Settings, Survey, dispersion, measure,
};
use grainlab_console::Failure;
use grainlab_core::{Packing, Stiffness};
use grainlab_emt::{Conditions, Measured, Modulus, christoffel};
use grainlab_node_kit::Exit;
use grainlab_page::median;

/// Half the width of a 95 % interval, standard deviations.
pub(super) const INTERVAL: f64 = 1.96;

/// Methods and values to measure.
#[derive(Debug, Default, clap::Args)]
pub(crate) struct Plan {
    /// Methods [default: all]
    #[arg(long, value_enum, value_name = "METHOD", value_delimiter = ',')]
    pub(crate) method: Vec<Method>,
    /// Rays: three (9 speeds) or complete (27)
    #[arg(long, value_enum, default_value_t)]
    pub(crate) survey: Rays,
    /// Tolerances of the squared frequencies of a dispersion
    #[arg(long, value_name = "REL", value_delimiter = ',', default_value = "1e-2,1e-4,1e-6,1e-8", value_parser = |text: &str| between(text, 1e-12, 1e-2))]
    pub(crate) tolerances: Vec<f64>,
    /// Measurements of each dispersion; the other methods, which take far longer, are measured once
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) repetitions: u32,
}

/// A set of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Rays {
    /// Along the axis, across it, and between.
    #[default]
    Three,
    /// With all azimuths for a transversely isotropic average.
    Complete,
}

impl From<Rays> for Survey {
    fn from(rays: Rays) -> Self {
        match rays {
            Rays::Three => Survey::Minimal,
            Rays::Complete => Survey::AzimuthalAverage,
        }
    }
}

/// A method of measuring speeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum Method {
    /// Modes of the frozen network.
    Dispersion,
    /// Onset of a burst.
    FirstArrival,
    /// Delay of largest correlation of a burst.
    CrossCorrelation,
    /// Delay of the peak of a burst.
    Peak,
}

/// One row per method and value, for all packings together.
pub(crate) fn rows(packings: &[Packing], plan: &Plan) -> Result<Vec<Row>, Failure> {
    let networks = packings.iter().map(stiffness).collect::<Result<Vec<_>, _>>()?;
    let methods = if plan.method.is_empty() { Method::value_variants() } else { &plan.method };
    let mut rows = Vec::new();
    for method in methods {
        for (value, way) in ways(*method, plan) {
            let settings = Settings { method: way, survey: plan.survey.into(), ..Settings::default() };
            let repetitions = if *method == Method::Dispersion { plan.repetitions } else { 1 };
            let (mut times, mut errors, mut failures) = (Vec::new(), Errors::default(), Vec::new());
            for (packing, network) in packings.iter().zip(&networks) {
                let (seconds, found) = timed(repetitions, || measure(packing, &settings))?;
                times.push(seconds);
                match found {
                    Ok(found) => {
                        errors.add(&found, network, packing);
                        failures.extend(found.notes.iter().map(ToString::to_string));
                    }
                    Err(reason @ AcousticsError::Setting { .. }) => return Err(Failure::usage(reason)),
                    Err(reason) => failures.push(format!("step {}: {reason}", packing.step)),
                }
            }
            failures.dedup();
            let name = method.to_possible_value().map(|v| v.get_name().replace('_', " "));
            let reference = "frozen network, the same directions and polarizations";
            rows.push(Row {
                grains: packings.first().map(Packing::grains),
                failure: (!failures.is_empty()).then(|| failures.join("; ")),
                details: errors.details(),
                ..Row::new(
                    Family::Waves,
                    (name.unwrap_or_default(), value),
                    (median(times), repetitions as usize),
                    (Some(rms(&errors.found)).filter(|e| e.is_finite()), reference),
                )
            });
        }
    }
    Ok(rows)
}

/// The stiffness of the frozen network.
fn stiffness(packing: &Packing) -> Result<Stiffness, Failure> {
    let invalid = |e: &dyn std::fmt::Display| Failure::new(Exit::PhysicsInvalid, e.to_string());
    let analysis = grainlab_micromechanics::analyze(packing, &Default::default()).map_err(|e| invalid(&e))?;
    Ok(analysis.report.elasticity.map_err(|e| invalid(&e))?.tensor)
}

fn ways(method: Method, plan: &Plan) -> Vec<(String, MethodSettings)> {
    let flight = |pick| {
        let settings = time_of_flight::Settings { pick, ..time_of_flight::Settings::default() };
        vec![(String::new(), MethodSettings::TimeOfFlight(settings))]
    };
    match method {
        Method::Dispersion => (plan.tolerances.iter())
            .map(|tolerance| {
                let settings = dispersion::Settings { tolerance: *tolerance, ..Default::default() };
                (format!("{tolerance:e}"), MethodSettings::Dispersion(settings))
            })
            .collect(),
        Method::FirstArrival => flight(ArrivalPick::FirstArrival),
        Method::CrossCorrelation => flight(ArrivalPick::CrossCorrelation),
        Method::Peak => flight(ArrivalPick::Peak),
    }
}

/// Errors of all speeds by one method.
#[derive(Debug, Default)]
struct Errors {
    /// Errors of ρ v², relative, with the standard deviations stated.
    found: Vec<f64>,
    stated: Vec<f64>,
    /// Standard deviations stated of the speeds, relative, and errors of the speeds in units of them.
    speed_stated: Vec<f64>,
    sigmas: Vec<f64>,
    /// Largest of a modulus; `None` if one is undetermined.
    moduli: Vec<Option<f64>>,
}

impl Errors {
    fn add(&mut self, measurement: &Measurement, network: &Stiffness, packing: &Packing) {
        let density = measurement.density;
        for measured in &measurement.waves {
            let wave = &measured.wave;
            let expected = wave.polarization.dot(&(network.christoffel(&wave.direction) * wave.polarization));
            self.found.push(density * wave.speed.powi(2) / expected - 1.0);
            let stated = wave.stddev.unwrap_or(f64::NAN) / wave.speed;
            self.stated.push((2.0 * stated).hypot(measurement.density_stddev / density));
            let expected = measurement.effective_density.speed(network, &wave.direction, &wave.polarization);
            if wave.stddev.is_some() {
                self.speed_stated.push(stated);
                self.sigmas.push((wave.speed / expected - 1.0) / stated);
            }
        }
        self.moduli.push(moduli(measurement, network, packing));
    }

    fn details(&self) -> std::collections::BTreeMap<&'static str, f64> {
        let covered = self.sigmas.iter().filter(|s| s.abs() <= INTERVAL).count();
        let moduli = self.moduli.iter().copied().collect::<Option<Vec<f64>>>();
        let moduli = moduli.unwrap_or_default().into_iter().reduce(f64::max).unwrap_or(f64::NAN);
        let all = [
            ("speeds", self.found.len() as f64),
            ("stated", rms(&self.stated)),
            ("speed_stated", median(self.speed_stated.clone())),
            ("covered", covered as f64 / self.sigmas.len() as f64),
            ("sigmas_rms", rms(&self.sigmas)),
            ("sigmas_mean", mean(&self.sigmas)),
            ("sigmas_worst", self.sigmas.iter().fold(f64::NAN, |most, s| most.max(s.abs()))),
            ("moduli", moduli),
        ];
        all.into_iter().filter(|(_, value)| value.is_finite()).collect()
    }
}

/// Largest relative error of C33, C11, C44, C66 and C13 by Christoffel; `None` if one of them is undetermined.
fn moduli(measurement: &Measurement, stiffness: &Stiffness, packing: &Packing) -> Option<f64> {
    let speeds: Vec<_> = measurement.waves.iter().map(|w| w.wave).collect();
    let density = Measured { value: measurement.density, stddev: measurement.density_stddev };
    let conditions = Conditions::at(grainlab_core::stress::stress(packing).tensor.mean().max(0.0));
    let fitted = christoffel::moduli_from_speeds(&speeds, density, measurement.axis, conditions).ok()?;
    let t = stiffness.transverse_isotropy();
    [
        (Modulus::C33, t.c33),
        (Modulus::C11, t.c11),
        (Modulus::G13, t.g13),
        (Modulus::G12, t.g12),
        (Modulus::C13, t.c13),
    ]
    .iter()
    .map(|(modulus, expected)| Some((fitted.observation.moduli.get(*modulus)? / expected - 1.0).abs()))
    .try_fold(0.0, |most: f64, error| Some(most.max(error?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_within_two_sigma_and_the_worst_speed_are_counted() {
        let errors = Errors { sigmas: vec![1.0, -2.0, 0.0, 5.0], ..Errors::default() };
        let details = errors.details();
        assert_eq!((details["covered"], details["sigmas_worst"], details["sigmas_mean"]), (0.5, 5.0, 1.0));
        assert!((details["sigmas_rms"] - 7.5f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_method_without_speeds_has_no_numbers() {
        assert_eq!(Errors::default().details().into_iter().collect::<Vec<_>>(), [("speeds", 0.0)]);
    }
}
