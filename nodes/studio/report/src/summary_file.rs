//! `summary.json` of a run, as far as a report needs it: everything in it may be missing.

use grainlab_results::{NodeEnd, TopicCount};
use serde::Deserialize;

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct SummaryFile {
    pub(crate) scene: String,
    pub(crate) seed: Option<u64>,
    pub(crate) run: String,
    pub(crate) domain: Option<u16>,
    pub(crate) wall_seconds: Option<f64>,
    pub(crate) nodes: Vec<NodeEnd>,
    pub(crate) topics: Vec<TopicCount>,
    pub(crate) strangers: Vec<serde_json::Value>,
    pub(crate) exchanges: Option<u64>,
    pub(crate) exchanges_per_second: Option<f64>,
    pub(crate) waiting_fraction: Option<f64>,
    pub(crate) particle_steps_per_second: Option<f64>,
    pub(crate) saved_step: Option<u64>,
    pub(crate) exit: Option<u8>,
    pub(crate) warnings: Vec<String>,
}

impl SummaryFile {
    pub(crate) fn total(&self, count: fn(&TopicCount) -> u64) -> u64 {
        self.topics.iter().map(count).sum()
    }
}
