//! Time of flight: a burst is sent through a supercell, the packing repeated along the path.
//!
//! A slab of grains across the path is driven along the polarization with a tone burst; slabs at several distances
//! receive the mean velocity of their grains. The slope of arrival time against distance ([`Arrivals`]) is converted to
//! the phase speed at each frequency, for any kind of pick, and [`crate::DispersionCurve::fit`] extrapolates these to
//! long waves.
//!
//! The wave leaves the source in both directions, and the path is periodic: it is long enough for the wave in the
//! opposite direction to arrive after the measurement. Receivers are whole periods of the packing apart where possible:
//! there the wave is the same, with a delay.

mod arrival;
mod burst;
mod burst_run;
mod line;
mod measurement;
mod path_plan;
mod phase_velocity;
pub(crate) mod pick;
mod settings;
mod slab;
pub(crate) mod spectrum;
mod wave_path;

pub use arrival::Arrivals;
pub use settings::{ArrivalPick, Settings};

use crate::curve::DispersionCurve;
use crate::error::AcousticsError;
use crate::instrument::Instrument;
use crate::left_out::keep;
use crate::ray::Ray;
use crate::sample::Sample;
use crate::trace::Trace;
use grainlab_core::Packing;
use grainlab_core::notes::Note;
use measurement::TimeOfFlight;
use rayon::prelude::*;
use wave_path::paths;

/// The curves of all polarizations of all rays, in that order, and their traces.
///
/// Each ray must name lattice planes. A polarization whose arrivals are hidden by noise is left out with a
/// a note. If all are, the first error is returned. The result is the same to the last bit for
/// any number of threads.
#[allow(clippy::type_complexity)]
pub fn curves(
    packing: &Packing,
    rays: &[Ray],
    settings: &Settings,
    instrument: &Instrument,
) -> Result<(Vec<DispersionCurve>, Vec<Trace>, Vec<Note>), AcousticsError> {
    settings.validated()?;
    instrument.validated()?;
    let paths = paths(packing, rays)?;
    let sample = Sample::new(packing, settings.friction)?;
    let measured = |path| TimeOfFlight { path, sample: &sample }.measure(settings, instrument);
    let (mut curves, mut traces) = (Vec::new(), Vec::new());
    let mut notes = Vec::from_iter(sample.unbalanced.map(Note::not_at_rest));
    keep(paths.par_iter().map(measured).collect(), &mut notes, |mut found, notes| {
        curves.push(found.curve);
        traces.append(&mut found.traces);
        notes.append(&mut found.notes);
    })?;
    Ok((curves, traces, notes))
}

/// The curve of one mode from its traces, for bursts of `cycles` periods at one or more frequencies. `seed`
/// is that of the noisy copies that give the uncertainty. The mean `diameter`, m, gives the error of a single
/// frequency.
pub fn curve(
    traces: &[Trace],
    cycles: f64,
    pick: ArrivalPick,
    diameter: f64,
    seed: u64,
) -> Result<DispersionCurve, AcousticsError> {
    let arrivals: Vec<Arrivals> =
        traces.iter().map(|t| Arrivals::pick(t, cycles, pick, seed)).collect::<Result<_, _>>()?;
    phase_velocity::curve(traces, &arrivals, cycles, pick, diameter)
}
