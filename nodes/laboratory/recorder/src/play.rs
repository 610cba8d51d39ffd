//! `grainlab bag play`.

mod delivery;
mod keys;
mod publisher;
mod session;
mod watch;

use grainlab_console::{Failure, say};
use grainlab_msgs::topics;
use grainlab_node_kit::{DdsBus, Exit, tool_bus};
use grainlab_recordings::{ChannelInfo, PlayOptions, Player, QosOverrides, Recording, StoredDefinition};
use keys::Keys;
use publisher::{TopicPublishers, offer, pause, wait_for_readers};
use session::{Ended, Session};
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;
use std::time::Duration;

const EXAMPLES: &str = "\
Examples:
  grainlab bag play recordings/runs/demo-1-1 --topics packing
  grainlab bag play recordings/runs/demo-1-1 --rate 10 --start-offset 2.5 --clock 100
  grainlab bag play recordings/runs/demo-1-1 --remap stress:=/copy/stress --loop
  grainlab bag play robot.mcap --qos-profile-overrides-path qos.yaml

Playback that starts in the middle begins with the last earlier message of every latched topic. A topic that a live node
publishes is left out with a message: two writers would mix their messages. Any type is played, byte for byte, with the QoS
that its publishers offered when it was recorded (reliable, volatile, depth 10 if they differed). Whatever the depth, a reliable
subscriber receives every message: the playback waits for its acknowledgements, and ends with exit 3 and the number of messages
that were not acknowledged if it acknowledges none for 10 s. A type of this program whose
definition in the recording differs is sent as that of this program, by the names of its fields, or left out (exit 3).

Keys, if stdin is a terminal, or with --start-paused or --step: space pauses and continues, s or right sends the next message,
up and down change the rate by a tenth, q ends. Not from a terminal, an empty line is a step, too.";

/// Time to discover the publishers.
const LOOK_AROUND: Duration = Duration::from_millis(700);
/// Time for which this process stays after the last acknowledgement: when a writer leaves, readers lose the samples that they
/// have not taken.
const GRACE: Duration = Duration::from_millis(300);

#[derive(Clone, Debug)]
struct Remap {
    from: String,
    to: String,
}

impl FromStr for Remap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (from, to) = text.split_once(":=").ok_or("write it as FROM:=TO")?;
        let absolute = |name: &str| format!("/{}", name.trim_start_matches('/'));
        let wrong = |name: &str| name.split('/').any(str::is_empty);
        match wrong(absolute(to).trim_start_matches('/')) {
            true => Err(format!("{to:?} is not the name of a topic")),
            false => Ok(Self { from: absolute(from), to: absolute(to) }),
        }
    }
}

/// Arguments of `grainlab bag play`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct Args {
    /// Run directory or MCAP file
    #[arg(value_name = "PATH")]
    path: PathBuf,
    /// Topics to play [default: all]
    #[arg(long, num_args = 1.., value_name = "TOPIC")]
    topics: Vec<String>,
    /// Topics to leave out of those
    #[arg(long, num_args = 1.., value_name = "TOPIC")]
    exclude: Vec<String>,
    /// Publish a topic under another name
    #[arg(short = 'm', long, num_args = 1.., value_name = "FROM:=TO")]
    remap: Vec<Remap>,
    /// Recorded seconds per second; inf is as fast as the readers can receive
    #[arg(short, long, value_name = "RATE", default_value_t = 1.0)]
    rate: f64,
    /// Start, s after the first message
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    start_offset: f64,
    /// Duration to play, s of the recording [default: to the end]
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    /// Begin again after the last message
    #[arg(short = 'l', long = "loop")]
    again: bool,
    /// Begin stopped: space continues
    #[arg(short = 'p', long)]
    start_paused: bool,
    /// Begin stopped, and send one message for each key s, or for each line of stdin
    #[arg(long)]
    step: bool,
    /// Publish the time of the recording on /clock, this often per second
    #[arg(long, value_name = "HZ", value_parser = frequency)]
    clock: Option<f64>,
    /// QoS of topics instead of the recorded one, as a YAML file of rosbag2
    #[arg(long, value_name = "FILE")]
    qos_profile_overrides_path: Option<PathBuf>,
    /// Subscribers that every topic needs before sending
    #[arg(long, value_name = "N", default_value_t = 1)]
    min_subscribers: usize,
    /// Wait at most this long for the subscribers of every topic before sending, s; 0 does not wait
    #[arg(long, value_name = "S", default_value_t = 10.0)]
    wait_for_subscribers: f64,
}

fn renamed<'a>(remaps: &'a [Remap], name: &'a str) -> &'a str {
    remaps.iter().find(|r| r.from == name).map_or(name, |r| &r.to)
}

/// Refuses a name that no played topic has, and one name for topics of two types. `topics`: names and types.
fn check_remaps(remaps: &[Remap], topics: &[(&str, &str)]) -> Result<(), String> {
    if let Some(Remap { from, .. }) = remaps.iter().find(|r| !topics.iter().any(|(name, _)| *name == r.from))
    {
        let known = topics.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
        return Err(format!("--remap: {from} is not played; these topics are: {known}"));
    }
    for (n, (first, of_first)) in topics.iter().enumerate() {
        let to = renamed(remaps, first);
        let other =
            topics[n + 1..].iter().find(|(name, kind)| renamed(remaps, name) == to && kind != of_first);
        if let Some((second, of_second)) = other {
            return Err(format!(
                "--remap: {first} ({of_first}) and {second} ({of_second}) would both be {to}: a topic has one type; give each a \
                 name of its own"
            ));
        }
    }
    Ok(())
}

