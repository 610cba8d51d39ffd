//! Processes on the bus that are not part of the run, as they are recorded.

use grainlab_node_kit::{Stranger, member_of};
use grainlab_recordings::strangers::StrangerView;
use std::collections::BTreeMap;

/// The name under which a stranger is counted: `run ID` for all processes of another launched run, else the
/// process.
pub fn name(stranger: &Stranger) -> String {
    match stranger.run {
        Some(run) if member_of(&stranger.participant) != 0 => format!("run {run}"),
        _ => stranger.to_string(),
    }
}

/// For a recording and for `summary.json`: one entry for each process, and one for each other run.
pub fn grouped(strangers: impl Iterator<Item = Stranger>) -> Vec<StrangerView> {
    let mut views: BTreeMap<String, StrangerView> = BTreeMap::new();
    for stranger in strangers {
        let run = stranger.run.map(|run| run.to_string());
        let who = name(&stranger);
        let new = StrangerView { who: who.clone(), run, ignored: BTreeMap::new() };
        let view = views.entry(who).or_insert(new);
        for (topic, count) in stranger.ignored {
            *view.ignored.entry(topic).or_default() += count;
        }
    }
    views.into_values().collect()
}
