//! Options of a campaign.

use grainlab_console::Failure;

/// An engine that runs the members of a campaign.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Engine {
    /// On this machine, some at a time
    #[default]
    Local,
    /// As a job array of Slurm, by sbatch
    Slurm,
    /// As a task array of HyperQueue, by hq
    Hq,
    /// Runs nothing: prints the commands as a shell script, with an option of Slurm as one for sbatch. The folder gets the list of members, for status and gather
    Print,
}

/// Further trials of a member, if none are given.
pub(super) const RETRIES: u16 = 2;

/// Engine that runs the members, and its options.
#[derive(Clone, Debug, clap::Args)]
pub struct Options {
    /// Machine that runs the members
    #[arg(long, value_enum, default_value_t)]
    pub engine: Engine,
    /// Members at a time on this machine [default: as many as there are cores, with --processes one more], or tasks at a time of Slurm
    // Each waits at its start and end.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,
    /// Number of further trials of an interrupted member, the last one anew [default: 2]
    #[arg(long, value_name = "N")]
    pub(crate) retries: Option<u16>,
    /// Run members again that failed; those that reached a limit continue
    #[arg(long)]
    pub(crate) redo_failed: bool,
    /// Run the nodes of a member as processes over DDS: slower, with the same bytes, and visible to other programs
    #[arg(long)]
    pub processes: bool,
    /// Wall-clock time after which a member on this machine counts as failed, s; with a longer one, --redo-failed continues it
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) member_time: Option<u32>,
    /// Memory above which a member on this machine counts as failed, MiB
    #[arg(long, value_name = "MIB", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) member_memory: Option<u32>,
    /// Members of a task of Slurm or HyperQueue, one after another [default: 1, or as many as the arrays of Slurm need]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) chunk: Option<u32>,
    /// Partition of Slurm
    #[arg(long, value_name = "NAME")]
    partition: Option<String>,
    /// Account of Slurm
    #[arg(long, value_name = "NAME")]
    account: Option<String>,
    /// Time limit of a task of Slurm, for all its members
    #[arg(long, value_name = "TIME")]
    time: Option<String>,
    /// Another option of sbatch, such as --sbatch-option=--mem=2G; repeatable
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    sbatch_option: Vec<String>,
    /// Submit to Slurm although an array of this campaign may still be queued or running
    #[arg(long)]
    pub(crate) submit_again: bool,
}

impl Options {
    /// Refuses options that the engine does not have.
    ///
    /// # Errors
    /// Names the option and the engines that have it.
    pub fn check(&self) -> Result<(), Failure> {
        let (own, sbatch) = (format!("{:?}", self.engine).to_lowercase(), self.sbatch());
        let of_sbatch = sbatch.first().map_or("", String::as_str);
        let all = [
            ("--jobs", self.jobs.is_some(), "local or slurm"),
            ("--retries", self.retries.is_some(), "local, slurm or hq"),
            ("--redo-failed", self.redo_failed, "local, slurm or hq"),
            ("--member-time", self.member_time.is_some(), "local"),
            ("--member-memory", self.member_memory.is_some(), "local"),
            ("--chunk", self.chunk.is_some(), "slurm, hq or print"),
            (of_sbatch, !sbatch.is_empty(), "slurm or print"),
            ("--submit-again", self.submit_again, "slurm"),
        ];
        if let Some((option, _, of)) = all.into_iter().find(|(_, given, of)| *given && !of.contains(&own)) {
            return Err(Failure::usage(format!(
                "{option} has no effect with --engine {own}: leave it out, or use --engine {of}"
            )));
        }
        for option in &sbatch {
            let own = ["--array", "--job-name", "--output", "--parsable", "--wait", "--wrap"];
            // Slurm takes the beginning of a name for the name.
            let is_own =
                option.split('=').next().is_some_and(|name| own.iter().any(|own| own.starts_with(name)));
            if is_own || !option.starts_with("--") || option.contains(char::is_control) {
                let own = own.join(", ");
                return Err(Failure::usage(format!(
                    "{option:?}: write --NAME or --NAME=VALUE, and none of those that the campaign sets: {own}"
                )));
            }
        }
        Ok(())
    }

    pub(super) fn sbatch(&self) -> Vec<String> {
        let named = [("partition", &self.partition), ("account", &self.account), ("time", &self.time)];
        let named =
            named.into_iter().filter_map(|(name, value)| Some(format!("--{name}={}", value.as_ref()?)));
        named.chain(self.sbatch_option.iter().cloned()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::{Args, Command, FromArgMatches};

    #[test]
    fn an_option_of_another_engine_is_refused_by_name() {
        for (line, named) in [
            ("x --time 1", "--time=1 has no effect with --engine local: leave it out, or use --engine slurm"),
            ("x --engine hq --jobs 3", "--jobs has no effect with --engine hq"),
            ("x --engine print --redo-failed", "--redo-failed has no effect with --engine print"),
            ("x --engine slurm --sbatch-option=--arr=1-3", "none of those that the campaign sets: --array"),
            ("x --engine slurm --sbatch-option=-p", "--NAME=VALUE"),
            ("x --engine slurm --sbatch-option=--mem=2G --sbatch-option=--wait-all-nodes=1", "Ok(())"),
        ] {
            let matches = Options::augment_args(Command::new("x")).get_matches_from(line.split(' '));
            let checked = format!("{:?}", Options::from_arg_matches(&matches).unwrap().check());
            assert!(checked.contains(named), "{line}: {checked}");
        }
    }
}
