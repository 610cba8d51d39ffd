//! One packing measured: its state, and the messages that a node would publish.

use crate::commands::packings::bar::Bar;
use crate::commands::packings::{self, Measure};
use crate::tape::Tape;
use grainlab_console::Failure;
use grainlab_core::{Packing, Stiffness};
use grainlab_experiment::PathPosition;
use grainlab_micromechanics::network::{SpringNetwork, Springs, relaxed_stiffness};
use grainlab_micromechanics::probe::{StrainProbe, StrainProbeResult, amplitude_sweep};
use grainlab_micromechanics::{MicroError, PackingView, Settings, analyze};
use grainlab_msgs::boundary::packing_report_message;
use grainlab_msgs::{msg, topics};
use grainlab_node_kit::Exit;
use grainlab_recordings::import::Imported;
use grainlab_results::{MeasuredPacking, ProbeView, ScanView, ScannedView, state_warnings, yields};
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
    /// The message that the node `fabric_analyzer` would publish, or the reason why it would not.
    pub(super) message: Result<msg::PackingReport, String>,
}

impl packings::Found for Found {
    type Shown = MeasuredPacking;

    fn shown(&self) -> &MeasuredPacking {
        &self.packing
    }

    /// Without a stiffness, or with one that some strain does not load: no wave passes it.
    fn is_without(&self) -> bool {
        self.packing.report.stiffness().is_none() || yields(&self.packing.report)
    }

    fn record(&self, tape: &mut Tape, bar: &Bar) -> Result<Exit, Failure> {
        match &self.message {
            Ok(report) => {
                tape.put(&topics::PACKING_REPORT, &report.header, report)?;
                Ok(Exit::Done)
            }
            Err(message) => {
                bar.say(&format!("grainlab: {message}"));
                Ok(Exit::PhysicsInvalid)
            }
        }
    }
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
        measured.probe = probe.zip(self.settings.probe).map(|(p, set)| probe_view(set.amplitude, p));
        if !self.scan.is_empty() && report.stiffness().is_some() {
            measured.scan = Some(self.scanned(packing).map_err(|e| named(&e))?);
        }
        let mut warnings = imported.notes.clone();
        warnings.extend(state_warnings(packing, report, measured.position, &imported.notes));
        warnings.extend(report.elasticity.as_ref().err().map(ToString::to_string));
        warnings.extend(probe.and_then(one_sided));
        measured.warnings = warnings;
        let message =
            packing_report_message(imported.header.clone(), &measured.report).map_err(|e| named(&e));
        Ok(Found { packing: measured, message })
    }
}

impl Analysis {
    /// Probes of all amplitudes, compared with the frozen network.
    fn scanned(&self, packing: &Packing) -> Result<ScanView, MicroError> {
        let set = &self.settings;
        let sweep = amplitude_sweep(packing, &explicit(set.springs), &self.scan, AGREEMENT)?;
        let network = SpringNetwork::new(&PackingView::new(packing)?, set.springs)?;
        let found = relaxed_stiffness(&network, set.solver, set.tolerance, set.max_iterations)?;
        let network = found.map(|s| s.relaxed);
        let probes = sweep.probes.iter().map(|(amplitude, found)| {
            let probe = found.as_ref().ok();
            let off =
                |(p, c): (&StrainProbeResult, Stiffness)| (p.stiffness.0 - c.0).amax() / c.0[(0, 0)].abs();
            ScannedView {
                amplitude: *amplitude,
                probe: probe.map(|p| probe_view(*amplitude, p)),
                failure: found.as_ref().err().map(ToString::to_string),
                off_network: probe.zip(network).map(off),
            }
        });
        let linear =
            sweep.linear.as_ref().map(|run| [sweep.probes[*run.start()].0, sweep.probes[*run.end()].0]);
        Ok(ScanView { probes: probes.collect(), linear })
    }
}

/// The details of a probe with strains of this amplitude.
fn probe_view(amplitude: f64, probe: &StrainProbeResult) -> ProbeView {
    ProbeView {
        amplitude,
        asymmetry: probe.asymmetry,
        steps: probe.steps(),
        opened: probe.sum(|c| c.opened),
        closed: probe.sum(|c| c.closed),
        sliding: probe.sum(|c| c.sliding),
        forward_backward: probe.forward_backward(),
        error: probe.relative_error(),
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
