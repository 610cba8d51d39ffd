//! One packing measured: its state, and the messages that a node would publish.

use crate::commands::packings::Measure;
use grainlab_core::Packing;
use grainlab_experiment::PathPosition;
use grainlab_fabric_analyzer::{Measured, messages};
use grainlab_micromechanics::network::{SpringNetwork, Springs, relaxed_stiffness};
use grainlab_micromechanics::probe::{StrainProbe, StrainProbeResult, amplitude_sweep};
use grainlab_micromechanics::{MicroError, PackingView, Settings, analyze};
use grainlab_recordings::import::Imported;
use grainlab_results::{MeasuredPacking, ProbeView, ScanView, state_warnings};
use std::time::Instant;

/// Relative difference of the forward and the backward stiffness of a probe without a warning: half of it is
/// the error of either, while the error of their mean is of a smaller order.
const ONE_SIDED: f64 = 0.01;

/// Settings of the measurement.
#[derive(Clone, Debug)]
pub(super) struct Analysis {
    pub(super) settings: Settings,
    /// Amplitudes of additional probes.
    pub(super) scan: Vec<f64>,
}

/// Stiffnesses of a scan agree if no entry differs by more than this fraction of the largest: the precision
/// of comparisons with other probes.
const AGREEMENT: f64 = 1e-3;

/// The result for one packing.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) packing: MeasuredPacking,
    /// The messages that the node `fabric_analyzer` would publish, or the reason why it would not.
    pub(super) messages: Result<Measured, String>,
}

impl Measure for Analysis {
    type Found = Found;

    fn measure(&self, source: &str, imported: &Imported) -> Result<Found, String> {
        let began = Instant::now();
        let packing = &imported.packing;
        let named = |e: &dyn std::fmt::Display| format!("{source}, step {}: {e}", packing.step);
        let found = analyze(packing, &self.settings).map_err(|e| named(&e))?;
        let position = PathPosition::of(&imported.run_state);
        let mut measured = MeasuredPacking::new(source.to_owned(), found.report).at(position);
        measured.step = imported.step;
        measured.seconds = Some(began.elapsed().as_secs_f64());
        let (report, probe) = (&measured.report, found.probe.as_ref());
        measured.probe = probe.zip(self.settings.probe).map(|(p, set)| ProbeView::new(set.amplitude, p));
        if !self.scan.is_empty() && report.stiffness().is_some() {
            measured.scan = Some(self.scanned(packing).map_err(|e| named(&e))?);
        }
        let mut warnings = imported.notes.clone();
        warnings.extend(state_warnings(packing, report, measured.position, &imported.notes));
        warnings.extend(report.elasticity.not_jammed().map(ToString::to_string));
        warnings.extend(probe.and_then(one_sided));
        measured.warnings = warnings;
        let messages = messages(&imported.header, &measured.report).map_err(|e| named(&e));
        Ok(Found { packing: measured, messages })
    }
}

impl Analysis {
    /// Probes of all amplitudes, compared with the frozen network.
    fn scanned(&self, packing: &Packing) -> Result<ScanView, MicroError> {
        let set = &self.settings;
        let sweep = amplitude_sweep(packing, &explicit(set.springs), &self.scan, AGREEMENT)?;
        let network = SpringNetwork::new(&PackingView::new(packing)?, set.springs)?;
        let found = relaxed_stiffness(&network, set.solver, set.tolerance, set.max_iterations)?;
        Ok(ScanView::new(&sweep, found.map(|s| s.relaxed).as_ref()))
    }
}

/// A warning of a probe if the response depends on the direction of the strain.
fn one_sided(probe: &StrainProbeResult) -> Option<String> {
    let changed = probe.sum(|c| c.opened + c.closed);
    let worst = probe.forward_backward().unwrap_or(0.0);
    (worst > ONE_SIDED).then(|| {
        format!(
            "the probe's forward and backward strain give stiffnesses that differ by {:.1} %, {changed} contacts opened \
             or closed: compare other values of --amplitude",
            100.0 * worst
        )
    })
}

/// A probe with the friction that leaves these springs.
pub(super) fn explicit(springs: Springs) -> StrainProbe {
    let friction = match springs {
        Springs::Carried => None,
        Springs::NormalAndTangential => Some(f64::INFINITY),
        Springs::Normal | Springs::PrestressedNormal => Some(0.0),
    };
    StrainProbe { friction, ..StrainProbe::default() }
}
