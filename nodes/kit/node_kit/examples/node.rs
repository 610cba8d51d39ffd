//! A node of your own: prints the coordination number of each packing, and takes part in the graph as every other node.
//!
//! `cargo run --release -p grainlab_node_kit --example node`, then `grainlab launch` in another terminal.

use grainlab_core::results::{InferredQuantity, PackingReport};
use grainlab_msgs::{msg, topics};
use grainlab_node_kit::{
    Bus, Demand, Health, Next, Node, NodeError, NodeSpec, RosArgs, Scope, Subscription, run_node,
};
use std::process::ExitCode;
use std::time::Duration;

struct Printer {
    reports: Subscription<msg::PackingReport>,
    printed: u64,
}

impl Node for Printer {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        while let Some((message, _)) = self.reports.take_valid(bus)? {
            match PackingReport::try_from(&message) {
                Ok(report) => {
                    println!("{:.0} Pa: k {:?}", report.pressure(), report.counted(InferredQuantity::K))
                }
                Err(invalid) => eprintln!("{invalid}"),
            }
            self.printed += 1;
        }
        Ok(Next::Wait(Duration::from_secs(3600)))
    }

    fn health(&self) -> Health {
        Health::ok(format!("{} reports printed", self.printed))
    }
}

fn main() -> ExitCode {
    let spec = NodeSpec {
        name: "printer",
        summary: "Prints the coordination number of each packing.",
        scope: Scope::Everyone,
        parameters: Vec::new(),
    };
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let args = match RosArgs::parse(&arguments) {
        Ok((args, _)) => args,
        Err(wrong) => {
            eprintln!("{wrong}");
            return ExitCode::from(2);
        }
    };
    let exit = run_node(&spec, &args, |bus, _| {
        let reports = Subscription::subscribe(bus, &topics::PACKING_REPORT, Demand::reliable(16))?;
        Ok(Box::new(Printer { reports, printed: 0 }))
    });
    exit.into()
}
