//! A launched run as text.

use crate::acoustic_text;
use crate::inference::{Inference, Origin, by_origin};
use crate::inference_text::warning_lines;
use crate::packing_text;
use crate::packing_text::indented;
use crate::read_back::{Film, InvertedPacking};
use crate::summary::Summary;
use grainlab_console::{Table, count, fixed};
use grainlab_core::results::InferredQuantity;
use grainlab_msgs::topics;
use std::collections::BTreeSet;

/// The result table of a run.
pub fn text(s: &Summary) -> String {
    let mut text = String::new();
    for (n, state) in s.states.iter().enumerate() {
        let (number, of, step) = (n + 1, s.states.len(), state.packing.step);
        text += &format!("State {number} of {of}: scene {}, seed {}, step {step}\n", s.scene, s.seed);
        text += &packing_text::text(&state.packing);
        state.acoustics().for_each(|a| text += &acoustic_text::text(a, &state.packing.report));
        text += &inferred(state);
        text.push('\n');
    }
    if s.film.packings > 0 {
        let Film { packings, structures, moduli } = s.film;
        text += &format!(
            "Within phases: {} recorded, {structures} with a structure, {moduli} with moduli: \
             grainlab analyze RECORDING --format csv\n\n",
            count(packings, "packing")
        );
    }
    for (origin, results) in by_origin(&s.of_instruments) {
        let data = origin.data().unwrap_or_else(|| "data".to_owned());
        let table = crate::inference_text::table(&results.into_iter().cloned().collect::<Vec<_>>());
        text += &format!("Of no packing of the run: from {data}\n{}\n", indented(&table));
    }
    text += "Run\n";
    let since = if s.resumed { " since it was resumed" } else { "" };
    text += &format!("  wall time {:.2} s{since}", s.wall_seconds);
    if let Some(rate) = s.particle_steps_per_second {
        text += &format!(", {:.2} M particle-steps/s while computing", rate / 1e6);
    }
    if let (Some(n), Some(rate), Some(waiting)) = (s.exchanges, s.exchanges_per_second, s.waiting_fraction) {
        text +=
            &format!("; {}, {rate:.0}/s, {:.1} % of the time waiting", count(n, "exchange"), 100.0 * waiting);
    }
    text.push('\n');
    let mut t = Table::new(["topic", "published", "recorded", "lost", "repeated"]);
    for topic in s.topics.iter().filter(|t| t.published > 0) {
        let counts = [topic.published, topic.recorded, topic.lost, topic.repeated].map(|n| n.to_string());
        t.row([topic.name.clone()].into_iter().chain(counts));
    }
    if !s.topics.is_empty() {
        text += &indented(&t.text());
    }
    for node in s.nodes.iter().filter(|n| n.restarts > 0) {
        text += &format!("  {} was restarted {}\n", node.name, count(node.restarts, "time"));
    }
    text
}

/// The results of each model, one block per kind of data.
fn inferred(s: &InvertedPacking) -> String {
    let groups = by_origin(&s.results);
    let inversions: BTreeSet<_> = groups.iter().map(|(o, _)| &o.by).collect();
    let sources: BTreeSet<_> = groups.iter().map(|(o, _)| &o.source).collect();
    let mut text = String::new();
    let several = groups.iter().any(|(o, _)| o.measurement.is_some());
    for (origin @ Origin { source, by, measurement }, results) in &groups {
        if inversions.len() > 1 {
            text += &format!("  by {}\n", by.as_deref().unwrap_or("a node that the recording does not name"));
        }
        if sources.len() > 1 || several {
            let data = match (source.as_deref(), s.acoustic_of(measurement.as_ref())) {
                (Some(name), Some(a)) if name == topics::WAVE_SPEEDS.name => acoustic_text::heading(a),
                (Some(name), _) if name == topics::PACKING_REPORT.name && measurement.is_none() => {
                    let method = s.packing.report.stiffness().map_or("given", |s| s.method.name());
                    format!("moduli ({})", method.replace('_', " "))
                }
                _ => origin.data().unwrap_or_else(|| "data".to_owned()),
            };
            text += &format!("  from {data}\n");
        }
        text += &block(results, s);
    }
    text
}

/// The results of each model from one kind of data, with errors against the measured values.
fn block(results: &[&Inference], s: &InvertedPacking) -> String {
    let counted = |q: InferredQuantity| s.packing.report.counted(q);
    let columns = InferredQuantity::ALL.into_iter().flat_map(|q| [q.text(), "sigma", "error"]);
    let mut t = Table::new(["inferred by"].into_iter().chain(columns).chain(["status"]));
    for r in results {
        let cells = InferredQuantity::ALL.into_iter().flat_map(|q| {
            let (value, digits) = (r.values[q], q.digits());
            let off = value.zip(counted(q)).map(|(v, truth)| format!("{:+.digits$}", v - truth));
            [fixed(value, digits), fixed(r.sigma[q], digits), off.unwrap_or_else(|| "-".to_owned())]
        });
        t.row([r.model.clone()].into_iter().chain(cells).chain([r.status.to_owned()]));
    }
    let mut text = indented(&t.without_empty_columns().text());
    text += "  errors against the values counted";
    let taken = results.iter().find_map(|r| r.gamma_over_delta.zip(r.gamma_over_delta_source.as_ref()));
    if let Some((g, source)) = taken {
        text += &format!("; gamma/Delta taken, by the models that need it: {g:.4} ({source})");
    }
    text + "\n" + &warning_lines(results.iter().copied())
}
