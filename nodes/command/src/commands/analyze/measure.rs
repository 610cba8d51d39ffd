//! One packing measured: its state, and the messages that a node would publish.

use crate::commands::packings::Found;
use crate::offline_recording::Recorded;
use grainlab_core::notes::Note;
use grainlab_core::results::{NoStiffness, yields};
use grainlab_micromechanics::network::Springs;
use grainlab_micromechanics::probe::{StrainProbe, StrainProbeResult};
use grainlab_micromechanics::{Settings, analyze};
use grainlab_msgs::boundary::packing_report_message;
use grainlab_msgs::topics;
use grainlab_recordings::import::Imported;
use grainlab_results::{MeasuredPacking, ProbeView};
use std::time::Instant;

/// Relative difference of the forward and the backward stiffness of a probe without a warning: half of it is
/// the error of either, while the error of their mean is of a smaller order.
const ONE_SIDED: f64 = 0.01;

/// Measures one packing of `source`; the error names both.
pub(crate) fn measure(
    settings: &Settings,
    source: &str,
    imported: &Imported,
) -> Result<Found<MeasuredPacking>, String> {
    let began = Instant::now();
    let packing = &imported.packing;
    let named = |e: &dyn std::fmt::Display| format!("{source}, step {}: {e}", packing.step);
    let found = analyze(packing, settings).map_err(|e| named(&e))?;
    let why_none = found.why_no_stiffness();
    let mut shown = MeasuredPacking::new(source.to_owned(), found.report).doubted(packing, &imported.notes);
    shown.step = imported.step;
    shown.seconds = Some(began.elapsed().as_secs_f64());
    let (report, probe) = (&shown.report, found.probe.as_ref());
    shown.probe = probe.zip(settings.probe).map(|(p, set)| probe_view(set.amplitude, p));
    let remarks = why_none.into_iter().chain(probe.and_then(one_sided));
    shown.notes.extend(remarks.map(Note::remark));
    // No wave passes a packing that some strain does not load.
    let is_without = report.stiffness().is_none() || yields(report);
    let is_too_deep = packing.overlaps().is_some_and(|overlaps| overlaps.are_too_deep());
    let is_fault = is_too_deep || report.elasticity.as_ref().is_err_and(NoStiffness::is_fault);
    let message = packing_report_message(imported.header.clone(), report).map_err(|e| named(&e));
    let messages = message.map(|m| vec![Recorded::new(topics::PACKING_REPORT, &m.header, &m)]);
    Ok(Found { shown, is_without, is_fault, messages })
}

fn probe_view(amplitude: f64, probe: &StrainProbeResult) -> ProbeView {
    ProbeView {
        amplitude,
        asymmetry: probe.asymmetry,
        steps: probe.steps(),
        opened: probe.sum(|c| c.opened),
        closed: probe.sum(|c| c.closed),
        sliding: probe.sum(|c| c.sliding),
        forward_backward: Some(probe.forward_backward()),
        error: probe.relative_error(),
    }
}

/// A warning of a probe if the response depends on the direction of the strain.
fn one_sided(probe: &StrainProbeResult) -> Option<String> {
    let changed = probe.sum(|c| c.opened + c.closed);
    let worst = probe.forward_backward();
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
