//! `grainlab launch`: the main job.

#[cfg(feature = "studio")]
use grainlab_campaign::{Campaign, Member};
use grainlab_console::{Failure, Format, memory, say};
use grainlab_launcher::agreement::names_of_run;
use grainlab_launcher::{BUILT_IN, LaunchFile, NodePlan, start_all};
use grainlab_node_kit::Exit;
use grainlab_recordings::runs::{RUNS, create_run_directory};
use grainlab_recordings::scenes::SceneText;
use grainlab_recordings::{input, scenes};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

mod conduct;
mod directory;
mod finish;
mod order;
mod resume;

use conduct::{conduct, medium};
use directory::Given;
#[cfg(feature = "studio")]
pub(crate) use directory::another_scene;
use finish::Output;
use order::{EngineOptions, Order, Record};

const EXAMPLES: &str = "\
Examples:
  grainlab                                  the demo scene
  grainlab launch --scene s2 --seed 3       a scene of the paper
  grainlab launch --scene s2 --set grains.count=500 --set friction=0.2 --set phase.rest.drag=1e3
  grainlab launch acoustic                  the same, with wave speeds measured and inverted, too
  grainlab launch acoustic method:=cross_correlation speed_noise:=0.01
  grainlab launch my.launch.yaml --scene my_scene.toml
  grainlab launch threads:=1 simd:=scalar   arguments of the launch file
  grainlab launch --resume recordings/runs/s2-1-1
  grainlab launch --scene s2 --run mine     begins, continues or keeps the run in the directory mine

The run is stored in recordings/runs/SCENE-SEED-N: the recording, scene.toml, summary.json and the logs of every node.
Without ROS_DOMAIN_ID, an unused DDS domain is chosen and printed.";

/// The run to launch.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Launch file: demo (the laboratory), acoustic (the same with an acoustic probe) or a file in the YAML form of ROS
    /// 2 launch [default: demo], and values for its arguments, as in threads:=2
    #[arg(value_name = "FILE or NAME:=VALUE")]
    words: Vec<String>,
    #[arg(long, value_name = "SCENE", help = scene_help())]
    scene: Option<String>,
    /// Set a key of the scene, as in grains.count=500 or phase.rest.drag=1e3; may be repeated. `grainlab
    /// scene keys` lists the keys
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Seed of every random choice [default: the one of the scene]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Folder for the directory of the run [default: recordings/runs]
    #[arg(long, short, alias = "output", value_name = "DIR")]
    out: Option<PathBuf>,
    /// Directory of the run itself: it begins there, continues if it was interrupted, and is left as it is if it is
    /// finished, so that the same command can be repeated
    #[arg(long, value_name = "DIR", conflicts_with = "out")]
    run: Option<PathBuf>,
    /// Continue this run from the last packing in its recording, with its launch file, arguments, scene and
    /// seed; the result is the same to the last byte as without the interruption (by LAMMPS, up to rounding errors)
    #[arg(long, value_name = "RUN", conflicts_with_all = ["words", "scene", "set", "seed", "out", "run"])]
    resume: Option<PathBuf>,
    /// Run all nodes in this process, without DDS, to the same bytes in less time. Tools and other programs cannot see such a run,
    /// and the run ends if a node fails
    #[arg(long, conflicts_with = "resume")]
    one_process: bool,
    /// Messages to record
    #[arg(long, value_enum, default_value_t, conflicts_with = "resume")]
    record: Record,
    #[command(flatten)]
    engine: EngineOptions,
    /// Write no report.html
    #[arg(long)]
    no_report: bool,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    /// Print all measurements of each packing, and the estimate of each model
    #[arg(long)]
    verbose: bool,
}

fn scene_help() -> String {
    let known = grainlab_scene::BUILT_IN.map(|(name, _)| name).join(", ");
    format!("Scene: {known} or a file [default: the one of the launch file]")
}

/// Memory of the simulator as a gas begins, bytes a grain. Through the whole laboratory a run comes to eight times as much.
const LEAST_MEMORY: f64 = 800.0;

pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    let args = &args.with_flags()?;
    let report = !args.no_report;
    let output = Output { format: args.format, verbose: args.verbose, resumed: false, report };
    if let Some(run) = &args.resume {
        directory::check_path(run)?;
        // A directory without a run gets no lock.
        Order::read(run)?;
        let _at_work = directory::lock(run)?;
        return resume::run(run, &args.engine, output);
    }
    if let Some(exit) = without_run(args)? {
        return Ok(exit);
    }
    directory::check_path(args.run.as_deref().or(args.out.as_deref()).unwrap_or(Path::new(RUNS)))?;
    let (scene, order) = planned(args)?;
    let grains = scene.scene.grains;
    memory::require(LEAST_MEMORY * f64::from(grains), &format!("a run of {grains} grains takes"))?;
    // The lock is held to the end of the run.
    let (directory, _at_work) = match &args.run {
        None => {
            let directory = new_directory(args.out.as_deref().unwrap_or(Path::new(RUNS)), &scene)?;
            let lock = directory::lock(&directory)?;
            (directory, lock)
        }
        Some(directory) => match directory::given(directory, &scene, &order)? {
            Given::Finished => return Ok(Exit::Done),
            Given::Begun(directory, _at_work) => {
                return resume::run(&directory, &EngineOptions::default(), output);
            }
            Given::Empty(directory, lock) => (directory, lock),
        },
    };
    let medium = medium(order.one_process)?;
    directory::fill(&directory, &scene)?;
    order.keep(&directory)?;
    let plans = order.plans(&directory)?;
    conduct(plans, medium, &directory, &scene, output)
}

/// Starts the processes of a launch file that has no simulator.
fn without_run(args: &Args) -> Result<Option<Exit>, Failure> {
    let (path, given) = split(&args.words)?;
    let plans = read_file(path)?.without_run(&given).map_err(|e| fault_of(path, &e))?;
    let Some(plans) = plans else { return Ok(None) };
    let of_run = args.scene.is_some() || args.seed.is_some() || args.out.is_some() || args.run.is_some();
    if of_run || args.one_process || !args.set.is_empty() {
        let fault = "the launch file has no dem_simulator: there is no run for --scene, --set, --seed, --out, --run or --one-process";
        return Err(Failure::usage(fault));
    }
    refuse_unknown(&plans)?;
    plans.iter().try_for_each(NodePlan::check_parameters).map_err(Failure::usage)?;
    let medium = medium(false)?;
    let domain = medium.domain().unwrap_or_default();
    say!(
        "grainlab: the launch file has no dem_simulator, so there is no run; {} processes in DDS domain {domain}",
        plans.len()
    );
    let runtime =
        tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(Failure::failed)?;
    runtime.block_on(start_all(plans, domain)).map(Some)
}

/// A fault of the launch file, or of the default one.
fn fault_of(path: Option<&Path>, fault: &dyn std::fmt::Display) -> Failure {
    Failure::usage(format!("{}: {fault}", path.unwrap_or(Path::new(BUILT_IN[0].0)).display()))
}

/// The scene and the order of a launch. Invalid input is refused before a directory is created.
fn planned(args: &Args) -> Result<(SceneText, Order), Failure> {
    let (path, given) = split(&args.words)?;
    let file = read_file(path)?;
    let name = args.scene.as_deref().or(file.default_of("scene")).unwrap_or("demo");
    let seed = args.seed.or_else(|| file.default_of("seed")?.parse().ok());
    let scene = scenes::load(name, &args.set, seed)?;
    let mut order = Order {
        launch: file.text().to_owned(),
        arguments: given.into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
        seed: scene.scene.seed,
        words: args.words.iter().map(|word| whole_path(word, path)).collect(),
        record: args.record,
        one_process: args.one_process,
    };
    args.engine.set(&mut order.arguments);
    let plans = order.plans(Path::new(".")).map_err(|e| fault_of(path, &e))?;
    refuse_unknown(&plans)?;
    let checked = plans.iter().try_for_each(NodePlan::check_parameters);
    checked.and_then(|()| names_of_run(&plans)).map_err(|e| fault_of(path, &e))?;
    Ok((scene, order))
}

