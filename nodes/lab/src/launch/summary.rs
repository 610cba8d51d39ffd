//! What a run found, read back from its recording: the content of `summary.json`.

use super::supervise::Fate;
use crate::failure::Failure;
use crate::results::inference::{Inference, Interval, Triple};
use crate::results::state::State;
use grainlab_msgs::boundary::{EstimateReading, EstimateStatus, MicrostructureReading};
use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::{Message, Topic, from_cdr, msg, topics};
use grains::{Fabric, Moduli, Packing};
use node_kit::Report;
use recordings::{Recording, Selection, TopicTally};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// The whole of `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Summary {
    pub(crate) scene: String,
    pub(crate) seed: u64,
    pub(crate) wall_seconds: f64,
    pub(crate) nodes: Vec<Fate>,
    pub(crate) topics: Vec<TopicTally>,
    pub(crate) exchanges: Option<u64>,
    pub(crate) exchanges_per_second: Option<f64>,
    /// Share of the simulator's time between first and last exchange spent waiting for answers.
    pub(crate) waiting_fraction: Option<f64>,
    pub(crate) particle_steps_per_second: Option<f64>,
    pub(crate) states: Vec<Measured>,
    pub(crate) recording: String,
    pub(crate) exit: u8,
}

/// One packing: what was measured on it, and what was inferred from its stiffness.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Measured {
    #[serde(flatten)]
    pub(crate) state: State,
    pub(crate) results: Vec<Inference>,
}

/// What the recording says beside the states.
pub(crate) struct Contents {
    pub(crate) states: Vec<Measured>,
    pub(crate) topics: Vec<TopicTally>,
    /// Last values of the simulator's health, by name.
    pub(crate) simulator: BTreeMap<String, f64>,
    /// What could not be read.
    pub(crate) warnings: Vec<String>,
}

/// Reads a recording back.
pub(crate) fn read(run: &Path) -> Result<Contents, Failure> {
    let recording = Recording::open(run).map_err(Failure::failure)?;
    let mut warnings = Vec::new();
    let fabrics = by_step::<msg::Fabric, Fabric>(&recording, &topics::FABRIC, |m| m.source_step, &mut warnings)?;
    let moduli = by_step::<msg::Moduli, Moduli>(&recording, &topics::MODULI, |m| m.source_step, &mut warnings)?;
    let inferred = by_step::<msg::Microstructure, MicrostructureReading>(
        &recording,
        &topics::MICROSTRUCTURE,
        |m| m.source_step,
        &mut warnings,
    )?;
    let packings = by_step::<msg::Packing, Packing>(&recording, &topics::PACKING, |m| m.step, &mut warnings)?;
    let mut states = Vec::new();
    for (step, packing) in &packings {
        let Some(fabric) = fabrics.get(step) else {
            warnings.push(format!("the packing at step {step} was not measured"));
            continue;
        };
        let mut state = State::new(run.display().to_string(), packing, fabric, moduli.get(step));
        if state.stiffness_pa.is_none() {
            state.warnings.push("no stiffness was published: the packing has no contact network".into());
        }
        let results = inferred.get(step).map_or_else(Vec::new, |m| m.estimates.iter().map(recorded).collect());
        states.push(Measured { state, results });
    }
    let tallies = recording.ledger().unwrap_or_default();
    let simulator = simulator(&recording)?;
    warnings.extend(recording.warnings().iter().map(ToString::to_string));
    Ok(Contents { states, topics: tallies, simulator, warnings })
}

/// Messages of a topic by step, checked; of several of one step the last.
fn by_step<M: Message, T: for<'m> TryFrom<&'m M, Error: std::fmt::Display>>(
    recording: &Recording,
    topic: &Topic,
    step: impl Fn(&M) -> u64,
    warnings: &mut Vec<String>,
) -> Result<BTreeMap<u64, T>, Failure> {
    let mut found = BTreeMap::new();
    let name = topic.absolute_name();
    if !recording.channels().iter().any(|c| c.topic == name) {
        return Ok(found);
    }
    for message in recording.messages(&Selection::topics([name.as_str()])).map_err(Failure::failure)? {
        let decoded = from_cdr::<M>(&message.payload).map_err(|e| e.to_string());
        match decoded.and_then(|m| T::try_from(&m).map(|t| (step(&m), t)).map_err(|e| e.to_string())) {
            Ok((step, value)) => {
                found.insert(step, value);
            }
            Err(reason) => warnings.push(format!("{name}: {reason}")),
        }
    }
    Ok(found)
}

/// The numbers of the simulator's last report.
fn simulator(recording: &Recording) -> Result<BTreeMap<String, f64>, Failure> {
    let mut last = BTreeMap::new();
    let name = topics::DIAGNOSTICS.absolute_name();
    if !recording.channels().iter().any(|c| c.topic == name) {
        return Ok(last);
    }
    for message in recording.messages(&Selection::topics([name])).map_err(Failure::failure)? {
        let Ok(array) = from_cdr::<DiagnosticArray>(&message.payload) else { continue };
        for report in Report::from_message(&array).iter().filter(|r| r.node.ends_with("/dem_simulator")) {
            let numbers = report.health.values.iter().filter_map(|(k, v)| Some((k.clone(), v.parse().ok()?)));
            last.extend(numbers);
        }
    }
    Ok(last)
}

fn recorded(estimate: &EstimateReading) -> Inference {
    let status = match estimate.status {
        EstimateStatus::Ok => "ok",
        EstimateStatus::Extrapolated => "extrapolated",
        EstimateStatus::Undetermined => "undetermined",
        EstimateStatus::Failed => "failed",
    };
    let mut result =
        Inference::failed(&estimate.model, &estimate.calibration, status, estimate.warnings.clone());
    if let Some(i) = &estimate.inferred {
        (result.k, result.k_hat, result.eps) = (Some(i.k), Some(i.k_hat), Some(i.eps));
        if let Some(c) = &i.covariance {
            let sigma = |k: usize| Some(c[4 * k].sqrt());
            result.sigma = Triple { k: sigma(0), k_hat: sigma(1), eps: sigma(2) };
        }
        if let Some(v) = &i.interval {
            let pair = |(low, high): (f64, f64)| Some([low, high]);
            result.interval = Interval {
                level: Some(v.level),
                bounds: Triple { k: pair(v.k), k_hat: pair(v.k_hat), eps: pair(v.eps) },
            };
        }
    }
    result
}
