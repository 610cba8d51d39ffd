//! The parameters of the node.

use grainlab_dem::{Compute, ComputeError, Simd};
use grainlab_msgs::{Topic, topics};
use grainlab_node_kit::{ParameterSpec, Parameters, Range};
use std::num::NonZeroUsize;
use std::time::Duration;

/// How the run is coupled to the servo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Every request waits for its own answer: a run is a pure function of scene and seed.
    Lockstep,
    /// The run uses the latest answer, as hardware does; it depends on timing. It waits only where the latest answer is
    /// older than `lag` requests, so that a failed servo stops it.
    FreeRun {
        /// Requests that may be ahead of the latest answer.
        lag: u64,
    },
}

impl Mode {
    /// Requests that may be ahead of the latest answer.
    pub(crate) fn lag(self) -> u64 {
        match self {
            Mode::Lockstep => 0,
            Mode::FreeRun { lag } => lag,
        }
    }
}

/// Topics of the simulator that `wait_for` may name.
const AWAITED: [Topic; 4] = [topics::STRESS, topics::PACKING, topics::RUN_STATE, topics::CLOCK];

/// The parameters of the node; scene and packing to resume from come as values.
pub fn parameters() -> Vec<ParameterSpec> {
    let d = Settings::default();
    let time = Range::Double { min: 0.0, max: 3600.0 };
    vec![
        ParameterSpec::new(
            "mode",
            "lockstep",
            "lockstep: each request waits for its answer, same bytes every run; free_run: the latest answer is used",
        )
        .within(Range::Choice(&["lockstep", "free_run"])),
        ParameterSpec::new("free_run_lag", 10_i64, "requests that free_run may be ahead of the latest answer")
            .within(Range::Integer { min: 1, max: 1_000_000 }),
        ParameterSpec::new(
            "look_around",
            d.look_around.as_secs_f64(),
            "time to look for another simulator before the first request, s",
        )
        .within(time),
        ParameterSpec::new(
            "resend_after",
            d.resend_after.as_secs_f64(),
            "a request without answer is published again after this time, s; doubled at each repetition",
        )
        .within(Range::Positive),
        ParameterSpec::new("resend_at_most", d.resend_at_most.as_secs_f64(), "longest time between repetitions, s")
            .within(Range::Positive),
        ParameterSpec::new(
            "wait_for",
            Vec::<String>::new(),
            "topics that need readers before the run starts, as in [stress, packing]",
        )
        .within(Range::Choice(&["stress", "packing", "run_state", "clock"])),
        ParameterSpec::new("min_readers", d.min_readers as i64, "readers that each topic of wait_for needs; clock needs one")
            .within(Range::Integer { min: 1, max: 1000 }),
        ParameterSpec::new(
            "min_packing_readers",
            0_i64,
            "readers that packing needs where wait_for has it, 0 for min_readers",
        )
        .within(Range::Integer { min: 0, max: 1000 }),
        ParameterSpec::new(
            "exit_when_finished",
            d.exit_when_finished,
            "end when the loading path is done; else stay, so that late readers get the last packing",
        ),
        ParameterSpec::new(
            "until_inverted",
            Vec::<String>::new(),
            "with exit_when_finished: stay until the last packing is inverted from the data of these topics, as in [packing_report]",
        )
        .within(Range::Choice(&["packing_report", "moduli", "wave_speeds"])),
        ParameterSpec::new(
            "inverted_within",
            d.inverted_within.as_secs_f64(),
            "longest time to wait for until_inverted after the end of the loading path, s",
        )
        .within(time),
        ParameterSpec::new(
            "ahead",
            d.ahead,
            "continue with the answer predicted by the servo's law while the answer is in transit, in lockstep and up to 4000 \
             grains; results do not depend on it",
        ),
        ParameterSpec::new("threads", 0_i64, "number of threads, 0 for as many as are efficient; results do not depend on it")
            .within(Range::Integer { min: 0, max: 1024 }),
        ParameterSpec::new("simd", "best", "instruction set to compute with; results do not depend on it")
            .within(Range::Choice(&["best", "scalar", "avx2", "avx512"])),
    ]
}

/// The parameters, typed.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// How the run is coupled to the servo.
    pub mode: Mode,
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
    /// The same for `packing`, which has more readers than the others; `None`: as many.
    pub min_packing_readers: Option<usize>,
    /// Whether the process ends when the loading path is done.
    pub exit_when_finished: bool,
    /// Topics whose data of the last packing must be inverted before the process ends.
    pub until_inverted: Vec<Topic>,
    /// Longest wait for that.
    pub inverted_within: Duration,
    /// Whether to continue with the answer predicted by the servo's law while the answer is in transit.
    pub ahead: bool,
    /// Number of threads; `None`: as many as are efficient.
    pub threads: Option<NonZeroUsize>,
    /// Instruction set; `None`: the widest.
    pub simd: Option<Simd>,
}

impl Settings {
    /// The compute settings of a run of `grains` grains.
    pub(crate) fn compute(&self, grains: usize) -> Result<Compute, ComputeError> {
        let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        let threads = self.threads.map_or(Compute::useful_threads(grains, cores), NonZeroUsize::get);
        Compute::new(self.simd.unwrap_or_else(Simd::best), threads)
    }
}

/// Discovery on one host takes 0.2 s; three times that finds a simulator on a busy host. An exchange takes
/// well below 1 ms; 20 ms allow for one time slice of a busy host.
impl Default for Settings {
    fn default() -> Self {
        Self {
            mode: Mode::Lockstep,
            look_around: Duration::from_millis(600),
            resend_after: Duration::from_millis(20),
            resend_at_most: Duration::from_millis(200),
            wait_for: Vec::new(),
            min_readers: 1,
            min_packing_readers: None,
            exit_when_finished: false,
            until_inverted: Vec::new(),
            inverted_within: Duration::from_secs(60),
            ahead: true,
            threads: None,
            simd: None,
        }
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
        Self {
            mode: match parameters.get::<String>("mode").as_str() {
                "free_run" => Mode::FreeRun { lag: count("free_run_lag") },
                _ => Mode::Lockstep,
            },
            look_around: seconds("look_around"),
            resend_after: seconds("resend_after"),
            resend_at_most: seconds("resend_at_most"),
            wait_for: topics_of("wait_for", &AWAITED),
            min_readers: count("min_readers") as usize,
            min_packing_readers: Some(count("min_packing_readers") as usize).filter(|n| *n > 0),
            exit_when_finished: parameters.get("exit_when_finished"),
            until_inverted: topics_of(
                "until_inverted",
                &[topics::PACKING_REPORT, topics::MODULI, topics::WAVE_SPEEDS],
            ),
            inverted_within: seconds("inverted_within"),
            ahead: parameters.get("ahead"),
            threads: NonZeroUsize::new(count("threads") as usize),
            simd: parameters.get::<String>("simd").parse().ok(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_declared_defaults_are_the_typed_ones() {
        assert_eq!(Settings::from(&Parameters::defaults(&parameters())), Settings::default());
    }
}
