//! `grainlab topic list`.

use crate::graph::TopicEntry;
use crate::names::is_hidden;
use crate::view::Common;
use grainlab_console::{Failure, Table};
use grainlab_node_kit::Exit;
use serde::Serialize;

/// Arguments of `grainlab topic list`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  grainlab topic list --types")]
pub struct Args {
    /// Print the types, and the numbers of publishers and subscriptions
    #[arg(short, long)]
    types: bool,
    #[command(flatten)]
    common: Common,
}

#[derive(Serialize)]
struct Row {
    name: String,
    /// One, unless publishers and subscriptions disagree.
    types: Vec<String>,
    publishers: usize,
    subscriptions: usize,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let graph = args.common.graph()?;
    let row = |(name, topic): (&str, TopicEntry<'_>)| Row {
        name: name.to_owned(),
        types: topic.types().into_iter().map(str::to_owned).collect(),
        publishers: topic.publishers.len(),
        subscriptions: topic.subscriptions.len(),
    };
    let rows: Vec<Row> = graph.topics().into_iter().filter(|(name, _)| !is_hidden(name)).map(row).collect();
    args.common.show(&rows, || {
        if !args.types {
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
