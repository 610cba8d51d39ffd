//! Microstructure inferred from noisy speeds and from the moduli of the analyzer, both by the inversion of
//! the node.

use super::measure::{INTERVAL, Rays};
use crate::cpu_time::timed;
use crate::numbers::{mean, rms};
use crate::row::{Family, Row};
use grainlab_acoustics::{Measurement, with_speed_noise};
use grainlab_console::Failure;
use grainlab_core::Packing;
use grainlab_core::results::{InferredQuantity, PackingReport};
use grainlab_msgs::boundary::packing_report_message;
use grainlab_node_kit::Exit;
use rayon::prelude::*;

/// The model of the inversion: it needs no γ/Δ and includes the scatter between packings.
const MODEL: &str = "relaxed";

const QUANTITIES: [(Family, InferredQuantity); 2] =
    [(Family::InversionEps, InferredQuantity::Eps), (Family::InversionZ, InferredQuantity::Z)];

/// Inferred less counted, also in units of the standard deviation, for each of the [`QUANTITIES`].
type Errors = [Option<(f64, f64)>; QUANTITIES.len()];

/// Two rows from the moduli, then two for each level of noise.
pub(super) fn rows(packings: &[Packing], rays: Rays, noise: &[f64], draws: u32) -> Result<Vec<Row>, Failure> {
    let all = || {
        packings.iter().map(|packing| one(packing, rays, noise, draws)).collect::<Result<Vec<_>, Failure>>()
    };
    let (seconds, measured) = timed(1, all)?;
    let (measured, n) = (measured?, packings.len());
    let row = |level: usize, which: usize| {
        let known: Vec<(f64, f64)> =
            measured.iter().flat_map(|m| &m[level]).filter_map(|e| e[which]).collect();
        let errors: Vec<f64> = known.iter().map(|e| e.0).collect();
        let (data, setting) = match level.checked_sub(1) {
            None => ("moduli", String::new()),
            Some(level) => ("speeds", format!("noise {}", noise[level])),
        };
        let covered = known.iter().filter(|e| e.1.abs() <= INTERVAL).count() as f64 / known.len() as f64;
        let reference = "counted in the same packings";
        let error = (Some(rms(&errors)).filter(|e| e.is_finite()), reference);
        let names = (format!("{MODEL}, from {data}"), setting);
        let mut row = Row::new(QUANTITIES[which].0, names, (seconds / n as f64, n), error);
        row.time_of = "all levels of noise of one packing, its speeds included";
        let details = [("bias", mean(&errors)), ("covered", covered), ("inferred", known.len() as f64)];
        row.details.extend(details.into_iter().filter(|(_, value)| value.is_finite()));
        row
    };
    let levels = |which| (0..=noise.len()).map(move |level| (level, which));
    Ok((0..QUANTITIES.len()).flat_map(levels).map(|(level, which)| row(level, which)).collect())
}

/// For one packing: the errors from the moduli of the analyzer, then those of every draw of every level.
fn one(packing: &Packing, rays: Rays, levels: &[f64], most: u32) -> Result<Vec<Vec<Errors>>, Failure> {
    let invalid = |e: &dyn std::fmt::Display| Failure::new(Exit::PhysicsInvalid, e.to_string());
    let settings = grainlab_acoustics::Settings { survey: rays.into(), ..Default::default() };
    let measurement = grainlab_acoustics::measure(packing, &settings).map_err(|e| invalid(&e))?;
    let truth =
        grainlab_micromechanics::analyze(packing, &Default::default()).map_err(|e| invalid(&e))?.report;
    let header = Default::default();
    let report = packing_report_message(Default::default(), &truth).map_err(|e| invalid(&e))?;
    let models = Vec::from_iter(grainlab_emt::model(MODEL));
    let inversion = grainlab_emt_inversion::Settings { models, ..Default::default() };
    let by_moduli = grainlab_emt_inversion::microstructure_of_report(&report, &inversion);
    if by_moduli.message.estimates.is_empty() {
        return Err(invalid(&"the packing has no stiffness"));
    }
    let mut errors = vec![vec![compared(by_moduli, &truth)?]];
    for noise in levels {
        let draws = if *noise > 0.0 { most } else { 1 };
        let draw = |seed: u32| {
            // Each packing has different draws.
            let seed = packing.step.wrapping_mul(u64::from(most) + 1).wrapping_add(seed.into());
            let waves = with_speed_noise(&measurement.waves, *noise, seed);
            let noisy = Measurement { waves, ..measurement.clone() };
            let sent =
                grainlab_acoustic_probe::messages(&header, packing, &noisy).map_err(|e| invalid(&e))?;
            compared(grainlab_emt_inversion::microstructure_of_speeds(&sent.wave_speeds, &inversion), &truth)
        };
        errors.push((1..=draws).into_par_iter().map(draw).collect::<Result<_, Failure>>()?);
    }
    Ok(errors)
}

fn compared(answer: grainlab_emt_inversion::Answer, truth: &PackingReport) -> Result<Errors, Failure> {
    if let Some(why) = answer.refused {
        return Err(Failure::new(Exit::PhysicsInvalid, why.to_string()));
    }
    let inferred = answer.message.results().ok().and_then(|all| all.into_iter().next());
    let of = |(_, quantity): (Family, InferredQuantity)| {
        let inferred = inferred.as_ref()?;
        let error = inferred.values[quantity]? - truth.counted(quantity)?;
        Some((error, error / inferred.sigma(quantity)?))
    };
    Ok(QUANTITIES.map(of))
}
