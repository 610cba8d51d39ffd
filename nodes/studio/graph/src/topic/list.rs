//! `grainlab topic list` and `find`.

use crate::graph::TopicEntry;
use crate::view::Listing;
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

/// Lists the topics, or those of a type.
pub(super) fn run(listing: &Listing, type_name: Option<&str>) -> Result<Exit, Failure> {
    let graph = listing.common.graph()?;
    let row = |(name, topic): (&str, TopicEntry<'_>)| Row {
        name: name.to_owned(),
        types: topic.types().into_iter().map(str::to_owned).collect(),
        publishers: topic.publishers.len(),
        subscriptions: topic.subscriptions.len(),
    };
    let is_asked = |row: &Row| type_name.is_none_or(|name| row.types.iter().any(|t| t == name));
    let rows = graph.topics().into_iter().map(row).filter(is_asked).collect();
    listing.print(
        rows,
        |row| &row.name,
        |rows| {
            let mut table = Table::new(["topic", "type", "publishers", "subscriptions"]);
            for row in rows {
                let counts = [row.publishers.to_string(), row.subscriptions.to_string()];
                table.row([row.name.clone(), row.types.join(" and ")].into_iter().chain(counts));
            }
            table.text()
        },
    )
}
