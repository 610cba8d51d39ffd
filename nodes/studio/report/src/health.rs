//! Whether the run went well: messages, processes, warnings, time; and how to repeat it.

use crate::run::Run;
use grainlab_console::count;
use grainlab_page::html::{Cell, code, escaped, paragraph, table};

impl Run {
    /// Counts and warnings.
    pub(crate) fn health(&self) -> String {
        let s = &self.summary;
        let mut facts: Vec<String> = Vec::new();
        let mut fact = |name: &str, value: Option<String>| {
            facts.extend(
                value.map(|v| format!("<div><dt>{}</dt><dd>{}</dd></div>", escaped(name), escaped(&v))),
            );
        };
        fact("messages recorded", (!s.topics.is_empty()).then(|| s.total(|t| t.recorded).to_string()));
        fact("lost", (!s.topics.is_empty()).then(|| s.total(|t| t.lost).to_string()));
        fact("repeated", (!s.topics.is_empty()).then(|| s.total(|t| t.repeated).to_string()));
        fact("exchanges", s.exchanges.map(|n| n.to_string()));
        fact("exchanges per second", s.exchanges_per_second.map(|n| format!("{n:.0}")));
        fact("waiting for answers", s.waiting_fraction.map(|w| format!("{:.1} % of the time", 100.0 * w)));
        fact(
            "particle-steps per second",
            s.particle_steps_per_second.map(|n| format!("{:.1} million", n / 1e6)),
        );
        fact("wall time", s.wall_seconds.map(|t| format!("{t:.1} s")));
        fact(
            "restarts",
            (!s.nodes.is_empty()).then(|| s.nodes.iter().map(|n| n.restarts).sum::<usize>().to_string()),
        );
        let facts = if facts.is_empty() {
            String::new()
        } else {
            format!("<dl class=\"facts\">{}</dl>\n", facts.concat())
        };
        let topic = |t: &crate::summary_file::TopicCount| {
            let counts = [t.published, t.recorded, t.lost, t.repeated].map(|n| Cell::number(n.to_string()));
            std::iter::once(Cell::text(&t.name)).chain(counts).collect()
        };
        let topics: Vec<Vec<Cell>> = s.topics.iter().map(topic).collect();
        let node = |n: &crate::summary_file::Node| {
            let exit = n.exit.map_or_else(|| "by a signal".to_owned(), |e| e.to_string());
            vec![Cell::text(&n.name), Cell::number(exit), Cell::number(n.restarts.to_string())]
        };
        let nodes: Vec<Vec<Cell>> = s.nodes.iter().map(node).collect();
        let mut tables = String::new();
        if !topics.is_empty() {
            tables += &table(
                "Messages of each topic",
                &["topic", "published", "recorded", "lost", "repeated"],
                &topics,
            );
        }
        if !nodes.is_empty() {
            tables += &table("Processes", &["node", "exit code", "restarts"], &nodes);
        }
        format!("{}{facts}<div class=\"grid\">\n{tables}</div>\n", self.warnings())
    }

    /// Everything that readers of the numbers should know.
    fn warnings(&self) -> String {
        let of_packings = self.states.iter().flat_map(|s| &s.packing.warnings);
        let strangers = match self.summary.strangers.len() {
            0 => None,
            n => Some(format!(
                "{} on the bus were not part of the run; their messages were left out",
                count(n, "process")
            )),
        };
        let lines: Vec<String> =
            (self.summary.warnings.iter().chain(of_packings).cloned()).chain(strangers).collect();
        if lines.is_empty() {
            return paragraph("No warnings.");
        }
        let items: String = lines.iter().map(|w| format!("<li>{}</li>", escaped(w))).collect();
        format!("<ul class=\"warnings\">{items}</ul>\n")
    }

    /// Commands, versions, and the text of the scene.
    pub(crate) fn repeat(&self) -> String {
        let folder = grainlab_results::brief::quoted(&self.directory.display().to_string());
        let scene = grainlab_results::brief::quoted(&self.directory.join("scene.toml").display().to_string());
        let seed = self.seed().map_or_else(String::new, |s| format!(" --seed {s}"));
        let again = self.launched.as_ref().map(|words| {
            let words: String =
                words.iter().map(|w| format!("{} ", grainlab_results::brief::quoted(w))).collect();
            format!("grainlab launch {words}--scene {scene}{seed}    # the same run: the same bytes")
        });
        let lines = [
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
        let mut text = format!(
            "<pre>{}</pre>\n{}",
            escaped(&lines.join("\n")),
            paragraph(&format!("{}.", versions.join(", ")))
        );
        if !self.scene_text.is_empty() {
            text += &format!(
                "<details><summary>The scene, {}</summary><pre>{}</pre></details>\n",
                code("scene.toml"),
                escaped(&self.scene_text)
            );
        }
        text
    }
}
