//! `grainlab campaign status`: how far the members of a campaign came.

use grainlab_campaign::{Campaign, Folder, Standing};
use grainlab_console::{Failure, Format, Table, count, duration, exact};
use grainlab_node_kit::Exit;
use grainlab_page::Mean;
use grainlab_recordings::{AtWork, Lock};
use serde_json::json;
use std::collections::BTreeMap;

/// Most rows of members at work, and of others.
const ROWS: usize = 10;

pub(super) fn run(campaign: &Campaign, folder: &Folder, format: Format) -> Result<Exit, Failure> {
    let members: Vec<Standing> = campaign.members.iter().map(|m| folder.standing(m)).collect();
    let process = match Lock::at_work(folder.root()) {
        AtWork::Holder(who) => Some(who),
        _ => None,
    };
    let left = seconds_left(&members);
    let counts: BTreeMap<_, _> = Standing::counts(&members).into_iter().collect();
    let (name, root) = (&campaign.name, folder.root().to_string_lossy());
    let value = json!({"campaign": name, "folder": root, "process": process, "seconds_left": left, "counts": counts, "members": members});
    let text = || {
        let left = left.map_or_else(String::new, |s| format!("; about {} left", duration(s)));
        let is_over = members.iter().all(|m| ["finished", "failed"].contains(&m.state));
        let process = match process {
            Some(who) => format!("{who} runs the campaign\n"),
            None if is_over => String::new(),
            None if members.iter().any(|m| m.state == "running") => "its members run without it\n".into(),
            None => "no process of this host runs it: the command that began it continues it\n".into(),
        };
        let (all, words) = (count(members.len(), "member"), Standing::words(&members));
        format!("{name}: {all}: {words}{left}\n{process}") + &rows(&members)
    };
    format.print(&value, || csv(&members), text)?;
    Ok(Exit::Done)
}

/// Members that run, and others with the reason why they are not finished, some of each.
fn rows(members: &[Standing]) -> String {
    let (running, others): (Vec<_>, Vec<_>) =
        members.iter().filter(|m| m.reason.is_some()).partition(|m| m.state == "running");
    let shown: Vec<_> = running.iter().take(ROWS).chain(others.iter().take(ROWS)).collect();
    let row = |m: &&&Standing| {
        let after = m.seconds.map_or_else(String::new, |s| format!(", {s:.1} s"));
        format!("  {}: {}{after}: {}\n", m.name, m.state, m.reason.as_deref().unwrap_or_default())
    };
    let text: String = shown.iter().map(row).collect();
    match running.len() + others.len() - shown.len() {
        0 => text,
        n => format!("{text}  and {n} more: --format json has every member\n"),
    }
}

fn csv(members: &[Standing]) -> String {
    let mut table = Table::new(["member", "state", "seconds", "reason"]);
    for Standing { name, state, reason, seconds } in members {
        table.row([name, *state, &exact(*seconds), reason.as_deref().unwrap_or_default()]);
    }
    table.csv()
}

/// Time until the last member is finished, s, if each takes the mean of those that are, and as many as now run at a time. One that has
/// run longer than the mean is expected to take as long again.
fn seconds_left(members: &[Standing]) -> Option<f64> {
    let of = |states: &'static [&str]| members.iter().filter(move |m| states.contains(&m.state));
    let mean = Mean::of(of(&["finished"]).filter_map(|m| m.seconds))?.value;
    let rest = |run: f64| if run < mean { mean - run } else { run };
    let begun: f64 = of(&["running"]).map(|m| rest(m.seconds.unwrap_or(0.0))).sum();
    let left = begun + mean * of(&["waiting", "interrupted"]).count() as f64;
    Some(left / of(&["running"]).count() as f64).filter(|s| s.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_known_once_a_member_is_finished_and_another_one_runs_and_rows_are_few() {
        let members = |states: &[(&'static str, f64)]| -> Vec<Standing> {
            let reason = Some("why".to_owned());
            let one =
                |&(state, s)| Standing { name: "m".into(), state, reason: reason.clone(), seconds: Some(s) };
            states.iter().map(one).collect()
        };
        let all =
            [("finished", 4.0), ("finished", 6.0), ("running", 2.0), ("running", 9.0), ("waiting", 0.0)];
        assert_eq!(seconds_left(&members(&all)), Some((3.0 + 9.0 + 5.0) / 2.0));
        assert_eq!([&all[..2], &all[2..]].map(|some| seconds_left(&members(some))), [None; 2]);
        let text = rows(&members(&[("failed", 1.0); ROWS + 2]));
        assert_eq!(text.matches("  m: failed, 1.0 s: why\n").count(), ROWS, "{text}");
        assert!(text.ends_with("  and 2 more: --format json has every member\n"), "{text}");
    }
}
