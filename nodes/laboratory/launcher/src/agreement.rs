//! Agreement of the processes of a launch file before anything is started: on the names of topics, and the scene, seed and
//! directory of the run.

use crate::nodes::NodeKind;
use crate::plan::{NodePlan, PlanError};
use grainlab_node_kit::{NameError, Names};
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
    let (_, _, recorded) =
        recorder.ok_or(PlanError::Count { node: NodeKind::Recorder, count: 0, allowed: "one" })?;
    for (plan, node, names) in &parsed {
        let resolve = |names: &Names, topic: &str| {
            let refused =
                |e: NameError| PlanError::Arguments { name: plan.name.clone(), reason: e.to_string() };
            names.resolve(topic).map_err(refused)
        };
        let mut known: BTreeMap<String, &'static str> = BTreeMap::new();
        for topic in node.topics() {
            let (found, wanted) = (resolve(names, topic.name)?, resolve(recorded, topic.name)?);
            let (name, topic) = (plan.name.clone(), topic.name);
            if found != wanted {
                return Err(PlanError::Apart { name, topic, found, recorded: wanted });
            }
            if let Some(first) = known.insert(found.clone(), topic) {
                return Err(PlanError::OneName { name, first, second: topic, found });
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
                let name = self.name.clone();
                return Err(PlanError::NotHandedOn { name, parameter, found, wanted, arg });
            }
        }
        Ok(())
    }
}
