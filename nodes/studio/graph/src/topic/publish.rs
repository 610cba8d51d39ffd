//! `grainlab topic pub`.

use super::qos::QosArgs;
use crate::names::absolute;
use crate::view::schema;
use grainlab_console::{Failure, count, print_more};
use grainlab_msgs::Topic;
use grainlab_node_kit::{Bus, BusError, DdsBus, Delivery, Exit, Graph, Wake, tool_bus};
use grainlab_recordings::MessagePath;
use std::time::{Duration, Instant};

/// Longest sleep while subscriptions are waited for: the graph is looked at then.
const POLL: Duration = Duration::from_millis(100);

/// Time from a match at this end to the first message: a reader that has not yet matched the writer would never get it.
const SETTLE: Duration = Duration::from_millis(600);

/// Longest time for which a reader is waited for that does not answer.
const UNANSWERED: Duration = Duration::from_secs(3);

/// Time for which the publisher stays after the last message: a reader that still discovers it gets a latched one.
const STAY: Duration = Duration::from_millis(100);

/// Pause between two looks at the acknowledgements.
const LOOK: Duration = Duration::from_millis(10);

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
    let start = Instant::now();
    let mut was_said = false;
    while bus.readers(publisher) < needed {
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
        let matched = Instant::now();
        let is_settled = |bus: &DdsBus| {
            let limit = if bus.is_known_to_readers(publisher) { SETTLE } else { UNANSWERED };
            matched.elapsed() >= limit
        };
        while !is_settled(&bus) {
            if bus.wait(POLL) == Wake::Shutdown {
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
        if !print_more(&format!("publishing #{sent}: {shown}\n"))? {
            return Ok(exit);
        }
        let is_last = times.is_some_and(|times| sent >= times);
        let due = start + Duration::from_secs_f64(sent as f64 / args.rate);
        let due = if is_last { Instant::now() + STAY } else { due };
        while let Some(left) = due.checked_duration_since(Instant::now()).filter(|left| !left.is_zero()) {
            if bus.wait(left) == Wake::Shutdown {
                return Ok(if times.is_some() { Exit::Interrupted } else { exit });
            }
        }
        if is_last {
            let mut delivery = Delivery::begin(u64::MAX, bus.now());
            loop {
                let pending = bus.unacknowledged(publisher);
                if pending == 0 {
                    return Ok(exit);
                }
                if delivery.is_stuck(pending, bus.now()) {
                    let messages = count(pending, "message");
                    grainlab_console::say!(
                        "grainlab: {messages} not acknowledged: a subscription of {name} has acknowledged none of them for {} s",
                        Delivery::PATIENCE.as_secs()
                    );
                    return Ok(Exit::DataLoss);
                }
                if bus.wait(LOOK) == Wake::Shutdown {
                    return Ok(Exit::Interrupted);
                }
            }
        }
    }
}
