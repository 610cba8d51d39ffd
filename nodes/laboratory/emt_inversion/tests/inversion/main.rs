//! The inversion node and its messages, for the first row of the paper's Table III.

mod moduli;
mod node;
mod sets;
mod settings;
mod speeds;

use grainlab_core::results::{
    ContactStatistics, ElasticStiffness, Fabric, PackingReport, PrincipalAxis, StiffnessBounds,
    StiffnessMethod, StrainRatios,
};
use grainlab_core::stress::Stress;
use grainlab_core::{Material, Stiffness, SymTensor, Vec3};
use grainlab_emt_inversion::{Settings, microstructure_of_moduli, microstructure_of_report};
use grainlab_msgs::boundary::packing_report_message;
use grainlab_msgs::msg::{self, Estimate, Microstructure, Moduli};
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
        strain_ratios: msg::StrainRatios { total: vec![-0.0623], contact: vec![-0.02], ..Default::default() },
        grain_shear_modulus: 29e9,
        grain_poisson_ratio: 0.2,
        grain_density: 2500.0,
        ..Moduli::default()
    }
}

/// The report of a packing in the state of S1 with this stiffness.
fn report_of(stiffness: &Stiffness) -> PackingReport {
    let bounds = StiffnessBounds { affine: *stiffness, uniform_rotation: *stiffness, bulk_reuss: None };
    let principal_axis = PrincipalAxis { direction: Vec3::z(), ..PrincipalAxis::default() };
    let fabric = Fabric { reference_axis: Vec3::z(), principal_axis, ..Fabric::default() };
    let elasticity = Ok(Box::new(ElasticStiffness {
        method: StiffnessMethod::FrozenNetwork,
        smooth: false,
        tensor: *stiffness,
        stddev: Stiffness::from_row_major(&[0.0; 36]),
        residual: 0.0,
        iterations: 0,
        bounds,
    }));
    PackingReport {
        step: 42,
        material: Material { shear_modulus: 29e9, poisson_ratio: 0.2, density: 2500.0 },
        law: Default::default(),
        friction: 0.3,
        solid_fraction: 0.636,
        size_spread: 0.0,
        strain: None,
        stress: Stress { tensor: SymTensor::isotropic(50e3), asymmetry: 0.0 },
        unbalanced_force_ratio: None,
        // So many that packings of one kind do not differ.
        contacts: ContactStatistics { grains: u32::MAX, ..ContactStatistics::default() },
        fabric,
        stress_decomposition: Default::default(),
        strain_ratios: StrainRatios { total: Some(-0.0623), elastic: None, contact: Some(-0.02) },
        elasticity,
        symmetry: None,
    }
}

/// The message of a report.
fn message(report: &PackingReport) -> msg::PackingReport {
    packing_report_message(s1().header, report).unwrap()
}

/// The estimate of model `ratio` from moduli, checked like by any reader.
fn corrected(moduli: &Moduli, settings: &Settings) -> Estimate {
    of_ratio(microstructure_of_moduli(moduli, settings).message)
}

/// That from a report.
fn of_packing(report: &PackingReport, settings: &Settings) -> Estimate {
    of_ratio(microstructure_of_report(&message(report), settings).message)
}

/// An entry of the covariance, without the part that the model leaves out.
fn of_data(e: &Estimate, at: usize) -> f64 {
    e.covariance[at] - e.covariance_model.get(at).copied().unwrap_or_default()
}

fn of_ratio(message: Microstructure) -> Estimate {
    assert!(message.results().is_ok(), "a reader refuses {message:?}");
    message.estimates.into_iter().find(|e| e.model == "ratio").unwrap()
}
