//! The result of a run, read back from its recording.

use grainlab_console::{Failure, Format, called, json, print, replace_whole, worse};
use grainlab_launcher::NodeKind;
use grainlab_launcher::{Received, Supervised};
use grainlab_node_kit::{Exit, RunId};
use grainlab_recordings::scenes::SceneText;
use grainlab_recordings::strangers;
use grainlab_recordings::{Recording, Selection, TopicTally};
use grainlab_results::continuity::Exchanges;
use grainlab_results::read_back::{self, ReadBack};
use grainlab_results::{Launched, MeasuredPacking, NodeEnd, Printed, Summary};
use grainlab_results::{brief, summary_text};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(Clone, Copy, Debug)]
pub(super) struct Output {
    pub(super) format: Format,
    /// Print everything before the summary.
    pub(super) verbose: bool,
    /// True if the run was resumed: its times cover only the part since then.
    pub(super) resumed: bool,
    #[cfg_attr(not(feature = "studio"), expect(dead_code, reason = "the studio writes pages"))]
    pub(super) report: bool,
}

fn missing(received: &Received, back: &ReadBack) -> Vec<String> {
    let mut missing = Vec::new();
    if back.several_runs.is_some() {
        return missing;
    }
    if let Some(published) = received.packings.filter(|n| back.packings < *n as usize) {
        missing.push(format!("{} of {published} packings are in the recording", back.packings));
    }
    for (topic, steps) in &received.results {
        let recorded = back.results.get(topic);
        for step in steps.iter().filter(|step| recorded.is_none_or(|known| !known.contains(step))) {
            missing.push(format!("the {topic} of step {step} was published and is not in the recording"));
        }
    }
    missing
}

/// Number of messages by topic. A damaged file is read message by message: its statistics also count unreadable ones.
fn recorded(recording: &Recording) -> Result<BTreeMap<String, u64>, Failure> {
    let stated = recording.info().topics.into_iter().map(|t| (t.name, t.messages));
    if recording.warnings().is_empty() {
        return Ok(stated.collect());
    }
    let mut read: BTreeMap<String, u64> = stated.map(|(name, _)| (name, 0)).collect();
    for message in recording.messages(&Selection::default())? {
        *read.entry(message.channel.topic.clone()).or_default() += 1;
    }
    Ok(read)
}

