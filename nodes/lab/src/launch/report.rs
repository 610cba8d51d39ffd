//! The table that a run prints at its end.

use super::summary::{Measured, Summary};
use crate::output::{Table, fixed};
use crate::recorder;
use crate::results::inference::{Inference, warning_lines};
use crate::results::state_text;

/// The whole report.
pub(crate) fn text(summary: &Summary) -> String {
    let mut text = format!("scene {}, seed {}\n", summary.scene, summary.seed);
    for (n, measured) in summary.states.iter().enumerate() {
        text += &format!("\nstate {} of {}, step {}\n", n + 1, summary.states.len(), measured.state.step);
        text += &state_text::text(&measured.state);
        text += "\n";
        text += &state_text::indented(&inferences(measured));
        let warnings = warning_lines(&measured.results);
        if !warnings.is_empty() {
            text += &state_text::indented(&warnings);
        }
    }
    text += "\n";
    text += &recorder::counts(&summary.topics);
    text += &format!(
        "\n{:.1} s of wall time; {} particle-steps/s while computing; {} exchanges, {} per second, waiting {} of the time\n",
        summary.wall_seconds,
        millions(summary.particle_steps_per_second),
        summary.exchanges.map_or_else(|| "-".into(), |n| n.to_string()),
        fixed(summary.exchanges_per_second, 0),
        summary.waiting_fraction.map_or_else(|| "-".into(), |f| format!("{:.1} %", 100.0 * f)),
    );
    text + &format!("recording {}\n", summary.recording)
}

/// What each model infers, beside the truth measured on the packing: k against k, ε against ε.
fn inferences(measured: &Measured) -> String {
    let mut t = Table::new(["model", "k", "sigma", "error", "k_hat", "sigma", "eps", "sigma", "error", "status"]);
    let s = &measured.state;
    t.row(["measured", &fixed(Some(s.k), 3), "", "", "", "", &fixed(Some(s.eps), 4), "", "", ""]);
    for r in &measured.results {
        t.row(row(r, s.k, s.eps));
    }
    t.text()
}

fn row(r: &Inference, k: f64, eps: f64) -> [String; 10] {
    let error = |value: Option<f64>, truth: f64, digits: usize| {
        value.map_or_else(|| "-".to_owned(), |v| format!("{:+.digits$}", v - truth))
    };
    [
        r.model.clone(),
        fixed(r.k, 3),
        fixed(r.sigma.k, 3),
        error(r.k, k, 3),
        fixed(r.k_hat, 3),
        fixed(r.sigma.k_hat, 3),
        fixed(r.eps, 4),
        fixed(r.sigma.eps, 4),
        error(r.eps, eps, 4),
        r.status.to_owned(),
    ]
}

fn millions(value: Option<f64>) -> String {
    value.map_or_else(|| "-".into(), |v| format!("{:.2} million", v / 1e6))
}
