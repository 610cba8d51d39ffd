//! The inversion node and its messages, for the first row of the paper's Table III.

mod moduli;
mod node;
mod sets;
mod settings;
mod speeds;

use grainlab_emt_inversion::{Settings, microstructure_message};
use grainlab_msgs::boundary::MicrostructureReading;
use grainlab_msgs::msg::{ElasticStiffness, Estimate, Microstructure, Moduli, StrainRatios};
use grainlab_msgs::stamp;
use grainlab_msgs::std_msgs::Header;

/// Sample S1 as measured by an instrument: k = 5.73, k̂ = 5.63, ε = .016.
fn s1() -> Moduli {
    Moduli {
        header: Header { stamp: stamp(0.125), frame_id: "cell".into() },
        source_step: 42,
        g12: vec![121.71e6],
        g13: vec![127.37e6],
        theta: vec![144.38e6],
        pressure: 50e3,
        solid_fraction: vec![0.636],
        strain_ratios: StrainRatios { total: vec![-0.0623], contact: vec![-0.02], ..StrainRatios::default() },
        grain_shear_modulus: 29e9,
        grain_poisson_ratio: 0.2,
        grain_density: 2500.0,
        ..Moduli::default()
    }
}

/// A stiffness as published by the analyzer; an inversion uses only the tensor.
fn sent(stiffness: &grainlab_core::Stiffness) -> Vec<ElasticStiffness> {
    vec![ElasticStiffness { stiffness: stiffness.row_major(), ..ElasticStiffness::default() }]
}

/// The estimate of model `ratio`, checked like by any reader.
fn corrected(moduli: &Moduli, settings: &Settings) -> Estimate {
    of_ratio(microstructure_message(moduli, settings).message)
}

/// An entry of the covariance, without the part that the model leaves out.
fn of_data(e: &Estimate, at: usize) -> f64 {
    e.covariance[at] - e.covariance_model.get(at).copied().unwrap_or_default()
}

fn of_ratio(message: Microstructure) -> Estimate {
    assert!(MicrostructureReading::try_from(&message).is_ok(), "a reader refuses {message:?}");
    message.estimates.into_iter().find(|e| e.model == "ratio").unwrap()
}