/// A word of the command; the path of a launch file so that it is found from every directory.
fn whole_path(word: &str, file: Option<&Path>) -> String {
    let is_built_in = BUILT_IN.iter().any(|(name, _)| word == *name);
    let path = file.filter(|file| !is_built_in && *file == Path::new(word));
    let whole = path.and_then(|path| path.canonicalize().ok());
    whole.map_or_else(|| word.to_owned(), |path| path.to_string_lossy().into_owned())
}

impl Args {
    /// `scene:=`, `seed:=` and `out:=` as the flags of these names, which the launcher itself needs.
    fn with_flags(&self) -> Result<Self, Failure> {
        let mut args = Self { words: Vec::new(), ..self.clone() };
        for word in &self.words {
            match word.split_once(":=") {
                Some(("scene", value)) if args.scene.is_none() => args.scene = Some(value.to_owned()),
                Some(("out", value)) if args.out.is_none() && args.run.is_none() => {
                    args.out = Some(value.into())
                }
                Some(("seed", value)) if args.seed.is_none() => {
                    let fault = |_| Failure::usage(format!("{word}: the seed is a whole number from 0"));
                    args.seed = Some(value.parse().map_err(fault)?);
                }
                Some((name @ ("scene" | "seed" | "out"), _)) => {
                    return Err(Failure::usage(format!(
                        "{word}: the flag --{name} or --run is there, too; give one of them"
                    )));
                }
                _ => args.words.push(word.clone()),
            }
        }
        Ok(args)
    }
}

#[cfg(feature = "studio")]
impl Args {
    pub(crate) fn of_member(campaign: &Campaign, member: &Member, run: PathBuf) -> Self {
        Self {
            words: std::iter::once(&campaign.launch).chain(&campaign.arguments).cloned().collect(),
            scene: Some(member.scene.clone()),
            set: member.sets(),
            seed: Some(member.seed),
            run: Some(run),
            record: if campaign.record_all { Record::All } else { Record::Results },
            no_report: !campaign.report,
            one_process: !campaign.processes,
            ..Self::default()
        }
    }

    /// Refuses a launch that could not begin, or whose directory has another run. With `same_nodes` as another launch that was
    /// checked, the scene alone is read.
    pub(crate) fn check(&self, same_nodes: bool) -> Result<(), Failure> {
        let directory = self.run.as_deref().unwrap_or(Path::new(RUNS));
        let is_new = grainlab_recordings::run_state(directory) == grainlab_recordings::RunState::Absent;
        if let (true, true, Some(scene)) = (is_new, same_nodes, &self.scene) {
            return scenes::load(scene, &self.set, self.seed).map(drop);
        }
        let (scene, order) = planned(self)?;
        if is_new { Ok(()) } else { directory::refuse_another(directory, &scene, &order) }
    }
}

/// Refuses a launch file that names an unknown program, before anything is started.
fn refuse_unknown(plans: &[NodePlan]) -> Result<(), Failure> {
    let Some(plan) = plans.iter().find(|p| p.node.is_none() && !is_program(&p.program)) else {
        return Ok(());
    };
    let NodePlan { name, program, .. } = plan;
    Err(Failure::usage(format!("executable {name}: there is no program {program:?}, here or on the PATH")))
}

/// True if a command of this name could be started: a path to an executable file, or the name of one on the PATH.
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
        None => input::text(path, input::SETTINGS).map_err(Failure::at(path))?,
    };
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    LaunchFile::parse(&text, folder).map_err(|e| Failure::usage(format!("{}: {e}", path.display())))
}

fn new_directory(root: &Path, scene: &SceneText) -> Result<PathBuf, Failure> {
    let failed = Failure::at(root);
    let directory = create_run_directory(root, &scene.scene.name, scene.scene.seed).map_err(&failed)?;
    directory.canonicalize().map_err(failed)
}
