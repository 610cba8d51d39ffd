//! Draws from a posterior as files: CSV, and the groups that ArviZ reads.

use grainlab_console::CsvText;
use grainlab_emt::{Draw, Draws};
use serde_json::{Map, Value, json};

/// One line a draw; columns that name a modulus have its symbol in lower case. ln densities are of moduli in MPa.
pub fn csv(draws: &Draws, chains: usize) -> String {
    let moduli: Vec<String> = draws.observed.iter().map(|(m, _)| m.name().to_lowercase()).collect();
    let of_each = |form: fn(&str) -> String| moduli.iter().map(|m| form(m)).collect::<Vec<_>>();
    let mut header: Vec<String> = ["chain", "draw"].map(str::to_owned).to_vec();
    header.extend(draws.quantities.iter().map(|q| q.name().to_owned()));
    header.extend(["log_likelihood", "log_prior"].map(str::to_owned));
    header.extend(of_each(|m| format!("log_likelihood_{m}")));
    header.extend(of_each(|m| format!("predicted_{m}_pa")));
    header.extend(of_each(|m| format!("observed_{m}_pa")));
    let mut text = CsvText::default();
    text.row(header);
    for (chain, part) in by_chain(draws, chains).enumerate() {
        for (number, draw) in part.iter().enumerate() {
            let values = draws.quantities.iter().filter_map(|q| draw.structure.get(*q));
            let numbers = values
                .chain([draw.ln_likelihood, draw.ln_prior])
                .chain(draw.ln_likelihood_by_modulus.iter().copied())
                .chain(draw.replicated.iter().copied())
                .chain(draws.observed.iter().map(|(_, value)| *value));
            text.row(
                [chain, number].map(|n| n.to_string()).into_iter().chain(numbers.map(|v| v.to_string())),
            );
        }
    }
    text.finish()
}

/// The groups of ArviZ's InferenceData as arrays of chains and draws, for `arviz.from_json(file)`: posterior, sample_stats,
/// log_likelihood (of each modulus given the others), posterior_predictive, observed_data. Moduli in Pa, ln densities of moduli
/// in MPa.
pub fn inference_data(draws: &Draws, chains: usize, attributes: Map<String, Value>) -> Value {
    let chain_values = |value: &dyn Fn(&Draw) -> Value| -> Value {
        by_chain(draws, chains).map(|part| part.iter().map(value).collect::<Value>()).collect()
    };
    let of_moduli = |values: Value| json!({ "moduli": values });
    let posterior: Map<String, Value> = draws
        .quantities
        .iter()
        .map(|q| (q.name().to_owned(), chain_values(&|draw| json!(draw.structure.get(*q)))))
        .collect();
    let observed: Vec<f64> = draws.observed.iter().map(|(_, value)| *value).collect();
    let names: Vec<&str> = draws.observed.iter().map(|(m, _)| m.name()).collect();
    json!({
        "posterior": posterior,
        "sample_stats": {
            "lp": chain_values(&|draw| json!(draw.ln_likelihood + draw.ln_prior)),
            "log_likelihood": chain_values(&|draw| json!(draw.ln_likelihood)),
            "log_prior": chain_values(&|draw| json!(draw.ln_prior)),
        },
        "log_likelihood": of_moduli(chain_values(&|draw| json!(draw.ln_likelihood_by_modulus))),
        "posterior_predictive": of_moduli(chain_values(&|draw| json!(draw.replicated))),
        "observed_data": of_moduli(json!(observed)),
        "coords": { "modulus": names },
        "dims": { "moduli": ["modulus"] },
        "attrs": attributes,
    })
}

fn by_chain(draws: &Draws, chains: usize) -> impl Iterator<Item = &[Draw]> {
    draws.draws.chunks((draws.draws.len() / chains.max(1)).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::results::{InferredQuantity, Microstructure};
    use grainlab_emt::Modulus;

    fn draws() -> Draws {
        let draw = |z: f64| Draw {
            structure: Microstructure { z: Some(z), ..Microstructure::default() },
            ln_likelihood: -2.0,
            ln_prior: -1.0,
            ln_likelihood_by_modulus: vec![-0.5, -0.25],
            replicated: vec![1e6, 2e6],
        };
        Draws {
            quantities: vec![InferredQuantity::Z],
            observed: vec![(Modulus::G12, 1.5e6), (Modulus::Theta, 2.5e6)],
            draws: [4.0, 4.5, 5.0, 5.5].map(draw).to_vec(),
            acceptance: 0.5,
            raised: 0,
        }
    }

    #[test]
    fn each_draw_is_a_line_with_its_chain() {
        let text = csv(&draws(), 2);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines[0],
            "chain,draw,z,log_likelihood,log_prior,log_likelihood_g12,log_likelihood_theta,predicted_g12_pa,\
             predicted_theta_pa,observed_g12_pa,observed_theta_pa"
        );
        assert_eq!(lines[3], "1,0,5,-2,-1,-0.5,-0.25,1000000,2000000,1500000,2500000");
        assert_eq!(lines.len(), 5);
    }

    #[test]
    fn groups_have_chains_draws_and_moduli_in_this_order() {
        let data = inference_data(&draws(), 2, Map::new());
        assert_eq!(data["posterior"]["z"], json!([[4.0, 4.5], [5.0, 5.5]]));
        assert_eq!(data["log_likelihood"]["moduli"][1][0], json!([-0.5, -0.25]));
        assert_eq!(data["sample_stats"]["lp"][0][1], json!(-3.0));
        assert_eq!(
            (&data["coords"]["modulus"], &data["dims"]["moduli"]),
            (&json!(["G12", "Theta"]), &json!(["modulus"]))
        );
    }
}
