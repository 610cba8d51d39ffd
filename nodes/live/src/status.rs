//! Heading, progress and processes of a run as parts of the page.

use crate::laboratory::{End, Laboratory};
use grainlab_console::count;
use grainlab_console::html::{Cell, escaped, paragraph, table};
use grainlab_msgs::boundary::RunStatus;
use grainlab_node_kit::{Level, Liveliness, Peer, run_of};
use std::time::Duration;

/// Silence of the simulator that is mentioned: it reports once a second.
const QUIET: Duration = Duration::from_secs(3);

/// The page while no run is on the bus.
pub(crate) fn waiting(awaited: &str) -> String {
    format!(
        "<p class=\"eyebrow\">grainlab</p>\n<h1>Waiting for a run</h1>\n\
         <p class=\"verdict\">No laboratory is on the bus {}. This page follows the next one.</p>\n\
         <p>Start one in another terminal: <code>grainlab launch --scene demo</code></p>\n",
        escaped(awaited)
    )
}

/// A duration for readers.
pub(crate) fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..100 => format!("{whole} s"),
        100..6000 => format!("{} min", (whole + 30) / 60),
        6000..180_000 => format!("{} h", (whole + 1800) / 3600),
        _ => format!("{} days", whole / 86_400),
    }
}

impl Laboratory {
    /// What runs, and whether it does.
    pub(crate) fn heading(&self, domain: u16, others: usize, now: Duration) -> String {
        let run = self.run.map_or_else(|| "started by hand".to_owned(), |run| format!("run {run}"));
        let name = if self.scene.is_empty() { "A run" } else { &self.scene };
        let grains = self.grains.map_or_else(String::new, |n| format!(": {}", count(n, "grain")));
        let (class, words) = self.verdict(now);
        let others = match others {
            0 => String::new(),
            n => format!("<p>{} on the bus, not shown.</p>\n", count(n, "further run")),
        };
        format!(
            "<p class=\"eyebrow\">grainlab · {} · domain {domain}</p>\n<h1>{}</h1>\n\
             <p class=\"verdict {class}\">{}</p>\n{others}{}",
            escaped(&run),
            escaped(&format!("{name}{grains}")),
            escaped(&words),
            self.progress_bar(),
        )
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
            None => ("good run", format!("Running{}", self.note())),
        }
    }

    /// The conditions at which the phase ends that do not hold yet.
    fn note(&self) -> String {
        let message =
            self.state.as_ref().filter(|s| s.status == RunStatus::Running).map(|s| s.message.as_str());
        message.filter(|m| !m.is_empty()).map_or_else(String::new, |m| format!(": {m}"))
    }

    fn progress_bar(&self) -> String {
        let Some(state) = &self.state else { return String::new() };
        let percent = 100.0 * state.progress;
        let left = match (&self.end, self.progress.time_until(1.0)) {
            (Some(_), _) => String::new(),
            (None, Some(seconds)) => format!(" · about {} left", duration(seconds)),
            (None, None) => " · time left not known".to_owned(),
        };
        let phase = self
            .phase()
            .map_or_else(String::new, |n| format!("phase {}, {}", n + 1, self.timeline.phase_name(n)));
        format!(
            "<div class=\"progress\" role=\"progressbar\" aria-label=\"Progress\" aria-valuemin=\"0\" aria-valuemax=\"100\" \
             aria-valuenow=\"{percent:.0}\"><i style=\"width:{percent:.1}%\"></i></div>\n\
             <p class=\"below\"><span>{}</span><span>{percent:.0} % of the loading path{left}</span></p>\n",
            escaped(&phase)
        )
    }

    /// Who is there; `now` is the time of the bus.
    pub(crate) fn nodes<'a>(&self, peers: impl Iterator<Item = &'a Peer>, now: Duration) -> String {
        let mut peers: Vec<&Peer> = peers.filter(|p| run_of(&p.participant) == self.run).collect();
        // A restarted process follows the one that it replaces.
        peers.sort_by(|a, b| (&a.report.node, a.last_heard).cmp(&(&b.report.node, b.last_heard)));
        let rows: Vec<Vec<Cell>> = peers.iter().map(|p| row(p, now)).collect();
        let refused = match self.refused {
            0 => String::new(),
            n => paragraph(&format!(
                "{} refused by this page: not as the contract of topics says.",
                count(n, "message")
            )),
        };
        if rows.is_empty() {
            return paragraph("No process has reported yet: each one does once a second.") + &refused;
        }
        let caption = "Reports of the last second. Lost: not delivered to a reader that was too far behind, or missing in the recording.";
        table(caption, &["node", "", "reports", "received", "refused", "lost", "process"], &rows) + &refused
    }
}

fn row(peer: &Peer, now: Duration) -> Vec<Cell> {
    let report = &peer.report;
    let (class, presence) = match peer.liveliness(now) {
        Liveliness::Alive if report.health.level == Level::Ok => ("here", "present".to_owned()),
        Liveliness::Alive => ("unwell", "present".to_owned()),
        Liveliness::Silent(time) => ("unwell", format!("silent for {}", duration(time.as_secs_f64()))),
        Liveliness::Left(exit) if exit.code() == 0 => ("gone", "has ended".to_owned()),
        Liveliness::Left(exit) => ("bad", format!("ended: {exit}")),
    };
    let value = |key: &str| {
        report.health.values.iter().find(|(name, _)| name == key).and_then(|(_, v)| v.parse::<u64>().ok())
    };
    let lost = report.published.iter().map(|p| p.full).sum::<u64>() + value("missing").unwrap_or(0);
    let (taken, refused) =
        report.received.iter().fold((0, 0), |(taken, refused), r| (taken + r.taken, refused + r.refused));
    let number = |n: u64| if n > 0 { Cell::classed(n.to_string(), "n bad") } else { Cell::number("0") };
    vec![
        Cell::text(&report.node),
        Cell::classed(presence, class),
        Cell::text(&report.health.message),
        Cell::number(taken.to_string()),
        number(refused),
        number(lost),
        Cell::number(report.pid.to_string()),
    ]
}

#[cfg(test)]
mod tests {
    use super::duration;

    #[test]
    fn durations_are_in_a_unit_that_readers_grasp() {
        let all = [
            (0.2, "0 s"),
            (99.4, "99 s"),
            (100.0, "2 min"),
            (3600.0, "60 min"),
            (7200.0, "2 h"),
            (1e6, "11 days"),
        ];
        all.iter().for_each(|(seconds, text)| assert_eq!(duration(*seconds), *text));
    }
}
