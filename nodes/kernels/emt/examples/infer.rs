//! From moduli to microstructure: the first state of the paper's Table III, by every model.
//!
//! `cargo run --release -p grainlab_emt --example infer`

use grainlab_core::results::InferredQuantity;
use grainlab_emt::{Measured, Observation, StrainRatio, models, recommended};

fn main() {
    // G12, G13, Theta and pressure in Pa, each modulus with an error of 1 %; gamma/Delta is that of the
    // paper.
    let gamma = StrainRatio::given(-0.0623);
    let mut state = Observation::from_g12_g13_theta(121.71e6, 127.37e6, 144.38e6, 50e3, gamma);
    state.conditions.solid_fraction = Some(Measured::exact(0.636));
    let state = state.with_relative_error(0.01);

    let mut found = Vec::new();
    for model in models() {
        let calibration = model.default_calibration();
        match model.infer(&state, calibration) {
            Ok(estimate) => {
                let told = |q: InferredQuantity| {
                    let value = estimate.structure.get(q)?;
                    Some(format!("{} {value:.3} +- {:.3}", q.name(), estimate.stddev(q)?))
                };
                let values: Vec<String> = InferredQuantity::ALL.into_iter().filter_map(told).collect();
                println!("{:16}  {:?}: {}", estimate.model, estimate.status(), values.join(", "));
                found.push((estimate.model, estimate.status()));
            }
            Err(why) => println!("{:16}  {why}", model.name()),
        }
    }
    println!("recommended: {}", recommended(found).unwrap_or("none"));
}
