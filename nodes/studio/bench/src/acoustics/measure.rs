//! Each method, timed and compared with the stiffness of the frozen network.

use super::args::{Args, Method};
use super::report::{Error, Row};
use crate::cpu_time::process_seconds;
use grainlab_acoustics::time_of_flight::{self, ArrivalPick};
use grainlab_acoustics::{
    AcousticsError, Measurement, MethodSettings, Settings, dispersion, measure, standing_wave,
};
use grainlab_console::Failure;
use grainlab_core::{Packing, Stiffness};
use grainlab_emt::{Conditions, Measured, Modulus, christoffel};
use grainlab_node_kit::Exit;
use std::time::Instant;

/// One row per method and value.
pub(super) fn rows(packing: &Packing, args: &Args) -> Result<Vec<Row>, Failure> {
    let stiffness = stiffness(packing)?;
    let mut rows = Vec::new();
    for method in args.methods() {
        for (value, way) in ways(*method, args) {
            let settings = Settings { method: way, survey: args.survey.into(), ..Settings::default() };
            rows.push(row(*method, value, packing, &settings, &stiffness)?);
        }
    }
    Ok(rows)
}

/// The stiffness of the frozen network.
pub(super) fn stiffness(packing: &Packing) -> Result<Stiffness, Failure> {
    let invalid = |e: &dyn std::fmt::Display| Failure::new(Exit::PhysicsInvalid, e.to_string());
    let analysis = grainlab_micromechanics::analyze(packing, &Default::default()).map_err(|e| invalid(&e))?;
    Ok(analysis.report.elasticity.map_err(|e| invalid(&e))?.tensor)
}

fn ways(method: Method, args: &Args) -> Vec<(Option<f64>, MethodSettings)> {
    let flight = |pick| {
        let settings = time_of_flight::Settings { pick, ..time_of_flight::Settings::default() };
        vec![(None, MethodSettings::TimeOfFlight(settings))]
    };
    match method {
        Method::Dispersion => (args.tolerances.iter())
            .map(|tolerance| {
                let settings = dispersion::Settings { tolerance: *tolerance, ..Default::default() };
                (Some(*tolerance), MethodSettings::Dispersion(settings))
            })
            .collect(),
        Method::StandingWave => (args.copies.iter())
            .map(|copies| {
                let settings = standing_wave::Settings { copies: *copies, ..Default::default() };
                (Some(f64::from(*copies)), MethodSettings::StandingWave(settings))
            })
            .collect(),
        Method::FirstArrival => flight(ArrivalPick::FirstArrival),
        Method::CrossCorrelation => flight(ArrivalPick::CrossCorrelation),
        Method::Peak => flight(ArrivalPick::Peak),
    }
}

fn row(
    method: Method,
    value: Option<f64>,
    packing: &Packing,
    settings: &Settings,
    stiffness: &Stiffness,
) -> Result<Row, Failure> {
    let (wall, cpu) = (Instant::now(), process_seconds()?);
    let outcome = measure(packing, settings);
    let seconds = process_seconds()? - cpu;
    let row = Row {
        method,
        value,
        grains: packing.grains(),
        speeds: 0,
        seconds,
        wall_seconds: wall.elapsed().as_secs_f64(),
        error: Error::default(),
        failure: None,
    };
    Ok(match outcome {
        Ok(measurement) => Row {
            speeds: measurement.waves.len(),
            error: error(&measurement, stiffness, packing),
            failure: (!measurement.warnings.is_empty()).then(|| listed(&measurement)),
            ..row
        },
        Err(reason @ AcousticsError::Setting { .. }) => return Err(Failure::usage(reason)),
        Err(reason) => Row { failure: Some(reason.to_string()), ..row },
    })
}

fn listed(measurement: &Measurement) -> String {
    measurement.warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

fn error(measurement: &Measurement, stiffness: &Stiffness, packing: &Packing) -> Error {
    let n = measurement.waves.len() as f64;
    let (mut sum, mut largest, mut stated, mut sigmas) = (0.0, 0.0f64, 0.0, 0.0f64);
    for measured in &measurement.waves {
        let (wave, density) = (&measured.wave, measurement.density);
        let expected = wave.polarization.dot(&(stiffness.christoffel(&wave.direction) * wave.polarization));
        let error = (density * wave.speed.powi(2) / expected - 1.0).abs();
        let of_speed = 2.0 * wave.stddev.unwrap_or(f64::NAN) / wave.speed;
        let sigma = of_speed.hypot(measurement.density_stddev / density);
        sum += error * error;
        largest = largest.max(error);
        stated += sigma * sigma;
        sigmas = sigmas.max(error / sigma);
    }
    Error {
        rms: Some((sum / n).sqrt()),
        largest: Some(largest),
        stated: Some((stated / n).sqrt()),
        worst_sigmas: Some(sigmas),
        moduli: moduli(measurement, stiffness, packing),
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
