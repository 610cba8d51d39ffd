//! Tests of the models, one file per subject.

mod cases;
mod faults;
mod forward;
mod hard;
mod inversion;
mod posterior;
mod prior;
mod propagation;
mod recovery;
mod relaxed;
mod rock_physics;
mod simulated;
mod sphere;
mod status;
mod table3;

/// The models of the paper, with its errata and approximations: all that use G12, G13 and γ/Δ.
const PAPER_MODELS: [&str; 3] = ["emt", "ratio", "ratio-as-printed"];

/// The calibration learned from packings.
fn ours() -> &'static grainlab_emt::Calibration {
    grainlab_emt::Calibration::builtin("grainlab").unwrap()
}

/// The model of this name.
fn model(name: &str) -> &'static dyn grainlab_emt::Model {
    grainlab_emt::model(name).unwrap_or_else(|| panic!("no model {name}"))
}
