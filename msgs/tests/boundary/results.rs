use super::refuses;
use super::structure::{contacts, fabric, stress_decomposition};
use grainlab_core::contact::ContactLaw;
use grainlab_core::results::{
    ElasticStiffness, Elasticity, PackingReport, StiffnessBounds, StiffnessMethod, StrainRatios,
};
use grainlab_core::stress::Stress;
use grainlab_core::{Material, Stiffness, SymTensor, TransverseIsotropy, Vec3};
use grainlab_msgs::boundary::{
    FabricReading, ModuliReading, RunStateReading, RunStatus, fabric_message, moduli_message,
};
use grainlab_msgs::msg;
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{from_cdr, stamp, to_cdr};

const INF: f64 = f64::INFINITY;
const NAN: f64 = f64::NAN;

pub(crate) fn header() -> Header {
    Header { stamp: stamp(0.25), frame_id: "cell".into() }
}

pub(crate) fn report() -> PackingReport {
    PackingReport {
        step: 7,
        material: Material::GLASS,
        law: ContactLaw::default(),
        solid_fraction: 0.64,
        size_spread: 0.1,
        stress: Stress { tensor: SymTensor::isotropic(5e4), asymmetry: 0.0 },
        unbalanced_force_ratio: None,
        contacts: contacts(),
        fabric: fabric(),
        stress_decomposition: stress_decomposition(),
        strain_ratios: StrainRatios { total: Some(-0.3), elastic: Some(0.02), contact: None },
        elasticity: Elasticity::Jammed(Box::new(stiffness())),
        symmetry: None,
    }
}

/// The part of a report in a `Fabric` message.
pub(crate) fn fabric_of(report: &PackingReport) -> FabricReading {
    FabricReading {
        contacts: report.contacts,
        fabric: report.fabric,
        stress_decomposition: report.stress_decomposition,
        strain_ratios: report.strain_ratios,
    }
}

fn stiffness() -> ElasticStiffness {
    let relaxed = TransverseIsotropy {
        c11: 360e6,
        c12: 80e6,
        c13: 70e6,
        c33: 400e6,
        g13: 150e6,
        g12: 140e6,
        residual: 0.0,
    };
    let affine = TransverseIsotropy { c11: 460e6, g13: 200e6, ..relaxed };
    let uniform_rotation = TransverseIsotropy { c11: 460e6, g13: 199e6, ..relaxed };
    ElasticStiffness {
        method: StiffnessMethod::FrozenNetwork,
        tensor: relaxed.stiffness(),
        stddev: Stiffness::from_row_major(&[0.5; 36]),
        residual: 1e-9,
        iterations: 91,
        bounds: StiffnessBounds {
            affine: affine.stiffness(),
            uniform_rotation: uniform_rotation.stiffness(),
            bulk_reuss: Some(1.2e8),
        },
    }
}

fn moduli_sent() -> msg::Moduli {
    moduli_message(header(), &report(), &stiffness()).unwrap()
}

#[test]
fn a_fabric_crosses_the_wire_and_back() {
    let sent = fabric_message(header(), &report()).unwrap();
    let received: msg::Fabric = from_cdr(&to_cdr(&sent)).unwrap();
    assert_eq!(FabricReading::try_from(&received).unwrap(), fabric_of(&report()));
    assert_eq!((received.source_step, received.header), (7, header()));
}

#[test]
fn moduli_cross_the_wire_and_back() {
    for method in StiffnessMethod::ALL {
        let stiffness = ElasticStiffness { method, ..stiffness() };
        let sent = moduli_message(header(), &report(), &stiffness).unwrap();
        let received: msg::Moduli = from_cdr(&to_cdr(&sent)).unwrap();
        assert_eq!(ModuliReading::try_from(&received).unwrap().stiffness, Some(stiffness));
    }
}

/// Without an axis in the message all quantities are about e3.
#[test]
fn moduli_are_about_the_reference_axis_of_the_fabric_which_the_message_carries() {
    let sent = moduli_sent();
    let about = report().fabric.reference_axis;
    assert_eq!(about, Vec3::x());
    let r = ModuliReading::try_from(&sent).unwrap();
    let t = stiffness().tensor.transverse_isotropy_about(&about);
    assert_eq!((r.reference_axis, r.g12, r.g13), (about, Some(t.g12), Some(t.g13)));
    assert!((t.c33 / stiffness().tensor.0[(0, 0)] - 1.0).abs() < 1e-14, "C11 is along x");
    let nameless = msg::Moduli { reference_axis: Default::default(), ..sent };
    assert_eq!(ModuliReading::try_from(&nameless).unwrap().reference_axis, Vec3::z());
}