/// Refuses a QoS profile of a topic that is not played. `topics`: names and types.
fn check_overrides(overrides: &QosOverrides, topics: &[(&str, &str)]) -> Result<(), String> {
    let is_played = |name: &&str| topics.iter().any(|(topic, _)| topic.trim_start_matches('/') == *name);
    let Some(name) = overrides.topics().find(|name| !is_played(name)) else { return Ok(()) };
    let known = topics.iter().map(|(topic, _)| *topic).collect::<Vec<_>>().join(", ");
    Err(format!("--qos-profile-overrides-path: /{name} is not played; played are: {known}"))
}

fn seconds(flag: &str, value: f64) -> Result<Duration, Failure> {
    let message = |_| Failure::usage(format!("--{flag} {value} is out of range: seconds, 0 or more"));
    Duration::try_from_secs_f64(value).map_err(message)
}

/// Runs the command.
///
/// # Errors
/// If the recording cannot be read, a topic does not exist, or the bus fails.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let mut options = PlayOptions {
        exclude: args.exclude.clone(),
        topics: (!args.topics.is_empty()).then(|| args.topics.clone()),
        rate: args.rate,
        start_offset: seconds("start-offset", args.start_offset)?,
        duration: args.duration.map(|d| seconds("duration", d)).transpose()?,
    };
    let patience = seconds("wait-for-subscribers", args.wait_for_subscribers)?;
    let recording = Recording::open(&args.path).map_err(Failure::failed)?;
    // Errors of the options are found before anything is published.
    let overrides = args.qos_profile_overrides_path.as_deref().map(QosOverrides::read).transpose()?;
    let overrides = overrides.unwrap_or_default();
    let channels = Player::new(&recording, &options)?.channels().to_vec();
    let topics: Vec<(&str, &str)> =
        channels.iter().map(|c| (c.topic.as_str(), c.ros_type.as_str())).collect();
    check_remaps(&args.remap, &topics).map_err(Failure::usage)?;
    check_overrides(&overrides, &topics).map_err(Failure::usage)?;

    let mut bus = tool_bus("player")?;
    pause(&mut bus, LOOK_AROUND);
    let Offered { mut publishers, left_out, is_refused } = offer_all(args, &mut bus, channels, &overrides)?;
    if publishers.is_empty() {
        return Err(Failure::failed("nothing is left to play"));
    }
    options.exclude.extend(left_out);
    if !wait_for_readers(&mut bus, &mut publishers, args.min_subscribers, patience) {
        return Ok(Exit::Interrupted);
    }
    let is_paused = args.start_paused || args.step;
    let mut session = Session::new(bus, publishers, Keys::open(is_paused), args.clock)?;
    let ended = session.play(&recording, &options, is_paused, args.again)?;
    let is_finished = match ended {
        Ended::Signal => false,
        Ended::Stuck => true,
        Ended::Done | Ended::Key => delivery::wait(&mut session.bus, &mut session.publishers)?,
    };
    std::thread::sleep(GRACE);
    let warnings = recording.warnings();
    warnings.iter().for_each(|w| say!("grainlab: {w}"));
    session.say_delay();
    if !is_finished {
        return Ok(Exit::Interrupted);
    }
    let is_whole = session.report(ended) && warnings.is_empty() && !is_refused;
    Ok(if is_whole { Exit::Done } else { Exit::DataLoss })
}

struct Offered {
    publishers: TopicPublishers,
    left_out: Vec<String>,
    /// The definition of a topic in the recording is refused.
    is_refused: bool,
}

/// Advertises the recorded topics, and says which are left out and why.
fn offer_all(
    args: &Args,
    bus: &mut DdsBus,
    channels: Vec<Arc<ChannelInfo>>,
    overrides: &QosOverrides,
) -> Result<Offered, Failure> {
    let (mut publishers, mut left_out, mut is_refused) = (TopicPublishers::new(), Vec::new(), false);
    for channel in channels {
        let (name, to) = (&channel.topic, renamed(&args.remap, &channel.topic));
        let note = channel.stored.note();
        let offered = if args.clock.is_some() && to == topics::CLOCK.name {
            Err("--clock publishes it".to_owned())
        } else if matches!(channel.stored, StoredDefinition::Refused(_)) {
            is_refused = true;
            Err(note.clone().unwrap_or_default())
        } else {
            offer(bus, &channel, to, overrides)?
        };
        match offered {
            Ok(publisher) => {
                note.iter().for_each(|note| say!("grainlab: {name}: {note}"));
                publishers.insert(channel.topic.clone(), publisher);
            }
            Err(reason) => {
                say!("grainlab: {name} is left out: {reason}");
                left_out.push(channel.topic.clone());
            }
        }
    }
    Ok(Offered { publishers, left_out, is_refused })
}

fn frequency(text: &str) -> Result<f64, String> {
    let hz = text.parse::<f64>().ok().filter(|hz| (0.001..=10_000.0).contains(hz));
    hz.ok_or_else(|| format!("{text:?} is out of range: 0.001 to 10000 per second"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remap_names_a_topic_that_is_played_and_gives_no_topic_two_types() {
        let topics = [("/moduli", "Moduli"), ("/packing", "Packing"), ("/left/moduli", "Moduli")];
        let check = |remaps: &[&str]| {
            let remaps: Vec<Remap> = remaps.iter().map(|r| r.parse().unwrap()).collect();
            check_remaps(&remaps, &topics)
        };
        assert_eq!(check(&["moduli:=/x", "packing:=/y"]), Ok(()));
        assert_eq!(check(&["left/moduli:=moduli"]), Ok(()), "one type");
        assert!(check(&["modulii:=/x"]).unwrap_err().contains("/modulii is not played"));
        assert!(check(&["moduli:=/x", "packing:=/x"]).unwrap_err().contains("would both be /x"));
        assert!(check(&["moduli:=/packing"]).unwrap_err().contains("would both be /packing"));
    }
}
