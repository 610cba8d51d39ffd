//! `grainlab topic pub`.

use super::qos::QosArgs;
use crate::names::absolute;
use crate::view::{schema, seconds};
use grainlab_console::{Failure, print_more};
use grainlab_msgs::Topic;
use grainlab_node_kit::{Bus, BusError, Exit, Wake, tool_bus};
use grainlab_recordings::MessagePath;
use std::time::{Duration, Instant};

/// Longest sleep while subscriptions are waited for: the graph is looked at then.
const POLL: Duration = Duration::from_millis(100);

/// Time from a match at this end to the first message: a reader that has not yet matched the writer would never get it.
const SETTLE: Duration = Duration::from_millis(600);

/// Longest wait for the acknowledgement of the last message.
const ACKNOWLEDGED: Duration = Duration::from_secs(2);

/// Arguments of `grainlab topic pub`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  grainlab topic pub /chatter std_msgs/msg/String '{data: hello}' --once\n  grainlab topic pub -r 10 /cmd_vel \
                  geometry_msgs/msg/Twist '{linear: {x: 0.5}}'\n\nFields that are not given have their defaults, or zero. A topic of a run that \
                  others publish on\n(stress, strain_rate) is not to be disturbed: its nodes take messages of their own run only."
)]
pub struct Args {
    /// Name of the topic
    topic: String,
    /// Type of the message, as in std_msgs/msg/String
    #[arg(value_name = "TYPE")]
    type_name: String,
    /// Values of its fields, as YAML or JSON [default: those of the type]
    values: Option<String>,
    /// Publish one message, once a subscription is there
    #[arg(short = '1', long, conflicts_with = "times")]
    once: bool,
    /// Publish this many messages
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    times: Option<u64>,
    /// Messages per second
    #[arg(short, long, value_name = "HZ", default_value_t = 1.0)]
    rate: f64,
    /// Wait for this many subscriptions [default: 1 with --once and --times, else 0]
    #[arg(short, long, value_name = "N")]
    wait_matching_subscriptions: Option<usize>,
    /// Wait at most this time for them, s
    #[arg(long, value_name = "S", value_parser = seconds)]
    max_wait_time_secs: Option<f64>,
    /// Stay this time after the last message, s
    #[arg(long, value_name = "S", default_value_t = 0.1, value_parser = seconds)]
    keep_alive: f64,
    /// Print every Nth message
    #[arg(short, long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    print: u64,
    #[command(flatten)]
    messages: MessagePath,
    #[command(flatten)]
    qos: QosArgs,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    if !(args.rate > 0.0 && args.rate <= 1e5) {
        return Err(Failure::usage(format!(
            "--rate {}: more than 0 and at most 100000 per second",
            args.rate
        )));
    }
    let (type_name, schema) = schema(&args.type_name, &args.messages)?;
    let text = args.values.as_deref().unwrap_or("{}");
    let non_finite_float_policy = serde_saphyr::NonFiniteFloatPolicy::AsString;
    let options =
        serde_saphyr::options! { strict_booleans: true, non_finite_float_policy: non_finite_float_policy };
    let wrong = |e| format!("{text:?} is not YAML: {e}");
    let given = serde_saphyr::from_str_with_options(text, options).map_err(|e| Failure::usage(wrong(e)))?;
    let message = schema.given(&given).map_err(|fault| Failure::usage(format!("{type_name}: {fault}")))?;
    let shown = grainlab_any_message::Shown::new(&message).json();
    let body = message.encode();
    let name = absolute(&args.topic);
    let topic = Topic::outside_contract(&name, &type_name, args.qos.offered());
    let topic =
        topic.ok_or_else(|| Failure::usage(format!("{type_name} is no message type, package/msg/Type")))?;
    let mut bus = tool_bus(&format!("grainlab_topic_{}", std::process::id()))?;
    let publisher = bus.advertise(&topic).map_err(Failure::failed)?;
    let times = if args.once { Some(1) } else { args.times };
    let needed = args.wait_matching_subscriptions.unwrap_or(usize::from(times.is_some()));
    let limit = args.max_wait_time_secs.map(Duration::from_secs_f64);
    let start = Instant::now();
    let mut was_said = false;
    while bus.readers(publisher) < needed {
        if limit.is_some_and(|limit| start.elapsed() >= limit) {
            return Err(Failure::failed(format!(
                "{name}: fewer than {needed} subscriptions of {type_name}; see grainlab topic info"
            )));
        }
        if !was_said && start.elapsed() > Duration::from_secs(1) {
            was_said = true;
            grainlab_console::say!(
                "grainlab: waiting for {needed} subscriptions of {name} (-w 0 publishes without)"
            );
        }
        if bus.wait(POLL) == Wake::Shutdown {
            return Err(Failure::new(Exit::Interrupted, "interrupted"));
        }
    }
    if needed > 0 {
        let settled = Instant::now() + SETTLE;
        while let Some(left) = settled.checked_duration_since(Instant::now()).filter(|left| !left.is_zero()) {
            if bus.wait(left) == Wake::Shutdown {
                return Err(Failure::new(Exit::Interrupted, "interrupted"));
            }
        }
    }
    let start = Instant::now();
    let (mut sent, mut exit) = (0, Exit::Done);
    loop {
        match bus.publish(publisher, &body) {
            Ok(_) => {}
            Err(error @ BusError::Full { .. }) => {
                exit = Exit::DataLoss;
                grainlab_console::say!("grainlab: #{} is lost: {error}", sent + 1);
            }
            Err(error) => return Err(Failure::failed(error)),
        }
        sent += 1;
        let text = format!("publishing #{sent}: {shown}\n");
        if sent % args.print == 0 && !print_more(&text)? {
            return Ok(exit);
        }
        let is_last = times.is_some_and(|times| sent >= times);
        let due = start + Duration::from_secs_f64(sent as f64 / args.rate);
        let due = if is_last { Instant::now() + Duration::from_secs_f64(args.keep_alive) } else { due };
        while let Some(left) = due.checked_duration_since(Instant::now()).filter(|left| !left.is_zero()) {
            if bus.wait(left) == Wake::Shutdown {
                return Ok(if times.is_some() { Exit::Interrupted } else { exit });
            }
        }
        if is_last {
            if !bus.flush(ACKNOWLEDGED) {
                grainlab_console::say!(
                    "grainlab: a subscription of {name} has not acknowledged the last message"
                );
                exit = Exit::DataLoss;
            }
            return Ok(exit);
        }
    }
}