#[test]
fn an_inversion_reads_what_the_analysis_measured() {
    let mut upright = report();
    upright.fabric.reference_axis = Vec3::z();
    let sent = moduli_message(header(), &upright, &stiffness()).unwrap();
    let r = ModuliReading::try_from(&sent).unwrap();
    assert_eq!(r.reference_axis, Vec3::z());
    // The projection of a transversely isotropic stiffness is exact up to rounding.
    for (read, measured) in [
        (r.g12.unwrap(), 140e6),
        (r.g13.unwrap(), 150e6),
        (r.theta.unwrap(), (2.0 * 360e6 + 400e6 + 2.0 * 80e6 + 4.0 * 70e6) / 9.0),
    ] {
        assert!((read / measured - 1.0f64).abs() < 1e-14, "{read} {measured}");
    }
    assert_eq!(r.strain_ratios, report().strain_ratios);
    assert_eq!((r.stress_ratio, r.size_spread), (Some(0.0), Some(0.1)));
    assert_eq!((r.pressure, r.solid_fraction, r.material), (5e4, Some(0.64), Material::GLASS));
    assert_eq!(r.contact_law, Some(ContactLaw::default()));
    assert_eq!((r.grains, r.axis, r.covariance), (Some(500), Some(Vec3::z()), None));
    assert_eq!((sent.source_step, &sent.header), (7, &header()));
}

/// An instrument measures two or three moduli, pressure and the material; all other fields are unknown.
#[test]
fn fields_unknown_to_an_instrument_are_none() {
    let message = msg::Moduli {
        covariance: vec![4e12, 1e12, 0.0, 1e12, 4e12, 0.0, 0.0, 0.0, 9e12],
        g12: vec![140e6],
        g13: vec![150e6],
        theta: vec![170e6],
        name: "sand 4".to_owned(),
        pressure: 5e4,
        pressure_stddev: 500.0,
        solid_fraction: vec![0.64],
        stress_ratio: vec![0.0],
        stress_ratio_stddev: 0.05,
        size_spread: vec![0.1],
        grain_shear_modulus: 29e9,
        grain_shear_modulus_stddev: 1e9,
        grain_poisson_ratio: 0.2,
        grain_poisson_ratio_stddev: 0.02,
        grain_density: 2500.0,
        smooth: true,
        ..msg::Moduli::default()
    };
    let r = ModuliReading::try_from(&message).unwrap();
    assert_eq!((r.pressure_stddev, r.stress_ratio_stddev), (500.0, 0.05));
    assert_eq!((r.shear_modulus_stddev, r.poisson_ratio_stddev, r.smooth), (1e9, 0.02, true));
    assert_eq!(r.contact_law, None);
    assert_eq!((r.grains, r.stiffness, r.axis, r.strain_ratios), (None, None, None, StrainRatios::default()));
    assert_eq!(r.covariance.unwrap().to_vec(), message.covariance);
    let shear_alone = msg::Moduli { theta: vec![], solid_fraction: vec![], ..message };
    let r = ModuliReading::try_from(&shear_alone).unwrap();
    assert_eq!((r.g12, r.g13, r.theta, r.solid_fraction), (Some(140e6), Some(150e6), None, None));
}

#[test]
fn each_fault_of_the_moduli_is_refused_by_name() {
    let mut good = moduli_sent();
    good.covariance = vec![4e12, 1e12, 0.0, 1e12, 4e12, 0.0, 0.0, 0.0, 9e12];
    (good.contact_law, good.contact_law_parameters) = ("linear".to_owned(), vec![1e5, 0.5]);
    refuses(
        &good,
        &[
            (|m| m.header.stamp.nanosec = u32::MAX, "Moduli.header.stamp.nanosec"),
            (
                |m| m.stiffness[0].method = 1,
                "Moduli.stiffness.method = 1 is refused: it must be one of 0 (frozen network)",
            ),
            (|m| m.stiffness[0].stiffness[35] = NAN, "Moduli.stiffness.stiffness[35] = NaN is refused"),
            (|m| m.stiffness[0].stddev[3] = -1.0, "Moduli.stiffness.stddev[3] = -1.0 is refused"),
            (|m| m.stiffness[0].affine[0] = INF, "Moduli.stiffness.affine[0] = inf is refused"),
            (
                |m| m.stiffness[0].uniform_rotation[7] = NAN,
                "Moduli.stiffness.uniform_rotation[7] = NaN is refused",
            ),
            (
                |m| m.stiffness[0].bulk_reuss_bound[0] = -1.0,
                "Moduli.stiffness.bulk_reuss_bound = -1.0 is refused",
            ),
            (|m| m.stiffness[0].residual = NAN, "Moduli.stiffness.residual = NaN is refused"),
            (
                |m| m.stiffness.push(Default::default()),
                "Moduli.stiffness has 2 entries and is refused: it must have 1 (or none, if it is not known)",
            ),
            (|m| m.g12[0] = NAN, "Moduli.g12 = NaN is refused"),
            (|m| m.g13[0] = INF, "Moduli.g13 = inf is refused"),
            (|m| m.theta.push(1.0), "Moduli.theta has 2 entries and is refused: it must have 1"),
            (|m| _ = m.covariance.pop(), "Moduli.covariance has 8 entries and is refused: it must have 9"),
            (|m| m.covariance[1] = NAN, "Moduli.covariance[1] = NaN is refused"),
            (|m| m.covariance[4] = -1.0, "Moduli.covariance[4] = -1.0 is refused"),
            (|m| m.covariance[3] = 1.0, "Moduli.covariance[3] = 1.0 is refused: it must be symmetric"),
            (|m| m.pressure = -5e4, "Moduli.pressure = -50000.0 is refused"),
            (|m| m.solid_fraction[0] = 0.0, "Moduli.solid_fraction = 0.0 is refused"),
            (|m| m.pressure_stddev = NAN, "Moduli.pressure_stddev = NaN is refused"),
            (|m| m.stress_ratio[0] = NAN, "Moduli.stress_ratio = NaN is refused"),
            (|m| m.stress_ratio_stddev = -1.0, "Moduli.stress_ratio_stddev = -1.0 is refused"),
            (
                |m| (m.stress_ratio, m.stress_ratio_stddev) = (vec![], 0.1),
                "Moduli.stress_ratio_stddev = 0.1 is refused: it must be 0 where the quantity is not known",
            ),
            (|m| m.grain_shear_modulus_stddev = INF, "Moduli.grain_shear_modulus_stddev = inf is refused"),
            (|m| m.grain_poisson_ratio_stddev = -0.1, "Moduli.grain_poisson_ratio_stddev = -0.1 is refused"),
            (
                |m| m.contact_law = "hooke".into(),
                "Moduli.contact_law is refused: unknown contact law \"hooke\"",
            ),
            (|m| m.contact_law.clear(), "Moduli.contact_law is refused: unknown contact law \"\""),
            (|m| m.size_spread[0] = -0.1, "Moduli.size_spread = -0.1 is refused"),
            (|m| m.axis.z = 0.5, "Moduli.|axis| = 0.5 is refused: it must be 1"),
            (|m| m.axis.x = NAN, "Moduli.|axis| = NaN is refused"),
            (|m| m.strain_ratios.total[0] = NAN, "Moduli.strain_ratios.total = NaN is refused"),
            (|m| m.strain_ratios.contact.push(INF), "Moduli.strain_ratios.contact = inf is refused"),
            (|m| m.grain_shear_modulus = 0.0, "Moduli.grain_shear_modulus = 0.0 is refused"),
            (|m| m.grain_poisson_ratio = 0.51, "Moduli.grain_poisson_ratio = 0.51 is refused"),
            (|m| m.grain_density = -1.0, "Moduli.grain_density = -1.0 is refused"),
        ],
        |m| ModuliReading::try_from(m),
    );
}

