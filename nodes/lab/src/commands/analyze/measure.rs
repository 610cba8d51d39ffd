//! One packing measured: its state, and the messages that a node would publish.

use crate::commands::packings::Measure;
use crate::results::doubts::doubts;
use crate::results::probe::{ProbeView, ScanView};
use crate::results::state::State;
use grainlab_core::Packing;
use grainlab_fabric_analyzer::{Measured, messages};
use grainlab_micromechanics::scan::scan;
use grainlab_micromechanics::stiffness::moduli;
use grainlab_micromechanics::{MicroError, Network};
use grainlab_recordings::import::Imported;
use std::time::Instant;

/// Forward and backward stiffness of a probe may differ by this share without a warning: half of it is the error of either,
/// and the difference of both is of a smaller order.
const ONE_SIDED: f64 = 0.01;

/// How packings are measured.
#[derive(Clone, Debug)]
pub(super) struct Analysis {
    pub(super) settings: grainlab_micromechanics::Settings,
    /// Amplitudes to probe with, beside the measurement proper.
    pub(super) scan: Vec<f64>,
}

/// Stiffnesses of a scan agree if no entry differs by more than this share of the largest: the precision that probes are
/// compared with others to.
const AGREEMENT: f64 = 1e-3;

/// What was found of one packing.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) state: State,
    /// As the node `fabric_analyzer` would publish it, or why it could not.
    pub(super) messages: Result<Measured, String>,
}

impl Measure for Analysis {
    type Found = Found;

    fn measure(&self, source: &str, imported: &Imported) -> Result<Found, String> {
        let began = Instant::now();
        let packing = &imported.packing;
        let named = |e: &dyn std::fmt::Display| format!("{source}, step {}: {e}", packing.step);
        let found = grainlab_micromechanics::analyse(packing, &self.settings).map_err(|e| named(&e))?;
        let moduli = found.moduli.as_ref();
        let mut state = State::new(source.to_owned(), packing, &found.fabric, moduli.ok());
        state.step = imported.step;
        state.seconds = Some(began.elapsed().as_secs_f64());
        state.probe =
            found.probe.as_ref().zip(self.settings.probe).map(|(p, set)| ProbeView::new(set.amplitude, p));
        if !self.scan.is_empty() && moduli.is_ok() {
            state.scan = Some(self.scanned(packing).map_err(|e| named(&e))?);
        }
        state.warnings.clone_from(&imported.notes);
        state.warnings.extend(doubts(packing, &state));
        state.warnings.extend(moduli.err().map(ToString::to_string));
        state.warnings.extend(found.probe.as_ref().and_then(one_sided));
        let messages = messages(&imported.header, packing, found).map_err(|e| named(&e));
        Ok(Found { state, messages })
    }
}

impl Analysis {
    /// Probes of all amplitudes beside the frozen network.
    fn scanned(&self, packing: &Packing) -> Result<ScanView, MicroError> {
        let probe = super::explicit(self.settings.tangential);
        let scan = scan(packing, &probe, &self.scan, AGREEMENT)?;
        let mut network = Network::new(packing, self.settings.tangential)?;
        if self.settings.prestress {
            network = network.with_prestress(packing);
        }
        let set = &self.settings;
        let found = moduli(&network, set.solver, set.tolerance, set.max_iterations)?;
        Ok(ScanView::new(&scan, found.ok().map(|m| m.stiffness).as_ref()))
    }
}

/// What a probe says about a response that depends on the direction of the strain.
fn one_sided(probe: &grainlab_micromechanics::ProbeResult) -> Option<String> {
    let changed: u32 = probe.columns.iter().map(|c| c.opened + c.closed).sum();
    let worst = probe.columns.iter().filter_map(|c| c.forward_backward).fold(0.0, f64::max);
    (worst > ONE_SIDED).then(|| {
        format!(
            "the probe's forward and backward strain give stiffnesses that differ by {:.1} %, {changed} contacts opened \
             or closed: lower --amplitude",
            100.0 * worst
        )
    })
}
