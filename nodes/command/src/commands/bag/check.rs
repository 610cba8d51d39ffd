//! `grainlab bag check`.

use super::recorded::Recorded;
use grainlab_console::{Failure, Format, Table, count, say};
use grainlab_node_kit::Exit;
use grainlab_recordings::{Check, SeveralRuns, WarningKind, strangers};
use serde::Serialize;

pub(super) const EXAMPLES: &str = "\
Examples:
  grainlab bag check recordings/runs/demo-1-1
  grainlab bag check run.mcap --format json

Reads every record: framing, checksums of chunks, attachments, summary and data, the index and metadata.yaml (topics, counts, times, files, storage, compression) against the messages, the messages
against the definitions of their types, the order of files, the recorder's ledger against the messages, what its recorder noted as disputed between processes, and the definitions
of types against those of this program. Exit 0 without faults, else 3; a definition that is read by the names of its fields is no fault, nor are several runs in one recording, nor a
ledger that is absent because another program, a copy, or `bag recover` wrote the file: then losses cannot be judged. What `bag recover` left out but for
an incomplete end is a fault.";

pub(super) fn run(args: &Recorded) -> Result<Exit, Failure> {
    let (recording, _) = args.messages.open(&args.path)?;
    let check = recording.check();
    let view = View {
        check,
        disputes: strangers::disputes(&recording),
        several_runs: SeveralRuns::of(&recording).map(|s| s.to_string()),
    };
    let check = &view.check;
    let sound = check.warnings.is_empty()
        && view.disputes.is_empty()
        && check.ended_early.is_none()
        && check.unaccounted.is_empty()
        && !check.refused
        // The end of a file that was being written is lost in any case.
        && check.recovered.values().flatten().all(|part| part.kind == WarningKind::Truncated)
        && check.lost.unwrap_or(0) == 0;
    args.format.print(&view, || csv(check), || text(&view))?;
    if args.format != Format::Table {
        check.warnings.iter().for_each(|w| say!("grainlab: {w}"));
        check
            .definitions
            .iter()
            .chain(&view.disputes)
            .chain(&view.several_runs)
            .for_each(|line| say!("grainlab: {line}"));
    }
    Ok(if sound { Exit::Done } else { Exit::DataLoss })
}

#[derive(Serialize)]
struct View {
    #[serde(flatten)]
    check: Check,
    disputes: Vec<String>,
    /// That the recording holds several runs, and by what; null if it is of one.
    several_runs: Option<String>,
}

fn text(view: &View) -> String {
    let check = &view.check;
    let mut lines = vec![format!(
        "{}, {}: {}, {}, {}, {}",
        count(check.files.len(), "file"),
        count(check.bytes, "byte"),
        count(check.records, "record"),
        count(check.chunks, "chunk"),
        count(check.messages, "message"),
        count(check.attachments, "stored file")
    )];
    lines.extend(check.warnings.iter().map(ToString::to_string));
    lines.extend(check.ended_early.iter().cloned());
    for path in &check.unaccounted {
        let what = "it has no ledger: its recorder was killed, had no room on the disk, or is still running";
        lines.push(format!("{}: {what}", path.display()));
    }
    for (path, without) in &check.recovered {
        let what = "it was recovered: its last messages may be missing, and are in no count";
        lines.push(format!("{}: {what}", path.display()));
        lines.extend(without.iter().map(|part| format!("  left out then: {part}")));
    }
    if let Some(lost) = check.lost.filter(|n| *n > 0) {
        lines.push(format!("according to the ledger, {lost} messages were published and not recorded"));
    }
    lines.extend(check.definitions.iter().chain(&view.disputes).cloned());
    if lines.len() == 1 {
        let ledgers = if check.unjudged.is_empty() { ", ledgers" } else { "" };
        let (parsed, all) = (check.ros_definitions, check.all_definitions);
        let checksums = match check.checksums {
            0 => "none in the recording".to_owned(),
            n => format!("{n} valid"),
        };
        let definitions =
            if parsed == all { String::new() } else { format!(" of {all}, the others are not of ROS 2") };
        lines.push(format!(
            "all records{}{ledgers} are valid; checksums: {checksums}; definitions: {parsed} parsed{definitions}",
            if check.without_index { "" } else { ", indexes" }
        ));
    }
    for path in &check.unjudged {
        let what = "losses cannot be judged: only grainlab's recorder counts them";
        lines.push(format!("{}: {what}", path.display()));
    }
    lines.extend(check.unknown_records.iter().map(|opcode| {
        format!("records of type 0x{opcode:02x}, which MCAP does not define as far as this program knows, are not read")
    }));
    if check.without_index {
        lines
            .push("its index is absent or incomplete, which MCAP allows: the whole file was read".to_owned());
    }
    lines.extend(view.several_runs.clone());
    lines.join("\n") + "\n"
}

fn csv(check: &Check) -> String {
    let mut t = Table::new(["file", "byte", "kind", "detail"]);
    for w in &check.warnings {
        let kind = serde_json::to_value(w.kind).ok().and_then(|k| k.as_str().map(str::to_owned));
        t.row([
            w.path.display().to_string(),
            w.offset.to_string(),
            kind.unwrap_or_default(),
            w.detail.clone(),
        ]);
    }
    t.csv()
}
