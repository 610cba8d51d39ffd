//! Processes to start: nodes of grainlab and other programs.

use crate::nodes::NodeKind;
use grainlab_node_kit::{Names, Parameters};

/// Why a launch file is refused: the place, and what to write instead.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct PlanError(pub(crate) String);

impl PlanError {
    /// The fault of one executable.
    pub(crate) fn of(name: &str, reason: impl std::fmt::Display) -> Self {
        Self(format!("executable {name}: {reason}"))
    }

    /// The fault with the line of its action, unless it has one of an action within.
    pub(crate) fn in_line(self, line: u64) -> Self {
        if self.0.starts_with("line ") { self } else { Self(format!("line {line}: {self}")) }
    }

    pub(crate) fn included(self, file: &str) -> Self {
        Self(format!("include {file}: {self}"))
    }

    /// The number of these nodes is not the allowed one.
    pub(crate) fn count(node: NodeKind, count: usize) -> Self {
        Self(format!("the launch file starts {count} of {node}; there must be {}", node.per_run().1))
    }
}

/// Topics that are recorded where only packings and results are.
const RESULTS: &str = "topics:=[packing,packing_report,moduli,wave_speeds,microstructure,run_state,energy,diagnostics,tf_static]";

/// One process to start.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NodePlan {
    /// Name of the process and of its log.
    pub name: String,
    /// The node of grainlab; `None` for a third-party program.
    pub node: Option<NodeKind>,
    /// The program; for a grainlab node, any `grainlab` means this binary.
    pub program: String,
    /// Arguments; for a node: `run`, the node, its ROS arguments.
    pub arguments: Vec<String>,
    /// True if it is restarted when it ends by itself.
    pub respawn: bool,
    /// True if its end is that of all.
    pub ends_all: bool,
    /// Variables of its environment, beside those of the launcher; a later one takes precedence.
    pub environment: Vec<(String, String)>,
}

impl NodePlan {
    /// True if it is this node of grainlab.
    pub fn is(&self, node: NodeKind) -> bool {
        self.node == Some(node)
    }

    /// Refuses parameters that its node does not have, or whose values it does not take, before anything is started.
    ///
    /// # Errors
    /// If there is such a parameter; the text names the process, the parameter and its valid values.
    pub fn check_parameters(&self) -> Result<(), PlanError> {
        self.parsed().map(drop)
    }

    /// The node with the names of its topics and the values of its parameters; `None` for a third-party program.
    pub(crate) fn parsed(&self) -> Result<Option<(NodeKind, Names, Parameters)>, PlanError> {
        let Some(node) = self.node else { return Ok(None) };
        // After `run NODE`.
        let parsed = node.parse(self.arguments.get(2..).unwrap_or_default());
        let (names, parameters) = parsed.map_err(|reason| PlanError::of(&self.name, reason))?;
        Ok(Some((node, names, parameters)))
    }

    /// Sets the parameters of a simulator whose run is supervised. It does not look for duplicates, unless the launch file
    /// sets it. It does not end by itself: the launcher ends it after the results, and a restarted reader needs its packing.
    pub fn supervised(&mut self) {
        if self.is(NodeKind::DemSimulator) {
            // The last value of a parameter takes precedence: this one is before those of the launch file, after `run NODE`.
            let given = ["--ros-args", "-p", "look_around:=0.0"].map(str::to_owned);
            self.arguments.splice(2..2, given);
            self.insist(&["finish:=never", "exit_when_finished:=false"]);
        }
    }

    /// Sets parameters of the node; they take precedence over those of the launch file.
    fn insist(&mut self, parameters: &[&str]) {
        for given in parameters {
            self.arguments.extend(["--ros-args", "-p", given].map(str::to_owned));
        }
    }

    /// Records packings and results alone: no other node waits for a recorder of the lockstep.
    pub fn record_results(&mut self) {
        match self.node {
            Some(NodeKind::Recorder) => self.insist(&[RESULTS]),
            Some(NodeKind::DemSimulator) => self.insist(&["wait_for:=[packing]"]),
            Some(NodeKind::ServoController) => self.insist(&["min_readers:=1"]),
            _ => {}
        }
    }

    /// Makes ready for one process with the servo: the answer is there at once, and nothing is gained by a speculative step.
    pub fn composed(&mut self) {
        if self.is(NodeKind::DemSimulator) {
            self.insist(&["ahead:=false"]);
        }
    }
}
