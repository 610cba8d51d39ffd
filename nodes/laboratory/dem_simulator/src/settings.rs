//! The parameters of the node.

use crate::run_end::{DATA, RecordedSpeeds};
use grainlab_core::Packing;
use grainlab_dem::{Dem, Engine, Simd};
use grainlab_engine::{Compute, EngineFactory, ThreadsError};
use grainlab_lammps::Lammps;
use grainlab_msgs::{Topic, topics};
use grainlab_node_kit::{NodeError, ParameterSpec, Parameters, Range, parameters};
use grainlab_scene::Scene;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Duration;

/// Topics of the simulator that `wait_for` may name.
const AWAITED: [Topic; 4] = [topics::STRESS, topics::PACKING, topics::RUN_STATE, topics::CLOCK];

/// Name of our engine.
const OURS: &str = "grainlab";

/// The parameters of the node; scene and packing to resume from come as values.
pub fn parameters() -> Vec<ParameterSpec> {
    let time = Range::Double { min: 0.0, max: 3600.0 };
    parameters! {
        // Discovery on one host takes 0.2 s; three times that finds a simulator on a busy host.
        "look_around" 0.6, time, "time to look for another simulator before the first request, s";
        // An exchange takes well below 1 ms; 20 ms allow for one time slice of a busy host.
        "resend_after" 0.02, Range::Positive,
            "a request without answer is published again after this time, s; doubled at each repetition";
        "resend_at_most" 0.2, Range::Positive, "longest time between repetitions, s";
        "wait_for" Vec::<String>::new(), Range::Choice(&["stress", "packing", "run_state", "clock"]),
            "topics that need readers before the run starts, as in [stress, packing]";
        "min_readers" 1_i64, Range::Integer { min: 1, max: 1000 }, "readers that each topic of wait_for needs; clock needs one";
        "min_packing_readers" 0_i64, Range::Integer { min: 0, max: 1000 },
            "readers that packing needs where wait_for has it, 0 for min_readers";
        "finish" "never", Range::Choice(&["never", "inverted", "at_once"]),
            "when the process ends: never, so that late readers get the last packing; inverted, when all data about the last packing \
             are inverted, with the exit code of the run; at_once, at the end of the loading path";
        "awaited" Vec::<String>::new(), Range::Choice(&["packing_report", "moduli", "wave_speeds"]),
            "topics whose data about the last packing are awaited, even if no program has sent any about another packing, as in [moduli]";
        "exit_when_finished" false, Range::Any, "earlier name: finish:=at_once, or finish:=inverted with until_inverted";
        "until_inverted" Vec::<String>::new(), Range::Choice(&["packing_report", "moduli", "wave_speeds"]), "earlier name of awaited";
        "inverted_within" 0.0, time, "without effect: the limits are fixed";
        "ahead" true, Range::Any,
            "continue with the answer predicted by the servo's law while the answer is in transit, up to 4000 grains; results \
             do not depend on it";
        "engine" "", Range::Choice(&["", "grainlab", "lammps"]),
            "program that moves the grains once they touch: grainlab or lammps; empty: grainlab, and in a resumed run the one \
             of the recording. Naming another one than the recording's changes it";
        "engine_command" LAMMPS_COMMAND, Range::Any, "for lammps: the program with what starts it, as in mpiexec -n 4 lmp";
        "engine_time_limit" 300.0, Range::Positive, "for lammps: longest time of an exchange, s";
        "threads" 0_i64, Range::Integer { min: 0, max: 1024 },
            "number of threads, 0 for as many as are efficient; results do not depend on it";
        "simd" "best", Range::Choice(&["best", "scalar", "avx2", "avx512"]),
            "instruction set to compute with; results do not depend on it";
    }
}

/// Default of `engine_command`.
const LAMMPS_COMMAND: &str = "lmp";

/// Longest time limit, a year: clocks overflow beyond some.
const LONGEST_LIMIT: Duration = Duration::from_secs(365 * 86_400);

/// When the process of the simulator ends by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finish {
    /// Never: late readers get the last packing.
    Never,
    /// When all data about the last packing are inverted.
    Inverted,
    /// At the end of the loading path.
    AtOnce,
}