#[test]
fn each_fault_of_a_fabric_is_refused_by_name() {
    refuses(
        &fabric_message(header(), &report()).unwrap(),
        &[
            (
                |m| m.contacts.rattlers = 501,
                "Fabric.contacts.rattlers = 501.0 is refused: it must be at most the number of grains",
            ),
            (|m| m.contacts.coordination = NAN, "Fabric.contacts.coordination = NaN is refused"),
            (
                |m| m.contacts.mechanical_coordination = -1.0,
                "Fabric.contacts.mechanical_coordination = -1.0 is refused",
            ),
            (|m| m.contact_fabric.yy = NAN, "Fabric.contact_fabric.yy = NaN is refused"),
            (|m| m.normal_force_fabric.xy = INF, "Fabric.normal_force_fabric.xy = inf is refused"),
            (|m| m.stiffness_fabric.yz = NAN, "Fabric.stiffness_fabric.yz = NaN is refused"),
            (|m| m.contact_anisotropy = INF, "Fabric.contact_anisotropy = inf is refused"),
            (
                |m| m.principal_axis.direction.x = 1.0,
                "Fabric.|principal_axis.direction| = 1.4142135623730951 is refused",
            ),
            (|m| m.p4_coefficient = NAN, "Fabric.p4_coefficient = NaN is refused"),
            (|m| m.strain_ratios.total[0] = NAN, "Fabric.strain_ratios.total = NaN is refused"),
            (
                |m| m.contacts.sliding_fraction = 1.5,
                "Fabric.contacts.sliding_fraction = 1.5 is refused: it must be between 0 and 1",
            ),
        ],
        |m| FabricReading::try_from(m),
    );
    let mut broken = report();
    broken.fabric.contact_anisotropy = NAN;
    assert!(fabric_message(header(), &broken).is_err(), "nor is it written");
}

#[test]
fn a_run_state_is_read_and_its_faults_are_refused_by_name() {
    let good =
        msg::RunState { state: msg::RunState::FINISHED, progress: 1.0, step: 9, ..msg::RunState::default() };
    let reading = RunStateReading::try_from(&good).unwrap();
    assert_eq!((reading.status, reading.step, reading.last_packing_step), (RunStatus::Finished, 9, None));
    let with_packing = msg::RunState { packings: 2, last_packing_step: 8, ..good.clone() };
    assert_eq!(RunStateReading::try_from(&with_packing).unwrap().last_packing_step, Some(8));
    refuses(
        &good,
        &[
            (|m| m.state = 9, "RunState.state = 9 is refused: it must be one of 0 (running)"),
            (|m| m.progress = 1.5, "RunState.progress = 1.5 is refused: it must be between 0 and 1"),
            (|m| m.progress = NAN, "RunState.progress = NaN is refused"),
        ],
        |m| RunStateReading::try_from(m),
    );
}
