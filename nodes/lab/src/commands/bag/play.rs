//! `grainlab bag play`.

use grainlab_console::Failure;
use grainlab_console::network::tool_bus;
use grainlab_msgs::{Topic, topics};
use grainlab_node_kit::{BulkPublisher, Bus, BusError, DdsBus, Exit, PublisherId, Wake};
use grainlab_recordings::{Play, PlayOptions, Player, Recording};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

const EXAMPLES: &str = "\
Examples:
  grainlab bag play recordings/runs/demo-1-1 --topics packing
  grainlab bag play recordings/runs/demo-1-1 --rate 10 --start-offset 2.5

Playback that starts in the middle begins with the last earlier message of every latched topic. A topic that a live node
publishes is left out with a message: two writers would mix their messages.";

/// Time to discover the publishers, and for all subscriptions to be discovered after the first.
const LOOK_AROUND: Duration = Duration::from_millis(700);
const SETTLE: Duration = Duration::from_millis(1000);
/// Pause before the next attempt to send a message while a reader is slow.
const HOLD: Duration = Duration::from_millis(5);
/// Time limit for the last messages, and time for which this process stays afterwards: when a writer leaves,
/// readers lose the samples that they have not taken.
const FAREWELL: Duration = Duration::from_secs(5);
const GRACE: Duration = Duration::from_millis(300);

/// The publisher of one topic.
enum Outlet {
    Plain(PublisherId),
    /// Packings of any length: large ones in parts.
    Bulk(Box<BulkPublisher>),
}

impl Outlet {
    fn id(&self) -> PublisherId {
        match self {
            Self::Plain(id) => *id,
            Self::Bulk(bulk) => bulk.id(),
        }
    }

    fn publish(&mut self, bus: &mut DdsBus, body: &[u8]) -> Result<(), BusError> {
        match self {
            Self::Plain(id) => bus.publish(*id, body).map(|_| ()),
            Self::Bulk(bulk) => bulk.publish(bus, body),
        }
    }

    /// Sends parts of a large message; true if none is in transit.
    fn advance(&mut self, bus: &mut DdsBus) -> Result<bool, Failure> {
        match self {
            Self::Plain(_) => Ok(true),
            Self::Bulk(bulk) => bulk.advance(bus).map_err(Failure::failed),
        }
    }
}

type Outlets = BTreeMap<String, Outlet>;

/// Arguments of `grainlab bag play`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub(crate) struct Args {
    /// Run directory or MCAP file
    #[arg(value_name = "PATH")]
    path: PathBuf,
    /// Topics to play [default: all]
    #[arg(long, num_args = 1.., value_name = "TOPIC")]
    topics: Vec<String>,
    /// Recorded seconds per second; inf is as fast as the readers can receive
    #[arg(short, long, value_name = "RATE", default_value_t = 1.0)]
    rate: f64,
    /// Start, s after the first message
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    start_offset: f64,
    /// Duration to play, s of the recording [default: to the end]
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    /// Subscribers that every topic needs before sending
    #[arg(long, value_name = "N", default_value_t = 1)]
    min_subscribers: usize,
    /// Wait at most this long for the subscribers of every topic before sending, s; 0 does not wait
    #[arg(long, value_name = "S", default_value_t = 10.0)]
    wait_for_subscribers: f64,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let seconds = |flag: &str, value: f64| {
        let message = |_| Failure::usage(format!("--{flag} {value} is out of range: seconds, 0 or more"));
        Duration::try_from_secs_f64(value).map_err(message)
    };
    let mut options = PlayOptions {
        topics: (!args.topics.is_empty()).then(|| args.topics.clone()),
        rate: args.rate,
        start_offset: seconds("start-offset", args.start_offset)?,
        duration: args.duration.map(|d| seconds("duration", d)).transpose()?,
        ..PlayOptions::default()
    };
    let patience = seconds("wait-for-subscribers", args.wait_for_subscribers)?;
    let recording = Recording::open(&args.path).map_err(Failure::failed)?;
    // Errors of the options are found before anything is published.
    let wanted: Vec<String> = Player::new(&recording, &options)
        .map_err(play_failure)?
        .channels()
        .iter()
        .map(|c| c.topic.clone())
        .collect();

    let mut bus = tool_bus("player")?;
    pause(&mut bus, LOOK_AROUND);
    let mut publishers = BTreeMap::new();
    for name in wanted {
        match offer(&mut bus, &name)? {
            Ok(publisher) => {
                publishers.insert(name, publisher);
            }
            Err(reason) => {
                grainlab_console::say!("grainlab: {name} is left out: {reason}");
                options.exclude.push(name);
            }
        }
    }
    if publishers.is_empty() {
        return Err(Failure::failed("nothing is left to play"));
    }
    if !wait_for_readers(&mut bus, &publishers, args.min_subscribers, patience) {
        return Ok(Exit::Interrupted);
    }
    let mut player = Player::new(&recording, &options).map_err(play_failure)?;
    let sent = send(&mut bus, &mut player, &mut publishers)?;
    let acknowledged = bus.flush(FAREWELL);
    std::thread::sleep(GRACE);
    let warnings = recording.warnings();
    warnings.iter().for_each(|w| grainlab_console::say!("grainlab: {w}"));
    if player.slipped() > Duration::from_millis(100) {
        grainlab_console::say!(
            "grainlab: the readers are slower than the recording: {:.1} s late in total",
            player.slipped().as_secs_f64()
        );
    }
    let Some(sent) = sent else { return Ok(Exit::Interrupted) };
    grainlab_console::say!("grainlab: {} sent", grainlab_console::count(sent, "message"));
    if !acknowledged {
        grainlab_console::say!("grainlab: a reader has not acknowledged the last messages");
    }
    Ok(if acknowledged && warnings.is_empty() { Exit::Done } else { Exit::DataLoss })
}

