//! Health of the run: messages, processes, warnings, time; and the commands that repeat it.

use crate::run::Run;
use grainlab_console::count;
use grainlab_page::{Cell, Html, code, details, grid, html, lines, list, paragraph, table};
use grainlab_results::AcousticReport;
use std::collections::BTreeSet;

impl Run {
    pub(crate) fn health(&self) -> Html {
        let s = &self.summary;
        let of_topics = |total: u64| (!s.topics.is_empty()).then(|| total.to_string());
        let restarts = || s.nodes.iter().map(|n| n.restarts).sum::<usize>().to_string();
        let facts = [
            ("messages recorded", of_topics(s.total(|t| t.recorded))),
            ("lost", of_topics(s.total(|t| t.lost))),
            ("repeated", of_topics(s.total(|t| t.repeated))),
            ("exchanges", s.exchanges.map(|n| n.to_string())),
            ("exchanges per second", s.exchanges_per_second.map(|n| format!("{n:.0}"))),
            ("waiting for answers", s.waiting_fraction.map(|w| format!("{:.1} % of the time", 100.0 * w))),
            (
                "particle-steps per second",
                s.particle_steps_per_second.map(|n| format!("{:.1} million", n / 1e6)),
            ),
            ("wall time", s.wall_seconds.map(|t| format!("{t:.1} s"))),
            ("restarts", (!s.nodes.is_empty()).then(restarts)),
        ];
        let facts: Vec<_> = facts.into_iter().filter_map(|(name, value)| Some((name, value?))).collect();
        let topics = s.topics.iter().map(|t| {
            let counts = [t.published, t.recorded, t.lost, t.repeated].map(Cell::number);
            std::iter::once(Cell::text(&t.name)).chain(counts)
        });
        let nodes = s.nodes.iter().map(|n| {
            let exit = n.exit.map_or_else(|| "by a signal".to_owned(), |e| e.to_string());
            [Cell::text(&n.name), Cell::number(exit), Cell::number(n.restarts)]
        });
        let header = ["topic", "published", "recorded", "lost", "repeated"];
        html!(
            "{{ warnings }}{% if facts %}<dl class=\"facts\">\
             {% for fact in facts %}<div><dt>{{ fact[0] }}</dt><dd>{{ fact[1] }}</dd></div>{% endfor %}</dl>\n{% endif %}\
             {{ tables }}",
            warnings => self.warnings(),
            facts,
            tables => grid(
                table("Messages of each topic", header, topics)
                    + table("Processes", ["node", "exit code", "restarts"], nodes)
            ),
        )
    }

    fn warnings(&self) -> Html {
        let mut seen = BTreeSet::new();
        let of_states = self.states.iter().flat_map(|s| {
            s.packing.notes.iter().cloned().chain(s.acoustics().flat_map(AcousticReport::notes))
        });
        let of_states = of_states.map(|note| note.to_string()).filter(|text| seen.insert(text.clone()));
        let strangers = match self.summary.strangers.len() {
            0 => None,
            n => Some(format!(
                "{} on the bus were not part of the run; their messages were left out",
                count(n, "process")
            )),
        };
        let lines = list(self.summary.warnings.iter().cloned().chain(of_states).chain(strangers));
        if lines.is_empty() { paragraph("No warnings.") } else { lines }
    }

    pub(crate) fn repeat(&self) -> Html {
        let folder = grainlab_results::brief::quoted(&self.directory.display().to_string());
        let scene = grainlab_results::brief::quoted(&self.directory.join("scene.toml").display().to_string());
        let seed = self.seed().map_or_else(String::new, |s| format!(" --seed {s}"));
        let again = self.launched.as_ref().map(|words| {
            let words: String =
                words.iter().map(|w| format!("{} ", grainlab_results::brief::quoted(w))).collect();
            let same = self.another.as_deref().unwrap_or("the same run: the same bytes");
            format!("grainlab launch {words}--scene {scene}{seed}    # {}", same.replace('\n', " "))
        });
        let commands = [
            again.unwrap_or_else(|| "# how it was launched is not recorded".to_owned()),
            format!("grainlab analyze {folder}    # all that is measured"),
            format!("grainlab bag info {folder}    # what was recorded"),
            format!("grainlab view {folder}    # the packings alone"),
            format!("grainlab report {folder}    # this page"),
        ];
        let mut versions = vec![format!("report by grainlab {}", env!("CARGO_PKG_VERSION"))];
        versions.extend(self.recorded_by.as_ref().map(|by| format!("recorded by {by}")));
        versions.extend((!self.summary.run.is_empty()).then(|| format!("run {}", self.summary.run)));
        versions.extend(self.summary.domain.map(|d| format!("DDS domain {d}")));
        versions.extend(self.seed().map(|s| format!("seed {s}")));
        let text = self.scene_text.as_str();
        let scene = if text.is_empty() { Html::default() } else { lines(text) };
        let summary = html!("The scene, {{ file }}", file => code("scene.toml"));
        lines(&commands.join("\n")) + paragraph(format!("{}.", versions.join(", "))) + details(summary, scene)
    }
}
