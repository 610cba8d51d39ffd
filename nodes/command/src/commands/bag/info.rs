//! `grainlab bag info`.

use super::recorded::Recorded;
use grainlab_console::{Failure, Format, Table};
use grainlab_node_kit::Exit;
use grainlab_recordings::strangers::{self, StrangerView};
use grainlab_recordings::{Info, METADATA_RECORD, SeveralRuns};
use serde::Serialize;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "Example:\n  grainlab bag info recordings/runs/demo-1-1 --format json";

pub(super) fn run(args: &Recorded) -> Result<Exit, Failure> {
    let (recording, _) = args.messages.open(&args.path)?;
    let view = View {
        info: recording.info(),
        run: recording.metadata(METADATA_RECORD).and_then(|record| record.get("run").cloned()),
        strangers: strangers::strangers(&recording),
        disputes: strangers::disputes(&recording),
        left_out: strangers::left_out(&recording),
        several_runs: SeveralRuns::of_scenes(&recording).map(|s| s.to_string()),
        unaccounted: recording.unaccounted(),
    };
    args.format.print(&view, || csv(&view.info), || table(&view))?;
    if args.format == Format::Csv {
        notes(&view).iter().for_each(|line| grainlab_console::say!("grainlab: {line}"));
    }
    let warnings = recording.warnings();
    warnings.iter().for_each(|w| grainlab_console::say!("grainlab: {w}"));
    Ok(if warnings.is_empty() && view.disputes.is_empty() { Exit::Done } else { Exit::DataLoss })
}

/// The recording and the recorder's metadata of its run.
#[derive(Serialize)]
struct View {
    #[serde(flatten)]
    info: Info,
    /// Id of the run; null if the recorder was not bound to one.
    run: Option<String>,
    /// Processes whose messages were left out.
    strangers: Vec<StrangerView>,
    /// Why it is unknown which messages are right.
    disputes: Vec<String>,
    /// Topics that the recorder of the run left out, in a sentence; null without.
    left_out: Option<String>,
    /// That the recording has the scenes of several runs; null if it has one or none.
    several_runs: Option<String>,
    /// Files whose recorder was killed, or is still running: their messages are not in the counts of lost ones.
    unaccounted: Vec<PathBuf>,
}

/// Notes that the table of topics does not show.
fn notes(view: &View) -> Vec<String> {
    let uncounted = |path: &PathBuf| {
        format!(
            "{}: its recorder was killed, or is still running: published, lost and repeated do not count it",
            path.display()
        )
    };
    view.disputes
        .iter()
        .chain(&view.several_runs)
        .chain(&view.left_out)
        .cloned()
        .chain(view.unaccounted.iter().map(uncounted))
        .collect()
}

fn table(view: &View) -> String {
    let mut text = format!("{}\n", view.info);
    if let Some(run) = &view.run {
        text += &format!("\nrun {run}\n");
    }
    view.strangers.iter().for_each(|s| text += &format!("{}\n", s.line()));
    notes(view).iter().for_each(|line| text += &format!("\n{line}\n"));
    text
}

fn csv(info: &Info) -> String {
    let mut t =
        Table::new(["topic", "type", "messages", "published", "lost", "repeated", "latched", "definition"]);
    let count = |n: Option<u64>| n.map_or_else(String::new, |n| n.to_string());
    for topic in &info.topics {
        t.row([
            topic.name.clone(),
            topic.ros_type.clone(),
            topic.messages.to_string(),
            count(topic.published),
            count(topic.lost),
            count(topic.repeated),
            topic.latched.to_string(),
            topic.definition.to_owned(),
        ]);
    }
    t.csv()
}
