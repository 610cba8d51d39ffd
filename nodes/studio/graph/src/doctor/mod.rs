//! `grainlab doctor`: finds what keeps nodes of a domain from working together.
//!
//! - `finding`: what is wrong, where, and what to do
//! - `endpoints`: types and QoS; `nodes`: names, simulators, reports, parameters; `host`: network and environment; `processes`:
//!   stopped ones

mod endpoints;
mod finding;
mod host;
mod nodes;
mod processes;

use crate::observer::Observer;
use crate::reports::latest_reports;
use crate::view::Common;
use finding::{Finding, Severity};
use grainlab_console::{Failure, count};
use grainlab_node_kit::{CROWDING_ADVICE, Exit, Network};
use serde::Serialize;
use std::time::Duration;

/// Least time of discovery: a graph that was not waited for would look healthy.
const LEAST: Duration = Duration::from_secs(3);

/// Arguments of `grainlab doctor`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  ROS_DOMAIN_ID=7 grainlab doctor\n\nExit 1 if something is wrong that keeps nodes from \
                  working together, 0 if there are warnings or notes only. Partitions \
                  and exclusive ownership are not looked at: endpoints that these keep apart are not reported."
)]
pub struct Args {
    #[command(flatten)]
    common: Common,
}

#[derive(Serialize)]
struct View {
    domain: Option<u16>,
    nodes: usize,
    topics: usize,
    services: usize,
    findings: Vec<Finding>,
}

/// Runs the command.
///
/// # Errors
/// With the exit code and the message for the user.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let mut findings = host::environment(|name| std::env::var(name).ok());
    let mut view = View { domain: None, nodes: 0, topics: 0, services: 0, findings: Vec::new() };
    // Without a valid environment there is no domain to look at.
    if let Ok(network) = Network::from_env() {
        findings.extend(host::network(network));
        findings.extend(processes::stopped(network.domain));
        view.domain = Some(network.domain);
        match Observer::join_network(network) {
            Ok(observer) => findings.extend(of_domain(observer, args, &mut view)?),
            Err(failure) => findings.push(Finding::error(
                "cannot_join",
                format!("this process cannot join the domain: {failure}"),
                "see the other findings; without loopback (ip link set lo up) no node runs",
            )),
        }
    }
    findings.sort_by_key(|f| f.severity);
    view.findings = findings;
    args.common.show(&view, || text(&view))?;
    let wrong = view.findings.iter().any(|f| f.severity == Severity::Error);
    Ok(if wrong { Exit::Failure } else { Exit::Done })
}

fn of_domain(mut observer: Observer, args: &Args, view: &mut View) -> Result<Vec<Finding>, Failure> {
    let graph = observer.discovered(args.common.patience().max(LEAST), |_| false);
    let mut findings = endpoints::findings(&graph);
    findings.extend(observer.crowding().map(|what| Finding::warning("full_domain", what, CROWDING_ADVICE)));
    findings.extend(nodes::findings(&graph));
    findings.extend(nodes::of_reports(&graph, &latest_reports(&mut observer, &graph.reporting())?));
    findings.extend(nodes::of_sim_time(&mut observer, &graph)?);
    if graph.endpoints.is_empty() {
        let what = format!("nobody takes part in domain {}", view.domain.unwrap_or_default());
        let advice = "start nodes (grainlab launch), or set the ROS_DOMAIN_ID of those that run";
        findings.push(Finding::warning("empty_domain", what, advice));
    }
    view.nodes = graph.nodes.len();
    (view.topics, view.services) = (graph.topics().len(), graph.services().len());
    Ok(findings)
}

fn text(view: &View) -> String {
    let head = view.domain.map_or_else(
        || "no domain\n".to_owned(),
        |domain| {
            let (nodes, topics) = (count(view.nodes, "node"), count(view.topics, "topic"));
            format!("domain {domain}: {nodes}, {topics}, {}\n", count(view.services, "service"))
        },
    );
    let found: String = view.findings.iter().map(ToString::to_string).collect();
    let none = if view.findings.is_empty() { "nothing wrong was found\n" } else { "" };
    format!("{head}{found}{none}")
}
