//! `grainlab topic list` and `find`.

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
    #[arg(short = 't', long, visible_alias = "show-types", short_alias = 'v', visible_alias = "verbose")]
    types: bool,
    /// Print their number only
    #[arg(short, long)]
    count_topics: bool,
    /// Also those with a part that begins with an underscore
    #[arg(long)]
    include_hidden_topics: bool,
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

fn rows(common: &Common, hidden: bool) -> Result<Vec<Row>, Failure> {
    let graph = common.graph()?;
    let topics = graph.topics();
    let shown = topics.iter().filter(|(name, _)| hidden || !is_hidden(name));
    let row = |(name, topic): (&&str, &crate::graph::TopicEntry<'_>)| Row {
        name: (*name).to_owned(),
        types: topic.types().into_iter().map(str::to_owned).collect(),
        publishers: topic.publishers.len(),
        subscriptions: topic.subscriptions.len(),
    };
    Ok(shown.map(row).collect())
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let rows = rows(&args.common, args.include_hidden_topics)?;
    if args.count_topics {
        return args.common.show(&rows.len(), || format!("{}\n", rows.len()));
    }
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

pub(super) fn find(type_name: &str, count: bool, hidden: bool, common: &Common) -> Result<Exit, Failure> {
    let mut rows = rows(common, hidden)?;
    rows.retain(|row| row.types.iter().any(|t| t == type_name));
    if count {
        return common.show(&rows.len(), || format!("{}\n", rows.len()));
    }
    common.show(&rows, || rows.iter().map(|row| format!("{}\n", row.name)).collect())
}
