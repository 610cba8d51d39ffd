//! `grainlab campaign status`: how far the members of a campaign came.

use grainlab_campaign::{Campaign, Folder, Standing};
use grainlab_console::{Failure, Format, Table, count, duration, exact};
use grainlab_node_kit::Exit;
use grainlab_recordings::{AtWork, Lock};
use serde::Serialize;
use std::collections::BTreeMap;

/// Most rows of members at work, and of members that failed.
const ROWS: usize = 10;

/// A campaign, as JSON has it.
#[derive(Serialize)]
struct Status<'a> {
    campaign: &'a str,
    folder: String,
    /// The process of the campaign, if it can be seen from here.
    process: Option<String>,
    seconds_left: Option<f64>,
    counts: BTreeMap<&'static str, usize>,
    members: Vec<Standing>,
}

/// Prints it.
pub(super) fn run(campaign: &Campaign, folder: &Folder, format: Format) -> Result<Exit, Failure> {
    let members: Vec<Standing> = campaign.members.iter().map(|m| folder.standing(m)).collect();
    let process = match Lock::at_work(folder.root()) {
        AtWork::Holder(who) => Some(who),
        _ => None,
    };
    let status = Status {
        campaign: &campaign.name,
        folder: folder.root().display().to_string(),
        process,
        seconds_left: seconds_left(&members),
        counts: Standing::counts(&members).into_iter().collect(),
        members,
    };
    format.print(&status, || csv(&status.members), || text(&status))?;
    Ok(Exit::Done)
}

/// Time until the last member is finished, s, if each takes the mean of those that are, and as many as now run at a time.
fn seconds_left(members: &[Standing]) -> Option<f64> {
    let of = |states: &'static [&str]| members.iter().filter(move |m| states.contains(&m.state));
    let took: Vec<f64> = of(&["finished"]).filter_map(|m| m.seconds).collect();
    let running = of(&["running"]).count();
    if took.is_empty() || running == 0 {
        return None;
    }
    let mean = took.iter().sum::<f64>() / took.len() as f64;
    let begun: f64 = of(&["running"]).map(|m| (mean - m.seconds.unwrap_or(0.0)).max(0.0)).sum();
    Some((begun + mean * of(&["waiting", "interrupted"]).count() as f64) / running as f64)
}

fn csv(members: &[Standing]) -> String {
    let mut table = Table::new(["member", "state", "seconds", "reason"]);
    for m in members {
        table.row([
            m.name.clone(),
            m.state.to_owned(),
            exact(m.seconds),
            m.reason.clone().unwrap_or_default(),
        ]);
    }
    table.csv()
}

fn text(status: &Status<'_>) -> String {
    let members = &status.members;
    let left = status.seconds_left.map_or_else(String::new, |s| format!("; about {} left", duration(s)));
    let (name, all) = (status.campaign, count(members.len(), "member"));
    let mut text = format!("{name}: {all}: {}{left}\n", Standing::words(members));
    let is_over = |m: &&Standing| matches!(m.state, "finished" | "failed");
    match &status.process {
        Some(who) => text += &format!("{who} runs the campaign\n"),
        None if members.iter().all(|m| is_over(&m)) => {}
        None => text += "no process of this host runs the campaign: the command that began it continues it\n",
    }
    let of = |states: &'static [&str]| members.iter().filter(move |m| states.contains(&m.state));
    let rows: Vec<&Standing> = of(&["running"])
        .take(ROWS)
        .chain(of(&["failed", "interrupted", "unknown"]).take(ROWS))
        .chain(of(&["waiting"]).filter(|m| m.reason.is_some()).take(ROWS))
        .collect();
    let width = rows.iter().map(|m| m.name.len()).max().unwrap_or(0);
    for Standing { name, state, reason, seconds } in &rows {
        let (seconds, reason) =
            (seconds.map_or_else(String::new, |s| format!("{s:.1} s")), reason.as_deref());
        let line = format!("  {name:width$}  {state:11}  {seconds:>10}  {}", reason.unwrap_or_default());
        text += &format!("{}\n", line.trim_end());
    }
    let left_out = of(&["running", "failed", "interrupted", "unknown"]).count().saturating_sub(rows.len());
    if left_out > 0 {
        text += &format!("  and {left_out} more: --format json has every member\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn members(states: &[(&'static str, f64)]) -> Vec<Standing> {
        let one = |(n, (state, seconds)): (usize, &(&'static str, f64))| Standing {
            name: format!("m-{n}"),
            state,
            reason: (*state == "failed").then(|| "exit code 4: why".to_owned()),
            seconds: Some(*seconds),
        };
        states.iter().enumerate().map(one).collect()
    }

    #[test]
    fn the_time_left_is_known_once_a_member_is_finished_and_another_one_runs() {
        let all =
            [("finished", 4.0), ("finished", 6.0), ("running", 2.0), ("running", 9.0), ("waiting", 0.0)];
        assert_eq!(seconds_left(&members(&all)), Some((3.0 + 5.0) / 2.0));
        assert_eq!(seconds_left(&members(&all[..2])), None);
        assert_eq!(seconds_left(&members(&all[2..])), None);
    }

    #[test]
    fn the_text_has_few_rows_and_every_reason_in_them() {
        let all = [[("failed", 1.0); 12].as_slice(), &[("running", 1.0), ("finished", 2.0)]].concat();
        let members = members(&all);
        let counts = BTreeMap::new();
        let status = Status {
            campaign: "x",
            folder: String::new(),
            process: None,
            seconds_left: Some(1.0),
            counts,
            members,
        };
        let text = text(&status);
        assert!(
            text.starts_with("x: 14 members: 1 finished, 1 running, 12 failed; about 1 s left\n"),
            "{text}"
        );
        assert!(text.contains("no process of this host") && text.contains("  and 2 more: "), "{text}");
        assert_eq!(text.matches("exit code 4: why").count(), ROWS, "{text}");
    }
}
