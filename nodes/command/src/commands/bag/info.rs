//! `grainlab bag info`.

use super::recorded::Recorded;
use grainlab_console::{Failure, Format, Table};
use grainlab_node_kit::Exit;
use grainlab_recordings::strangers::{self, StrangerView};
use grainlab_recordings::{Info, METADATA_RECORD, Recording, SeveralRuns};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "Example:\n  grainlab bag info recordings/runs/demo-1-1 --format json";

pub(super) fn run(args: &Recorded) -> Result<Exit, Failure> {
    let (recording, _) = args.messages.open(&args.path)?;
    let recorders = records_of_recorders(&recording);
    let all = |key: &str| recorders.iter().filter_map(|r| r.get(key).cloned()).collect::<BTreeSet<_>>();
    // Recorders that differ have no common value.
    let of_recorder = |key: &str| Some(all(key)).filter(|values| values.len() == 1)?.pop_first();
    let several = || Some(all("run")).filter(|runs| runs.len() > 1).map(Vec::from_iter);
    let view = View {
        info: recording.info(),
        run: of_recorder("run"),
        commit: of_recorder("commit"),
        host: of_recorder("host"),
        strangers: strangers::strangers(&recording),
        disputes: strangers::disputes(&recording),
        left_out: strangers::left_out(&recording),
        several_runs: SeveralRuns::of_scenes(&recording).map(|s| s.to_string()).or_else(|| {
            Some(format!("the recording has the messages of several runs: {}", several()?.join(", ")))
        }),
        ended_early: recording.ended_early(),
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

/// Returns the metadata records of the recorders. A copy of several recordings has them under `grainlab`, `grainlab.2`, and so on.
fn records_of_recorders(recording: &Recording) -> Vec<BTreeMap<String, String>> {
    let is_number = |rest: &str| rest.strip_prefix('.').is_some_and(|n| n.parse::<u32>().is_ok());
    let is_of_recorder = |name: &String| {
        name.strip_prefix(METADATA_RECORD).is_some_and(|rest| rest.is_empty() || is_number(rest))
    };
    let names = recording.metadata_names();
    names.iter().filter(|name| is_of_recorder(name)).filter_map(|name| recording.metadata(name)).collect()
}

#[derive(Serialize)]
struct View {
    #[serde(flatten)]
    info: Info,
    /// Id of the run; null if the recorder was not bound to one, or the recording has several runs.
    run: Option<String>,
    /// Commit that the recorder was built from; null if it is unknown, or recorders differ.
    commit: Option<String>,
    /// Name of the host of the recorder; null if it is unknown, or recorders differ.
    host: Option<String>,
    strangers: Vec<StrangerView>,
    disputes: Vec<String>,
    /// Topics that the recorder of the run left out, in a sentence; null without.
    left_out: Option<String>,
    /// That the recording has several runs; null if it has one or none.
    several_runs: Option<String>,
    /// Why the recorder ended before the run did, as on a full disk; null if it did not.
    ended_early: Option<String>,
    /// Files without a ledger, whose recorder was killed or is still running: their messages are not in the counts of lost ones.
    unaccounted: Vec<PathBuf>,
}

/// Notes that the table of topics does not show.
fn notes(view: &View) -> Vec<String> {
    let uncounted = |path: &PathBuf| {
        format!(
            "{}: its recorder was killed, had no room on the disk, or is still running: published, lost and repeated do not \
             count this file",
            path.display()
        )
    };
    view.disputes
        .iter()
        .chain(&view.several_runs)
        .chain(&view.left_out)
        .chain(&view.ended_early)
        .cloned()
        .chain(view.unaccounted.iter().map(uncounted))
        .collect()
}

fn table(view: &View) -> String {
    let mut text = format!("{}\n", view.info);
    let stated = [("run", &view.run), ("commit", &view.commit), ("host", &view.host)];
    let lines = stated.into_iter().filter_map(|(key, value)| Some(format!("\n{key} {}\n", value.as_ref()?)));
    text.extend(lines);
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
