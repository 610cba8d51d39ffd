//! `grainlab node state`.

use crate::observer::Observer;
use crate::reports::latest_reports;
use crate::view::Common;
use grainlab_console::{Failure, Table};
use grainlab_node_kit::{Exit, Level, Report};
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Serialize)]
struct NodeState {
    node: String,
    /// `ok`, `warning`, `error`, or `silent`.
    level: &'static str,
    /// Text of the node about its work, or what it waits for.
    state: String,
    pid: Option<u32>,
    values: BTreeMap<String, String>,
}

fn row(report: &Report) -> NodeState {
    let level = match report.health.level {
        Level::Ok => "ok",
        Level::Warn => "warning",
        _ => "error",
    };
    let values = report.health.values.iter().map(|(key, value)| (key.clone(), value.clone())).collect();
    let state = report.health.message.clone();
    NodeState { node: report.node.clone(), level, state, pid: Some(report.pid), values }
}

pub(super) fn run(common: &Common) -> Result<Exit, Failure> {
    let mut observer = Observer::join()?;
    let graph = observer.settled(common.patience());
    let heard = latest_reports(&mut observer, &graph.reporting())?;
    let mut rows: BTreeMap<String, NodeState> =
        heard.iter().map(|(node, report)| (node.clone(), row(report))).collect();
    for node in graph.reporting() {
        rows.entry(node.clone()).or_insert_with(|| NodeState {
            node,
            level: "silent",
            state: "no report for 15 s: stopped, hanging, or killed less than a minute ago".into(),
            pid: None,
            values: BTreeMap::new(),
        });
    }
    let rows: Vec<NodeState> = rows.into_values().collect();
    common.show(&rows, || {
        let mut table = Table::new(["node", "level", "pid", "state"]);
        for r in &rows {
            let pid = r.pid.map_or_else(|| "-".to_owned(), |pid| pid.to_string());
            table.row([r.node.clone(), r.level.to_owned(), pid, r.state.clone()]);
        }
        table.text()
    })?;
    let wrong = rows.iter().any(|r| matches!(r.level, "error" | "silent"));
    Ok(if wrong { Exit::Failure } else { Exit::Done })
}
