//! A launched run for people.

use super::inference::warning_lines;
use super::read_back::InvertedState;
use super::state_text::{self, indented};
use super::summary::Summary;
use crate::output::{Table, fixed};

/// The result table of a run.
pub(crate) fn text(s: &Summary) -> String {
    let mut text = String::new();
    for (n, state) in s.states.iter().enumerate() {
        let (number, of, step) = (n + 1, s.states.len(), state.state.step);
        text += &format!("State {number} of {of}: scene {}, seed {}, step {step}\n", s.scene, s.seed);
        text += &state_text::text(&state.state);
        text += &inferred(state);
        text.push('\n');
    }
    text += "Run\n";
    text += &format!("  wall time {:.2} s", s.wall_seconds);
    if let Some(rate) = s.particle_steps_per_second {
        text += &format!(", {:.2} M particle-steps/s while computing", rate / 1e6);
    }
    if let (Some(n), Some(rate), Some(waiting)) = (s.exchanges, s.exchanges_per_second, s.waiting_fraction) {
        text += &format!("; {n} exchanges, {rate:.0}/s, {:.1} % of the time waiting", 100.0 * waiting);
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
        text += &format!("  {} was started again {} times\n", node.name, node.restarts);
    }
    text
}

/// What each model infers, with its error against what was measured.
fn inferred(s: &InvertedState) -> String {
    if s.results.is_empty() {
        return String::new();
    }
    let mut t = Table::new([
        "inferred by",
        "k",
        "sigma",
        "error",
        "k_hat",
        "sigma",
        "eps",
        "sigma",
        "error",
        "status",
    ]);
    let off = |found: Option<f64>, truth: f64, digits: usize| {
        found.map_or_else(|| "-".to_owned(), |v| format!("{:+.digits$}", v - truth))
    };
    for r in &s.results {
        t.row([
            r.model.clone(),
            fixed(r.values.k, 3),
            fixed(r.sigma.k, 3),
            off(r.values.k, s.state.k, 3),
            fixed(r.values.k_hat, 3),
            fixed(r.sigma.k_hat, 3),
            fixed(r.values.eps, 4),
            fixed(r.sigma.eps, 4),
            off(r.values.eps, s.state.eps, 4),
            r.status.to_owned(),
        ]);
    }
    let mut text = indented(&t.text());
    if let Some(r) = s.results.first()
        && let (Some(g), Some(source)) = (r.gamma_over_delta, &r.gamma_over_delta_source)
    {
        text += &format!("  errors against k and eps measured; gamma/Delta taken: {g:.4} ({source})\n");
    }
    text + &warning_lines(&s.results)
}
