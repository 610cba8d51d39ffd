//! Options of a campaign.

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
    /// Nowhere: print the commands as a shell script
    Print,
}

/// Engine that runs the members, and its options.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct Options {
    /// Machine that runs the members
    #[arg(long, value_enum, default_value_t)]
    pub engine: Engine,
    /// Members at a time on this machine [default: one more than there are cores]
    // Each waits at its start and end.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,
    /// Number of further trials of an interrupted member, the last one anew
    #[arg(long, value_name = "N", default_value_t = 2)]
    pub(crate) retries: u16,
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
}
