//! Heading, progress and processes of a run as parts of the page.

use crate::laboratory::{End, Laboratory};
use crate::markup::{KPA, three_digits};
use grainlab_console::{count, duration};
use grainlab_node_kit::{Level, Liveliness, Peer, run_of};
use grainlab_page::{Cell, Html, heading, html, paragraph, table, verdict};
use std::time::Duration;

/// Silence of the simulator that is mentioned: it reports once a second.
const QUIET: Duration = Duration::from_secs(3);

/// The page while no run is on the bus, with a note on those in one process.
pub(crate) fn waiting(awaited: &str, off_the_bus: Option<String>) -> Html {
    heading("grainlab", "Waiting for a run", "")
        + verdict("", &format!("No laboratory is on the bus {awaited}. This page follows the next one."))
        + off_the_bus.map_or_else(Html::default, |note| paragraph(&note))
        + html!("<p>Start one in another terminal: <code>grainlab launch --scene demo</code></p>\n")
}

impl Laboratory {
    pub(crate) fn heading(&self, domain: u16, others: usize, now: Duration) -> Html {
        let run = self.run.map_or_else(|| "started by hand".to_owned(), |run| format!("run {run}"));
        let name = if self.scene.is_empty() { "A run" } else { &self.scene };
        let grains = self.grains.map_or_else(String::new, |n| format!(": {}", count(n, "grain")));
        let (class, words) = self.verdict(now);
        let others = match others {
            0 => Html::default(),
            n => paragraph(format!("{} on the bus, not shown.", count(n, "further run"))),
        };
        heading(&format!("grainlab · {run} · domain {domain}"), &format!("{name}{grains}"), "")
            + verdict(class, &words)
            + others
            + self.progress_bar()
    }

    fn verdict(&self, now: Duration) -> (&'static str, String) {
        let silence = self.silence(now);
        match &self.end {
            Some(End::Complete) => ("good", "Complete. The page follows the next run".to_owned()),
            Some(End::Early(why)) => ("bad", format!("Ended early: {why}. The page follows the next run")),
            Some(End::Vanished) => {
                ("bad", "The simulator has left. The page follows the next run".to_owned())
            }
            None if silence >= QUIET => (
                "warn",
                format!(
                    "The simulator has been silent for {}: it computes, is stopped, or has crashed. These are its last values",
                    duration(silence.as_secs_f64())
                ),
            ),
            None => ("good run", "Running".to_owned()),
        }
    }

    /// End of the present phase by the report of the simulator: the share that is done and the time left, or
    /// the conditions that do not hold.
    fn rest_of_phase(&self, name: &str) -> String {
        let report = &self.of_phase;
        // A report may come later than the state that it is compared with.
        if self.end.is_some() || report.name != name {
            return String::new();
        }
        match report.share {
            Some(share) => {
                let left = self.pace.time_until(1.0).map(|s| {
                    if s < 1.0 { ", almost done".to_owned() } else { format!(", about {} left", duration(s)) }
                });
                format!(": {:.0} %{}", (100.0 * share).floor(), left.unwrap_or_default())
            }
            None if report.unmet.is_empty() => String::new(),
            None => format!(", not yet: {}", report.unmet),
        }
    }

    fn progress_bar(&self) -> Html {
        let Some(state) = &self.state else { return Html::default() };
        let percent = 100.0 * state.progress;
        let note = self.latest.as_ref().map(|r| {
            let (p, grains) = (
                three_digits(r.input.stress.mean() * KPA),
                self.grains.map_or_else(String::new, |n| format!("{}: ", count(n, "grain"))),
            );
            let now = format!(
                "{grains}pressure {p} kPa, solid fraction {:.4}, {:.2} contacts per grain.",
                r.solid_fraction, r.coordination
            );
            paragraph(now)
        });
        let phase = self.phase().map(|n| {
            let name = self.timeline.phase_name(n);
            format!("phase {n}, {name}{}", self.rest_of_phase(&name))
        });
        let (whole, width) = (format!("{percent:.0}"), format!("{percent:.1}"));
        html!(include_str!("../assets/progress.html"), whole, width, phase, note)
    }

    pub(crate) fn no_packing(&self) -> String {
        let published = self.state.as_ref().map_or(0, |s| s.packings);
        match published {
            0 => "No packing has been received yet. States of the grains come every two seconds, up to 2 MB (some 6,000 grains \
                  in contact) and not from LAMMPS; larger ones are shown when the scene asks for a packing."
                .to_owned(),
            n => format!(
                "{} published, none received by this page. A packing over 2 MB (some 6,000 grains) is sent in parts, which a run \
                 does not repeat for a page that joins later: the next one is shown. All are in the recording.",
                count(n, "packing")
            ),
        }
    }

