//! `grainlab launch`: the main job.

use crate::failure::{Failure, worse};
use crate::launch::Run;
use crate::launch::plan::{BUILT_IN, LaunchFile, NodePlan};
use crate::launch::supervisor::{Heard, Supervised, Supervisor};
use crate::network::FreeDomain;
use crate::output::{Format, json, print};
use crate::results::continuity;
use crate::results::measured_packing;
use crate::results::read_back::{self, ReadBack};
use crate::results::summary::{Launched, NodeEnd, Summary};
use crate::results::summary_text;
use crate::scenes::{self, SceneText};
use grainlab_msgs::topics;
use grainlab_node_kit::{Exit, Network, RunId};
use grainlab_recordings::Recording;
use grainlab_recordings::input;
use grainlab_recordings::runs::{RUNS, create_run_directory};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

mod order;
mod resume;

use order::Order;

const EXAMPLES: &str = "\
Examples:
  grainlab                                  the demo scene
  grainlab launch --scene s2 --seed 3       a scene of the paper
  grainlab launch acoustic                  the same, with wave speeds measured and inverted beside the moduli
  grainlab launch acoustic method:=standing_wave speed_noise:=0.01
  grainlab launch my.launch.yaml --scene my_scene.toml
  grainlab launch threads:=1 simd:=scalar   arguments of the launch file
  grainlab launch --resume recordings/runs/s2-1-1

The run lands in recordings/runs/SCENE-SEED-N: the recording, scene.toml, summary.json and the logs of every node.
Without ROS_DOMAIN_ID, a DDS domain that nobody uses is taken and named.";