/// The parameters, typed.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Time to look for another simulator before the first request.
    pub look_around: Duration,
    /// Time after which a request without answer is published again.
    pub resend_after: Duration,
    /// Longest time between repetitions; it doubles at each repetition.
    pub resend_at_most: Duration,
    /// Topics that need readers before the run starts.
    pub wait_for: Vec<Topic>,
    /// Readers that each topic of `wait_for` needs.
    pub min_readers: usize,
    /// Readers that `packing` needs, which has more of them than the others; `None`: as many.
    pub min_packing_readers: Option<usize>,
    /// When the process ends.
    pub finish: Finish,
    /// Topics whose data about the last packing are awaited in any case.
    pub awaited: Vec<Topic>,
    /// Wave speeds in the recording of a run that is resumed.
    pub recorded: RecordedSpeeds,
    /// True to continue with the answer predicted by the servo's law while the answer is in transit.
    pub ahead: bool,
    /// Name of the engine; empty for the engine of the packing that the run resumes from, and for ours in a new run.
    pub engine: String,
    /// Starts an engine that is another program.
    pub lammps: Lammps,
    /// Number of the first request that the recording does not have, of a run that is resumed.
    pub next_request: u64,
    /// Number of threads; `None`: as many as are efficient.
    pub threads: Option<NonZeroUsize>,
    /// Instruction set; `None`: the widest.
    pub simd: Option<Simd>,
}

impl Settings {
    /// The engine of a run from the beginning, or from a packing with its run state.
    pub(crate) fn engine_for(
        &self,
        scene: &Scene,
        from: Option<(&Packing, &[u8])>,
    ) -> Result<Arc<dyn EngineFactory>, NodeError> {
        let simd = self.simd.unwrap_or_else(Simd::best).if_available().map_err(NodeError::failed)?;
        let resumed = from.filter(|(_, run_state)| !run_state.is_empty()).map(|(packing, _)| packing);
        let made_by = resumed.and_then(|packing| packing.path.as_ref()?.engine.as_ref());
        let recorded = made_by.map_or(OURS, |program| program.name.as_str());
        let wanted = if self.engine.is_empty() { recorded } else { &self.engine };
        // A gas is ours under any engine.
        if resumed.is_some_and(|packing| wanted != recorded && !packing.contacts.is_empty()) {
            log::warn!("the run continues with the engine {wanted}; its last packing was made by {recorded}");
        }
        match wanted {
            // A run that continues with another engine keeps its arguments.
            OURS if resumed.is_none() && self.lammps.command != LAMMPS_COMMAND => Err(NodeError::usage(
                "engine_command is given, and the engine is grainlab: name the engine of the command (--engine lammps)",
            )),
            OURS => Ok(Arc::new(Dem { simd })),
            grainlab_lammps::NAME => {
                self.lammps.check(scene).map_err(NodeError::usage)?;
                Ok(Arc::new(self.lammps.clone()))
            }
            other => Err(NodeError::usage(format!(
                "the recording was made with the engine {other:?}, which this version does not have"
            ))),
        }
    }

    pub(crate) fn compute(&self, grains: usize) -> Result<Compute, ThreadsError> {
        let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        let threads = self.threads.map_or(Engine::useful_threads(grains, cores), NonZeroUsize::get);
        Compute::new(threads)
    }
}

/// The declared defaults.
impl Default for Settings {
    fn default() -> Self {
        Self::from(&Parameters::defaults(&parameters()))
    }
}

impl From<&Parameters> for Settings {
    fn from(parameters: &Parameters) -> Self {
        let seconds = |name: &str| Duration::try_from_secs_f64(parameters.get(name)).unwrap_or(Duration::MAX);
        let count = |name: &str| parameters.get::<i64>(name).unsigned_abs();
        let topics_of = |name: &str, known: &[Topic]| {
            let names: Vec<String> = parameters.get(name);
            let named = |t: &&Topic| names.iter().any(|name| name == t.name.trim_start_matches('/'));
            known.iter().filter(named).copied().collect()
        };
        let [awaited, earlier]: [Vec<Topic>; 2] =
            ["awaited", "until_inverted"].map(|name| topics_of(name, &DATA));
        let finish = match (parameters.get::<String>("finish").as_str(), parameters.get("exit_when_finished"))
        {
            ("never", true) if earlier.is_empty() => Finish::AtOnce,
            ("never", true) | ("inverted", _) => Finish::Inverted,
            ("at_once", _) => Finish::AtOnce,
            _ => Finish::Never,
        };
        Self {
            look_around: seconds("look_around"),
            resend_after: seconds("resend_after"),
            resend_at_most: seconds("resend_at_most"),
            wait_for: topics_of("wait_for", &AWAITED),
            min_readers: count("min_readers") as usize,
            min_packing_readers: Some(count("min_packing_readers") as usize).filter(|n| *n > 0),
            finish,
            awaited: awaited.into_iter().chain(earlier).collect(),
            recorded: RecordedSpeeds::default(),
            ahead: parameters.get("ahead"),
            engine: parameters.get("engine"),
            next_request: 0,
            lammps: Lammps {
                command: parameters.get("engine_command"),
                time_limit: seconds("engine_time_limit").min(LONGEST_LIMIT),
            },
            threads: NonZeroUsize::new(count("threads") as usize),
            simd: parameters.get::<String>("simd").parse().ok(),
        }
    }
}
