//! A launch from the first process to the report.

use super::finish::{Output, finish};
use super::order;
use crate::commands::scene::notes_on;
use grainlab_console::Failure;
use grainlab_launcher::{NodePlan, Outline, Run, Supervised, Supervisor, run_in_one_process};
use grainlab_node_kit::{Exit, FreeDomain, Network, OffTheBus, RunId};
use grainlab_recordings::Lock;
use grainlab_recordings::scenes::SceneText;
use grainlab_scene::Scene;
use std::path::Path;

/// Starts the processes, follows the run to its end, and reports it.
pub(super) fn conduct(
    mut plans: Vec<NodePlan>,
    medium: Medium,
    directory: &Path,
    scene: &SceneText,
    output: Output,
) -> Result<Exit, Failure> {
    plans.iter_mut().for_each(NodePlan::supervised);
    let id = RunId::fresh();
    let domain = medium.domain();
    let place = domain.map_or_else(|| "in one process".to_owned(), |domain| format!("DDS domain {domain}"));
    grainlab_console::say!(
        "grainlab: scene {}, seed {}, {} grains; {place}, run {id}; {}",
        scene.scene.name,
        scene.scene.seed,
        scene.scene.grains,
        directory.display()
    );
    for note in notes_on(scene) {
        grainlab_console::say!("grainlab: note: {note}");
    }
    let outline = outline(&scene.scene);
    let supervised = match domain {
        None => run_in_one_process(plans, id, directory, outline),
        Some(domain) => supervise(plans, Run { id, domain }, directory, outline),
    };
    drop(medium);
    let supervised = supervised.inspect_err(|_| _ = remove_if_unused(directory))?;
    let failed = matches!(supervised.exit, Exit::Failure | Exit::Usage);
    if failed && remove_if_unused(directory) {
        return Ok(supervised.exit);
    }
    finish(output, directory, scene, (id, domain), supervised)
}

/// Removes the directory of a run that did not start, if it holds only the scene and empty logs. False if there is
/// more.
fn remove_if_unused(directory: &Path) -> bool {
    let logs = directory.join("logs");
    let empty = |e: &std::fs::DirEntry| e.metadata().is_ok_and(|m| m.len() == 0);
    let unused = std::fs::read_dir(directory).is_ok_and(|mut entries| {
        entries.all(|e| {
            e.is_ok_and(|e| {
                e.path() == logs
                    || ["scene.toml", order::FILE, Lock::FILE].iter().any(|name| e.file_name() == *name)
            })
        })
    });
    let silent = match std::fs::read_dir(&logs) {
        Ok(mut entries) => entries.all(|e| e.as_ref().is_ok_and(empty)),
        Err(_) => true,
    };
    // A failure to remove it is not reported: the reason why the run did not start is.
    unused && silent && std::fs::remove_dir_all(directory).is_ok()
}

/// Transport of the messages of a run.
pub(super) enum Medium {
    /// The memory of this process, which tools of this host can find.
    Memory(#[expect(dead_code, reason = "held to the end of the run")] OffTheBus),
    /// The DDS domain of the environment.
    Domain(u16),
    /// A free domain, reserved until this is dropped.
    Free(FreeDomain),
}

impl Medium {
    pub(super) fn domain(&self) -> Option<u16> {
        match self {
            Self::Memory(_) => None,
            Self::Domain(domain) => Some(*domain),
            Self::Free(free) => Some(free.id),
        }
    }
}

/// The medium of a run in one process, or else of processes: the domain of the environment, or a free one.
pub(super) fn medium(one_process: bool) -> Result<Medium, Failure> {
    if one_process {
        return Ok(Medium::Memory(OffTheBus::enter()));
    }
    let network = Network::from_env().map_err(Failure::usage)?;
    network.exposure().iter().for_each(|text| grainlab_console::say!("grainlab: warning: {text}"));
    if std::env::var("ROS_DOMAIN_ID").is_ok_and(|v| !v.trim().is_empty()) {
        return Ok(Medium::Domain(network.domain));
    }
    FreeDomain::take().map(Medium::Free)
}

fn supervise(
    plans: Vec<NodePlan>,
    run: Run,
    directory: &Path,
    outline: Outline,
) -> Result<Supervised, Failure> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(|e| Failure::failed(format!("tokio: {e}")))?;
    runtime.block_on(async { Supervisor::new(plans, run, directory, outline)?.run().await })
}

fn outline(scene: &Scene) -> Outline {
    Outline { phases: scene.phases.len(), starts_from_packing: scene.start.is_some() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_directory_of_a_run_that_left_nothing_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        for (file, content, kept) in
            [("logs/servo.log", "", false), ("logs/servo.log", "why", true), ("a_0.mcap", "", true)]
        {
            let run = folder.path().join("run");
            std::fs::create_dir_all(run.join("logs")).unwrap();
            std::fs::write(run.join("scene.toml"), "name = 'x'").unwrap();
            std::fs::write(run.join(file), content).unwrap();
            remove_if_unused(&run);
            assert_eq!(run.exists(), kept, "{file} {content:?}");
            let _ = std::fs::remove_dir_all(&run);
        }
    }
}