fn play_failure(error: grainlab_recordings::PlayError) -> Failure {
    match &error {
        grainlab_recordings::PlayError::Read(e)
            if !matches!(e, grainlab_recordings::ReadError::NoSuchTopic { .. }) =>
        {
            Failure::failed(error)
        }
        _ => Failure::usage(error),
    }
}

/// Advertises one recorded topic under its recorded name; the inner error is the reason if it is not
/// possible.
fn offer(bus: &mut DdsBus, name: &str) -> Result<Result<Outlet, String>, Failure> {
    let Some(row) = Topic::by_name(name) else {
        return Ok(Err("its type is not one of the laboratory".to_owned()));
    };
    // The names of topics are static; these are few.
    let topic = Topic { name: Box::leak(name.to_owned().into_boxed_str()), ..*row };
    let writers = bus.foreign_writers(&topic);
    if let Some(writer) = writers.first() {
        return Ok(Err(format!("a live node publishes it (writer {writer})")));
    }
    let outlet = if topic.info == topics::PACKING.info {
        BulkPublisher::advertise(bus, &topic).map(|bulk| Outlet::Bulk(Box::new(bulk)))
    } else {
        bus.advertise(&topic).map(Outlet::Plain)
    };
    Ok(Ok(outlet.map_err(Failure::failed)?))
}

/// Follows the graph for `time`.
fn pause(bus: &mut DdsBus, time: Duration) {
    let end = bus.now() + time;
    while let Some(left) = end.checked_sub(bus.now()).filter(|left| !left.is_zero()) {
        bus.wait(left);
    }
}

/// Waits until every topic has the readers it needs and no more appear for a short time; false on a signal.
fn wait_for_readers(bus: &mut DdsBus, publishers: &Outlets, needed: usize, patience: Duration) -> bool {
    let end = bus.now() + patience;
    let count = |bus: &DdsBus| publishers.values().map(|p| bus.readers(p.id())).collect::<Vec<_>>();
    let (mut known, mut since) = (count(bus), bus.now());
    loop {
        let now = bus.now();
        let counts = count(bus);
        if counts != known {
            (known, since) = (counts, now);
        }
        let complete = known.iter().all(|n| *n >= needed) && now - since >= SETTLE;
        if complete || now >= end {
            let lonely = publishers.keys().zip(&known).filter(|(_, n)| **n < needed);
            let lonely: Vec<&str> = lonely.map(|(name, _)| name.as_str()).collect();
            if !lonely.is_empty() && !patience.is_zero() {
                grainlab_console::say!("grainlab: fewer than {needed} subscribers of {}", lonely.join(", "));
            }
            return true;
        }
        if bus.wait(Duration::from_millis(100)) == Wake::Shutdown {
            return false;
        }
    }
}

/// Sends each message when it is due; the number of messages, or `None` on a signal. Returns when every message
/// sent in parts is complete at every active reader.
fn send(bus: &mut DdsBus, player: &mut Player<'_>, publishers: &mut Outlets) -> Result<Option<u64>, Failure> {
    let mut sent = 0;
    loop {
        let mut idle = true;
        for outlet in publishers.values_mut() {
            idle &= outlet.advance(bus)?;
        }
        let wait = match player.poll(bus.now()) {
            Play::Done | Play::Paused if idle => return Ok(Some(sent)),
            Play::Done | Play::Paused => BulkPublisher::patience(),
            Play::Wait(time) if idle => time,
            Play::Wait(time) => time.min(BulkPublisher::patience()),
            Play::Send(message) => {
                let Some(outlet) = publishers.get_mut(&message.channel.topic) else { continue };
                loop {
                    match outlet.publish(bus, &message.payload) {
                        Ok(()) => break,
                        Err(BusError::Full { .. }) => {}
                        Err(error) => return Err(Failure::failed(error)),
                    }
                    if bus.wait(HOLD) == Wake::Shutdown {
                        return Ok(None);
                    }
                }
                sent += 1;
                Duration::ZERO
            }
        };
        if bus.wait(wait) == Wake::Shutdown {
            return Ok(None);
        }
    }
}