    /// Who is there; `now` is the time of the bus.
    pub(crate) fn nodes<'a>(&self, peers: impl Iterator<Item = &'a Peer>, now: Duration) -> Html {
        let mut peers: Vec<&Peer> = peers.filter(|p| run_of(&p.participant) == self.run).collect();
        // A restarted process follows the one that it replaces.
        peers.sort_by(|a, b| (&a.report.node, a.last_heard).cmp(&(&b.report.node, b.last_heard)));
        let refused = match self.refused {
            0 => Html::default(),
            n => paragraph(format!(
                "{} refused by this page: not as the contract of topics says.",
                count(n, "message")
            )),
        };
        if peers.is_empty() {
            return paragraph("No process has reported yet: each one does once a second.") + refused;
        }
        let caption = "Reports of the last second. Lost: not delivered to a reader that was too far behind, or missing in the recording.";
        let header = ["node", "", "reports", "received", "refused", "lost", "process"];
        table(caption, header, peers.iter().map(|p| row(p, now))) + refused
    }
}

fn row(peer: &Peer, now: Duration) -> [Cell; 7] {
    let report = &peer.report;
    let (class, presence) = match peer.liveliness(now) {
        Liveliness::Alive if report.health.level == Level::Ok => ("here", "present".to_owned()),
        Liveliness::Alive => ("unwell", "present".to_owned()),
        Liveliness::Silent(time) => ("unwell", format!("silent for {}", duration(time.as_secs_f64()))),
        Liveliness::Left(exit) if exit.code() == 0 => ("gone", "has ended".to_owned()),
        Liveliness::Left(exit) => ("bad", format!("ended: {exit}")),
    };
    let missing = report.health.value("missing").and_then(|v| v.parse::<u64>().ok());
    let lost = report.published.iter().map(|p| p.full).sum::<u64>() + missing.unwrap_or(0);
    let (taken, refused) =
        report.received.iter().fold((0, 0), |(taken, refused), r| (taken + r.taken, refused + r.refused));
    let number = |n: u64| Cell::classed(n.to_string(), if n > 0 { "n bad" } else { "n" });
    [
        Cell::text(&report.node),
        Cell::classed(presence, class),
        Cell::text(&report.health.message),
        Cell::number(taken),
        number(refused),
        number(lost),
        Cell::number(report.pid),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_node_kit::{Health, Report};

    /// A laboratory in a phase, with a report of its simulator at each of these times and shares.
    fn reported(name: &str, shares: &[(u64, &str)]) -> Laboratory {
        let mut lab = Laboratory::new(None, Duration::ZERO);
        let message = grainlab_msgs::msg::RunState {
            phase: 1,
            phase_name: "extension".to_owned(),
            progress: 0.5,
            packings: 1,
            message: "without spins".to_owned(),
            ..Default::default()
        };
        lab.run_state(&message, Duration::ZERO);
        for (second, share) in shares {
            let unmet = "unbalanced is 2e-3, above 1e-3";
            let health = Health::ok("").with("phase", name).with("phase_share", share).with("unmet", unmet);
            let (node, published, received) = ("simulator".to_owned(), Vec::new(), Vec::new());
            let report = Report { node, pid: 1, health, exit: None, published, received };
            lab.simulator(&report, Duration::from_secs(*second));
        }
        lab
    }

    #[test]
    fn a_phase_of_known_end_has_a_share_and_a_time_and_another_its_open_conditions() {
        let heading = |lab: &Laboratory| lab.heading(0, 0, Duration::from_secs(2));
        let known = heading(&reported("extension", &[(0, "0.20"), (2, "0.40")]));
        assert!(known.contains("extension: 40 %, about 6 s left<"), "{known:?}");
        assert!(known.contains(">Running<"), "{known:?}");
        let open = heading(&reported("extension", &[(0, "")]));
        assert!(open.contains("extension, not yet: unbalanced is 2e-3, above 1e-3<"), "{open:?}");
        let late = heading(&reported("gas", &[(0, "0.9")]));
        assert!(late.contains("phase 1, extension<"), "the report is of another phase: {late:?}");
    }

    #[test]
    fn a_page_without_packings_says_why() {
        let lab = reported("extension", &[]);
        assert!(lab.no_packing().starts_with("1 packing published, none received"));
        assert!(Laboratory::new(None, Duration::ZERO).no_packing().contains("No packing has been received"));
    }
}
