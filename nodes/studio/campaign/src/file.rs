//! The file of a campaign.

use serde::Deserialize;
use std::collections::BTreeMap;
use toml::{Table, Value};

/// The keys of the file, as written.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CampaignFile {
    /// Name of the campaign; letters, digits, `_` and `-`.
    pub(crate) name: String,
    /// Description in one line.
    #[serde(default)]
    pub(crate) description: String,
    /// Scenes, each run with every combination of `vary` and every seed.
    #[serde(default)]
    pub(crate) scenes: Vec<String>,
    /// Seeds of every combination.
    pub(crate) seeds: Option<Seeds>,
    /// Launch file: built in, or a path from this file.
    pub(crate) launch: Option<String>,
    /// Values for arguments of the launch file.
    #[serde(default)]
    pub(crate) arguments: BTreeMap<String, Value>,
    /// Messages to record: `results` (packings, and what was measured and inferred) or `all`.
    #[serde(default)]
    pub(crate) record: Record,
    /// Each member has a page, `report.html`.
    #[serde(default)]
    pub(crate) report: bool,
    /// Keys set in every scene.
    #[serde(default)]
    pub(crate) set: Table,
    /// Keys and the values that each takes.
    #[serde(default)]
    pub(crate) vary: Table,
    /// More combinations, each with scenes, seeds and values of its own.
    #[serde(default)]
    pub(crate) group: Vec<Group>,
    /// A table of runs: CSV by its path from this file, with the columns `scene`, `seed`, and keys of scenes.
    pub(crate) table: Option<String>,
}

/// Messages that the recording of a member has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Record {
    #[default]
    Results,
    All,
}

/// Scenes, each run with every combination of `vary` and every seed.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Group {
    pub(crate) scenes: Vec<String>,
    pub(crate) seeds: Option<Seeds>,
    #[serde(default)]
    pub(crate) set: Table,
    #[serde(default)]
    pub(crate) vary: Table,
}

/// Seeds: a list, or a range.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, expecting = "seeds are whole numbers from 0: a list, or { first = 1, count = 5 }")]
pub(crate) enum Seeds {
    List(Vec<u64>),
    Range { first: u64, count: u64 },
}

impl Seeds {
    /// The seeds, at most `most` of them.
    pub(crate) fn all(&self, most: usize) -> Vec<u64> {
        match self {
            Self::List(seeds) => seeds.iter().take(most).copied().collect(),
            Self::Range { first, count } => (*first..first.saturating_add(*count)).take(most).collect(),
        }
    }
}