/// Reads the recording back, prints the result and writes it beside the recording.
pub(super) fn finish(
    output: Output,
    directory: &Path,
    scene: &SceneText,
    (run, domain): (RunId, Option<u16>),
    supervised: Supervised,
) -> Result<Exit, Failure> {
    let mut exit = supervised.exit;
    let recording = Recording::open(directory);
    let mut recorders = supervised.children.iter().filter(|c| c.plan.is(NodeKind::Recorder));
    if recording.is_err() && recorders.any(|c| c.code == Some(i32::from(Exit::Failure.code()))) {
        // The recorder could not begin, which was printed: there is nothing to sum up.
        return Ok(Exit::Failure);
    }
    let (mut back, tallies) = match &recording {
        Ok(recording) => (read_back::read(recording), recording.ledger()),
        Err(error) => (ReadBack::failed(error), None),
    };
    let mut missing = missing(&supervised.received, &back);
    let exchanges = recording.as_ref().ok().map(Exchanges::of).transpose()?.flatten();
    // An interrupted run may end with an unanswered request.
    if let (Some(_), Some(exchanges)) = (supervised.received.packings, &exchanges) {
        missing.extend(exchanges.missing(back.engine_changes()));
    }
    let recorded = recording.as_ref().ok().map(recorded).transpose()?.unwrap_or_default();
    let damage = recording.as_ref().map_or_else(|_| Vec::new(), Recording::warnings);
    // That of the messages that the results are made of is among them.
    let damage = damage.iter().map(ToString::to_string).filter(|line| !back.complaints.contains(line));
    let damage: Vec<String> = damage.collect();
    back.complaints.extend(damage);
    let is_short = |t: &TopicTally| t.lost > 0 || recorded.get(&t.name).copied().unwrap_or(0) < t.recorded;
    if tallies.as_ref().is_none_or(|tallies| tallies.iter().any(is_short)) {
        exit = worse(exit, Exit::DataLoss);
    }
    let children = &supervised.children;
    let has = |node: NodeKind| children.iter().any(|c| c.plan.is(node));
    let unanswered = (has(NodeKind::FabricAnalyzer) && back.not_analysed > 0)
        || (has(NodeKind::EmtInversion) && back.not_inverted > 0);
    let unused = back.refused > 0 || back.several_runs.is_some() || back.disputed;
    if !missing.is_empty() || unanswered || unused {
        exit = worse(exit, Exit::DataLoss);
        back.complaints.extend(missing);
    }
    for state in &back.states {
        if let Some(why) = state.packing.report.elasticity.as_ref().err().filter(|why| why.is_fault()) {
            exit = worse(exit, Exit::PhysicsInvalid);
            back.complaints.push(format!("the packing of step {}: {why}", state.packing.step));
        }
    }
    let ended_early = recording.as_ref().map_or(0, |recording| recording.ended_early().iter().len());
    let uncounted = recording.as_ref().map_or_else(|_| Vec::new(), Recording::unaccounted);
    back.complaints.extend(uncounted.iter().map(|path| {
        let path = path.display();
        format!(
            "{path}: its recorder was killed, or had no room on the disk: messages sent then may be missing, and are not \
             counted as lost; if the disk is full, free space and resume the run"
        )
    }));
    let nodes = supervised.children.iter().map(|c| NodeEnd {
        name: c.plan.name.clone(),
        pid: c.last_pid,
        exit: c.code,
        restarts: c.restarts.len(),
    });
    let launched = Launched {
        scene: scene.scene.name.clone(),
        seed: scene.scene.seed,
        domain,
        run: run.to_string(),
        resumed: output.resumed,
        exchanges: exchanges.map(|e| e.count()),
        recorded,
        uncounted_files: uncounted.len() + ended_early,
        wall_seconds: supervised.wall.as_secs_f64(),
        nodes: nodes.collect(),
        recording: recording.is_ok().then(|| directory.display().to_string()),
        exit: exit.code(),
        reasons: supervised.reasons,
    };
    back.strangers.iter().for_each(|s| grainlab_console::say!("grainlab: {}", s.line()));
    let left_out = recording.as_ref().ok().and_then(strangers::left_out);
    left_out.iter().for_each(|line| grainlab_console::say!("grainlab: {line}"));
    // The launcher has printed its reasons.
    back.complaints.iter().for_each(|w| grainlab_console::say!("grainlab: {w}"));
    let summary = Summary::new(launched, back, tallies.as_deref());
    let path = directory.join("summary.json");
    let text = json(&summary)?;
    let packings: Vec<_> = summary.states.iter().map(|s| s.packing.clone()).collect();
    // The states were read from the recording.
    let kept =
        if summary.states.is_empty() { "" } else { "; the result is printed, and is in the recording" };
    let written =
        replace_whole(&path, &text).map_err(|e| Failure::failed(format!("{}: {e}{kept}", path.display())));
    let exists = |name: &str| directory.join(name).exists();
    let files = [
        ("recording", recording.is_ok()),
        ("summary.json", written.is_ok()),
        ("scene.toml", exists("scene.toml")),
        ("logs", exists("logs")),
    ];
    let files: Vec<&str> = files.into_iter().filter(|(_, there)| *there).map(|(name, _)| name).collect();
    // Printed in any case, so that a full disk does not lose the result.
    let printed = print(&match output.format {
        Format::Json => text.clone(),
        Format::Csv => MeasuredPacking::table(&packings).csv(),
        Format::Table => {
            let all = if output.verbose { summary_text::text(&summary) + "\n" } else { String::new() };
            all + &brief::text(&summary, &from_here(directory), &files, &called())
        }
    });
    for failure in [written, printed].into_iter().filter_map(Result::err) {
        grainlab_console::say!("grainlab: {failure}");
        // With a full disk the exit stays that of the data loss.
        exit = if exit == Exit::DataLoss { exit } else { worse(exit, failure.exit) };
    }
    #[cfg(feature = "studio")]
    if recording.is_ok() && output.report {
        report(output, directory);
    }
    Ok(exit)
}

/// Writes the page of the run. Without it the run is complete, too: a failure is a warning.
#[cfg(feature = "studio")]
fn report(output: Output, directory: &Path) {
    match grainlab_report::write_report(directory) {
        Ok(path) if output.format == Format::Table => {
            // A closed pipe or a full disk behind stdout was reported with the results.
            let _ = print(&format!("Report    {}\n", from_here(&path).display()));
        }
        Ok(_) => {}
        Err(error) => grainlab_console::say!("grainlab: no report: {error}"),
    }
}

/// The path from the present folder, if it is below it.
fn from_here(path: &Path) -> PathBuf {
    let here = std::env::current_dir().and_then(|d| d.canonicalize());
    here.ok().and_then(|d| path.strip_prefix(d).ok()).unwrap_or(path).to_owned()
}
