//! Wave speeds of samples whose contacts are not known: structure at each pressure, and the contact.

mod doubts;
mod inputs;
mod print;
mod sample;

use super::args::Args;
use super::contact::Contact;
use super::speed_table::SpeedLine;
use grainlab_console::{Failure, Format, input, say};
use grainlab_emt::{Calibration, EmtError, Sensitivity, SeriesPrior, infer_series};
use grainlab_node_kit::Exit;
use sample::Sample;
use std::path::Path;

/// The prior of a series: the built-in one, or a file.
pub(super) fn prior(path: Option<&Path>) -> Result<SeriesPrior, Failure> {
    let Some(path) = path else { return Ok(SeriesPrior::builtin().clone()) };
    let name = path.display();
    let text = input::text(path, input::SETTINGS).map_err(|e| Failure::failed(format!("{name}: {e}")))?;
    SeriesPrior::parse(&text)
        .map_err(|e| Failure::usage(format!("{name}: {e}; this prior is that of samples whose contacts are not known: --print-prior --contact free prints one")))
}

pub(super) fn run(
    name: &str,
    lines: &[SpeedLine],
    args: &Args,
    contact: Contact,
    prior: &SeriesPrior,
    (format, plot): (Format, Option<&Path>),
) -> Result<Exit, Failure> {
    plot.map_or(Ok(()), |path| grainlab_console::has_name_of("--plot", path, "html"))?;
    let network = Calibration::builtin("grainlab").and_then(|c| c.network.as_ref());
    let network = network.ok_or_else(|| Failure::failed("the built-in calibration has no network"))?;
    let prior = contact.of(prior);
    let mut samples: Vec<(String, Vec<SpeedLine>)> = Vec::new();
    for line in lines {
        match samples.iter_mut().find(|(sample, _)| *sample == line.sample) {
            Some((_, of)) => of.push(line.clone()),
            None => samples.push((line.sample.clone(), vec![line.clone()])),
        }
    }
    let (mut found, mut failed) = (Vec::new(), Vec::new());
    for (sample, lines) in samples {
        let usage = |fault: String| Failure::usage(format!("{name}: {fault}"));
        let (series, assumed) = args.series(&lines).map_err(usage)?;
        let wrong = |e: EmtError| usage(format!("sample {sample:?}: {e}"));
        let estimate = match infer_series(&series, network, &prior) {
            Err(e @ EmtError::NotSampled { .. }) => {
                failed.push(format!("{name}: sample {sample:?}: {e}"));
                continue;
            }
            estimate => estimate.map_err(wrong)?,
        };
        let sensitivity = Sensitivity::of(&estimate, &series, network, &prior).map_err(wrong)?;
        let contact = contact.text();
        let status = estimate.status(&sensitivity);
        let mut all = Sample {
            sample,
            contact,
            status,
            lines,
            series,
            estimate,
            sensitivity,
            assumed,
            notes: Vec::new(),
            doubts: Vec::new(),
        };
        [all.doubts, all.notes] = doubts::sentences(&all, &prior, network.reach.z[0]);
        found.push(all);
    }
    format.print(&found, || print::csv(&found), || found.iter().map(print::text).collect())?;
    if let Some(path) = plot.filter(|_| !found.is_empty()) {
        plotted(&found, path)?;
    }
    let contradictory: Vec<&Sample> = found.iter().filter(|s| s.is_contradictory()).collect();
    for sample in &contradictory {
        say!(
            "grainlab: {name}: sample {:?}: contradictory: {}",
            sample.sample,
            doubts::contradiction(sample)
        );
    }
    failed.iter().for_each(|fault| say!("grainlab: {fault}"));
    Ok(if contradictory.is_empty() && failed.is_empty() { Exit::Done } else { Exit::PhysicsInvalid })
}

#[cfg(feature = "studio")]
fn plotted(samples: &[Sample], path: &Path) -> Result<(), Failure> {
    let mut all = Vec::new();
    for s in samples {
        all.push(grainlab_report::InferredSample {
            name: &s.sample,
            series: &s.series,
            estimate: &s.estimate,
            is_contradictory: s.is_contradictory(),
            notes: &s.notes,
            doubts: &s.doubts,
        });
    }
    let page = grainlab_report::series_page(&all);
    grainlab_console::write_whole(path, page.as_bytes())
}

#[cfg(not(feature = "studio"))]
fn plotted(_: &[Sample], _: &Path) -> Result<(), Failure> {
    Err(Failure::usage("--plot needs the studio: build with its feature"))
}
