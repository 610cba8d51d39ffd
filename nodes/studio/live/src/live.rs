//! Follows one run after the other, and shows what is known.

use crate::domain::Choice;
use crate::follower::{Follower, NODE};
use crate::laboratory::Laboratory;
use crate::server::Server;
use crate::snapshot::{Pictures, Snapshot};
use crate::status::waiting;
use grainlab_console::{Failure, Signals, print};
use grainlab_node_kit::{Exit, Logger, Names, OffTheBus, RosArgs};
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// Time between two snapshots.
const PERIOD: Duration = Duration::from_millis(250);

/// Every how many snapshots the curves are drawn.
const CURVES: u64 = 4;

/// Time between two looks for a domain with a run.
const LOOK: Duration = Duration::from_millis(500);

/// Inputs of the page.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Port on 127.0.0.1; 0 for any free one, without one [`DEFAULT_PORT`](crate::DEFAULT_PORT) if it is free.
    pub port: Option<u16>,
    /// Namespace, remaps and log level.
    pub ros: RosArgs,
}

/// Serves the page until SIGINT or SIGTERM. Prints its address once it is served, and calls `opened` with it.
///
/// # Errors
/// If the port is taken, a name or variable is invalid, or the bus fails.
pub fn run(options: &Options, opened: impl FnOnce(&str) -> Result<(), Failure>) -> Result<Exit, Failure> {
    let names = Names::from_args(NODE, &options.ros).map_err(Failure::usage)?;
    let choice = Choice::from_env()?;
    let quiet = RosArgs { log_level: log_level(&options.ros), rosout: false, ..RosArgs::default() };
    Logger::install(NODE, &quiet);
    let signals = Signals::install().map_err(Failure::failed)?;
    let server = Server::listen(options.port)?;
    let mut show = Show {
        server,
        choice,
        clock: Instant::now(),
        domain: 0,
        snapshot: Snapshot::default(),
        drawn: Drawn::default(),
    };
    show.publish(None, None);
    print(&format!("{}\n", show.server.url()))?;
    opened(&show.server.url())?;
    let (mut follower, mut laboratory) = (None::<Follower>, None);
    let (mut next_look, mut next_show) = (Instant::now(), Instant::now());
    while !signals.requested() {
        if Instant::now() >= next_look {
            next_look = Instant::now() + LOOK;
            let is_busy = laboratory.as_ref().is_some_and(|l: &Laboratory| l.end.is_none());
            let joined = follower.as_ref().map(|f| f.domain);
            let wanted = choice.network(joined, is_busy);
            if wanted.map(|network| network.domain) != joined {
                drop(follower.take());
                follower =
                    wanted.map(|network| Follower::join(network, names.clone(), show.clock)).transpose()?;
            }
        }
        match &mut follower {
            Some(follower) => {
                follower.take(&mut laboratory).map_err(Failure::failed)?;
                follower.wait(next_show.saturating_duration_since(Instant::now()).min(PERIOD));
            }
            None => std::thread::sleep(PERIOD),
        }
        if Instant::now() >= next_show {
            next_show = Instant::now() + PERIOD;
            // Nothing is drawn while nobody looks.
            if show.server.browsers() > 0 {
                show.publish(laboratory.as_ref(), follower.as_ref());
            }
        }
    }
    Ok(Exit::Done)
}

fn log_level(ros: &RosArgs) -> log::LevelFilter {
    if ros.log_level == RosArgs::default().log_level { log::LevelFilter::Warn } else { ros.log_level }
}

#[derive(Default)]
struct Drawn {
    /// When the run was first heard of.
    began: Option<Duration>,
    count: u64,
    /// Number of values in the curves, and step of the last measured packing.
    values: (usize, Option<u64>),
    /// Plots of small shear components that were shown, and stay.
    plots: BTreeSet<&'static str>,
    pictured: u64,
    /// Version of the pictures, of all runs.
    version: u64,
}

struct Show {
    server: Server,
    choice: Choice,
    clock: Instant,
    domain: u16,
    snapshot: Snapshot,
    drawn: Drawn,
}

impl Show {
    fn publish(&mut self, laboratory: Option<&Laboratory>, follower: Option<&Follower>) {
        match laboratory {
            None => {
                self.snapshot = Snapshot::default();
                self.snapshot.set("heading", waiting(&self.choice.awaited(), OffTheBus::note()));
                self.snapshot.set("stage", "waiting".into());
            }
            Some(laboratory) => self.draw(laboratory, follower),
        }
        self.drawn.count += 1;
        self.server.show(self.snapshot.clone());
    }

    fn draw(&mut self, known: &Laboratory, follower: Option<&Follower>) {
        let now = self.clock.elapsed();
        let others = follower.map_or(0, Follower::others);
        self.domain = follower.map_or(self.domain, |f| f.domain);
        if self.drawn.began != Some(known.began) {
            // Nothing of the run before stays.
            self.drawn = Drawn { began: Some(known.began), version: self.drawn.version, ..Drawn::default() };
            self.snapshot = Snapshot::default();
            self.snapshot.set("curves", "".into());
            self.snapshot.set("phases", "".into());
        }
        let parts = &mut self.snapshot;
        parts.set("stage", if known.end.is_some() { "run over" } else { "run" }.into());
        parts.set("heading", known.heading(self.domain, others, now));
        parts.set("cards", known.cards());
        parts.set("targets", known.targets());
        parts.set("structure", known.structure());
        parts.set("no-packing", known.no_packing().into());
        if let Some(follower) = follower {
            parts.set("nodes", known.nodes(follower.peers(), follower.bus_now()));
        }
        let values = (known.timeline.count(), known.report.as_ref().map(|r| r.step));
        if values != self.drawn.values
            && (self.drawn.count.is_multiple_of(CURVES) || self.drawn.values.0 == 0)
        {
            self.drawn.values = values;
            parts.set("phases", known.timeline.phase_list());
            parts.set("curves", known.timeline.drawings(&mut self.drawn.plots));
        }
        if self.drawn.pictured != known.pictured {
            self.drawn.pictured = known.pictured;
            self.drawn.version += 1;
            let views = known.views();
            parts.pictures = (!views.is_empty()).then(|| Pictures {
                version: self.drawn.version,
                json: grainlab_viewer::states(&known.scene, &views).into(),
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::tests::{pair, request};
    use grainlab_msgs::{boundary::packing_report_message, msg};

    #[test]
    fn a_packing_that_is_measured_after_the_end_is_in_the_plots_and_the_stage_says_that_the_run_is_over() {
        let mut show = Show {
            server: Server::listen(Some(0)).unwrap(),
            choice: Choice::from_env().unwrap(),
            clock: Instant::now(),
            domain: 0,
            snapshot: Snapshot::default(),
            drawn: Drawn::default(),
        };
        let mut lab = Laboratory::new(None, Duration::ZERO);
        lab.request(&request(1), Duration::ZERO);
        lab.run_state(
            &msg::RunState { state: msg::RunState::FINISHED, ..Default::default() },
            Duration::ZERO,
        );
        show.publish(Some(&lab), None);
        let curves = |show: &Show| show.snapshot.parts["curves"].to_string();
        assert!(&*show.snapshot.parts["stage"] == "run over" && !curves(&show).contains("data-name=\"z\""));
        let measured = grainlab_micromechanics::analyze(&pair(), &Default::default()).unwrap();
        lab.packing_report(&packing_report_message(Default::default(), &measured.report).unwrap());
        (0..CURVES).for_each(|_| show.publish(Some(&lab), None));
        assert!(curves(&show).contains("data-name=\"z\""), "{}", lab.refused);
    }
}
