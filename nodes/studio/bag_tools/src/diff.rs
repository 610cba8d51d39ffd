//! `grainlab bag diff`.

use crate::decoders::losses;
use crate::selection::Topics;
use grainlab_console::{Failure, Format, Table, worse};
use grainlab_msgs::Exit;
use grainlab_recordings::MessagePath;
use side_by_side::{Compared, Pair};
use std::path::PathBuf;

mod messages;
mod side_by_side;

const EXAMPLES: &str = "\
Examples:
  grainlab bag diff recordings/runs/demo-1-1 recordings/runs/demo-1-2
  grainlab bag diff camera.mcap copy.mcap --times

The messages of each topic are compared byte by byte, in their order, without padding at the end of messages in CDR, and so are the definitions of their
types; of the first that differs the first field that does is shown. Of a reproducible topic of the laboratory, repeats of a message (of a
restarted node) are left out, and estimates are compared source by source; its topics that depend on the clock are compared with --all, or if topics are named. Exit 1 if anything differs, 3 if a part could not be read.";

/// Arguments of `grainlab bag diff`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// First recording: run directory or MCAP file
    #[arg(value_name = "A")]
    first: PathBuf,
    /// Second recording: run directory or MCAP file
    #[arg(value_name = "B")]
    second: PathBuf,
    #[command(flatten)]
    topics: Topics,
    #[command(flatten)]
    messages: MessagePath,
    /// Compare the times of publishing, too
    #[arg(long)]
    times: bool,
    /// Compare topics of the laboratory that depend on the clock, too
    #[arg(long)]
    all: bool,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Errors if a recording cannot be read, or has no topic that is asked for.
pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    let both = [args.messages.open(&args.first)?.0, args.messages.open(&args.second)?.0];
    let topics = args.topics.check(&both)?;
    let pairs = side_by_side::pairs(&both, |channel| topics.take(channel));
    let mut rows = side_by_side::compare(&both, &pairs)?;
    for (row, pair) in rows.iter_mut().zip(&pairs) {
        judge(row, pair, args);
    }
    args.format.print(&rows, || table(&rows).csv(), || text(&rows))?;
    // A stored file that cannot be read is not compared, and no reason to call both complete.
    both.iter().for_each(|recording| drop(recording.stored_files()));
    let differs = |r: &Compared| {
        !["same", "not compared", "no messages"].contains(&r.payload) || args.times && !r.same_times
    };
    let exit = if rows.iter().any(differs) { Exit::Failure } else { Exit::Done };
    Ok(worse(exit, losses(&both)))
}

/// Completes the comparison of the messages of a topic by the comparison of its channels.
fn judge(row: &mut Compared, pair: &Pair, args: &Args) {
    let contract = pair.contract();
    let is_reproducible = contract.is_some_and(|topic| topic.reproducible);
    let not_compared = contract.is_some() && !is_reproducible && !args.all && !args.topics.is_given();
    row.payload = match &pair.channels {
        _ if not_compared => "not compared",
        [None, _] | [_, None] if row.messages == [0, 0] => "no messages",
        [Some(a), Some(b)] if !a.is_read_as(b) => {
            row.first_difference = Some(match a.differs_as(b) {
                Some((what, a, b)) => format!("its {what} is {a} in A and {b} in B"),
                None => format!("its definition of {:?} differs", a.ros_type),
            });
            "differ"
        }
        [Some(_), None] => "only in A",
        [None, Some(_)] => "only in B",
        _ if row.messages[0] != row.messages[1] || row.first_difference.is_some() => "differ",
        _ => "same",
    };
    row.first_difference = row.first_difference.take().filter(|_| !not_compared);
}

fn table(rows: &[Compared]) -> Table {
    let mut table = Table::new(["topic", "A", "B", "payload", "publish times"]);
    for r in rows {
        let times = if r.same_times { "same" } else { "differ" };
        let [a, b] = r.messages.map(|n| n.to_string());
        table.row([r.topic.clone(), a, b, r.payload.to_owned(), times.to_owned()]);
    }
    table
}

fn text(rows: &[Compared]) -> String {
    let first = rows.iter().filter_map(|r| Some(format!("{}: {}\n", r.topic, r.first_difference.as_ref()?)));
    table(rows).text() + &first.collect::<String>()
}
