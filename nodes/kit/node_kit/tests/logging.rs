//! Log lines on `/rosout`. The only test in its process, which has one logger.

use grainlab_msgs::rcl_interfaces::Log;
use grainlab_msgs::topics;
use grainlab_node_kit::{
    Bus, Demand, Exit, Hub, Logger, Names, Next, Node, NodeError, RosArgs, Subscription, drive,
};

struct Idle;

impl Node for Idle {
    fn step(&mut self, _: &mut dyn Bus) -> Result<Next, NodeError> {
        Ok(Next::Finished(Exit::Done))
    }
}

/// A node whose only step logs 1,200 lines and panics.
struct Panics;

impl Node for Panics {
    fn step(&mut self, _: &mut dyn Bus) -> Result<Next, NodeError> {
        (0..1200).for_each(|n| log::info!("line {n}"));
        panic!("the bug")
    }
}

#[test]
fn log_lines_go_to_rosout_also_before_a_panic_and_none_after_the_last_report() {
    let quiet = RosArgs { stderr: false, ..RosArgs::default() };
    let logger = Logger::install("/lab/ticker", &quiet);
    log::info!("the gas is {} dense", 0.5);
    log::debug!("too quiet to be heard");

    let hub = Hub::new(1);
    let mut bus = hub.bus(Names::in_namespace("ticker", "/lab").unwrap());
    drive(&mut Idle, &mut bus, "/lab/ticker", Some(logger), &|| false).unwrap();
    log::error!("after the end");
    assert!(logger.drain().is_empty(), "closed");

    let mut observer = hub.bus(Names::new("late_observer").unwrap());
    let rosout =
        Subscription::<Log>::subscribe(&mut observer, &topics::ROSOUT, Demand::reliable(2000)).unwrap();
    let lines: Vec<Log> =
        std::iter::from_fn(|| rosout.take_valid(&mut observer).unwrap()).map(|(line, _)| line).collect();
    let texts: Vec<&str> = lines.iter().map(|l| l.msg.as_str()).collect();
    assert_eq!(texts, ["the gas is 0.5 dense", "leaving: done (exit 0)"]);
    assert_eq!((lines[0].name.as_str(), lines[0].level), ("lab.ticker", Log::INFO));
    assert!(lines[0].file.ends_with("logging.rs") && lines[0].line > 0 && lines[0].stamp.sec > 1_600_000_000);

    // The queue holds 1,000 lines: the first line says how many older ones it dropped.
    let logger = Logger::install("/panics", &quiet);
    let mut bus = hub.bus(Names::new("panics").unwrap());
    let node = || drive(&mut Panics, &mut bus, "/panics", Some(logger), &|| false).map(drop);
    assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(node)).is_err());
    let lines: Vec<Log> =
        std::iter::from_fn(|| rosout.take_valid(&mut observer).unwrap()).map(|(line, _)| line).collect();
    let texts: Vec<&str> = lines.iter().map(|l| l.msg.as_str()).collect();
    let first = (lines[0].level, texts[0], texts[1]);
    assert_eq!(first, (Log::WARN, "200 lines before this one are on stderr alone", "line 200"));
    assert_eq!(texts.last(), Some(&"line 1199"));
}
