//! `grainlab topic list`.

use crate::view::Common;
use grainlab_console::{Failure, Table};
use grainlab_node_kit::Exit;
use serde::Serialize;

#[derive(Serialize)]
struct Row {
    name: String,
    /// One, unless publishers and subscriptions disagree.
    types: Vec<String>,
    publishers: usize,
    subscriptions: usize,
}

pub(super) fn run(types: bool, common: &Common) -> Result<Exit, Failure> {
    let graph = common.graph()?;
    let topics = graph.topics();
    let rows: Vec<Row> = topics
        .iter()
        .map(|(name, topic)| Row {
            name: (*name).to_owned(),
            types: topic.types().into_iter().map(str::to_owned).collect(),
            publishers: topic.publishers.len(),
            subscriptions: topic.subscriptions.len(),
        })
        .collect();
    common.show(&rows, || {
        if !types {
            return rows.iter().map(|row| format!("{}\n", row.name)).collect();
        }
        let mut table = Table::new(["topic", "type", "publishers", "subscriptions"]);
        for row in &rows {
            let counts = [row.publishers.to_string(), row.subscriptions.to_string()];
            table.row([row.name.clone(), row.types.join(" and ")].into_iter().chain(counts));
        }
        table.text()
    })
}
