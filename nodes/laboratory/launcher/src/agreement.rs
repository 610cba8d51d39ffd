//! Agreement of the processes of a launch file before anything is started: on the names of topics, and the scene, seed and
//! directory of the run.

use crate::nodes::NodeKind;
use crate::plan::{NodePlan, PlanError};
use grainlab_node_kit::Names;
use std::collections::BTreeMap;
use std::path::Path;

/// The names of the topics of a run, which are those of its recorder.
///
/// # Errors
/// If a node uses another name for a topic than the recorder, or two topics have one name: the run would not begin, or would be
/// recorded in part.
pub fn names_of_run(plans: &[NodePlan]) -> Result<Names, PlanError> {
    let parsed: Vec<(&NodePlan, NodeKind, Names)> = plans
        .iter()
        .filter_map(|plan| Some(plan.parsed().transpose()?.map(|(node, names, _)| (plan, node, names))))
        .collect::<Result<_, _>>()?;
    let recorder = parsed.iter().find(|(_, node, _)| *node == NodeKind::Recorder);
    let (_, _, recorded) = recorder.ok_or_else(|| PlanError::count(NodeKind::Recorder, 0))?;
    for (plan, node, names) in &parsed {
        let resolve =
            |names: &Names, topic: &str| names.resolve(topic).map_err(|e| PlanError::of(&plan.name, e));
        let mut known: BTreeMap<String, &'static str> = BTreeMap::new();
        for topic in node.topics() {
            let (found, wanted) = (resolve(names, topic.name)?, resolve(recorded, topic.name)?);
            let topic = topic.name;
            if found != wanted {
                let reason = format!(
                    "the topic {topic} is {found} there and {wanted} for the recorder: the processes of a run meet, and are \
                     recorded, under one name. Give all of them the same namespace (-r __ns:=/NAME) and the same remaps (-r)"
                );
                return Err(PlanError::of(&plan.name, reason));
            }
            if let Some(first) = known.insert(found.clone(), topic) {
                let reason =
                    format!("the topics {first} and {topic} are both {found}: give each a name of its own");
                return Err(PlanError::of(&plan.name, reason));
            }
        }
    }
    Ok(recorded.clone())
}

impl NodePlan {
    /// Refuses a simulator or recorder that does not use the scene, the seed and the directory that the launcher sets: another
    /// run would be simulated, or recorded elsewhere, than is reported.
    ///
    /// # Errors
    /// If a parameter has another value; the text names it.
    pub fn check_handed_on(&self, scene: &Path, seed: u64, out: &Path) -> Result<(), PlanError> {
        let Some((node, _, parameters)) = self.parsed()? else { return Ok(()) };
        let path = |path: &Path| path.to_string_lossy().into_owned();
        let wanted = [
            ("scene", "scene", path(scene)),
            ("seed", "seed", seed.to_string()),
            ("out", "output", path(out)),
        ];
        for (arg, parameter, wanted) in wanted {
            let found = match (node, parameter) {
                (NodeKind::DemSimulator | NodeKind::Recorder, "scene") => parameters.get::<String>(parameter),
                (NodeKind::DemSimulator | NodeKind::Recorder, "seed") => {
                    parameters.get::<i64>(parameter).to_string()
                }
                (NodeKind::Recorder, "output") => parameters.get::<String>(parameter),
                _ => continue,
            };
            if found != wanted {
                let reason = format!(
                    "its parameter {parameter} is {found:?}, not {wanted:?}, which grainlab launch sets: hand it on with \
                     `-p {parameter}:=$(var {arg})`"
                );
                return Err(PlanError::of(&self.name, reason));
            }
        }
        Ok(())
    }
}