/// What to launch.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Launch file: demo (the laboratory), acoustic (the same with an acoustic probe) or a file in the YAML form of ROS 2
    /// launch [default: demo], and values for its arguments, as in threads:=2
    #[arg(value_name = "FILE or NAME:=VALUE")]
    words: Vec<String>,
    /// Scene: demo, s1, s2, s3, s4 or a file [default: the one of the launch file]
    #[arg(long, value_name = "SCENE")]
    scene: Option<String>,
    /// Seed of every random choice [default: the one of the scene]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Folder in which the run gets a directory of its own
    #[arg(long, value_name = "DIR", default_value = RUNS)]
    out: PathBuf,
    /// Goes on with this run, from the last packing in its recording, to the bytes that it would have come to; with its
    /// own launch file, arguments, scene and seed
    #[arg(long, value_name = "RUN", conflicts_with_all = ["words", "scene", "seed", "out"])]
    resume: Option<PathBuf>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Default for Args {
    fn default() -> Self {
        Self {
            words: Vec::new(),
            scene: None,
            seed: None,
            out: RUNS.into(),
            resume: None,
            format: Format::Table,
        }
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    if let Some(run) = &args.resume {
        return resume::run(run, args.format);
    }
    let (path, given) = split(&args.words)?;
    let file = read_file(path)?;
    let name = args.scene.as_deref().or(file.default_of("scene")).unwrap_or("demo");
    let seed = args.seed.or_else(|| file.default_of("seed")?.parse().ok());
    let scene = scenes::load(name, seed)?;
    let order = |given: BTreeMap<&str, String>| Order {
        launch: file.text().to_owned(),
        arguments: given.into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
        seed: scene.scene.seed,
    };
    // All that can be refused is refused before the run has a directory.
    refuse_unknown(&order(given.clone()).plans(Path::new("."))?)?;
    let (domain, lock) = domain()?;
    let directory = run_directory(&args.out, &scene)?;
    let order = order(given);
    order.keep(&directory)?;
    let plans = order.plans(&directory)?;
    conduct(plans, domain, lock, &directory, &scene, args.format)
}

/// Starts the processes, follows the run to its end, and reports it.
fn conduct(
    mut plans: Vec<NodePlan>,
    domain: u16,
    lock: Option<FreeDomain>,
    directory: &Path,
    scene: &SceneText,
    format: Format,
) -> Result<Exit, Failure> {
    plans.iter_mut().for_each(NodePlan::do_not_look_around);
    let run = Run { id: RunId::fresh(), domain };
    crate::output::say!(
        "grainlab: scene {}, seed {}, {} grains; DDS domain {domain}, run {}; {}",
        scene.scene.name,
        scene.scene.seed,
        scene.scene.grains,
        run.id,
        directory.display()
    );
    let supervised = supervise(plans, run, directory, scene.scene.phases.len());
    drop(lock);
    let supervised = supervised.inspect_err(|_| _ = remove_if_unused(directory))?;
    let failed = matches!(supervised.exit, Exit::Failure | Exit::Usage);
    if failed && remove_if_unused(directory) {
        return Ok(supervised.exit);
    }
    finish(format, directory, scene, run, supervised)
}

/// A launch file that names a node or a program that does not exist would end in the midst of its start.
fn refuse_unknown(plans: &[NodePlan]) -> Result<(), Failure> {
    let known: Vec<&str> = crate::commands::run::nodes().iter().map(|n| n.name).collect();
    for plan in plans {
        let name = &plan.name;
        match plan.node.as_deref() {
            Some(node) if !known.contains(&node) => {
                let known = known.join(", ");
                let message = format!("executable {name}: there is no node {node:?}; there are: {known}");
                return Err(Failure::usage(message));
            }
            None if !is_program(&plan.program) => {
                let program = &plan.program;
                let message =
                    format!("executable {name}: there is no program {program:?}, here or on the PATH");
                return Err(Failure::usage(message));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Whether a command of this name could be started: a path to an executable file, or the name of one on the PATH.
fn is_program(name: &str) -> bool {
    use std::os::unix::fs::PermissionsExt;
    let executable =
        |path: &Path| path.metadata().is_ok_and(|m| m.is_file() && m.permissions().mode() & 0o111 != 0);
    if name.contains('/') {
        return executable(Path::new(name));
    }
    std::env::var_os("PATH")
        .is_some_and(|path| std::env::split_paths(&path).any(|d| executable(&d.join(name))))
}

/// Removes the directory of a run that did not start: nothing but the scene, and logs without a word, is in it. False if
/// there is more.
fn remove_if_unused(directory: &Path) -> bool {
    let logs = directory.join("logs");
    let empty = |e: &std::fs::DirEntry| e.metadata().is_ok_and(|m| m.len() == 0);
    let unused = std::fs::read_dir(directory).is_ok_and(|mut entries| {
        entries.all(|e| {
            e.is_ok_and(|e| e.file_name() == "scene.toml" || e.file_name() == order::FILE || e.path() == logs)
        })
    });
    let silent = match std::fs::read_dir(&logs) {
        Ok(mut entries) => entries.all(|e| e.as_ref().is_ok_and(empty)),
        Err(_) => true,
    };
    // What cannot be removed stays: the reason for which the run did not start is told in any case.
    unused && silent && std::fs::remove_dir_all(directory).is_ok()
}

/// The launch file, if one is named, and the values for its arguments.
fn split(words: &[String]) -> Result<(Option<&Path>, BTreeMap<&str, String>), Failure> {
    let (mut file, mut values) = (None, BTreeMap::new());
    for word in words {
        match word.split_once(":=") {
            Some((name @ ("scene" | "seed" | "out"), _)) => {
                return Err(Failure::usage(format!("{word}: use --{name}, which the launcher itself needs")));
            }
            Some((name, value)) => {
                values.insert(name, value.to_owned());
            }
            None if file.is_none() => file = Some(Path::new(word)),
            None => {
                return Err(Failure::usage(format!("{word}: a second launch file; one is run at a time")));
            }
        }
    }
    Ok((file, values))
}

/// A built-in launch file or one on disk; the default without a name.
fn read_file(path: Option<&Path>) -> Result<LaunchFile, Failure> {
    let (default, _) = BUILT_IN[0];
    let path = path.unwrap_or(Path::new(default));
    let text = match BUILT_IN.iter().find(|(name, _)| path.as_os_str() == *name) {
        Some((_, text)) => (*text).to_owned(),
        None if path.components().count() == 1 && !path.exists() => {
            let known = BUILT_IN.map(|(name, _)| name).join(", ");
            let message = format!(
                "no launch file {}: neither a file nor built in; built in are: {known}",
                path.display()
            );
            return Err(Failure::usage(message));
        }
        None => input::text(path, input::SETTINGS)
            .map_err(|e| Failure::failed(format!("{}: {e}", path.display())))?,
    };
    LaunchFile::parse(&text).map_err(|e| Failure::usage(format!("{}: {e}", path.display())))
}

fn network() -> Result<Network, Failure> {
    Network::from_env().map_err(Failure::usage)
}

/// The domain of the environment, else a free one, kept while the second value lives.
fn domain() -> Result<(u16, Option<FreeDomain>), Failure> {
    let network = network()?;
    if std::env::var("ROS_DOMAIN_ID").is_ok_and(|v| !v.trim().is_empty()) {
        return Ok((network.domain, None));
    }
    let free = FreeDomain::take()?;
    Ok((free.id, Some(free)))
}

/// The run's directory, with the scene as it is now: a file edited later changes neither the run nor a restart.
fn run_directory(root: &Path, scene: &SceneText) -> Result<PathBuf, Failure> {
    let failed = |e: std::io::Error| Failure::failed(format!("{}: {e}", root.display()));
    let directory = create_run_directory(root, &scene.scene.name, scene.scene.seed).map_err(failed)?;
    let directory = directory.canonicalize().map_err(failed)?;
    std::fs::write(directory.join("scene.toml"), &scene.text).map_err(failed)?;
    Ok(directory)
}

fn supervise(plans: Vec<NodePlan>, run: Run, directory: &Path, phases: usize) -> Result<Supervised, Failure> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(|e| Failure::failed(format!("tokio: {e}")))?;
    runtime.block_on(async { Supervisor::new(plans, run, directory, phases)?.run().await })
}

/// What the run published and its recording does not hold.
fn missing(heard: &Heard, back: &ReadBack) -> Vec<String> {
    let mut missing = Vec::new();
    if let Some(published) = heard.packings.filter(|n| back.packings < *n as usize) {
        missing.push(format!("{} of {published} packings are in the recording", back.packings));
    }
    for (topic, steps) in &heard.results {
        let recorded = back.results.get(topic);
        for step in steps.iter().filter(|step| recorded.is_none_or(|known| !known.contains(step))) {
            missing.push(format!("the {topic} of step {step} was published and is not in the recording"));
        }
    }
    missing
}

/// Reads the recording back, prints the result and writes it beside the recording.
fn finish(
    format: Format,
    directory: &Path,
    scene: &SceneText,
    run: Run,
    supervised: Supervised,
) -> Result<Exit, Failure> {
    let mut exit = supervised.exit;
    let recording = Recording::open(directory);
    let (back, tallies) = match &recording {
        Ok(recording) => (read_back::read(recording), recording.ledger()),
        Err(error) => (ReadBack { complaints: vec![error.to_string()], ..ReadBack::default() }, None),
    };
    if tallies.as_ref().is_none_or(|t| t.iter().any(|t| t.lost > 0)) {
        exit = worse(exit, Exit::DataLoss);
    }
    let mut back = back;
    let mut missing = missing(&supervised.heard, &back);
    // A run that was cut off has a request without its answer.
    if let (Some(_), Ok(recording)) = (supervised.heard.packings, &recording) {
        missing.extend(continuity::missing(recording).map_err(Failure::failed)?);
    }
    let has = |node: &str| supervised.children.iter().any(|c| c.plan.is(node));
    let unanswered = (has(topics::FABRIC.writer) && back.not_analysed > 0)
        || (has(topics::MICROSTRUCTURE.writer) && back.not_inverted > 0);
    if !missing.is_empty() || unanswered {
        exit = worse(exit, Exit::DataLoss);
        back.complaints.extend(missing);
    }
    let nodes = supervised.children.iter().map(|c| NodeEnd {
        name: c.plan.name.clone(),
        pid: c.last_pid,
        exit: c.code,
        restarts: c.restarts.len(),
    });
    let launched = Launched {
        scene: scene.scene.name.clone(),
        seed: scene.scene.seed,
        domain: run.domain,
        run: run.id.to_string(),
        wall_seconds: supervised.wall.as_secs_f64(),
        nodes: nodes.collect(),
        recording: recording.is_ok().then(|| directory.display().to_string()),
        exit,
    };
    let summary = Summary::new(launched, back, tallies.as_deref());
    let path = directory.join("summary.json");
    let text = json(&summary)?;
    summary.strangers.iter().for_each(|s| crate::output::say!("grainlab: {}", s.line()));
    summary.warnings.iter().for_each(|w| crate::output::say!("grainlab: {w}"));
    let packings: Vec<_> = summary.states.iter().map(|s| s.packing.clone()).collect();
    // Printed before anything that may fail: the result is not lost with the disk.
    let printed = print(&match format {
        Format::Json => text.clone(),
        Format::Csv => measured_packing::table(&packings).csv(),
        Format::Table => {
            let text = summary_text::text(&summary);
            format!("{text}  recording {}\n  summary   {}\n", directory.display(), path.display())
        }
    });
    for failure in [write_whole(&path, &text), printed].into_iter().filter_map(Result::err) {
        crate::output::say!("grainlab: {failure}");
        // A run that lost data because the disk was full has lost data; that its summary is missing, too, is no other fault.
        exit = if exit == Exit::DataLoss { exit } else { worse(exit, failure.exit) };
    }
    Ok(exit)
}

/// Writes a file whole or not at all.
fn write_whole(path: &Path, text: &str) -> Result<(), Failure> {
    let partial = path.with_extension("json.part");
    let written = std::fs::write(&partial, text).and_then(|()| std::fs::rename(&partial, path));
    written.map_err(|e| {
        let _ = std::fs::remove_file(&partial);
        Failure::failed(format!("{}: {e}; the result was printed, and is in the recording", path.display()))
    })
}

#[cfg(test)]
mod tests;
