//! The inversion node and its messages, with the first row of the paper's Table III.

mod moduli;
mod node;
mod sets;
mod settings;
mod speeds;

use grainlab_emt_inversion::{Settings, microstructure_message};
use grainlab_msgs::boundary::MicrostructureReading;
use grainlab_msgs::msg::{Estimate, Microstructure, Moduli};
use grainlab_msgs::stamp;
use grainlab_msgs::std_msgs::Header;

/// Sample S1 as an instrument gives it: k = 5.73, k̂ = 5.63, ε = .016.
fn s1() -> Moduli {
    Moduli {
        header: Header { stamp: stamp(0.125), frame_id: "cell".into() },
        source_step: 42,
        method: Moduli::METHOD_PROBE,
        g12: 121.71e6,
        g13: 127.37e6,
        theta: 144.38e6,
        pressure: 50e3,
        solid_fraction: 0.636,
        gamma_over_delta_total_known: true,
        gamma_over_delta_total: -0.0623,
        gamma_over_delta_contact_known: true,
        gamma_over_delta_contact: -0.02,
        grain_shear_modulus: 29e9,
        grain_poisson_ratio: 0.2,
        grain_density: 2500.0,
        ..Moduli::default()
    }
}

/// Of model `ratio`, as every reader takes it.
fn corrected(moduli: &Moduli, settings: &Settings) -> Estimate {
    of_ratio(microstructure_message(moduli, settings).unwrap())
}

fn of_ratio(message: Microstructure) -> Estimate {
    assert!(MicrostructureReading::try_from(&message).is_ok(), "a reader refuses {message:?}");
    message.estimates.into_iter().find(|e| e.model == "ratio").unwrap()
}
